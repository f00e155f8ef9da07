// Slips of two components in ModeDynamics: the direction of their friction (theory.md section 4).
#include "runtime/integrate/mode_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// The reference directions of a new mode: those of the slips, or the mode's own where they are zero.
void ModeDynamics::chooseDirections(double time, const double *state) {
  const tf_model &model = at_.model();
  pairs_.clear();
  double largest = 1;
  for (int i = 0; i < model.nv; ++i)
    largest = std::max(largest, std::abs(state[model.nq + i]));
  slipRounding_ = slipAccuracy_ * largest;
  if (std::any_of(problem_.partner.begin(), problem_.partner.end(), [](int partner) { return partner >= 0; })) {
    at_.setPoint(time, state);
    at_.switching(ModelEvaluation::Slips);
  }
  for (int j = 0; j < problem_.tangentCount; ++j) {
    const int row = rows_.tangents()[j];
    if (problem_.partner[j] < j || contactMode_.slip[j] == 0)
      continue;
    SlipPair pair = {j, row, 1, 0, false};
    const bool given = static_cast<int>(mode_.direction.size()) > row + 1 && (mode_.direction[row] != 0 || mode_.direction[row + 1] != 0);
    if (given) {
      pair.c = mode_.direction[row];
      pair.s = mode_.direction[row + 1];
    } else if (const double speed = std::hypot(at_.slip[row], at_.slip[row + 1]); speed > 0) {
      // Slow, but faster than what the selection of modes takes for zero: renewDirections leaves it.
      pair.c = at_.slip[row] / speed;
      pair.s = at_.slip[row + 1] / speed;
    }
    pairs_.push_back(pair);
  }
  launches_ = false;
  if (pairs_.empty())
    return;
  renewDirections(time, state);
  for (const SlipPair &pair : pairs_)
    launches_ = launches_ || std::hypot(at_.slip[pair.modelRow], at_.slip[pair.modelRow + 1]) <= 10 * slipRounding_;
}

void ModeDynamics::renewDirections(double time, const double *state) {
  if (pairs_.empty())
    return;
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips);
  for (SlipPair &pair : pairs_) {
    pair.held = false;
    const double x = at_.slip[pair.modelRow], y = at_.slip[pair.modelRow + 1], speed = std::hypot(x, y);
    if (speed <= 10 * slipRounding_)
      continue;
    pair.c = x / speed;
    pair.s = y / speed;
  }
}

bool ModeDynamics::hasLaunched() const {
  constexpr double small = 1e-2;
  return std::all_of(pairs_.begin(), pairs_.end(), [this](const SlipPair &pair) {
    return std::hypot(at_.slip[pair.modelRow], at_.slip[pair.modelRow + 1]) > small * slipRounding_ / slipAccuracy_;
  });
}

double ModeDynamics::along(const SlipPair &pair) const { return pair.c * at_.slip[pair.modelRow] + pair.s * at_.slip[pair.modelRow + 1]; }

double ModeDynamics::across(const SlipPair &pair) const { return pair.c * at_.slip[pair.modelRow + 1] - pair.s * at_.slip[pair.modelRow]; }

double ModeDynamics::slipSpeed(int guard) const {
  const SlipPair &pair = pairs_[guards_[guard].index];
  return std::hypot(at_.slip[pair.modelRow], at_.slip[pair.modelRow + 1]);
}

// With x along and y across the reference direction, the direction of friction has the slope y/x, which goes on smoothly where x changes
// its sign. Below the rounding δ of slips the slope falls to 0 as x y/(x² + δ²).
void ModeDynamics::alignFrames() {
  for (const SlipPair &pair : pairs_) {
    const double x = along(pair), y = across(pair);
    const double slope = pair.held ? 0 : x * y / (x * x + slipRounding_ * slipRounding_);
    const double cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
    rows_.setFrame(pair.row, pair.c * cosine - pair.s * sine, pair.s * cosine + pair.c * sine);
  }
}

// d slip/dv is Jt; what slips depend on q by is no part of a compiled model and found by differences (of Jacobians only).
void ModeDynamics::differenceSlips(double time, const double *state) {
  const tf_model &model = at_.model();
  const int columns = model.nq + model.nv;
  slipByState_.resize(2 * pairs_.size() * columns);
  if (pairs_.empty())
    return;
  std::vector<double> point(state, state + size());
  const auto difference = [&](int k, double step, double factor, bool first) {
    point[k] = state[k] + step;
    at_.setPoint(time, point.data());
    at_.switching(ModelEvaluation::Slips);
    for (std::size_t p = 0; p < 2 * pairs_.size(); ++p) {
      double &target = slipByState_[p * columns + k];
      target = (first ? 0 : target) + factor * at_.slip[pairs_[p / 2].modelRow + p % 2];
    }
    point[k] = state[k];
  };
  for (int k = 0; k < model.nq; ++k) {
    const double step = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(state[k]));
    difference(k, step, 0.5 / step, true);
    difference(k, -step, -0.5 / step, false);
  }
  for (std::size_t p = 0; p < 2 * pairs_.size(); ++p)
    std::copy_n(at_.tangent.data() + (pairs_[p / 2].modelRow + static_cast<int>(p % 2)) * model.nv, model.nv,
                slipByState_.data() + p * columns + model.nq);
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips);
}

// Derivative of the angle of friction's direction by state `column` (see alignFrames).
double ModeDynamics::turning(std::size_t pair, int column) const {
  const SlipPair &p = pairs_[pair];
  if (p.held)
    return 0;
  const int columns = at_.model().nq + at_.model().nv;
  const double first = slipByState_[2 * pair * columns + column], second = slipByState_[(2 * pair + 1) * columns + column];
  const double dx = p.c * first + p.s * second, dy = p.c * second - p.s * first;
  const double x = along(p), y = across(p);
  const double square = x * x + slipRounding_ * slipRounding_;
  const double slope = x * y / square;
  return ((x * dy + y * dx) / square - 2 * slope * x * dx / square) / (1 + slope * slope);
}

}  // namespace tf::runtime
