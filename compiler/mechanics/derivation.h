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

// Forward derivatives along the motion: q' = N v, t' = 1, v' = `acceleration` (0 or the symbols Acceleration).
enum class AlongMotion : std::uint8_t { WithoutAcceleration, WithAcceleration };
[[nodiscard]] std::vector<ir::NodeId> timeDerivative(HybridSystem &system, std::span<const ir::NodeId> nodes, AlongMotion motion);
[[nodiscard]] std::vector<ir::NodeId> symbols(ir::Graph &graph, ir::SymbolKind kind, int count);

// Affine in the velocities. Of a rotation: its angular velocity in the body's frame.
[[nodiscard]] std::vector<ir::NodeId> angularVelocity(HybridSystem &system, std::span<const ir::NodeId> rotation);
[[nodiscard]] BodyRates ratesOf(HybridSystem &system, const BodyEntry &body);
// Of `at`; where that is a rotation, its angular velocity in the world's frame.
[[nodiscard]] std::vector<ir::NodeId> ratesOf(HybridSystem &system, const ForceEntry &force);
// What the constraint holds at 0.
[[nodiscard]] std::vector<ir::NodeId> ratesOf(HybridSystem &system, const ConstraintEntry &constraint);

// The power is value·d(at)/dt, or torque·angular velocity.
[[nodiscard]] ir::NodeId kineticEnergyOf(HybridSystem &system, const BodyEntry &body);
[[nodiscard]] ir::NodeId powerOf(HybridSystem &system, const ForceEntry &force);

// What resists one rate of a body: mass or inertia of one scalar of its position or of its angle, or the tensor of inertia of its
// orientation, whose rates are the angular velocity in the body's frame.
struct Inertial {
  std::vector<ir::NodeId> rates;    // 1 or 3
  std::vector<ir::NodeId> inertia;  // [1] or [3 × 3]
  ir::NodeId gravity = -1;          // acceleration along it; −1: none
};
[[nodiscard]] std::vector<Inertial> inertials(const Derivation &derivation, const BodyEntry &body);
// Sum of the accelerations of all gravity elements that act on the body, one node per scalar of its position.
[[nodiscard]] std::vector<ir::NodeId> gravityOn(const Derivation &derivation, const BodyEntry &body);
// What inertia and gravity do along the rates: m (g − p''), and −(I ω' + ω × I ω) in the body's frame (Euler).
[[nodiscard]] std::vector<ir::NodeId> inertialForce(ir::Graph &graph, const Inertial &one, std::span<const ir::NodeId> acceleration);

// M and derivatives of at most so many entries are always written out: straight-line code is the fastest while it is small. Entries of
// contacts' rows are shorter, and evaluated for closed contacts only.
inline constexpr std::size_t fewEntries = 1000, fewRowEntries = 4000;
// Contacts' rows of so many entries on the average are of bodies that touch one another, not of mechanisms: together they are in proportion
// to the number of contacts, and code of like contacts is there once.
inline constexpr std::size_t shortRow = 16;

// M, f and the residual M v' − f − Jᵀλ.
void deriveDynamics(Derivation &derivation);
void deriveEnergies(Derivation &derivation);
// Residuals, rates, Jacobians and bias terms of constraints.
void deriveConstraints(Derivation &derivation);
// Gaps, slips, their rates, Jacobians and bias terms.
void deriveContacts(Derivation &derivation);
// Jn = ∂gap'/∂v and Jt = ∂slip/∂v of all contacts and tangential rows.
void writeOutRows(HybridSystem &system);

// What attributes may depend on, smoothness, affinity, coordinates without inertia; false after errors (reported).
[[nodiscard]] bool checkElements(Derivation &derivation);
[[nodiscard]] bool checkContacts(Derivation &derivation);
[[nodiscard]] bool checkConstraints(Derivation &derivation);
// Tensors of inertia that are not symmetric or not positive.
[[nodiscard]] bool checkInertia(Derivation &derivation);
// The largest nominal value of the coordinates and velocities that move `node`; 1 without any.
[[nodiscard]] double nominalOf(const HybridSystem &system, ir::NodeId node);
[[nodiscard]] bool checkMass(Derivation &derivation);

// Parameters, starts, and the table of quantities and aliases; false after errors (reported).
[[nodiscard]] bool tabulateParameters(Derivation &derivation);
// Starts that initial equations determine: of states that are not fixed, of coordinates and velocities with fixed = false.
[[nodiscard]] bool solveInitialEquations(Derivation &derivation, const std::vector<InitialEquation> &equations);
[[nodiscard]] bool tabulateQuantities(Derivation &derivation);

// Values of all parameters, bound ones included, as the model gives them.
[[nodiscard]] std::vector<double> parameterValues(const HybridSystem &system);

}  // namespace tf::mechanics
