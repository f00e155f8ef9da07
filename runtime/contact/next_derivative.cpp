#include "runtime/contact/next_derivative.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

double metricOf(const ContactProblem &problem, int row) {
  const double diagonal = problem.delassus(row, row);
  return diagonal > 0 ? std::sqrt(diagonal) : 1.0;
}

}  // namespace

void NextDerivative::pose(const ContactProblem &problem, const ContactRates &rates, double degeneracy, const ContactSolution &solution) {
  const int n = problem.normalCount, m = problem.tangentCount;
  ConeFrictionProblem &p = cone_.problem();
  p.resize(n, m);
  std::copy_n(problem.delassus.data(), (n + m) * (n + m), p.delassus.data());
  std::copy_n(rates.accelerationRate.begin(), n + m, p.bias.begin());
  degenerate_.assign(n + m, 0);
  for (const int row : solution.degenerate)
    degenerate_[row] = 1;
  for (int i = 0; i < n; ++i) {
    if (degenerate_[i])
      continue;
    p.normalKind[i] = solution.mode.closed[i] ? NormalKind::Bilateral : NormalKind::Prescribed;
    if (!solution.mode.closed[i])
      p.upper[i] = 0;
  }
  for (int j = 0; j < m; ++j)
    poseTangent(problem, rates, solution, degeneracy * solution.scale / metricOf(problem, n + j), j);
  dropDependent();
}

void NextDerivative::poseTangent(const ContactProblem &problem, const ContactRates &rates, const ContactSolution &solution,
                                 double zeroForce, int j) {
  ConeFrictionProblem &p = cone_.problem();
  const int n = problem.normalCount, owner = problem.owner[j];
  p.owner[j] = owner;
  p.friction[j] = owner >= 0 ? problem.friction[j] : 0.0;
  p.offset[j] = owner >= 0 ? rates.frictionRate[j] * solution.forces[owner] : rates.boundRate[j];
  const bool open = owner >= 0 && !degenerate_[owner] && !solution.mode.closed[owner];
  const bool without =
      owner >= 0 ? problem.friction[j] == 0 && rates.frictionRate[j] == 0 : problem.bound[j] == 0 && rates.boundRate[j] == 0;
  if (open || without || problem.isAcross(j)) {
    p.tangentKind[j] = TangentKind::None;
    return;
  }
  const int slip = problem.slipSign[j] != 0 ? problem.slipSign[j] : solution.mode.slip[j];
  const double force = solution.forces[n + j];
  // Off the border of their disk both rows of a pair keep their equations; it has no border yet where the limit is zero.
  const bool paired = problem.partner[j] >= 0 && problem.slipSign[j] == 0;
  if (paired && degenerate_[n + std::min(j, problem.partner[j])]) {
    p.tangentKind[j] = TangentKind::TwoSided;
    p.offset[j] = std::max(p.offset[j], 0.0);
    p.partner[j] = problem.partner[j];
    return;
  }
  if (problem.slipSign[j] != 0 || (!degenerate_[n + j] && slip != 0)) {
    p.tangentKind[j] = TangentKind::Slip;
    p.sign[j] = static_cast<std::int8_t>(slip);
  } else if (!degenerate_[n + j]) {
    p.tangentKind[j] = TangentKind::Bilateral;
  } else if (problem.limit(j, solution.forces.data()) <= zeroForce) {
    p.tangentKind[j] = TangentKind::TwoSided;
    p.offset[j] = std::max(p.offset[j], 0.0);
  } else {
    p.tangentKind[j] = TangentKind::OneSided;
    p.sign[j] = static_cast<std::int8_t>(force > 0 ? 1 : -1);
  }
}

// Of redundant rows that keep w = 0, a maximal independent subset (pivoted Cholesky factorisation of D) is enough: the accelerations of
// the others follow, and their forces' rates are free, here zero.
void NextDerivative::dropDependent() {
  ConeFrictionProblem &p = cone_.problem();
  const int n = p.normalCount;
  bilateral_.clear();
  for (int r = 0; r < n + p.tangentCount; ++r)
    if (r < n ? p.normalKind[r] == NormalKind::Bilateral : p.tangentKind[r - n] == TangentKind::Bilateral)
      bilateral_.push_back(r);
  const int k = static_cast<int>(bilateral_.size());
  gram_.resize(k, k);
  remaining_.resize(k);
  for (int r = 0; r < k; ++r)
    remaining_[r] = p.delassus(bilateral_[r], bilateral_[r]) > 0 ? 1.0 : 1e-300;  // positive: not yet taken
  for (int step = 0; step < k; ++step) {
    int best = -1;
    for (int r = 0; r < k; ++r)
      if (remaining_[r] > 0 && (best < 0 || remaining_[r] > remaining_[best] * (1 + 1e-12)))
        best = r;
    const int row = bilateral_[best];
    const double pivot = remaining_[best];
    remaining_[best] = -1;
    if (pivot <= 1e-10) {
      if (row < n) {
        p.normalKind[row] = NormalKind::Prescribed;
        p.upper[row] = 0;
      } else {
        p.tangentKind[row - n] = TangentKind::None;
      }
      std::fill_n(gram_.column(step), k, 0.0);
      continue;
    }
    const double root = std::sqrt(pivot);
    for (int r = 0; r < k; ++r) {
      const int other = bilateral_[r];
      const double scale = std::sqrt(p.delassus(other, other) * p.delassus(row, row));
      double value = scale > 0 ? p.delassus(other, row) / scale : 0.0;
      for (int c = 0; c < step; ++c)
        value -= gram_(r, c) * gram_(best, c);
      gram_(r, step) = value / root;
      if (remaining_[r] > 0)
        remaining_[r] = std::max(remaining_[r] - gram_(r, step) * gram_(r, step), 1e-300);
    }
  }
}

