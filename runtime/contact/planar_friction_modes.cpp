// All modes of a planar friction problem, one after the other: few rows only, but it finds every solution and proves that there is none.
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

double PlanarFrictionSolver::modeCount() const {
  double count = 1;
  for (int i = 0; i < scaled_.normalCount; ++i) {
    double loaded = 1;
    for (int j = 0; j < scaled_.tangentCount; ++j)
      if (scaled_.owner[j] == i)
        loaded *= scaled_.tangentKind[j] == TangentKind::TwoSided ? 3 : scaled_.tangentKind[j] == TangentKind::OneSided ? 2 : 1;
    if (scaled_.normalKind[i] == NormalKind::Unilateral)
      count *= 1 + loaded * (scaled_.upper[i] < std::numeric_limits<double>::infinity() ? 2 : 1);
    else
      count *= loaded;
  }
  for (int j = 0; j < scaled_.tangentCount; ++j)
    if (scaled_.owner[j] < 0)
      count *= scaled_.tangentKind[j] == TangentKind::TwoSided ? 3 : scaled_.tangentKind[j] == TangentKind::OneSided ? 2 : 1;
  return count;
}

int PlanarFrictionSolver::optionCount(int row, const PlanarFrictionMode &mode) const {
  const int n = scaled_.normalCount;
  if (row < n) {
    if (scaled_.normalKind[row] != NormalKind::Unilateral)
      return 1;
    return scaled_.upper[row] < std::numeric_limits<double>::infinity() ? 3 : 2;
  }
  const int j = row - n;
  if (!carriesForce(j, mode))
    return 1;
  return scaled_.tangentKind[j] == TangentKind::TwoSided ? 3 : scaled_.tangentKind[j] == TangentKind::OneSided ? 2 : 1;
}

// Option 0 of a normal row is Active, the last is Off: of modes with equally many contacts, the one whose lowest index is closed comes
// first.
void PlanarFrictionSolver::setOption(int row, int option, PlanarFrictionMode &mode) const {
  const int n = scaled_.normalCount;
  if (row < n) {
    if (scaled_.normalKind[row] != NormalKind::Unilateral)
      mode.normal[row] = scaled_.normalKind[row] == NormalKind::Bilateral ? NormalState::Active : NormalState::Off;
    else if (option == 0)
      mode.normal[row] = NormalState::Active;
    else
      mode.normal[row] = option + 1 == optionCount(row, mode) ? NormalState::Off : NormalState::Upper;
    return;
  }
  const int j = row - n;
  switch (scaled_.tangentKind[j]) {
  case TangentKind::None:
  case TangentKind::Bilateral:
    mode.slip[j] = 0;
    break;
  case TangentKind::Slip:
    mode.slip[j] = scaled_.sign[j];
    break;
  case TangentKind::TwoSided:
    mode.slip[j] = static_cast<std::int8_t>(option == 0 ? 0 : option == 1 ? 1 : -1);
    break;
  case TangentKind::OneSided:
    mode.slip[j] = static_cast<std::int8_t>(option == 0 ? 0 : -scaled_.sign[j]);
    break;
  }
}

// The next mode in lexicographic order of the options, row 0 slowest. Normal rows come first, so that a tangential row sees its owner.
bool PlanarFrictionSolver::nextMode(PlanarFrictionMode &mode) {
  const int count = scaled_.normalCount + scaled_.tangentCount;
  for (int row = count - 1; row >= 0; --row) {
    if (option_[row] + 1 >= optionCount(row, mode))
      continue;
    setOption(row, ++option_[row], mode);
    for (int later = row + 1; later < count; ++later) {
      option_[later] = 0;
      setOption(later, 0, mode);
    }
    return true;
  }
  return false;
}

void PlanarFrictionSolver::countChanges(const PlanarFrictionMode *previous) {
  trial_.pushing = 0;
  trial_.changes = 0;
  for (int i = 0; i < scaled_.normalCount; ++i) {
    trial_.pushing += static_cast<int>(trial_.mode.normal[i]);
    if (previous != nullptr && trial_.mode.normal[i] != previous->normal[i])
      ++trial_.changes;
  }
  for (int j = 0; j < scaled_.tangentCount; ++j)
    if (previous != nullptr && carriesForce(j, trial_.mode) && trial_.mode.slip[j] != previous->slip[j])
      ++trial_.changes;
}

// Accelerations of normal rows and of rows without slip: those of slipping rows may depend on how redundant contacts share their load.
bool PlanarFrictionSolver::sameMotion(const Candidate &a, const Candidate &b) const {
  const int n = scaled_.normalCount;
  const double tolerance = 1e-7 * magnitude_;
  for (int r = 0; r < n + scaled_.tangentCount; ++r) {
    if (r >= n && scaled_.tangentKind[r - n] == TangentKind::Slip)
      continue;
    if (std::abs(a.acceleration[r] - b.acceleration[r]) > tolerance)
      return false;
  }
  return true;
}

// Whether the trial replaces the best solution that moves differently.
bool PlanarFrictionSolver::preferred() const {
  const bool trialContinues = trial_.changes == 0 && stable(trial_.mode);
  const bool bestContinues = best_.changes == 0 && stable(best_.mode);
  if (trialContinues != bestContinues)
    return trialContinues;
  return trial_.pushing < best_.pushing;
}

// The number of solutions with different accelerations: 0, 1 or 2 (more than one).
int PlanarFrictionSolver::enumerate(const PlanarFrictionMode *previous, bool firstOnly) {
  const int count = scaled_.normalCount + scaled_.tangentCount;
  trial_.mode.normal.resize(scaled_.normalCount);
  trial_.mode.slip.resize(scaled_.tangentCount);
  option_.assign(count, 0);
  for (int row = 0; row < count; ++row)
    setOption(row, 0, trial_.mode);
  int found = 0;
  do {
    if (!evaluate(trial_) || !(trial_.violation <= tolerance_))
      continue;
    countChanges(previous);
    if (previous == nullptr)
      trial_.changes = 1;
    bool take = found == 0;
    if (!take && sameMotion(trial_, best_)) {
      const bool isStable = stable(trial_.mode);
      take = isStable == stable(best_.mode) ? trial_.changes < best_.changes : isStable;
    } else if (!take) {
      found = 2;
      take = preferred();
    }
    if (found == 0)
      found = 1;
    if (take) {
      best_.mode = trial_.mode;
      best_.force = trial_.force;
      best_.acceleration = trial_.acceleration;
      best_.violation = trial_.violation;
      best_.pushing = trial_.pushing;
      best_.changes = trial_.changes;
    }
    if (firstOnly)
      break;
  } while (nextMode(trial_.mode));
  return found;
}

}  // namespace tf::runtime
