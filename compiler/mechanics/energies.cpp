// Kinetic and potential energy, and the power of what is applied: with T = kinetic, V = potential (of gravity and of potential elements)
//
//     d(T + V)/dt = power + (Jn v)·λn + (Jt v)·λt + (H v)·ν.
//
// Rates are w = J v + w_t. Forces F do the power F·J v on the system; what drives the explicit dependence on time does the rest:
// (I w' − weight)·w_t at bodies, −m p·∂g/∂t in gravity, ∂E/∂t + ∂E/∂z z' in potential elements (inputs are left out: they change in steps).
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

// w_t.
std::vector<NodeId> atRest(ir::Graph &graph, std::span<const NodeId> rates) {
  return ir::substitute(graph, rates, [&](Symbol symbol) { return symbol.kind == SymbolKind::Velocity ? graph.constant(0) : NodeId{-1}; });
}

class Energies {
public:
  explicit Energies(Derivation &derivation) : d_(derivation), system_(derivation.system), graph_(derivation.system.graph) {}

  void run() {
    for (const BodyEntry &body : d_.elements.bodies)
      addBody(body);
    for (const PotentialEntry &entry : d_.elements.potentials) {
      potential_.push_back(entry.energy);
      power_.push_back(explicitRate(entry.energy));
    }
    for (const ForceEntry &force : d_.elements.forces) {
      std::vector<NodeId> rates = ratesOf(system_, force);
      const std::vector<NodeId> driven = atRest(graph_, rates);
      for (std::size_t k = 0; k < rates.size(); ++k)
        rates[k] = graph_.sub(rates[k], driven[k]);
      power_.push_back(dot(graph_, force.value, rates));
    }
    system_.kineticEnergy = graph_.sum(kinetic_);
    system_.potentialEnergy = graph_.sum(potential_);
    system_.power = graph_.sum(power_);
  }

private:
  void addBody(const BodyEntry &body) {
    const BodyRates rates = ratesOf(system_, body);
    kinetic_.push_back(kineticEnergyOf(system_, body));
    const std::vector<NodeId> gravity = gravityOn(d_, body);
    for (std::size_t k = 0; k < body.position.size() && body.mass >= 0; ++k) {
      const NodeId moment = graph_.mul(body.mass, body.position[k]);
      potential_.push_back(graph_.neg(graph_.mul(gravity[k], moment)));
      power_.push_back(graph_.neg(graph_.mul(explicitRate(gravity[k]), moment)));
    }
    for (const Inertial &one : inertials(d_, body)) {
      const std::vector<NodeId> driven = atRest(graph_, one.rates);
      if (std::ranges::all_of(driven, [&](NodeId node) { return graph_.isConstant(node, 0); }))
        continue;
      const std::vector<NodeId> acceleration = timeDerivative(system_, one.rates, AlongMotion::WithAcceleration);
      power_.push_back(graph_.neg(dot(graph_, inertialForce(graph_, one, acceleration), driven)));
    }
  }

  // At rest, with time and states on their way.
  NodeId explicitRate(NodeId node) {
    return ir::forwardDerivative(graph_, std::array{node}, [&](Symbol symbol) {
      if (symbol.kind == SymbolKind::State)
        return system_.stateDerivatives[static_cast<std::size_t>(symbol.index)];
      return graph_.constant(symbol.kind == SymbolKind::Time ? 1 : 0);
    })[0];
  }

  Derivation &d_;
  HybridSystem &system_;
  ir::Graph &graph_;
  std::vector<NodeId> kinetic_, potential_, power_;
};

}  // namespace

void deriveEnergies(Derivation &derivation) { Energies(derivation).run(); }

}  // namespace tf::mechanics
