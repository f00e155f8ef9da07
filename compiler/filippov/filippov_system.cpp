#include "compiler/filippov/filippov_system.h"

#include "runtime/abi/tf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace tf::filippov {

using ir::NodeId;
using ir::SymbolKind;

namespace {

class TimeFreezing {
public:
  explicit TimeFreezing(HybridSystem &system) : system_(system), graph_(system.graph) {}

  FilippovSystem run() {
    one_ = graph_.constant(1);
    addOde();
    NodeId timeRuns = one_;
    for (std::size_t k = 0; k < system_.contacts.size(); ++k)
      timeRuns = graph_.mul(timeRuns, addContact(static_cast<int>(k)));
    for (std::size_t k = 0; k < system_.frictions.size(); ++k)
      addFriction(static_cast<int>(k));
    for (std::size_t k = 0; k < system_.switches.size(); ++k) {
      const SwitchingFunction &switching = system_.switches[k];
      if (switching.kind == TF_SWITCH_REST)
        continue;
      form_.steps.push_back({StepRole::Switch, static_cast<int>(k), 0, switching.condition,
                             graph_.symbol(SymbolKind::StepVariable, static_cast<int>(k)), switching.text});
    }
    form_.terms[0].coefficient = timeRuns;
    removeRests();
    return std::move(form_);
  }

private:
  // Filippov's solutions take in what happens on a surface: 0 for step variables of conditions that stay zero on it.
  void removeRests() {
    if (std::ranges::none_of(system_.switches, [](const SwitchingFunction &one) { return one.kind == TF_SWITCH_REST; }))
      return;
    const auto remove = [this](std::vector<NodeId> nodes) {
      return ir::substitute(graph_, nodes, [this](ir::Symbol symbol) {
        const bool isRest = symbol.kind == SymbolKind::StepVariable && symbol.index < static_cast<int>(system_.switches.size()) &&
                            system_.switches[static_cast<std::size_t>(symbol.index)].kind == TF_SWITCH_REST;
        return isRest ? graph_.constant(0) : NodeId{-1};
      });
    };
    for (Field &field : form_.fields) {
      field.force = remove(field.force);
      field.stateDerivatives = remove(field.stateDerivatives);
    }
    for (auto &step : form_.steps)
      step.condition = remove({step.condition})[0];
    for (auto &term : form_.terms)
      term.coefficient = remove({term.coefficient})[0];
  }

  void addOde() {
    form_.fields.push_back({"f_ODE", -1, 0, 0, true, system_.force, system_.stateDerivatives});
    form_.terms.push_back({one_, 0});
  }

  NodeId addStep(StepRole role, int owner, NodeId condition, std::string meaning, int direction = 0) {
    const NodeId variable = graph_.symbol(SymbolKind::StepVariable, static_cast<int>(system_.switches.size()) + count_++);
    form_.steps.push_back({role, owner, direction, condition, variable, std::move(meaning)});
    return variable;
  }

  NodeId opposite(NodeId alpha) { return graph_.sub(one_, alpha); }

  std::span<const TangentRow> rows(int first, int count) const {
    return std::span(system_.tangents).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }

  NodeId slipSpeed(std::span<const TangentRow> tangents) {
    std::vector<NodeId> squares;
    for (const TangentRow &row : tangents)
      squares.push_back(graph_.mul(row.slip, row.slip));
    return graph_.unary(ir::Op::Sqrt, graph_.sum(squares));
  }

  // c3: v_t, or ‖v_t‖ − ε_t.
  NodeId slipCondition(std::span<const TangentRow> tangents, NodeId radius) {
    return tangents.size() == 1 ? tangents[0].slip : graph_.sub(slipSpeed(tangents), radius);
  }

  // Tangential force per row with the given magnitude: against the slip outside (c3 > 0), and inside the small disk of two-component slips
  // along it, so that the solution slides on its edge (theory.md section 4, relaxed); with one component, against a negative slip.
  std::vector<NodeId> tangentForce(std::span<const TangentRow> tangents, NodeId magnitude, bool isOutside) {
    std::vector<NodeId> force;
    if (tangents.size() == 1)
      return {isOutside ? graph_.neg(magnitude) : magnitude};
    const NodeId speed = slipSpeed(tangents);
    for (const TangentRow &row : tangents)
      force.push_back(isOutside ? graph_.neg(graph_.mul(magnitude, graph_.div(row.slip, speed))) : row.slip);
    return force;
  }

  void addAlong(std::vector<NodeId> &force, const std::vector<NodeId> &row, NodeId factor) {
    for (std::size_t k = 0; k < force.size(); ++k)
      force[k] = graph_.add(force[k], graph_.mul(row[k], factor));
  }

  [[nodiscard]] std::string nameSuffix(const Contact &contact) const {
    return system_.contacts.size() > 1 ? fmt::format("({})", contact.name) : "";
  }

  Field auxiliaryField(int contact, std::string name, double side, int direction = 0) {
    Field field;
    field.name = std::move(name);
    field.contact = contact;
    field.side = side;
    field.direction = direction;
    field.force.assign(static_cast<std::size_t>(system_.nv), graph_.constant(0));
    field.stateDerivatives.assign(static_cast<std::size_t>(system_.nz), graph_.constant(0));
    return field;
  }

