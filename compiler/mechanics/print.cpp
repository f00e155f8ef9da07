// `--emit cls`: the complementarity Lagrangian system as readable mathematics.
#include "compiler/mechanics/hybrid_system.h"

#include "runtime/abi/tf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace tf {

namespace {

using ir::NodeId;
using ir::SymbolKind;

int kindOf(SymbolKind kind) {
  switch (kind) {
  case SymbolKind::Time:
    return TF_KIND_TIME;
  case SymbolKind::Coordinate:
    return TF_KIND_COORDINATE;
  case SymbolKind::Velocity:
    return TF_KIND_VELOCITY;
  case SymbolKind::State:
    return TF_KIND_STATE;
  case SymbolKind::Input:
    return TF_KIND_INPUT;
  case SymbolKind::Parameter:
    return TF_KIND_PARAMETER;
  case SymbolKind::StepVariable:
    return TF_KIND_STEP_VARIABLE;
  case SymbolKind::Acceleration:
    return TF_KIND_ACCELERATION;
  case SymbolKind::NormalForce:
    return TF_KIND_NORMAL_FORCE;
  case SymbolKind::TangentForce:
    return TF_KIND_TANGENT_FORCE;
  case SymbolKind::Multiplier:
    return TF_KIND_MULTIPLIER;
  case SymbolKind::StateDerivative:
    return TF_KIND_STATE_DERIVATIVE;
  case SymbolKind::Radius:
  case SymbolKind::Seed:
  case SymbolKind::Unknown:
    break;
  }
  return -1;
}

class SystemPrinter {
public:
  explicit SystemPrinter(const HybridSystem &system) : s_(system) {
    for (const Quantity &quantity : s_.quantities)
      names_.try_emplace({quantity.kind, quantity.index}, &quantity.name);
  }

  std::string run() {
    out_ = fmt::format("model {}{}\n", s_.name, s_.description.empty() ? "" : " \"" + s_.description + "\"");
    if (s_.nv > 0)
      out_ += fmt::format("complementarity Lagrangian system: M v' = f + sum Jn' normalForce + sum Jt' frictionForce{},  {}\n",
                          s_.constraints.empty() ? "" : " + sum H' multiplier",
                          s_.motion.rotations().empty() ? "v = der(q)" : "der(q) = N(q) v");
    variables("coordinates q", TF_KIND_COORDINATE, s_.coordinateStarts);
    variables("velocities v", TF_KIND_VELOCITY, s_.velocityStarts);
    variables("states z", TF_KIND_STATE, s_.stateStarts);
    variables("inputs u", TF_KIND_INPUT, s_.inputStarts);
    parameters();
    kinematics();
    dynamics();
    for (const Contact &one : s_.contacts)
      contact(one);
    for (const FrictionElement &one : s_.frictions)
      friction(one);
    for (const Constraint &one : s_.constraints)
      constraint(one);
    switches();
    outputs();
    return std::move(out_);
  }

private:
  std::string text(NodeId node) const {
    return ir::print(s_.graph, node, [&](ir::Symbol symbol) {
      const auto found = names_.find({kindOf(symbol.kind), symbol.index});
      return found != names_.end() ? *found->second : s_.symbolName(symbol);
    });
  }

  std::string row(const std::vector<NodeId> &nodes) const {
    std::string list;
    for (const NodeId node : nodes)
      list += (list.empty() ? "" : ", ") + text(node);
    return "(" + list + ")";
  }

  static std::string remark(const Quantity &quantity) {
    return (quantity.unit.empty() ? "" : "  [" + quantity.unit + "]") +
           (quantity.description.empty() ? "" : "  \"" + quantity.description + "\"");
  }

  void variables(const char *title, int kind, const std::vector<NodeId> &starts) {
    if (starts.empty())
      return;
    out_ += fmt::format("\n{}\n", title);
    for (const Quantity &quantity : s_.quantities)
      if (quantity.kind == kind)
        out_ += fmt::format("  {}  start {}{}\n", quantity.name, text(starts[static_cast<std::size_t>(quantity.index)]), remark(quantity));
  }