// True: decided. Redundant rows with the rate 0 stay in the mode whatever part of the load this solution gives them.
bool NextDerivative::labelNormal(int i, double zero, ContactSolution &solution) const {
  const bool opens = found_.acceleration[i] / metric_[i] > zero, closes = found_.force[i] * metric_[i] > zero;
  solution.mode.closed[i] = opens ? 0 : closes || redundant_ || found_.mode.normal[i] == NormalState::Active ? 1 : 0;
  return opens || closes || redundant_;
}

bool NextDerivative::labelTangent(int n, int j, double zero, ContactSolution &solution) const {
  const ConeFrictionProblem &p = cone_.problem();
  const double metric = metric_[n + j];
  const double acceleration = found_.acceleration[n + j] / metric;
  const int owner = p.owner[j];
  const double limit = p.offset[j] + (owner >= 0 ? p.friction[j] * found_.force[owner] : 0.0);
  const double side = p.tangentKind[j] == TangentKind::OneSided ? p.sign[j] : found_.force[n + j] > 0 ? 1 : -1;
  const bool sticks = (limit - side * found_.force[n + j]) * metric > zero;
  if (std::abs(acceleration) > zero) {
    solution.mode.slip[j] = static_cast<std::int8_t>(acceleration > 0 ? 1 : -1);
    return true;
  }
  solution.mode.slip[j] = sticks || redundant_ ? std::int8_t{0} : found_.mode.slip[j];
  return sticks || redundant_ || p.tangentKind[j] == TangentKind::None;
}

bool NextDerivative::labelPair(int n, int j, double zero, ContactSolution &solution) const {
  const double first = found_.acceleration[n + j], second = found_.acceleration[n + j + 1], length = std::hypot(first, second);
  const bool slips = length > zero * metric_[n + j];
  solution.mode.slip[j] = solution.mode.slip[j + 1] = slips ? 1 : 0;
  if (slips) {
    solution.mode.direction[j] = first / length;
    solution.mode.direction[j + 1] = second / length;
  }
  return true;
}

void NextDerivative::label(const ContactProblem &problem, double degeneracy, ContactSolution &solution) const {
  const int n = problem.normalCount;
  const double zero = degeneracy * found_.scale;
  std::size_t kept = 0;
  for (const int row : solution.degenerate) {
    const int j = row - n;
    const bool decided = j < 0                            ? labelNormal(row, zero, solution)
                         : cone_.problem().partner[j] > j ? labelPair(n, j, zero, solution)
                                                          : labelTangent(n, j, zero, solution);
    const bool inactive = j >= 0 && problem.owner[j] >= 0 && !solution.mode.closed[problem.owner[j]];
    if (!decided && !inactive)
      solution.degenerate[kept++] = row;
  }
  solution.degenerate.resize(kept);
}

bool NextDerivative::solvePlanar(const PlanarFrictionMode *preferred, double feasibility) {
  solver_.problem() = cone_.problem();
  found_ = solver_.solve(preferred, feasibility);
  metric_ = solver_.metric();
  return found_.status == PlanarFrictionSolution::Status::Solved || found_.status == PlanarFrictionSolution::Status::Several;
}

bool NextDerivative::solveConic(double feasibility) {
  const ConeFrictionSolution &conic = cone_.solve(nullptr, feasibility);
  metric_ = cone_.metric();
  found_.force = conic.force;
  found_.acceleration = conic.acceleration;
  found_.scale = conic.scale;
  found_.mode.normal.assign(cone_.problem().normalCount, NormalState::Active);
  found_.mode.slip.assign(cone_.problem().tangentCount, 0);
  return conic.solved;
}

void NextDerivative::decide(const ContactProblem &problem, const ContactRates &rates, const ContactMode *previous,
                            const ContactSolver::Settings &settings, ContactSolution &solution) {
  redundant_ = solution.redundant;
  pose(problem, rates, settings.degeneracy, solution);
  const PlanarFrictionMode *preferred = nullptr;
  if (previous != nullptr) {
    previous_.slip.assign(previous->slip.begin(), previous->slip.end());
    previous_.normal.resize(previous->closed.size());
    for (std::size_t i = 0; i < previous->closed.size(); ++i)
      previous_.normal[i] =
          previous->closed[i] && cone_.problem().normalKind[i] != NormalKind::Prescribed ? NormalState::Active : NormalState::Off;
    preferred = &previous_;
  }
  const std::vector<int> &partner = cone_.problem().partner;
  const bool paired = std::any_of(partner.begin(), partner.end(), [](int other) { return other >= 0; });
  const bool solved = paired ? solveConic(settings.feasibility) : solvePlanar(preferred, settings.feasibility);
  forceRates_ = found_.force;
  if (solved)
    label(problem, settings.degeneracy, solution);
}

}  // namespace tf::runtime
