// Rates of what elements refer to, along the motion q' = N(q) v.
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

std::vector<NodeId> symbols(ir::Graph &graph, SymbolKind kind, int count) {
  std::vector<NodeId> nodes;
  nodes.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    nodes.push_back(graph.symbol(kind, k));
  return nodes;
}

std::vector<NodeId> timeDerivative(HybridSystem &system, std::span<const NodeId> nodes, AlongMotion motion) {
  ir::Graph &graph = system.graph;
  return ir::forwardDerivative(graph, nodes, [&](Symbol symbol) {
    if (symbol.kind == SymbolKind::Coordinate)
      return system.motion.rate(graph, symbol.index);
    if (symbol.kind == SymbolKind::Velocity && motion == AlongMotion::WithAcceleration)
      return graph.symbol(SymbolKind::Acceleration, symbol.index);
    return graph.constant(symbol.kind == SymbolKind::Time ? 1 : 0);
  });
}

std::vector<NodeId> angularVelocity(HybridSystem &system, std::span<const NodeId> rotation) {
  const equations::Vector3 w =
      system.motion.angularVelocity(system.graph, equations::quaternion(rotation), [&](std::span<const NodeId> nodes) {
        return timeDerivative(system, nodes, AlongMotion::WithoutAcceleration);
      });
  return {w.begin(), w.end()};
}

BodyRates ratesOf(HybridSystem &system, const BodyEntry &body) {
  BodyRates rates;
  rates.position = timeDerivative(system, body.position, AlongMotion::WithoutAcceleration);
  if (body.angle >= 0)
    rates.angle = timeDerivative(system, std::array{body.angle}, AlongMotion::WithoutAcceleration);
  if (!body.orientation.empty())
    rates.angularVelocity = angularVelocity(system, body.orientation);
  return rates;
}

std::vector<NodeId> ratesOf(HybridSystem &system, const ForceEntry &force) {
  if (!force.isTorque)
    return timeDerivative(system, force.at, AlongMotion::WithoutAcceleration);
  const std::vector<NodeId> w = angularVelocity(system, force.at);
  const equations::Vector3 inWorld = equations::rotate(system.graph, equations::quaternion(force.at), {w[0], w[1], w[2]});
  return {inWorld.begin(), inWorld.end()};
}

std::vector<NodeId> ratesOf(HybridSystem &system, const ConstraintEntry &constraint) {
  return constraint.isHolonomic ? timeDerivative(system, constraint.residual, AlongMotion::WithoutAcceleration) : constraint.residual;
}

NodeId kineticEnergyOf(HybridSystem &system, const BodyEntry &body) {
  return kineticEnergy(system.graph, ratesOf(system, body), body.mass, body.inertia);
}

NodeId powerOf(HybridSystem &system, const ForceEntry &force) { return dot(system.graph, force.value, ratesOf(system, force)); }

}  // namespace tf::mechanics
