// The tangential rows that a slip of two components makes (theory.md section 4). Exact and relaxed: its two components, which share one
// disk. Polyhedral with N directions d_k = (cos kπ/N, sin kπ/N): N rows w d_kᵀ v_t, each a planar sign law of its own with the limit of the
// disk,
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

  // Of a contact or friction element.
  [[nodiscard]] static FrictionForm of(const flat::Element &element);

  // Number of tangential rows of a slip with `components`.
  [[nodiscard]] int rowCount(int components) const;
  // The slips of the rows.
  [[nodiscard]] std::vector<ir::NodeId> rows(ir::Graph &graph, const std::vector<ir::NodeId> &slip) const;
  // The components of the force whose rows have the given forces.
  [[nodiscard]] std::vector<ir::NodeId> components(ir::Graph &graph, const std::vector<ir::NodeId> &rowForces) const;

private:
  [[nodiscard]] std::array<double, 2> direction(int row) const;  // w d_k
};

}  // namespace tf::mechanics
