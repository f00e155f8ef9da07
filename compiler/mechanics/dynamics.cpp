// Equations of motion. Christoffel symbols never appear: with positions p(q, t), p' a forward derivative along v and p'' = J_p v' + a_bias
// a second one, the generalised inertial forces are the reverse sweep Σ m J_pᵀ p'' (one sweep for all bodies), and so are applied forces.
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

// One scalar of a body's position or angle, with the mass or inertia that resists it.
struct InertialRow {
  NodeId place = -1, inertia = -1;
  NodeId gravity = -1;  // acceleration along it; −1: none
};

// Sum of the accelerations of all gravity elements that act on the body, one node per scalar of its position.
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

std::vector<InertialRow> inertialRows(const Derivation &derivation) {
  std::vector<InertialRow> rows;
  for (const BodyEntry &body : derivation.elements.bodies) {
    const std::vector<NodeId> gravity = gravityOn(derivation, body);
    for (std::size_t k = 0; k < body.position.size() && body.mass >= 0; ++k)
      rows.push_back({body.position[k], body.mass, gravity[k]});
    if (body.angle >= 0 && body.inertia >= 0)
      rows.push_back({body.angle, body.inertia, derivation.system.graph.constant(0)});
  }
  return rows;
}

std::vector<NodeId> placesOf(const std::vector<InertialRow> &rows) {
  std::vector<NodeId> places;
  places.reserve(rows.size());
  for (const InertialRow &row : rows)
    places.push_back(row.place);
  return places;
}

// Roots and weights of one reverse sweep: Σ weight · ∂root/∂q.
struct GeneralisedForce {
  std::vector<NodeId> roots, weights;

  void add(NodeId root, NodeId weight) {
    roots.push_back(root);
    weights.push_back(weight);
  }
};

// Applied forces: virtual work value·δ(at), potentials −∂E/∂q; and m (g − acceleration) for each inertial row.
GeneralisedForce forcesAgainst(const Derivation &derivation, const std::vector<InertialRow> &rows,
                               const std::vector<NodeId> &accelerations) {
  ir::Graph &graph = derivation.system.graph;
  GeneralisedForce force;
  for (std::size_t k = 0; k < rows.size(); ++k)
    force.add(rows[k].place, graph.mul(rows[k].inertia, graph.sub(rows[k].gravity, accelerations[k])));
  for (const ForceEntry &entry : derivation.elements.forces)
    for (std::size_t k = 0; k < entry.at.size(); ++k)
      force.add(entry.at[k], entry.value[k]);
  for (const PotentialEntry &entry : derivation.elements.potentials)
    force.add(entry.energy, graph.constant(-1));
  return force;
}

// M_jk = Σ m (∂p/∂q_j)(∂p/∂q_k): column j is the reverse sweep with weights m ∂p/∂q_j; the upper half is the mirror image.
void deriveMass(HybridSystem &system, const std::vector<InertialRow> &rows) {
  ir::Graph &graph = system.graph;
  const auto n = static_cast<std::size_t>(system.nv);
  const std::vector<NodeId> coordinates = symbols(graph, SymbolKind::Coordinate, system.nq);
  const std::vector<NodeId> places = placesOf(rows);
  system.mass.assign(n * n, graph.constant(0));
  for (std::size_t j = 0; j < n; ++j) {
    const std::vector<NodeId> column = ir::forwardDerivative(graph, places, [&](Symbol symbol) {
      return graph.constant(symbol.kind == SymbolKind::Coordinate && symbol.index == static_cast<int>(j) ? 1 : 0);
    });
    GeneralisedForce sweep;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (!graph.isConstant(column[k], 0))
        sweep.add(places[k], graph.mul(rows[k].inertia, column[k]));
    if (sweep.roots.empty())
      continue;
    const std::vector<NodeId> below = ir::reverseDerivative(graph, sweep.roots, sweep.weights, std::span(coordinates).subspan(j));
    for (std::size_t k = j; k < n; ++k)
      system.mass[k * n + j] = system.mass[j * n + k] = below[k - j];
  }
}

