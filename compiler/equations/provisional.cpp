#include "compiler/equations/provisional.h"

#include <fmt/format.h>

#include <span>

namespace tf::equations {

int Provisionals::variable(int unknown, int order, Span span) {
  const auto [entry, isNew] = variables_.try_emplace({unknown, order}, size());
  if (isNew)
    all_.push_back({Provisional::Kind::Variable, unknown, order, span});
  return entry->second;
}

int Provisionals::addSwitch(ProvisionalSwitch switching) {
  all_.push_back({Provisional::Kind::Switch, static_cast<int>(switches_.size()), 0, switching.span});
  switches_.push_back(std::move(switching));
  return size() - 1;
}

std::vector<ir::Symbol> symbolsOf(const ir::Graph &graph, ir::NodeId node) {
  return std::move(ir::dependencies(graph, std::span<const ir::NodeId>(&node, 1))[0]);
}

std::string SymbolNames::describe(ir::Symbol symbol) const {
  const auto index = static_cast<std::size_t>(symbol.index);
  const auto nameOf = [&](Role role) { return variables->name(variables->scalars(role)[index]); };
  switch (symbol.kind) {
  case ir::SymbolKind::Time:
    return "time";
  case ir::SymbolKind::Coordinate:
    return fmt::format("the coordinate '{}'", nameOf(Role::Coordinate));
  case ir::SymbolKind::Velocity:
    return fmt::format("the velocity of '{}'", variables->movingName(symbol.index));
  case ir::SymbolKind::Acceleration:
    return fmt::format("the acceleration of '{}'", variables->movingName(symbol.index));
  case ir::SymbolKind::Input:
    return fmt::format("the input '{}'", nameOf(Role::Input));
  case ir::SymbolKind::Parameter:
    return fmt::format("the parameter '{}'", nameOf(Role::Parameter));
  case ir::SymbolKind::NormalForce:
    return fmt::format("the contact force '{}'", normalForces[index]);
  case ir::SymbolKind::TangentForce:
    return fmt::format("the friction force '{}'", tangentForces[index]);
  case ir::SymbolKind::Multiplier:
    return fmt::format("the constraint force '{}'", multipliers[index]);
  case ir::SymbolKind::State:
    return fmt::format("the state '{}'", states[index]);
  default:
    return "a condition";
  }
}

}  // namespace tf::equations
