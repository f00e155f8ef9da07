// The tangential rows that a slip of two components makes (theory.md section 4). Exact: its two components, which share one disk.
// Relaxed: these, for impacts and printed forms, and two planar rows along the slip, so that c3 = ‖v_t‖ − ε_t is the slip of a planar row
//     s = ‖v_t‖ − ε_t outside of the disk, (‖v_t‖² − ε_t²)/(2 ε_t) inside;  rows (1 − h)/2 (s + ε_t) > 0 and (1 + h)/2 s,
// each with the limit of the disk: λ_t = −limit v_t/‖v_t‖ outside, h limit v_t/ε_t inside, and on the edge s = 0 anything between. s is
// once continuously differentiable, smooth at v_t = 0 and has the gradient v_t/‖v_t‖ outside. Polyhedral with N directions d_k = (cos kπ/N,
// sin kπ/N): N rows w d_kᵀ v_t, each a planar sign law of its own with the limit of the disk,
//     λ_t = Σ_k w d_k λ_k,   λ_k ∈ −limit·sign(w d_kᵀ v_t),   w = sin(π/(2N)),
// so that λ_t lies in a regular polygon of 2N sides whose vertices are on the disk's edge (a zonotope).
#pragma once

#include "compiler/ir/graph.h"
#include "lang/semantics/flat_model.h"

#include <array>
#include <vector>

namespace tf::mechanics {

struct FrictionForm {
  int kind = 0;        // enum tf_friction_form
  int directions = 0;  // of a polyhedral one

  // A slip with its components, and ε_t.
  struct Slip {
    std::vector<ir::NodeId> components;
    ir::NodeId radius = -1;
  };

  // Of a contact or friction element.
  [[nodiscard]] static FrictionForm of(const flat::Element &element);

  // Number of tangential rows of a slip with `components`.
  [[nodiscard]] int rowCount(int components) const;
  // Of these, from the first: rows that are affine in velocities; and the row that tells whether the slip sticks.
  [[nodiscard]] int affineCount(int components) const;
  [[nodiscard]] int stickRow() const;
  // The slips of the rows.
  [[nodiscard]] std::vector<ir::NodeId> rows(ir::Graph &graph, const Slip &slip) const;
  // The components of the force whose rows have the given forces.
  [[nodiscard]] std::vector<ir::NodeId> components(ir::Graph &graph, const Slip &slip, const std::vector<ir::NodeId> &rowForces) const;

private:
  [[nodiscard]] std::vector<ir::NodeId> relaxedRows(ir::Graph &graph, const Slip &slip) const;
  [[nodiscard]] std::vector<ir::NodeId> relaxedComponents(ir::Graph &graph, const Slip &slip,
                                                          const std::vector<ir::NodeId> &rowForces) const;
  [[nodiscard]] std::array<double, 2> direction(int row) const;  // w d_k
};

}  // namespace tf::mechanics
