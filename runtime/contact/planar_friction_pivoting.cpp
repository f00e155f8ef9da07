// The planar friction problem as a linear complementarity problem, for many rows. Friction without known direction takes Stewart and
// Trinkle's form (Int. J. Numer. Meth. Engng. 39, 1996): λ_t = β⁺ − β⁻ with the slip speed σ as multiplier of β⁺ + β⁻ ≤ limit, whose matrix
// is copositive, so that Lemke's method ends with a solution where no slip is prescribed.
#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

bool isFinite(double value) { return value < std::numeric_limits<double>::infinity(); }

}  // namespace

// Variables of row r begin at firstVariable_[r] (−1: none). Unilateral: λ and, with an upper bound, its multiplier ν. Bilateral: λ, free.
// TwoSided: β⁺, β⁻, σ. OneSided: e = limit − sign·λ.
int PlanarFrictionSolver::assignVariables() {
  const int n = scaled_.normalCount, count = n + scaled_.tangentCount;
  firstVariable_.assign(count, -1);
  int variables = 0;
  for (int r = 0; r < count; ++r) {
    int needed = 0;
    if (r < n) {
      const NormalKind kind = scaled_.normalKind[r];
      needed = kind == NormalKind::Prescribed ? 0 : kind == NormalKind::Bilateral || !isFinite(scaled_.upper[r]) ? 1 : 2;
    } else {
      const TangentKind kind = scaled_.tangentKind[r - n];
      needed = kind == TangentKind::TwoSided ? 3 : kind == TangentKind::None || kind == TangentKind::Slip ? 0 : 1;
    }
    if (needed > 0)
      firstVariable_[r] = variables;
    variables += needed;
  }
  return variables;
}

// λ = T z + constant.
void PlanarFrictionSolver::buildTransfer() {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  transfer_.clear();
  constant_.assign(n + m, 0.0);
  for (int i = 0; i < n; ++i) {
    if (firstVariable_[i] >= 0)
      transfer_.push_back({i, firstVariable_[i], 1});
    else
      constant_[i] = scaled_.upper[i];
  }
  for (int j = 0; j < m; ++j) {
    const int row = n + j, k = firstVariable_[row], i = scaled_.owner[j];
    const TangentKind kind = scaled_.tangentKind[j];
    if (kind == TangentKind::TwoSided) {
      transfer_.push_back({row, k, 1});
      transfer_.push_back({row, k + 1, -1});
    } else if (kind == TangentKind::Bilateral) {
      transfer_.push_back({row, k, 1});
    } else if (kind == TangentKind::Slip || kind == TangentKind::OneSided) {
      const double side = kind == TangentKind::Slip ? -scaled_.sign[j] : scaled_.sign[j];
      constant_[row] = side * limit(j, constant_);
      if (i >= 0 && firstVariable_[i] >= 0)
        transfer_.push_back({row, firstVariable_[i], side * scaled_.friction[j]});
      if (kind == TangentKind::OneSided)
        transfer_.push_back({row, k, -side});
    }
  }
}

