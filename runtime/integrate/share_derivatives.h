// How redundant contacts come to share their load in another way: the multipliers z of their rows in the least-norm problem
// (ForceSet::shareMultipliers) decide by the derivative of D z = J u, u = W Jᵀ z, with z fixed. The model's derivatives are affine in
// accelerations and forces, so that those of J u are differences of them at (a + u, λ + z) and at (a, λ).
#pragma once

#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/row_system.h"

#include <span>
#include <vector>

namespace tf::runtime {

class ShareDerivatives {
public:
  // At the evaluation's point, after its dynamicsDerivatives with this mask, which stay; `multipliers` are z [rows], zero on rows whose
  // frame turns.
  void evaluate(ModelEvaluation &at, const RowSystem &rows, const std::uint8_t *mask, std::span<const double> multipliers);
  // d(D z)/dx_column [rows], in the rows' frames as they are.
  void column(const ModelEvaluation &at, const RowSystem &rows, int column, std::span<double> rate);
  // Of a row: J u.
  [[nodiscard]] double product(const RowSystem &rows, int row) const { return rows.product(row, acceleration_.data()); }

private:
  std::vector<double> force_, acceleration_, constraintForce_;  // Jᵀ z, u and the multipliers of the constraints
  std::vector<double> residualByState_, normalByState_, tangentByState_, constraintByState_;
  std::vector<double> forceChange_, constraintChange_;
};

}  // namespace tf::runtime
