#include "runtime/contact/planar_friction.h"

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/numbers.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Matrices of modes with a smaller pivot are singular: the diagonal of D is scaled to 1.
constexpr double singularMode = 1e-11;
// Up to so many modes all are tried; above, an active set and pivoting come first, and all modes only where these find no solution.
constexpr double enumerationLimit = 64, exhaustiveLimit = 20000;

}  // namespace

void PlanarFrictionProblem::resize(int normals, int tangents) {
  normalCount = normals;
  tangentCount = tangents;
  delassus.setZero(normals + tangents, normals + tangents);
  bias.assign(normals + tangents, 0.0);
  normalKind.assign(normals, NormalKind::Unilateral);
  upper.assign(normals, infinity);
  tangentKind.assign(tangents, TangentKind::None);
  sign.assign(tangents, 0);
  owner.assign(tangents, -1);
  friction.assign(tangents, 0.0);
  offset.assign(tangents, 0.0);
}

// Rows are divided by √D_rr, so that all rows, of whatever unit, have the diagonal 1.
void PlanarFrictionSolver::scale() {
  const int n = problem_.normalCount, m = problem_.tangentCount, count = n + m;
  scaled_.normalCount = n;
  scaled_.tangentCount = m;
  scaled_.normalKind = problem_.normalKind;
  scaled_.tangentKind = problem_.tangentKind;
  scaled_.sign = problem_.sign;
  scaled_.owner = problem_.owner;
  scaled_.upper.resize(n);
  scaled_.friction.resize(m);
  scaled_.offset.resize(m);
  scaled_.bias.resize(count);
  scaled_.delassus.resize(count, count);
  metric_.resize(count);
  magnitude_ = solution_.scale = 0;
  for (int r = 0; r < count; ++r) {
    const double diagonal = problem_.delassus(r, r);
    metric_[r] = diagonal > 0 ? std::sqrt(diagonal) : 1.0;
    // Inert slips are of no size of their own.
    if (const int owner = r >= n && problem_.tangentKind[r - n] == TangentKind::Slip ? problem_.owner[r - n] : -1;
        owner >= 0 && isInertSlip(diagonal, problem_.delassus(owner, owner)))
      metric_[r] = metric_[owner];
    scaled_.bias[r] = problem_.bias[r] / metric_[r];
  }
  for (int c = 0; c < count; ++c)
    for (int r = 0; r < count; ++r)
      scaled_.delassus(r, c) = problem_.delassus(r, c) / (metric_[r] * metric_[c]);
  for (int i = 0; i < n; ++i) {
    scaled_.upper[i] = problem_.upper[i] * metric_[i];
    if (scaled_.upper[i] < infinity)
      solution_.scale = std::max(solution_.scale, std::abs(scaled_.upper[i]));
  }
  for (int j = 0; j < m; ++j) {
    const int i = problem_.owner[j];
    scaled_.friction[j] = i >= 0 ? problem_.friction[j] * metric_[n + j] / metric_[i] : 0.0;
    scaled_.offset[j] = problem_.offset[j] * metric_[n + j];
    solution_.scale = std::max(solution_.scale, std::abs(scaled_.offset[j]));
  }
  const auto slips = [&](int r) {
    return r >= n && problem_.owner[r - n] < 0 &&
           (problem_.tangentKind[r - n] == TangentKind::Slip || problem_.tangentKind[r - n] == TangentKind::None);
  };
  double largest = solution_.scale;
  for (int r = 0; r < count; ++r)
    if (!slips(r))
      largest = std::max(largest, std::abs(scaled_.bias[r]));
  // Nothing depends on how a slip of a friction element goes on; one at a dead centre would be of any size beside forces that hardly move
  // it.
  for (int r = 0; r < count; ++r)
    if (const double size = std::abs(scaled_.bias[r]); !slips(r) || !(largest > 0) || size <= deadCentre * largest) {
      magnitude_ = std::max(magnitude_, size);
      solution_.scale = std::max(solution_.scale, problem_.weight(r) * size);
    }
  magnitude_ = std::max(magnitude_, solution_.scale);
  if (!(magnitude_ > 0))
    magnitude_ = solution_.scale = 1;
  rows_ = {n, m, &scaled_.delassus, scaled_.bias.data(), scaled_.owner.data(), scaled_.friction.data(), scaled_.offset.data()};
}

double PlanarFrictionSolver::limit(int j, const std::vector<double> &force) const {
  const int i = scaled_.owner[j];
  return scaled_.offset[j] + (i >= 0 ? scaled_.friction[j] * force[i] : 0.0);
}