void PlanarFrictionSolver::buildComplementarity(int variables) {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  response_.setZero(n + m, variables);
  for (const Entry &entry : transfer_)
    addColumns(scaled_.delassus.column(entry.row), n + m, 1, 1, &entry.factor, response_.column(entry.variable));
  constantResponse_ = scaled_.bias;
  addColumns(scaled_.delassus.data(), n + m, n + m, 1, constant_.data(), constantResponse_.data());

  complementarity_.resize(variables);
  DenseMatrix &M = complementarity_.matrix();
  std::vector<double> &q = complementarity_.bias();
  const auto setRow = [&](int variable, int row, double sign) {
    for (int c = 0; c < variables; ++c)
      M(variable, c) = sign * response_(row, c);
    q[variable] = sign * constantResponse_[row];
  };
  for (int i = 0; i < n; ++i) {
    const int k = firstVariable_[i];
    if (k < 0)
      continue;
    setRow(k, i, 1);
    if (scaled_.normalKind[i] == NormalKind::Bilateral) {
      complementarity_.setFree(k);
    } else if (isFinite(scaled_.upper[i])) {
      M(k, k + 1) += 1;
      M(k + 1, k) = -1;
      q[k + 1] = scaled_.upper[i];
    }
  }
  for (int j = 0; j < m; ++j) {
    const int row = n + j, k = firstVariable_[row], i = scaled_.owner[j];
    if (k < 0)
      continue;
    switch (scaled_.tangentKind[j]) {
    case TangentKind::Bilateral:
      setRow(k, row, 1);
      complementarity_.setFree(k);
      break;
    case TangentKind::OneSided:
      setRow(k, row, -scaled_.sign[j]);
      break;
    default:
      setRow(k, row, 1);
      setRow(k + 1, row, -1);
      M(k, k + 2) += 1;
      M(k + 1, k + 2) += 1;
      M(k + 2, k) = M(k + 2, k + 1) = -1;
      if (i >= 0 && firstVariable_[i] >= 0)
        M(k + 2, firstVariable_[i]) = scaled_.friction[j];
      q[k + 2] = limit(j, constant_);
      break;
    }
  }
}

// The mode and forces of the complementarity solution.
void PlanarFrictionSolver::readComplementarity(Candidate &candidate) {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  const std::vector<double> &z = complementarity_.z();
  const double zero = 1e-12 * magnitude_;
  candidate.force = constant_;
  for (const Entry &entry : transfer_)
    candidate.force[entry.row] += entry.factor * z[entry.variable];
  candidate.acceleration = scaled_.bias;
  addColumns(scaled_.delassus.data(), n + m, n + m, 1, candidate.force.data(), candidate.acceleration.data());

  candidate.mode.normal.assign(n, NormalState::Off);
  candidate.mode.slip.assign(m, 0);
  for (int i = 0; i < n; ++i) {
    const int k = firstVariable_[i];
    if (scaled_.normalKind[i] != NormalKind::Unilateral)
      continue;
    if (isFinite(scaled_.upper[i]) && z[k + 1] > zero)
      candidate.mode.normal[i] = NormalState::Upper;
    else if (z[k] > zero)
      candidate.mode.normal[i] = NormalState::Active;
  }
  for (int j = 0; j < m; ++j) {
    const int k = firstVariable_[n + j];
    const double w = candidate.acceleration[n + j];
    if (scaled_.tangentKind[j] == TangentKind::TwoSided && z[k + 2] > zero)
      candidate.mode.slip[j] = static_cast<std::int8_t>(w > 0 ? 1 : -1);
    if (scaled_.tangentKind[j] == TangentKind::OneSided && !(z[k] > zero))
      candidate.mode.slip[j] = static_cast<std::int8_t>(-scaled_.sign[j]);
  }
  completeMode(candidate.mode);
}

// Lemke's method; a second covering vector where the first meets a ray.
bool PlanarFrictionSolver::pivot() {
  const int variables = assignVariables();
  buildTransfer();
  for (int attempt = 0; attempt < 8; ++attempt) {
    buildComplementarity(variables);
    for (int k = 0; k < variables && attempt > 0; ++k)
      complementarity_.covering()[k] = 1 + 0.37 * attempt * ((k * 7 + attempt * 3) % 11);
    const auto status = complementarity_.solve(1e-8 * magnitude_);
    pivots_ += complementarity_.pivots();
    if (status == LinearComplementarity::Status::Contradictory)
      return false;
    if (status == LinearComplementarity::Status::Ray)
      continue;
    readComplementarity(best_);
    best_.violation = violation(best_.force, best_.acceleration);
    // The equations of the mode found, solved afresh, are free of the rounding that pivoting accumulates.
    trial_.mode = best_.mode;
    if (evaluate(trial_) && trial_.violation <= best_.violation)
      std::swap(best_, trial_);
    if (best_.violation <= tolerance_)
      return true;
  }
  return false;
}

}  // namespace tf::runtime
