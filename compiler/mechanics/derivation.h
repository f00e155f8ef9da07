// The steps of derive(): from resolved elements to the equations of motion, contacts, checks and the table of quantities.
#pragma once

#include "compiler/mechanics/elements.h"
#include "compiler/mechanics/hybrid_system.h"

namespace tf::mechanics {

// One scalar initial equation, before the equations are solved.
struct InitialEquation {
  ir::NodeId left = -1, right = -1;
  Span span;
};

// What the steps share. Elements' nodes are resolved: in terms of the symbols of a HybridSystem.
struct Derivation {
  const flat::FlatModel &model;
  const equations::VariableTable &variables;
  equations::SymbolNames &names;
  equations::Scalariser &scalariser;
  equations::EquationSystem &equations;
  ElementTable &table;
  Elements &elements;
  HybridSystem &system;
  Diagnostics &diagnostics;
};

// Symbols that `node` depends on, those of the conditions of its step variables included.
[[nodiscard]] std::vector<ir::Symbol> allDependencies(const HybridSystem &system, ir::NodeId node);

// Forward derivatives along the motion: q' = v, t' = 1, v' = `acceleration` (0 or the symbols Acceleration).
enum class AlongMotion : std::uint8_t { WithoutAcceleration, WithAcceleration };
[[nodiscard]] std::vector<ir::NodeId> timeDerivative(ir::Graph &graph, std::span<const ir::NodeId> nodes, AlongMotion motion);
[[nodiscard]] std::vector<ir::NodeId> symbols(ir::Graph &graph, ir::SymbolKind kind, int count);

// ½ m |p'|² + ½ J φ'², and the power value·d(at)/dt.
[[nodiscard]] ir::NodeId kineticEnergyOf(ir::Graph &graph, const BodyEntry &body);
[[nodiscard]] ir::NodeId powerOf(ir::Graph &graph, const ForceEntry &force);

// M, f, the residual M v' − f − Jᵀλ, the energies (d'Alembert–Lagrange).
void deriveDynamics(Derivation &derivation);
// Gaps, slips, their rates, Jacobians and bias terms.
void deriveContacts(Derivation &derivation);

// What attributes may depend on, smoothness, affinity, coordinates without inertia; false after errors (reported).
[[nodiscard]] bool checkElements(Derivation &derivation);
[[nodiscard]] bool checkContacts(Derivation &derivation);
[[nodiscard]] bool checkMass(Derivation &derivation);

// Parameters, starts, and the table of quantities and aliases; false after errors (reported).
[[nodiscard]] bool tabulateParameters(Derivation &derivation);
// Starts that initial equations determine: of states that are not fixed, of coordinates and velocities with fixed = false.
[[nodiscard]] bool solveInitialEquations(Derivation &derivation, const std::vector<InitialEquation> &equations);
[[nodiscard]] bool tabulateQuantities(Derivation &derivation);

// Values of all parameters, bound ones included, as the model gives them.
[[nodiscard]] std::vector<double> parameterValues(const HybridSystem &system);

}  // namespace tf::mechanics
