// HybridSystem: the controlled complementarity Lagrangian system (theory.md section 1) in terms of the expression graph.
//
// Contract. Expressions refer to the symbols Time, Coordinate i, Velocity i, State i, Input i, Parameter i and StepVariable j; outputs and
// the residual also to Acceleration, NormalForce, TangentForce, Multiplier and StateDerivative. Conditions of switches do not depend on
// their own step variable. Everything that is a function of coordinates, time and parameters is twice differentiable. `verify` checks it.
#pragma once

#include "compiler/equations/motion.h"
#include "compiler/ir/function.h"
#include "compiler/ir/graph.h"
#include "lang/base/diagnostics.h"
#include "lang/semantics/flat_model.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace tf {

// A scalar quantity with a name in the model; fields as in tf_variable (runtime/abi/tf_model.h).
struct Quantity {
  std::string name, unit, description;
  int kind = 0;  // enum tf_kind
  int index = 0;
  int flags = 0;  // enum tf_variable_flags
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity(), nominal = 1;
  Span span;
};

struct Alias {
  std::string name, description;
  int quantity = 0;  // in HybridSystem::quantities
  double sign = 1;
};

struct TangentRow {
  ir::NodeId slip = -1, bias = -1;   // slip' = jacobian · v' + bias
  std::vector<ir::NodeId> jacobian;  // [nv], or empty: see HybridSystem::contactForce
};

struct Contact {
  std::string name;
  Span span;
  ir::NodeId gap = -1, gapRate = -1, bias = -1;  // gap'' = normal · v' + bias
  std::vector<ir::NodeId> normal;                // [nv], or empty: see HybridSystem::contactForce
  int tangentFirst = 0, tangentCount = 0;        // rows in HybridSystem::tangents
  ir::NodeId friction = -1, restitution = -1, rate = -1;
  int law = 0;  // enum tf_impact_law
  double nominal = 1;
  int frictionForm = 0;        // enum tf_friction_form
  ir::NodeId slipRadius = -1;  // of a relaxed form
  int affineCount = 0;         // of its rows, from the first: those of printed forms
};

struct FrictionElement {
  std::string name;
  Span span;
  int tangentFirst = 0, tangentCount = 0;
  ir::NodeId bound = -1;
  int frictionForm = 0;
  ir::NodeId slipRadius = -1;
  int affineCount = 0;
};

struct ConstraintRow {
  ir::NodeId residual = -1, rate = -1, bias = -1;  // rate' = jacobian · v' + bias; rate = residual where it is not holonomic
  std::vector<ir::NodeId> jacobian;                // [nv]
};

struct Constraint {
  std::string name;
  Span span;
  int rowFirst = 0, rowCount = 0;
  bool isHolonomic = true;
  double nominal = 1;
};

struct SwitchingFunction {
  std::string text;  // the condition as written
  Span span;
  ir::NodeId condition = -1;
  int kind = 0;  // enum tf_switch_kind
  bool zeroIsPositive = false;
  int of = -1;  // TF_SWITCH_REST: the switch that rests
};

struct HybridSystem {
  std::string name, description;
  ir::Graph graph;
  int nq = 0, nv = 0, nz = 0, nu = 0, np = 0;
  equations::Motion motion;  // of nq coordinates with nv velocities

  std::vector<Quantity> quantities;  // result columns, then parameters
  std::vector<Alias> aliases;

  std::vector<double> parameterValues;        // [np]
  std::vector<ir::NodeId> parameterBindings;  // [np], −1 where free
  std::vector<ir::NodeId> coordinateStarts, velocityStarts, stateStarts, inputStarts;

  std::vector<ir::NodeId> mass;              // [nv × nv]; empty where its entries would be many: see massProduct
  std::vector<ir::NodeId> massProduct;       // [nv] M s, s the symbols Seed; empty where `mass` is not
  std::vector<ir::NodeId> contactForce;      // [nv] Jnᵀ sn + Jtᵀ st, s = (sn, st) the symbols Seed; empty where the rows are written out
  std::vector<ir::NodeId> force;             // [nv]
  std::vector<ir::NodeId> residual;          // [nv] M v' − f − Jnᵀ λn − Jtᵀ λt − Hᵀ ν in terms of the symbols Acceleration, NormalForce,
                                             // TangentForce, Multiplier
  std::vector<ir::NodeId> stateDerivatives;  // [nz]
  std::vector<Contact> contacts;
  std::vector<FrictionElement> frictions;
  std::vector<TangentRow> tangents;
  std::vector<Constraint> constraints;
  std::vector<ConstraintRow> constraintRows;
  std::vector<SwitchingFunction> switches;
  std::vector<ir::NodeId> outputs;  // of quantities of kind TF_KIND_OUTPUT
  ir::NodeId kineticEnergy = -1, potentialEnergy = -1, power = -1;
  flat::Experiment experiment;

  [[nodiscard]] std::string symbolName(ir::Symbol symbol) const;
};

// Derives the system; nothing if there were errors (reported).
[[nodiscard]] std::optional<HybridSystem> derive(const flat::FlatModel &model, const SourceManager &sources, Diagnostics &diagnostics);

// `--emit cls`: unknowns, M, f, contacts, frictions, switches as readable mathematics.
[[nodiscard]] std::string print(const HybridSystem &system);
[[nodiscard]] std::string verify(const HybridSystem &system);

// Writes out M, Jn and Jt, for readers. Takes time and memory with the square of the system's size.
void writeOutMatrices(HybridSystem &system);

// The functions of runtime/abi/tf_model.h, in the order of the table's function pointers. A function that the table allows to be null and
// that is not needed has an empty name. Derivatives are formed in `system.graph`.
[[nodiscard]] std::vector<ir::Function> modelFunctions(HybridSystem &system);

}  // namespace tf
