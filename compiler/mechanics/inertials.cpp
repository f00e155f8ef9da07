// Mass, inertia and weight of bodies.
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;

std::vector<NodeId> gravityOn(const Derivation &derivation, const BodyEntry &body) {
  ir::Graph &graph = derivation.system.graph;
  const auto scopeOf = [&](const ElementEntry &entry) -> const std::string & {
    return derivation.model.elements[static_cast<std::size_t>(entry.element)].scope;
  };
  std::vector<NodeId> total(body.position.size(), graph.constant(0));
  for (const GravityEntry &gravity : derivation.elements.gravities)
    if (isWithin(scopeOf(body), scopeOf(gravity)))
      for (std::size_t k = 0; k < std::min(total.size(), gravity.acceleration.size()); ++k)
        total[k] = graph.add(total[k], gravity.acceleration[k]);
  return total;
}

std::vector<Inertial> inertials(const Derivation &derivation, const BodyEntry &body) {
  std::vector<Inertial> all;
  const std::vector<NodeId> gravity = gravityOn(derivation, body);
  const BodyRates rates = ratesOf(derivation.system, body);
  for (std::size_t k = 0; k < body.position.size() && body.mass >= 0; ++k)
    all.push_back({{rates.position[k]}, {body.mass}, gravity[k]});
  if (!rates.angle.empty() && !body.inertia.empty())
    all.push_back({rates.angle, {body.inertia[0]}});
  if (!rates.angularVelocity.empty() && !body.inertia.empty())
    all.push_back({rates.angularVelocity, body.inertia});
  return all;
}

std::vector<NodeId> inertialForce(ir::Graph &graph, const Inertial &one, std::span<const NodeId> acceleration) {
  if (one.rates.size() == 1)
    return {graph.mul(one.inertia[0], one.gravity < 0 ? graph.neg(acceleration[0]) : graph.sub(one.gravity, acceleration[0]))};
  const auto vector = [](const std::vector<NodeId> &v) { return equations::Vector3{v[0], v[1], v[2]}; };
  const equations::Vector3 gyroscopic = equations::cross(graph, vector(one.rates), vector(tensorProduct(graph, one.inertia, one.rates)));
  std::vector<NodeId> force = tensorProduct(graph, one.inertia, acceleration);
  for (std::size_t k = 0; k < 3; ++k)
    force[k] = graph.neg(graph.add(force[k], gyroscopic[k]));
  return force;
}

}  // namespace tf::mechanics
