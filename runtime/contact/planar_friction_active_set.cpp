// The planar friction problem by a primal-dual active set, which is a semismooth Newton method (Hintermüller, Ito and Kunisch, SIAM J.
// Optim. 13, 2002): each iteration solves the equations of one mode and moves every row whose condition fails to the state that the sign of
// its force or acceleration asks for. A few iterations from a good start, many rows at once; no guarantee, so pivoting stands behind it.
#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace tf::runtime {

namespace {

constexpr int iterationLimit = 25;
// Added to the diagonal (which is 1) of singular modes; refinement takes its effect away again and leaves the least-norm force.
constexpr double regularisation = 1e-6;
constexpr int refinements = 30;
// What rounding leaves, relative to the magnitude of the data: a solution is refined to this, and accepted with the tolerance of the caller
// only where nothing improves it.
constexpr double roundingError = 1e-13;

}  // namespace

// Forces of a mode whose equations are singular: iterated proximal points x ← x + (A + δ I)⁻¹ (b − A x).
PlanarFrictionSolver::Agreement PlanarFrictionSolver::solveRedundant(Candidate &candidate) {
  equations_.assemble(rows_, modeMatrix_);
  const int k = equations_.activeCount();
  DenseMatrix &A = factor_.matrix();
  A.resize(k, k);
  std::copy_n(modeMatrix_.data(), k * k, A.data());
  for (int r = 0; r < k; ++r)
    A(r, r) += regularisation;
  if (!factor_.factor(0))
    return Agreement::NotFinite;
  const int count = scaled_.normalCount + scaled_.tangentCount;
  unknown_.resize(k);
  equations_.rightHandSide(rows_, fixed_.data(), unknown_.data());
  target_.assign(unknown_.begin(), unknown_.end());
  factor_.solve(unknown_.data());
  double largest = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < refinements; ++pass) {
    residual_.assign(target_.begin(), target_.end());
    addColumns(modeMatrix_.data(), k, k, -1, unknown_.data(), residual_.data());
    const double before = std::exchange(largest, 0);
    for (const double r : residual_)
      largest = std::max(largest, std::abs(r));
    // Rounding, or a contradiction, keeps later passes from coming nearer.
    if (largest <= 1e-2 * roundingError * magnitude_ || (largest >= 0.5 * before && largest <= roundingError * magnitude_))
      break;
    factor_.solve(residual_.data());
    for (int r = 0; r < k; ++r)
      unknown_[r] += residual_[r];
  }
  candidate.force.resize(count);
  candidate.acceleration.resize(count);
  equations_.expand(rows_, unknown_.data(), candidate.force.data(), candidate.acceleration.data());
  // The active rows' accelerations as they are, not as they should be: the certificate must see contradictions.
  residual_.resize(k);
  std::transform(target_.begin(), target_.end(), residual_.begin(), std::negate());
  addColumns(modeMatrix_.data(), k, k, 1, unknown_.data(), residual_.data());
  for (int r = 0; r < k; ++r)
    candidate.acceleration[equations_.active()[r]] = residual_[r];
  candidate.violation = violation(candidate.force, candidate.acceleration);
  if (!std::isfinite(candidate.violation))
    return Agreement::NotFinite;
  return largest <= roundingError * magnitude_ ? Agreement::Agree : Agreement::Contradict;
}

// The mode's equations, of the kind that those of the mode before were, or else of the other one.
bool PlanarFrictionSolver::solveLikeBefore(Candidate &candidate, Equations &kind) {
  setEquations(candidate.mode);
  Agreement agreement = Agreement::NotFinite;
  const bool wasSingular = kind == Equations::Singular;
  if (wasSingular && (agreement = solveRedundant(candidate)) == Agreement::Agree)
    return true;
  kind = solveEquations(candidate) ? Equations::Regular : Equations::Singular;
  if (kind == Equations::Singular && !wasSingular)
    agreement = solveRedundant(candidate);
  return kind == Equations::Regular || agreement != Agreement::NotFinite;
}

