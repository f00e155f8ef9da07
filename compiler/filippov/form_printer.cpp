#include "compiler/filippov/form_printer.h"

#include <fmt/format.h>

#include <algorithm>

namespace tf::filippov {

using ir::NodeId;
using ir::SymbolKind;

std::string FormPrinter::symbolName(ir::Symbol symbol) const {
  if (symbol.kind == SymbolKind::StepVariable)
    for (std::size_t k = 0; k < form.steps.size(); ++k)
      if (system.graph[form.steps[k].variable].symbol == symbol)
        return fmt::format("alpha[{}]", k + 1);
  return system.symbolName(symbol);
}

std::string FormPrinter::text(NodeId node) const {
  return ir::print(system.graph, node, [&](ir::Symbol symbol) { return symbolName(symbol); });
}

std::string FormPrinter::heading(const char *title) const {
  std::string state;
  const auto add = [&](SymbolKind kind, int count) {
    for (int k = 0; k < count; ++k)
      state += system.symbolName({kind, k}) + ", ";
  };
  add(SymbolKind::Coordinate, system.nq);
  add(SymbolKind::Velocity, system.nv);
  add(SymbolKind::State, system.nz);
  std::string heading = fmt::format("{} of {} in numerical time, y = ({}time)\n", title, system.name, state);
  for (const Contact &contact : system.contacts)
    if (!system.graph.isConstant(contact.restitution, 0))
      heading +=
          fmt::format("note: {} has the restitution {}; this form is that of restitution 0\n", contact.name, text(contact.restitution));
  return heading;
}

std::string FormPrinter::switchingFunctions() const {
  std::vector<std::string> left;
  std::size_t width = 0;
  for (std::size_t k = 0; k < form.steps.size(); ++k) {
    left.push_back(fmt::format("c[{}] = {}", k + 1, text(form.steps[k].condition)));
    width = std::max(width, left.back().size());
  }
  std::string all = "\nswitching functions\n";
  for (std::size_t k = 0; k < left.size(); ++k)
    all += fmt::format("  {:<{}}  {}\n", left[k], std::min<std::size_t>(width, 60), form.steps[k].meaning);
  return all;
}

bool FormPrinter::isMassDiagonal() const {
  for (int i = 0; i < system.nv; ++i)
    for (int j = 0; j < system.nv; ++j)
      if (i != j && !system.graph.isConstant(system.mass[static_cast<std::size_t>(i) * system.nv + j], 0))
        return false;
  return true;
}

std::string FormPrinter::massText() const {
  std::string all;
  for (int i = 0; i < system.nv && (!isMassDiagonal() || !system.constraints.empty()); ++i)
    for (int j = 0; j <= i; ++j)
      if (const NodeId node = system.mass[static_cast<std::size_t>(i) * system.nv + j]; !system.graph.isConstant(node, 0))
        all += fmt::format("  M[{},{}] = {}\n", i + 1, j + 1, text(node));
  return all.empty() ? all : "\nmass matrix (symmetric; entries that are not shown are 0)\n" + all;
}

// With bilateral constraints every force acts through W, which leaves H v = const, and w keeps the constraints while time runs (theory.md
// section 1).
std::string FormPrinter::constraintText() const {
  if (system.constraints.empty())
    return {};
  std::string all = "\nconstraints: W = inverse(M) - G H inverse(M), w = -G bias, G = inverse(M) H' pinv(H inverse(M) H')\n";
  for (const Constraint &constraint : system.constraints)
    for (int k = 0; k < constraint.rowCount; ++k) {
      const ConstraintRow &row = system.constraintRows[static_cast<std::size_t>(constraint.rowFirst) + k];
      std::string entries;
      for (const NodeId node : row.jacobian)
        entries += (entries.empty() ? "" : ", ") + text(node);
      all += fmt::format("  {}: 0 = {},  H = ({}),  bias = {}\n", constraint.name, text(row.residual), entries, text(row.bias));
    }
  return all;
}

std::string FormPrinter::components(const std::string &name, const std::vector<NodeId> &force, const std::vector<NodeId> &stateDerivatives,
                                    bool timeRuns, const Region *region) const {
  ir::Graph &graph = system.graph;
  const auto shown = [&](NodeId node) {
    if (region == nullptr)
      return text(node);
    return text(ir::substitute(graph, std::span<const NodeId>(&node, 1), [&](ir::Symbol symbol) {
      for (std::size_t k = 0; k < form.steps.size(); ++k)
        if (graph[form.steps[k].variable].symbol == symbol)
          return graph.constant(region->signs[k] > 0 ? 1 : 0);
      return NodeId{-1};
    })[0]);
  };
  std::string all = fmt::format("  {}\n", name);
  for (int k = 0; k < system.nq && timeRuns; ++k)
    all += fmt::format("    {}' = {}\n", system.symbolName({SymbolKind::Coordinate, k}), text(system.motion.rate(graph, k)));
  const bool isConstrained = !system.constraints.empty();
  const bool isDiagonal = isMassDiagonal() && !isConstrained;
  std::string list;
  for (int k = 0; k < system.nv; ++k) {
    const NodeId node = force[static_cast<std::size_t>(k)];
    list += (k == 0 ? "" : ", ") + shown(node);
    if (isDiagonal && !graph.isConstant(node, 0))
      all += fmt::format("    {}' = {}\n", system.symbolName({SymbolKind::Velocity, k}),
                         shown(graph.div(node, system.mass[static_cast<std::size_t>(k) * system.nv + k])));
  }
  if (!isDiagonal)
    all += fmt::format("    v' = {}*({}){}\n", isConstrained ? "W" : "inverse(M)", list, isConstrained && timeRuns ? " + w" : "");
  for (int k = 0; k < system.nz && timeRuns; ++k)
    all += fmt::format("    {}' = {}\n", system.symbolName({SymbolKind::State, k}), shown(stateDerivatives[static_cast<std::size_t>(k)]));
  return all + (timeRuns ? "    time' = 1\n" : "    all other components are 0: time is frozen\n");
}

// f_aux,n, and f_aux,t with f_aux,n ∓ f_aux,t the two sides of the slip.
std::string FormPrinter::auxiliary(int index) const {
  ir::Graph &graph = system.graph;
  const Contact &contact = system.contacts[static_cast<std::size_t>(index)];
  const std::string of = system.contacts.size() > 1 ? fmt::format("({})", contact.name) : "";
  std::vector<NodeId> normal;
  normal.reserve(contact.normal.size());
  for (const NodeId node : contact.normal)
    normal.push_back(graph.mul(node, contact.rate));
  std::string all = components("f_aux,n" + of, normal, {}, false, nullptr);
  if (contact.tangentCount == 1) {
    std::vector<NodeId> tangential;
    for (const NodeId node : system.tangents[static_cast<std::size_t>(contact.tangentFirst)].jacobian)
      tangential.push_back(graph.mul(node, graph.mul(contact.friction, contact.rate)));
    return all + components("f_aux,t" + of, tangential, {}, false, nullptr);
  }
  for (const Field &field : form.fields)
    if (field.contact == index && (isDirection(field, system) ? field.side > 0 : field.side != 0))
      all += components(field.name, field.force, {}, false, nullptr);
  return all;
}

std::string FormPrinter::fields(const std::vector<const Region *> &odeRegions) const {
  std::string all = "\nvector fields\n";
  const Field &ode = form.fields[0];
  for (const Region *region : odeRegions)
    all += components(sum(*region), ode.force, ode.stateDerivatives, true, region);
  if (odeRegions.empty())
    all += components(ode.name, ode.force, ode.stateDerivatives, true, nullptr);
  for (std::size_t k = 0; k < system.contacts.size(); ++k)
    all += auxiliary(static_cast<int>(k));
  return all + massText() + constraintText();
}

bool FormPrinter::hasInnerSteps() const {
  return std::ranges::any_of(form.steps, [](const StepFunction &step) { return step.role > StepRole::Slip; });
}

std::string FormPrinter::sum(const Region &region) const {
  if (region.active[0] == 0)
    return hasInnerSteps() ? fmt::format("f_ODE[R{}]", region.mode + 1) : "f_ODE";
  std::string all;
  for (const int field : region.active) {
    const std::string &name = form.fields[static_cast<std::size_t>(field)].name;
    all += name.starts_with('-') ? " - " + name.substr(1) : (all.empty() ? "" : " + ") + name;
  }
  return all;
}

}  // namespace tf::filippov