// M v' − f − Jnᵀ λn − Jtᵀ λt as one sweep over full accelerations: cheaper to differentiate than M and f.
void deriveResidual(const Derivation &derivation, const std::vector<InertialRow> &rows, const std::vector<NodeId> &rates) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  GeneralisedForce sweep = forcesAgainst(derivation, rows, timeDerivative(graph, rates, AlongMotion::WithAcceleration));
  for (std::size_t k = 0; k < derivation.elements.contacts.size(); ++k)
    sweep.add(derivation.elements.contacts[k].gap, graph.symbol(SymbolKind::NormalForce, static_cast<int>(k)));
  const std::vector<NodeId> byPlace =
      ir::reverseDerivative(graph, sweep.roots, sweep.weights, symbols(graph, SymbolKind::Coordinate, system.nq));
  GeneralisedForce tangential;
  const auto addRows = [&](const std::vector<NodeId> &slip, int first) {
    for (std::size_t k = 0; k < slip.size(); ++k)
      tangential.add(slip[k], graph.symbol(SymbolKind::TangentForce, first + static_cast<int>(k)));
  };
  for (const ContactEntry &contact : derivation.elements.contacts)
    addRows(contact.slip, contact.tangentFirst);
  for (const FrictionEntry &friction : derivation.elements.frictions)
    addRows(friction.slip, friction.tangentFirst);
  const std::vector<NodeId> bySlip =
      ir::reverseDerivative(graph, tangential.roots, tangential.weights, symbols(graph, SymbolKind::Velocity, system.nv));
  system.residual.clear();
  for (std::size_t k = 0; k < byPlace.size(); ++k)
    system.residual.push_back(graph.neg(graph.add(byPlace[k], bySlip[k])));
}

void deriveEnergies(const Derivation &derivation, const std::vector<InertialRow> &rows) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  std::vector<NodeId> kinetic, potential, power;
  for (const BodyEntry &body : derivation.elements.bodies)
    kinetic.push_back(kineticEnergyOf(graph, body));
  for (const InertialRow &row : rows)
    potential.push_back(graph.neg(graph.mul(row.inertia, graph.mul(row.gravity, row.place))));
  for (const PotentialEntry &entry : derivation.elements.potentials)
    potential.push_back(entry.energy);
  for (const ForceEntry &force : derivation.elements.forces)
    power.push_back(powerOf(graph, force));
  system.kineticEnergy = graph.sum(kinetic);
  system.potentialEnergy = graph.sum(potential);
  system.power = graph.sum(power);
}

}  // namespace

std::vector<NodeId> symbols(ir::Graph &graph, SymbolKind kind, int count) {
  std::vector<NodeId> nodes;
  nodes.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    nodes.push_back(graph.symbol(kind, k));
  return nodes;
}

std::vector<NodeId> timeDerivative(ir::Graph &graph, std::span<const NodeId> nodes, AlongMotion motion) {
  return ir::forwardDerivative(graph, nodes, [&](Symbol symbol) {
    if (symbol.kind == SymbolKind::Coordinate)
      return graph.symbol(SymbolKind::Velocity, symbol.index);
    if (symbol.kind == SymbolKind::Velocity && motion == AlongMotion::WithAcceleration)
      return graph.symbol(SymbolKind::Acceleration, symbol.index);
    return graph.constant(symbol.kind == SymbolKind::Time ? 1 : 0);
  });
}

NodeId kineticEnergyOf(ir::Graph &graph, const BodyEntry &body) {
  std::vector<NodeId> terms;
  const auto addTerm = [&](NodeId inertia, std::span<const NodeId> places) {
    if (inertia < 0)
      return;
    for (const NodeId rate : timeDerivative(graph, places, AlongMotion::WithoutAcceleration))
      terms.push_back(graph.mul(inertia, graph.mul(rate, rate)));
  };
  addTerm(body.mass, body.position);
  if (body.angle >= 0)
    addTerm(body.inertia, std::array{body.angle});
  return graph.mul(graph.constant(0.5), graph.sum(terms));
}

NodeId powerOf(ir::Graph &graph, const ForceEntry &force) {
  const std::vector<NodeId> rate = timeDerivative(graph, force.at, AlongMotion::WithoutAcceleration);
  std::vector<NodeId> terms;
  terms.reserve(rate.size());
  for (std::size_t k = 0; k < rate.size(); ++k)
    terms.push_back(graph.mul(force.value[k], rate[k]));
  return graph.sum(terms);
}

void deriveDynamics(Derivation &derivation) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  const std::vector<InertialRow> rows = inertialRows(derivation);
  const std::vector<NodeId> rates = timeDerivative(graph, placesOf(rows), AlongMotion::WithoutAcceleration);
  deriveMass(system, rows);
  const GeneralisedForce sweep = forcesAgainst(derivation, rows, timeDerivative(graph, rates, AlongMotion::WithoutAcceleration));
  system.force = ir::reverseDerivative(graph, sweep.roots, sweep.weights, symbols(graph, SymbolKind::Coordinate, system.nq));
  deriveResidual(derivation, rows, rates);
  deriveEnergies(derivation, rows);
}

}  // namespace tf::mechanics
