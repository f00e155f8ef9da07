// FilippovSystem: the time-freezing form of a HybridSystem in numerical time tau (theory.md section 2), the one owner of its sum form
//
//     y' = Π_i (1 − push_i) f_ODE(y, u) + Σ_i push_i [ α3_i f_aux,i⁻ + (1 − α3_i) f_aux,i⁺ ],   push_i = (1 − α1_i)(1 − α2_i),
//
// with, for a polyhedral slip of two components (section 4), the bracket f_aux,n,i + Σ_k (1 − 2 α3_ik) f_aux,t,ik over its directions,
// y = (q, v, z, t), α_k ∈ γ(c_k). General switches and friction elements (section 5) act inside f_ODE, which depends on their α.
//
// Contract. Nodes live in the graph of the HybridSystem that the form was made of. StepVariable j < ns is the HybridSystem's switch j;
// those of contacts and friction elements follow. `steps` lists every α once, contacts first. Coefficients θ depend on step variables only.
#pragma once

#include "compiler/mechanics/hybrid_system.h"

#include <string>
#include <vector>

namespace tf::filippov {

enum class StepRole : std::uint8_t {
  Gap,      // c1 of a contact
  GapRate,  // c2 of a contact
  Slip,     // c3 of a contact: v_t, or ‖v_t‖ − ε_t where it has two components (section 4, relaxed), or one for each direction (polyhedral)
  Friction,  // slip of a friction element
  Switch,    // of a general switch
};

struct StepFunction {
  StepRole role = StepRole::Gap;
  int owner = 0;              // contact, friction element or switch
  int direction = 0;          // of a polyhedral slip
  ir::NodeId condition = -1;  // c(y, u)
  ir::NodeId variable = -1;   // the symbol α
  std::string meaning;        // "gap of floor"
};

// One vector field. q' = v and t' = 1 where time runs, 0 where it is frozen; M v' = force; z' in stateDerivatives (0 where frozen).
struct Field {
  std::string name;   // "f_ODE", "f_aux,n - f_aux,t"; with the contact in parentheses where there are several
  int contact = -1;   // −1: f_ODE
  double side = 0;    // −1: v_t > 0, +1: v_t < 0, 0: whatever the slip is
  int direction = 0;  // of a polyhedral slip, whose fields have tangential components only and names "f_aux,t[2]", "-f_aux,t[2]"
  bool timeRuns = false;
  std::vector<ir::NodeId> force;             // [nv]
  std::vector<ir::NodeId> stateDerivatives;  // [nz]
};

struct Term {
  ir::NodeId coefficient = -1;  // θ(α)
  int field = 0;
};

struct FilippovSystem {
  std::vector<StepFunction> steps;
  std::vector<ir::NodeId> push;  // [nc]
  std::vector<Field> fields;     // f_ODE first
  std::vector<Term> terms;       // the sum form
};

// Whether the field is one direction's part of a polyhedral friction.
[[nodiscard]] bool isDirection(const Field &field, const HybridSystem &system);

[[nodiscard]] FilippovSystem timeFreezing(HybridSystem &system);

// One row of Stewart's sign matrix S: the region where sign(c_k) = signs[k] for all k, in which the fields `active` add up.
struct Region {
  std::vector<int> signs;   // +1, −1
  std::vector<int> active;  // fields
  int mode = 0;             // regions of one mode have the same vector field; f_ODE with the switches' signs of mode 0 comes first
};

// pss and stewart enumerate up to this many switching functions.
inline constexpr int kEnumerationLimit = 12;
[[nodiscard]] std::vector<Region> regions(const FilippovSystem &filippov, HybridSystem &system);

// `--emit pss | stewart | step`.
[[nodiscard]] std::string printPiecewise(const FilippovSystem &filippov, HybridSystem &system);
[[nodiscard]] std::string printStewart(const FilippovSystem &filippov, HybridSystem &system);
[[nodiscard]] std::string printStep(const FilippovSystem &filippov, HybridSystem &system);

// First violation of the contract, empty if none: coefficients of each region's vertex are 0 or 1 and select the fields of that region, and
// one contact's coefficients, those of single directions aside, add up to 1 for all α.
[[nodiscard]] std::string verify(const FilippovSystem &filippov, HybridSystem &system);

}  // namespace tf::filippov
