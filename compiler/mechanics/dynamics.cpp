// Equations of motion by virtual power (Kane's form of d'Alembert's principle): everything that resists or drives the motion has a rate w
// that is affine in the velocities, w = J v + w_t: of a place p its time derivative, of a rotation its angular velocity. A force F along w
// makes the generalised force Jᵀ F = ∂(F·w)/∂v, one reverse sweep over the rates of the whole system. So Christoffel symbols never appear,
// and quasi-velocities (angular velocities) need nothing of their own.
#include "compiler/ir/sweep.h"
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;
using ir::SymbolKind;

namespace {

std::vector<NodeId> allRates(const std::vector<Inertial> &inertials) {
  std::vector<NodeId> rates;
  for (const Inertial &one : inertials)
    rates.insert(rates.end(), one.rates.begin(), one.rates.end());
  return rates;
}

// Roots and weights of one reverse sweep: Σ weight · ∂root/∂v.
struct GeneralisedForce {
  std::vector<NodeId> roots, weights;

  void add(NodeId root, NodeId weight) {
    roots.push_back(root);
    weights.push_back(weight);
  }
  void add(std::span<const NodeId> some, std::span<const NodeId> values) {
    roots.insert(roots.end(), some.begin(), some.end());
    weights.insert(weights.end(), values.begin(), values.end());
  }
  [[nodiscard]] std::vector<NodeId> sweep(HybridSystem &system) const {
    return ir::reverseDerivative(system.graph, roots, weights, symbols(system.graph, SymbolKind::Velocity, system.nv));
  }
};

// Inertial forces at the given accelerations of all rates, applied forces along the rates of `at`, potentials −∂E/∂q.
GeneralisedForce forcesAgainst(const Derivation &derivation, const std::vector<Inertial> &inertials,
                               std::span<const NodeId> accelerations) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  GeneralisedForce force;
  std::size_t first = 0;
  for (const Inertial &one : inertials) {
    force.add(one.rates, inertialForce(graph, one, accelerations.subspan(first, one.rates.size())));
    first += one.rates.size();
  }
  for (const ForceEntry &entry : derivation.elements.forces)
    force.add(ratesOf(system, entry), entry.value);
  for (const PotentialEntry &entry : derivation.elements.potentials)
    force.add(timeDerivative(system, std::array{entry.energy}, AlongMotion::WithoutAcceleration)[0], graph.constant(-1));
  return force;
}

// M_jk = Σ J_jᵀ I J_k over all inertias: column j is the reverse sweep with weights I J_j.
void deriveMass(HybridSystem &system, const std::vector<Inertial> &inertials) {
  ir::Graph &graph = system.graph;
  const auto n = static_cast<std::size_t>(system.nv);
  const std::vector<NodeId> velocities = symbols(graph, SymbolKind::Velocity, system.nv);
  const std::vector<NodeId> rates = allRates(inertials);
  const std::vector<NodeId> jacobian = ir::jacobian(graph, rates, velocities);
  system.mass.assign(n * n, graph.constant(0));
  for (std::size_t j = 0; j < n; ++j) {
    GeneralisedForce force;
    std::size_t first = 0;
    for (const Inertial &one : inertials) {
      std::vector<NodeId> column;
      column.reserve(one.rates.size());
      for (std::size_t k = 0; k < one.rates.size(); ++k)
        column.push_back(jacobian[(first + k) * n + j]);
      first += one.rates.size();
      if (std::ranges::any_of(column, [&](NodeId node) { return !graph.isConstant(node, 0); }))
        force.add(one.rates, tensorProduct(graph, one.inertia, column));
    }
    if (force.roots.empty())
      continue;
    const std::vector<NodeId> below = ir::reverseDerivative(graph, force.roots, force.weights, std::span(velocities).subspan(j));
    for (std::size_t k = j; k < n; ++k)
      system.mass[k * n + j] = system.mass[j * n + k] = below[k - j];
  }
}

// M s = ∂(M v')/∂v' · s out of the residual.
std::vector<NodeId> massProduct(HybridSystem &system) {
  ir::Graph &graph = system.graph;
  return ir::forwardDerivative(graph, system.residual, [&](ir::Symbol symbol) {
    return symbol.kind == SymbolKind::Acceleration ? graph.symbol(SymbolKind::Seed, symbol.index) : graph.constant(0);
  });
}

// M v' − f − Jnᵀ λn − Jtᵀ λt − Hᵀ ν as one sweep over full accelerations: cheaper to differentiate than M and f.
void deriveResidual(const Derivation &derivation, const std::vector<Inertial> &inertials) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  GeneralisedForce force = forcesAgainst(derivation, inertials, timeDerivative(system, allRates(inertials), AlongMotion::WithAcceleration));
  const auto addRows = [&](std::span<const NodeId> rates, SymbolKind kind, int first) {
    for (std::size_t k = 0; k < rates.size(); ++k)
      force.add(rates[k], graph.symbol(kind, first + static_cast<int>(k)));
  };
  std::vector<NodeId> gaps;
  for (const ContactEntry &contact : derivation.elements.contacts) {
    gaps.push_back(contact.gap);
    addRows(contact.form.rows(graph, {contact.slip, contact.slipRadius}), SymbolKind::TangentForce, contact.tangentFirst);
  }
  addRows(timeDerivative(system, gaps, AlongMotion::WithoutAcceleration), SymbolKind::NormalForce, 0);
  for (const FrictionEntry &friction : derivation.elements.frictions)
    addRows(friction.form.rows(graph, {friction.slip, friction.slipRadius}), SymbolKind::TangentForce, friction.tangentFirst);
  for (const ConstraintEntry &constraint : derivation.elements.constraints)
    addRows(ratesOf(system, constraint), SymbolKind::Multiplier, constraint.rowFirst);
  system.residual.clear();
  for (const NodeId component : force.sweep(system))
    system.residual.push_back(graph.neg(component));
}

}  // namespace

void deriveDynamics(Derivation &derivation) {
  HybridSystem &system = derivation.system;
  std::vector<Inertial> all;
  for (const BodyEntry &body : derivation.elements.bodies)
    std::ranges::move(inertials(derivation, body), std::back_inserter(all));
  const auto entries = static_cast<std::size_t>(system.nv) * static_cast<std::size_t>(system.nv);
  if (entries <= fewEntries)
    deriveMass(system, all);
  const std::vector<NodeId> accelerations = timeDerivative(system, allRates(all), AlongMotion::WithoutAcceleration);
  system.force = forcesAgainst(derivation, all, accelerations).sweep(system);
  deriveResidual(derivation, all);
  if (entries <= fewEntries)
    return;
  system.massProduct = massProduct(system);
  if (!ir::isSweepSmaller(system.graph, system.massProduct, system.nv, fewEntries)) {
    deriveMass(system, all);
    system.massProduct.clear();
  }
}

}  // namespace tf::mechanics

namespace tf {

void writeOutMatrices(HybridSystem &system) {
  if (!system.massProduct.empty()) {
    system.mass = ir::jacobian(system.graph, system.massProduct, mechanics::symbols(system.graph, ir::SymbolKind::Seed, system.nv));
    system.massProduct.clear();
  }
  if (!system.contactForce.empty()) {
    mechanics::writeOutRows(system);
    system.contactForce.clear();
  }
}

}  // namespace tf