// Whether the tangential row can carry force in the mode: its limit is not zero for good.
bool PlanarFrictionSolver::carriesForce(int j, const PlanarFrictionMode &mode) const {
  const int i = scaled_.owner[j];
  if (scaled_.tangentKind[j] == TangentKind::None)
    return false;
  if (i < 0 || mode.normal[i] != NormalState::Off || scaled_.offset[j] != 0)
    return true;
  return scaled_.normalKind[i] == NormalKind::Prescribed && scaled_.upper[i] != 0;
}

// Sets what the kinds of the rows leave no choice of.
void PlanarFrictionSolver::completeMode(PlanarFrictionMode &mode) const {
  for (int i = 0; i < scaled_.normalCount; ++i) {
    if (scaled_.normalKind[i] == NormalKind::Prescribed)
      mode.normal[i] = NormalState::Off;
    if (scaled_.normalKind[i] == NormalKind::Bilateral)
      mode.normal[i] = NormalState::Active;
    if (mode.normal[i] == NormalState::Upper && scaled_.upper[i] == infinity)
      mode.normal[i] = NormalState::Active;
  }
  for (int j = 0; j < scaled_.tangentCount; ++j) {
    switch (scaled_.tangentKind[j]) {
    case TangentKind::None:
    case TangentKind::Bilateral:
      mode.slip[j] = 0;
      break;
    case TangentKind::Slip:
      mode.slip[j] = scaled_.sign[j];
      break;
    case TangentKind::OneSided:
      if (mode.slip[j] == scaled_.sign[j])
        mode.slip[j] = 0;
      break;
    case TangentKind::TwoSided:
      if (!carriesForce(j, mode))
        mode.slip[j] = 0;
      break;
    }
  }
}

// Forces and accelerations of the candidate's mode; false where its equations are singular.
bool PlanarFrictionSolver::evaluate(Candidate &candidate) {
  setEquations(candidate.mode);
  return solveEquations(candidate);
}

void PlanarFrictionSolver::setEquations(const PlanarFrictionMode &mode) {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  active_.resize(n + m);
  slip_.resize(m);
  fixed_.resize(n);
  for (int i = 0; i < n; ++i) {
    active_[i] = mode.normal[i] == NormalState::Active ? 1 : 0;
    const bool loaded = mode.normal[i] == NormalState::Upper || scaled_.normalKind[i] == NormalKind::Prescribed;
    fixed_[i] = loaded ? scaled_.upper[i] : 0.0;
  }
  for (int j = 0; j < m; ++j) {
    slip_[j] = mode.slip[j];
    active_[n + j] = mode.slip[j] == 0 && carriesForce(j, mode) ? 1 : 0;
  }
  equations_.setMode(rows_, active_.data(), slip_.data());
}

// False: they are singular.
bool PlanarFrictionSolver::solveEquations(Candidate &candidate) {
  const int n = scaled_.normalCount, m = scaled_.tangentCount;
  equations_.assemble(rows_, factor_.matrix());
  if (!factor_.factor(singularMode))
    return false;
  unknown_.resize(equations_.activeCount());
  equations_.rightHandSide(rows_, fixed_.data(), unknown_.data());
  factor_.solve(unknown_.data());
  candidate.force.resize(n + m);
  candidate.acceleration.resize(n + m);
  equations_.expand(rows_, unknown_.data(), candidate.force.data(), candidate.acceleration.data());
  candidate.violation = violation(candidate.force, candidate.acceleration);
  return true;
}

// Largest violation of any condition, relative to the magnitude of the data. For λ ⟂ w it is the smaller of the two, so that it does not
// depend on the mode that the solution was found by.
double PlanarFrictionSolver::violation(const std::vector<double> &force, const std::vector<double> &acceleration) const {
  const int n = scaled_.normalCount;
  double largest = 0, worst = 0;
  for (const double f : force)
    largest = std::max(largest, std::abs(f));
  const auto include = [&worst](double v) { worst = v > worst || std::isnan(v) ? v : worst; };
  for (int i = 0; i < n; ++i) {
    const double f = force[i], w = acceleration[i];
    switch (scaled_.normalKind[i]) {
    case NormalKind::Prescribed:
      break;
    case NormalKind::Bilateral:
      include(std::abs(w));
      break;
    case NormalKind::Unilateral:
      include(std::max(-f, f - scaled_.upper[i]));
      include(std::min(f, w));
      include(std::min(scaled_.upper[i] - f, -w));
      break;
    }
  }
  for (int j = 0; j < scaled_.tangentCount; ++j) {
    const double f = force[n + j], w = acceleration[n + j], bound = limit(j, force), s = scaled_.sign[j];
    switch (scaled_.tangentKind[j]) {
    case TangentKind::None:
      include(std::abs(f));
      break;
    case TangentKind::Slip:
      include(std::abs(f + s * bound));
      break;
    case TangentKind::Bilateral:
      include(std::abs(w));
      break;
    case TangentKind::TwoSided:
      include(std::abs(f) - bound);
      include(std::min(f + bound, w));
      include(std::min(bound - f, -w));
      break;
    case TangentKind::OneSided:
      include(s * f - bound);
      include(s * w);
      include(std::min(bound - s * f, -s * w));
      break;
    }
  }
  return worst / (magnitude_ + 1e-5 * largest);
}

