// Sufficient conditions for at most one solution of a planar friction problem: one that has been found need not be compared with those of
// all other modes.
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr double clearPivot = 1e-9;

// Gaussian elimination without pivoting of a symmetric matrix, of its lower triangle: eliminates row k from those behind it.
void eliminate(DenseMatrix &matrix, int k) {
  const int size = matrix.rows();
  const double *pivot = matrix.column(k);
  for (int c = k + 1; c < size; ++c) {
    const double factor = pivot[c] / pivot[k];
    double *column = matrix.column(c);
    for (int r = c; r < size; ++r)
      column[r] -= factor * pivot[r];
  }
}

}  // namespace

bool PlanarFrictionSolver::isUnique(Wanted wanted) {
  const DenseMatrix &D = scaled_.delassus;
  // One contact whose friction is below Painlevé's limit.
  if (scaled_.normalCount == 1 && scaled_.tangentCount == 1 && scaled_.owner[0] == 0 && scaled_.normalKind[0] == NormalKind::Unilateral &&
      scaled_.tangentKind[0] == TangentKind::TwoSided)
    return D(0, 0) - scaled_.friction[0] * std::abs(D(0, 1)) > clearPivot && std::abs(D(0, 1)) < 1 - clearPivot;
  const bool onlyNormals =
      std::none_of(scaled_.normalKind.begin(), scaled_.normalKind.end(), [](NormalKind kind) { return kind == NormalKind::Bilateral; }) &&
      std::all_of(scaled_.tangentKind.begin(), scaled_.tangentKind.end(),
                  [](TangentKind kind) { return kind == TangentKind::None || kind == TangentKind::Slip; });
  return (onlyNormals && hasUniqueNormals()) || hasSmallFriction(wanted == Wanted::Forces);
}

// Normal forces alone are open, slips take friction along: the symmetric part of their matrix is positive definite.
bool PlanarFrictionSolver::hasUniqueNormals() {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  active_.assign(n + m, 0);
  slip_.resize(m);
  for (int i = 0; i < n; ++i)
    active_[i] = scaled_.normalKind[i] == NormalKind::Unilateral ? 1 : 0;
  for (int j = 0; j < m; ++j)
    slip_[j] = scaled_.tangentKind[j] == TangentKind::Slip ? scaled_.sign[j] : std::int8_t{0};
  equations_.setMode(rows_, active_.data(), slip_.data());
  DenseMatrix &A = factor_.matrix();
  equations_.assemble(rows_, A);
  const int k = A.rows();
  for (int c = 0; c < k; ++c)
    for (int r = c; r < k; ++r)
      A(r, c) = 0.5 * (A(r, c) + A(c, r));
  for (int c = 0; c < k; ++c) {
    if (!(A(c, c) > clearPivot))
      return false;
    eliminate(A, c);
  }
  return true;
}

// Two solutions differ by Δλ, Δw = D Δλ. Of normal rows, bounds and friction elements Δλ Δw ≤ 0; of the friction of contact i, whatever
// its kind, Δλ_t Δw_t ≤ μ |Δλ_i| |Δw_t|. With |x|² = Δλᵀ D Δλ, |Δw_t| ≤ √D_tt |x| and |Δλ_i| ≤ |x|/s_i, where s_i is what row i has that
// the other rows have not (its distance from their span in the metric of D): |x|² ≤ Σ μ √D_tt/s_i |x|². Where that sum is below one,
// x = 0: the accelerations are unique, and so are the forces of rows that do not depend on each other.
bool PlanarFrictionSolver::hasSmallFriction(bool withForces) {
  constexpr double dependent = 1e-14, below = 1 - 1e-6;
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  // Rows whose forces are open: tangential ones first, those with a force that is given not at all.
  order_.clear();
  for (int j = 0; j < m; ++j)
    if (const int i = scaled_.owner[j];
        scaled_.tangentKind[j] != TangentKind::None &&
        !(scaled_.tangentKind[j] == TangentKind::Slip && (i < 0 || scaled_.normalKind[i] == NormalKind::Prescribed)))
      order_.push_back(n + j);
  const int tangents = static_cast<int>(order_.size());
  for (int i = 0; i < n; ++i)
    if (scaled_.normalKind[i] != NormalKind::Prescribed)
      order_.push_back(i);
  const int size = static_cast<int>(order_.size());
  rest_.resize(size, size);
  for (int c = 0; c < size; ++c)
    for (int r = c; r < size; ++r)
      rest_(r, c) = scaled_.delassus(order_[r], order_[c]);
  for (int k = 0; k < size; ++k) {
    if (rest_(k, k) > clearPivot)
      eliminate(rest_, k);
    else if (k >= tangents || withForces || rest_(k, k) > dependent)
      return false;
  }
  // 1/s_i² are the diagonal entries of the inverse of what is left of the normal rows: of L⁻ᵀ Δ⁻¹ L⁻¹, column by column of L⁻¹.
  double sum = 0;
  for (int k = tangents; k < size; ++k) {
    double friction = 0;
    for (int j = 0; j < m; ++j)
      if (scaled_.owner[j] == order_[k] && scaled_.tangentKind[j] != TangentKind::None)
        friction += scaled_.friction[j];
    if (friction == 0)
      continue;
    unknown_.assign(size, 0.0);
    unknown_[k] = 1;
    double square = 0;
    for (int c = k; c < size; ++c) {
      square += unknown_[c] * unknown_[c] / rest_(c, c);
      for (int r = c + 1; r < size; ++r)
        unknown_[r] -= rest_(r, c) / rest_(c, c) * unknown_[c];
    }
    sum += friction * std::sqrt(square);
  }
  return sum < below;
}

}  // namespace tf::runtime