  void parameters() {
    if (s_.np > 0)
      out_ += "\nparameters\n";
    for (const Quantity &quantity : s_.quantities) {
      if (quantity.kind != TF_KIND_PARAMETER)
        continue;
      const auto index = static_cast<std::size_t>(quantity.index);
      const std::string value =
          s_.parameterBindings[index] >= 0 ? text(s_.parameterBindings[index]) : fmt::format("{}", s_.parameterValues[index]);
      out_ += fmt::format("  {} = {}{}\n", quantity.name, value, remark(quantity));
    }
  }

  void kinematics() {
    if (!s_.motion.rotations().empty())
      out_ += "\nrotations: der(R.q) = 1/2 R.q (0, R.w), a product of quaternions; R.w is the angular velocity in the body's frame\n";
    for (const equations::RotationCoordinate &rotation : s_.motion.rotations())
      out_ += fmt::format("  {}, ...: {}, ...\n", s_.symbolName({SymbolKind::Coordinate, rotation.coordinate}),
                          s_.symbolName({SymbolKind::Velocity, rotation.velocity}));
  }

  // Zeros are left out; M is symmetric, its lower half is printed.
  void dynamics() {
    if (s_.nv > 0)
      out_ += "\nequations of motion (entries that are not shown are 0; M is symmetric)\n";
    for (int i = 0; i < s_.nv; ++i)
      for (int j = 0; j <= i; ++j)
        if (const NodeId node = s_.mass[static_cast<std::size_t>(i) * s_.nv + j]; !s_.graph.isConstant(node, 0))
          out_ += fmt::format("  M[{},{}] = {}\n", i + 1, j + 1, text(node));
    for (int i = 0; i < s_.nv; ++i)
      if (const NodeId node = s_.force[static_cast<std::size_t>(i)]; !s_.graph.isConstant(node, 0))
        out_ += fmt::format("  f[{}] = {}\n", i + 1, text(node));
    if (s_.nz > 0)
      out_ += "\nstate equations\n";
    for (int k = 0; k < s_.nz; ++k)
      out_ += fmt::format("  {} = {}\n", s_.symbolName({SymbolKind::StateDerivative, k}),
                          text(s_.stateDerivatives[static_cast<std::size_t>(k)]));
  }

  void tangents(int first, int count) {
    for (int k = 0; k < count; ++k) {
      const TangentRow &tangent = s_.tangents[static_cast<std::size_t>(first) + k];
      const std::string index = count > 1 ? fmt::format("[{}]", k + 1) : "";
      out_ += fmt::format("  slip{} = {}\n", index, text(tangent.slip));
      out_ += fmt::format("  slip{}' = Jt v' + {},  Jt = {}\n", index, text(tangent.bias), row(tangent.jacobian));
    }
  }

  // What the form of friction changes.
  template <class Element> std::string formText(const Element &one) {
    switch (one.frictionForm) {
    case TF_FRICTION_RELAXED:
      return fmt::format(" where that is faster than {}", text(one.slipRadius));
    case TF_FRICTION_POLYHEDRAL:
      return " in each of its directions";
    default:
      return {};
    }
  }

  void contact(const Contact &one) {
    static constexpr const char *kLaws[] = {"Poisson", "Stronge", "Newton"};
    out_ += fmt::format("\ncontact {}: 0 <= gap, 0 <= normalForce, gap*normalForce = 0\n", one.name);
    out_ += fmt::format("  gap = {}\n  gap' = {}\n", text(one.gap), text(one.gapRate));
    out_ += fmt::format("  gap'' = Jn v' + {},  Jn = {}\n", text(one.bias), row(one.normal));
    tangents(one.tangentFirst, one.affineCount);
    if (one.tangentCount > 0)
      out_ += fmt::format("  |frictionForce| <= mu*normalForce against the slip{},  mu = {}\n", formText(one), text(one.friction));
    out_ +=
        fmt::format("  impact law {}, restitution {}, rate {}\n", kLaws[std::clamp(one.law, 0, 2)], text(one.restitution), text(one.rate));
  }

