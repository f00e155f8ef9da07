// What the model's table says beyond the system's own lists.
#pragma once

#include "compiler/mechanics/hybrid_system.h"

#include <vector>

namespace tf::codegen {

// Length of the longest chain of bound parameters that depend on one another; 0 if none is bound.
[[nodiscard]] int bindingDepth(const HybridSystem &system);
// M depends on parameters only.
[[nodiscard]] bool massIsConstant(const HybridSystem &system);
// tf_model::locality: bits of tf_locality.
[[nodiscard]] int locality(const HybridSystem &system);
// tf_model::uniform_flight.
[[nodiscard]] bool flightIsUniform(const HybridSystem &system);
// tf_contact::friction_varies.
[[nodiscard]] bool frictionVaries(const HybridSystem &system, const Contact &contact);
// tf_contact::gap_is_affine of each contact.
[[nodiscard]] std::vector<bool> affineGaps(const HybridSystem &system);
// tf_friction::bound_by_velocity.
[[nodiscard]] bool dependsOnVelocity(const HybridSystem &system, const FrictionElement &friction);

// Entries of M below the diagonal that may differ from zero: columns[rows[i]] … columns[rows[i + 1] − 1] of row i, ascending.
struct MassStructure {
  std::vector<int> rows, columns;
  [[nodiscard]] bool isFull() const;
};
[[nodiscard]] MassStructure massStructure(const HybridSystem &system);

// tf_model::variation: bits of tf_variation for each gap, slip and condition, then for the forces. Empty where nothing varies.
[[nodiscard]] std::vector<int> variation(const HybridSystem &system);

}  // namespace tf::codegen
