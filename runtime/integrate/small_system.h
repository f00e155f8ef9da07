// The equations of FoldedForces by code for their size: systems without bilateral constraints that have a few velocities and a few unknown
// forces are solved without loops over sizes that are known at run time only, and without a factorisation in memory.
#pragma once

#include "runtime/integrate/model_evaluation.h"

#include <vector>

namespace tf::runtime {

class SmallSystem {
public:
  static constexpr int mostVelocities = 6, mostUnknowns = 3;

  // A row that slips with a force of −sign · limit · (the force of its contact's normal row, or 1 of a friction element). All pointers lead
  // into the arrays of a ModelEvaluation.
  struct SlippingRow {
    const double *jacobian = nullptr, *limit = nullptr;  // [nv]; friction coefficient, or bound
    double sign = 1;
  };
  // A row whose acceleration is zero; with `slip` (null pointers: none) it takes the friction of its contact along.
  struct ActiveRow {
    const double *jacobian = nullptr, *bias = nullptr;  // [nv]; velocity terms of the row's acceleration
    SlippingRow slip = {};
  };

  // A mode is begun by `clear`, which returns the place of the active rows, its rows, and `start`, which factorises a constant mass matrix.
  // False: there is no code for this size.
  std::vector<ActiveRow> &clear();
  void addSlipping(const SlippingRow &row) { slipping_.push_back(row); }  // of a friction element
  bool start(const ModelEvaluation &at);
  // The forces of the active rows, the accelerations [nv] and the determinant of the forces' matrix, out of M, f and the rows at the
  // evaluation's point. False: M is not positive definite or the rows depend on each other.
  bool solve(const ModelEvaluation &at, double *unknowns, double *acceleration, double &determinant) const {
    return solve_(*this, at, unknowns, acceleration, determinant);
  }

  // rate = (v, acceleration) [2 nv], of a model whose coordinates' rates are its velocities. False: a value is not finite.
  bool giveRates(const double *velocity, const double *acceleration, double *rate) const {
    return giveRates_(velocity, acceleration, rate);
  }

  // change += M⁻¹ Jᵀ (J M⁻¹ Jᵀ)⁻¹ residual over the first `count` active rows: the smallest change in the metric of M. False: as `solve`.
  bool correct(const ModelEvaluation &at, int count, const double *residual, double *change) const {
    return correct_[count](*this, at, residual, change);
  }

private:
  template <int nv> struct Factor;
  template <int nv, int count> struct Equations;
  using Solve = bool (*)(const SmallSystem &, const ModelEvaluation &, double *, double *, double &);
  using GiveRates = bool (*)(const double *, const double *, double *);
  using Correct = bool (*)(const SmallSystem &, const ModelEvaluation &, const double *, double *);
  template <int nv> void useSize();

  std::vector<ActiveRow> active_;
  std::vector<SlippingRow> slipping_;
  long long factorRevision_ = -1;                                                       // the parameters of factor_; −1: M is not constant
  double factor_[mostVelocities * mostVelocities] = {}, inverse_[mostVelocities] = {};  // of a constant M: L by rows, 1/Δ
  bool isDiagonal_ = false;                                                             // the constant M is diagonal
  Solve solve_ = nullptr;
  GiveRates giveRates_ = nullptr;
  const Correct *correct_ = nullptr;  // by the number of rows
};

}  // namespace tf::runtime