// The rows whose conditions fail, and the states that they ask for.
void PlanarFrictionSolver::listMoves(const Candidate &candidate) {
  const int n = scaled_.normalCount;
  const double zero = roundingError * magnitude_;
  moves_.clear();
  const auto moveNormal = [this](int i, NormalState to, double by) { moves_.push_back({i, static_cast<std::int8_t>(to), by}); };
  for (int i = 0; i < n; ++i) {
    if (scaled_.normalKind[i] != NormalKind::Unilateral)
      continue;
    const NormalState state = candidate.mode.normal[i];
    const double force = candidate.force[i], acceleration = candidate.acceleration[i];
    if (state == NormalState::Active && force < -zero)
      moveNormal(i, NormalState::Off, -force);
    else if (state == NormalState::Active && force > scaled_.upper[i] + zero)
      moveNormal(i, NormalState::Upper, force - scaled_.upper[i]);
    else if ((state == NormalState::Off && acceleration < -zero) || (state == NormalState::Upper && acceleration > zero))
      moveNormal(i, NormalState::Active, std::abs(acceleration));
  }
  for (int j = 0; j < scaled_.tangentCount; ++j) {
    const TangentKind kind = scaled_.tangentKind[j];
    if (kind != TangentKind::TwoSided && kind != TangentKind::OneSided)
      continue;
    const std::int8_t slip = candidate.mode.slip[j];
    const double force = candidate.force[n + j], acceleration = candidate.acceleration[n + j], bound = limit(j, candidate.force);
    if (slip != 0 && slip * acceleration < -zero)
      moves_.push_back({n + j, 0, std::abs(acceleration)});
    else if (slip == 0 && carriesForce(j, candidate.mode) && std::abs(force) > bound + zero &&
             (kind == TangentKind::TwoSided || force * scaled_.sign[j] > 0))
      moves_.push_back({n + j, static_cast<std::int8_t>(force > 0 ? -1 : 1), std::abs(force) - bound});
  }
}

void PlanarFrictionSolver::move(const Move &move, PlanarFrictionMode &mode) const {
  if (move.row < scaled_.normalCount)
    mode.normal[move.row] = static_cast<NormalState>(move.to);
  else
    mode.slip[move.row - scaled_.normalCount] = move.to;
}

bool PlanarFrictionSolver::accept() {
  if (!stable(trial_.mode))
    return false;
  std::swap(best_, trial_);
  return true;
}

// `known`: of the start, where it is the mode of trial_, completed, and evaluate() was last called with it.
bool PlanarFrictionSolver::activeSet(const PlanarFrictionMode *start, Equations known) {
  if (known == Equations::Unknown && start != nullptr) {
    trial_.mode.normal = start->normal;
    trial_.mode.slip = start->slip;
  } else if (known == Equations::Unknown) {
    // Contacts at rest in an impact (φ = 0) are pressed by one another: of a row of open ones each iteration would close the next one only.
    trial_.mode.normal.resize(scaled_.normalCount);
    for (int i = 0; i < scaled_.normalCount; ++i)
      trial_.mode.normal[i] = scaled_.bias[i] <= 0 ? NormalState::Active : NormalState::Off;
    trial_.mode.slip.assign(scaled_.tangentCount, 0);
  }
  bool movesAlone = false;
  Equations kind = known;
  for (int iteration = 0; iteration < iterationLimit; ++iteration) {
    completeMode(trial_.mode);
    // Each mode follows from the one before: one that returns does so again and again (Brent's test: it is compared with those after 1, 2,
    // 4, … iterations). From there on the row that is farthest off moves alone, as in pivoting, but from a mode that few rows contradict.
    if (iteration > 0 && trial_.mode == returning_) {
      if (movesAlone)
        return false;
      movesAlone = true;
    }
    if ((iteration & (iteration - 1)) == 0)
      returning_ = trial_.mode;
    const bool isSolved = iteration == 0 && known == Equations::Regular;
    if (!isSolved && !solveLikeBefore(trial_, kind))
      return false;
    if (trial_.violation <= 10 * roundingError)
      return accept();
    listMoves(trial_);
    if (moves_.empty())
      return trial_.violation <= tolerance_ && accept();
    if (movesAlone)
      move(*std::ranges::max_element(moves_, {}, &Move::by), trial_.mode);
    else
      for (const Move &one : moves_)
        move(one, trial_.mode);
  }
  return false;
}

}  // namespace tf::runtime