double PlanarFrictionSolver::certificate(const std::vector<double> &force, const std::vector<double> &acceleration) {
  trial_.force.resize(force.size());
  trial_.acceleration.resize(force.size());
  for (std::size_t r = 0; r < force.size(); ++r) {
    trial_.force[r] = force[r] * metric_[r];
    trial_.acceleration[r] = acceleration[r] / metric_[r];
  }
  return violation(trial_.force, trial_.acceleration);
}

// A contact that slips with D_s < 0 is an unstable balance: more force presses it together. Such a mode is not continued where another
// solution exists.
bool PlanarFrictionSolver::stable(const PlanarFrictionMode &mode) const {
  const int n = scaled_.normalCount;
  for (int i = 0; i < n; ++i) {
    if (mode.normal[i] != NormalState::Active)
      continue;
    double response = scaled_.delassus(i, i);
    for (int j = 0; j < scaled_.tangentCount; ++j)
      if (scaled_.owner[j] == i)
        response -= mode.slip[j] * scaled_.friction[j] * scaled_.delassus(i, n + j);
    if (response < 0)
      return false;
  }
  return true;
}

void PlanarFrictionSolver::publish(PlanarFrictionSolution::Status status) {
  const int count = scaled_.normalCount + scaled_.tangentCount;
  solution_.status = status;
  solution_.mode = best_.mode;
  solution_.violation = best_.violation;
  solution_.scale = std::max(solution_.scale, finestScale(best_.violation, magnitude_));
  solution_.force.resize(count);
  solution_.acceleration.resize(count);
  for (int r = 0; r < count; ++r) {
    solution_.scale = std::max(solution_.scale, std::abs(best_.force[r]));
    solution_.force[r] = best_.force[r] / metric_[r];
    solution_.acceleration[r] = best_.acceleration[r] * metric_[r];
  }
}

// Forces that are exact for what has to be held, if there are such; else those that are so for all data, of which what falls freely may be
// the largest by far.
const PlanarFrictionSolution &PlanarFrictionSolver::solve(const PlanarFrictionMode *previous, double tolerance, Wanted wanted) {
  using Status = PlanarFrictionSolution::Status;
  scale();
  tolerance_ = tolerance;
  pivots_ = 0;
  const double size = magnitude_, heldSize = solution_.scale;
  if (heldSize < size) {
    magnitude_ = heldSize;
    if (const Status status = search(previous, wanted); status == Status::Solved || status == Status::Several) {
      publish(status);
      return solution_;
    }
    magnitude_ = size;
  }
  publish(search(previous, wanted));
  return solution_;
}

PlanarFrictionSolution::Status PlanarFrictionSolver::search(const PlanarFrictionMode *previous, Wanted wanted) {
  using Status = PlanarFrictionSolution::Status;
  const int count = scaled_.normalCount + scaled_.tangentCount;
  best_.force.assign(count, 0.0);
  best_.acceleration.assign(count, 0.0);
  best_.mode.normal.assign(scaled_.normalCount, NormalState::Off);
  best_.mode.slip.assign(scaled_.tangentCount, 0);
  best_.violation = 0;
  completeMode(best_.mode);

  const bool few = modeCount() <= enumerationLimit;
  const bool single = few && isUnique(wanted);
  path_ = Path::Previous;
  Equations ofPrevious = Equations::Unknown;
  if (previous != nullptr && (!few || single)) {
    trial_.mode = *previous;
    completeMode(trial_.mode);
    ofPrevious = evaluate(trial_) ? Equations::Regular : Equations::Singular;
    if (ofPrevious == Equations::Regular && trial_.violation <= tolerance_ && (few || stable(trial_.mode))) {
      std::swap(best_, trial_);
      return Status::Solved;
    }
  }
  if (!few) {
    path_ = Path::ActiveSet;
    if (activeSet(previous, ofPrevious))
      return Status::Solved;
    path_ = Path::Pivoting;
    if (pivot())
      return Status::Solved;
    if (modeCount() > exhaustiveLimit)
      return Status::Unsettled;
  }
  path_ = Path::Enumeration;
  const int found = enumerate(previous, single);
  return found == 0 ? Status::None : found == 1 ? Status::Solved : Status::Several;
}

}  // namespace tf::runtime