  void friction(const FrictionElement &one) {
    out_ += fmt::format("\nfriction {}: |force| <= bound against the slip{}\n", one.name, formText(one));
    tangents(one.tangentFirst, one.affineCount);
    out_ += fmt::format("  bound = {}\n", text(one.bound));
  }

  void constraint(const Constraint &one) {
    out_ += fmt::format("\nconstraint {}: residual = 0\n", one.name);
    for (int k = 0; k < one.rowCount; ++k) {
      const ConstraintRow &row = s_.constraintRows[static_cast<std::size_t>(one.rowFirst) + k];
      const std::string index = one.rowCount > 1 ? fmt::format("[{}]", k + 1) : "";
      out_ += fmt::format("  residual{} = {}\n", index, text(row.residual));
      if (one.isHolonomic)
        out_ += fmt::format("  residual{}' = {}\n", index, text(row.rate));
      out_ += fmt::format("  residual{}{} = H v' + {},  H = {}\n", index, one.isHolonomic ? "''" : "'", text(row.bias),
                          this->row(row.jacobian));
    }
  }

  void switches() {
    static constexpr const char *kKinds[] = {"sliding possible", "continuous", "time event", "1 while c stays 0"};
    if (!s_.switches.empty())
      out_ += "\nswitches: a step variable is 1 where c > 0, 0 where c < 0\n";
    for (std::size_t k = 0; k < s_.switches.size(); ++k)
      out_ += fmt::format("  {}:  c = {}  ({}; {})\n", s_.symbolName({SymbolKind::StepVariable, static_cast<int>(k)}),
                          text(s_.switches[k].condition), s_.switches[k].text, kKinds[s_.switches[k].kind]);
  }

  void outputs() {
    if (!s_.outputs.empty())
      out_ += "\noutputs\n";
    for (const Quantity &quantity : s_.quantities)
      if (quantity.kind == TF_KIND_OUTPUT)
        out_ += fmt::format("  {} = {}\n", quantity.name, text(s_.outputs[static_cast<std::size_t>(quantity.index)]));
    if (!s_.aliases.empty())
      out_ += "\nother names\n";
    for (const Alias &alias : s_.aliases)
      out_ +=
          fmt::format("  {} = {}{}\n", alias.name, alias.sign < 0 ? "-" : "", s_.quantities[static_cast<std::size_t>(alias.quantity)].name);
  }

  const HybridSystem &s_;
  std::map<std::pair<int, int>, const std::string *> names_;  // by kind and index
  std::string out_;
};

// Of a row that is no result of its own: of a direction of a polyhedral form, or along a relaxed slip.
std::string rowForceName(const HybridSystem &system, int row) {
  std::string name;
  const auto look = [&](const auto &element) {
    if (row >= element.tangentFirst && row < element.tangentFirst + element.tangentCount)
      name = fmt::format("{}.lt[{}]", element.name, row - element.tangentFirst + 1);
  };
  std::ranges::for_each(system.contacts, look);
  std::ranges::for_each(system.frictions, look);
  return name;
}

}  // namespace

std::string HybridSystem::symbolName(ir::Symbol symbol) const {
  const int kind = kindOf(symbol.kind);
  for (const Quantity &quantity : quantities)
    if (quantity.kind == kind && quantity.index == symbol.index)
      return quantity.name;
  if (symbol.kind == SymbolKind::TangentForce)
    return rowForceName(*this, symbol.index);
  return fmt::format("?{}[{}]", static_cast<int>(symbol.kind), symbol.index);
}

std::string print(const HybridSystem &system) { return SystemPrinter(system).run(); }

}  // namespace tf