  void add(Field field, NodeId coefficient) {
    form_.terms.push_back({coefficient, static_cast<int>(form_.fields.size())});
    form_.fields.push_back(std::move(field));
  }

  void addAuxiliary(int index, double side, NodeId coefficient) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(index)];
    const std::string of = nameSuffix(contact);
    Field field =
        auxiliaryField(index, side == 0 ? "f_aux,n" + of : fmt::format("f_aux,n{} {} f_aux,t{}", of, side < 0 ? "-" : "+", of), side);
    addAlong(field.force, contact.normal, contact.rate);
    if (side != 0) {
      const auto tangents = rows(contact.tangentFirst, contact.affineCount);
      const std::vector<NodeId> force = tangentForce(tangents, graph_.mul(contact.friction, contact.rate), side < 0);
      for (std::size_t k = 0; k < tangents.size(); ++k)
        addAlong(field.force, tangents[k].jacobian, force[k]);
    }
    add(std::move(field), coefficient);
  }

  // One direction of a polyhedral slip, on one side of it.
  void addDirection(int index, int direction, double side, NodeId coefficient) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(index)];
    Field field =
        auxiliaryField(index, fmt::format("{}f_aux,t[{}]{}", side < 0 ? "-" : "", direction + 1, nameSuffix(contact)), side, direction);
    const NodeId limit = graph_.mul(contact.friction, contact.rate);
    addAlong(field.force, rows(contact.tangentFirst, contact.affineCount)[static_cast<std::size_t>(direction)].jacobian,
             side < 0 ? graph_.neg(limit) : limit);
    add(std::move(field), coefficient);
  }

  void addPolyhedralSlip(int index, NodeId push) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(index)];
    addAuxiliary(index, 0, push);
    for (int k = 0; k < contact.tangentCount; ++k) {
      const NodeId condition = rows(contact.tangentFirst, contact.affineCount)[static_cast<std::size_t>(k)].slip;
      const NodeId slip = addStep(StepRole::Slip, index, condition, fmt::format("slip of {} in direction {}", contact.name, k + 1), k);
      addDirection(index, k, -1, graph_.mul(push, slip));
      addDirection(index, k, 1, graph_.mul(push, opposite(slip)));
    }
  }

  // Returns 1 − push = α1 + (1 − α1) α2.
  NodeId addContact(int index) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(index)];
    const NodeId gap = addStep(StepRole::Gap, index, contact.gap, "gap of " + contact.name);
    const NodeId notGap = opposite(gap);
    const NodeId rate = addStep(StepRole::GapRate, index, contact.gapRate, "rate of the gap of " + contact.name);
    const NodeId notRate = opposite(rate);
    const NodeId push = graph_.mul(notGap, notRate);
    form_.push.push_back(push);
    if (contact.tangentCount == 0) {
      addAuxiliary(index, 0, push);
    } else if (contact.frictionForm == TF_FRICTION_POLYHEDRAL) {
      addPolyhedralSlip(index, push);
    } else {
      const NodeId condition = slipCondition(rows(contact.tangentFirst, contact.affineCount), contact.slipRadius);
      const NodeId slip = addStep(StepRole::Slip, index, condition, "slip of " + contact.name);
      const NodeId notSlip = opposite(slip);
      addAuxiliary(index, -1, graph_.mul(push, slip));
      addAuxiliary(index, 1, graph_.mul(push, notSlip));
    }
    const NodeId opening = graph_.mul(notGap, rate);
    return graph_.add(gap, opening);
  }

  // A friction element acts in f_ODE: α (force against the slip) + (1 − α) (the other side), section 5; each direction of a polyhedral
  // form.
  void addFriction(int index) {
    const FrictionElement &friction = system_.frictions[static_cast<std::size_t>(index)];
    const auto tangents = rows(friction.tangentFirst, friction.affineCount);
    const bool isPolyhedral = friction.frictionForm == TF_FRICTION_POLYHEDRAL;
    const std::size_t slips = isPolyhedral ? tangents.size() : 1, perSlip = tangents.size() / slips;
    for (std::size_t s = 0; s < slips; ++s) {
      const auto own = tangents.subspan(s * perSlip, perSlip);
      const std::string direction = isPolyhedral ? fmt::format(" in direction {}", s + 1) : "";
      const NodeId alpha = addStep(StepRole::Friction, index, slipCondition(own, friction.slipRadius),
                                   "slip of " + friction.name + direction, static_cast<int>(s));
      const std::vector<NodeId> outside = tangentForce(own, friction.bound, true);
      const std::vector<NodeId> inside = tangentForce(own, friction.bound, false);
      for (std::size_t k = 0; k < own.size(); ++k)
        addAlong(form_.fields[0].force, own[k].jacobian, graph_.select(alpha, outside[k], inside[k]));
    }
  }

  HybridSystem &system_;
  ir::Graph &graph_;
  FilippovSystem form_;
  NodeId one_ = -1;
  int count_ = 0;
};

}  // namespace

bool isDirection(const Field &field, const HybridSystem &system) {
  return field.side != 0 && system.contacts[static_cast<std::size_t>(field.contact)].frictionForm == TF_FRICTION_POLYHEDRAL;
}

FilippovSystem timeFreezing(HybridSystem &system) { return TimeFreezing(system).run(); }

}  // namespace tf::filippov
