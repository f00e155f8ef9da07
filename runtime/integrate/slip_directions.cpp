#include "runtime/integrate/slip_directions.h"

#include "runtime/integrate/tangent_roles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// Slips below this part of the velocities that move them are rounding errors of zero.
constexpr double still = 1e-12;
// Those that are small.
constexpr double small = 1e-2;

}  // namespace

void SlipDirections::choose(const Mode &mode, const RowSystem &rows, const ContactRows &problem, double time, const double *state) {
  const tf_model &model = at_.model();
  pairs_.clear();
  launches_ = false;
  bool evaluated = false;
  for (std::size_t j = 0; j < rows.tangents().size(); ++j) {
    const int row = rows.tangents()[j];
    if (problem.partner[j] < static_cast<int>(j) || problem.slipSign[j] == 0)
      continue;
    if (!evaluated) {
      at_.setPoint(time, state);
      at_.switching(ModelEvaluation::Slips);
      evaluated = true;
    }
    const double *velocities = state + model.nq;
    const double scale = std::max(at_.scales.slip(row, velocities), at_.scales.slip(row + 1, velocities));
    Pair pair = {static_cast<int>(j), row, 1, 0, scale};
    const bool given = static_cast<int>(mode.direction.size()) > row + 1 && (mode.direction[row] != 0 || mode.direction[row + 1] != 0);
    pair.given = given;
    if (given) {
      pair.c = mode.direction[row];
      pair.s = mode.direction[row + 1];
    } else if (const double speed = std::hypot(at_.slip[row], at_.slip[row + 1]); speed > 0) {
      // Slow, but faster than what the selection of modes takes for zero: `renew` leaves it.
      pair.c = at_.slip[row] / speed;
      pair.s = at_.slip[row + 1] / speed;
    }
    pairs_.push_back(pair);
  }
  if (pairs_.empty())
    return;
  update(time, state);
  for (int k = 0; k < count(); ++k)
    launches_ = launches_ || speed(k) <= 10 * rounding(k);
}

bool SlipDirections::renew(double time, const double *state) {
  for (Pair &pair : pairs_)
    pair.given = false;
  return !pairs_.empty() && update(time, state);
}

bool SlipDirections::update(double time, const double *state) {
  constexpr double visible = 1e-5;  // of the angle, in radians
  bool jumps = false;
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips);
  for (Pair &pair : pairs_) {
    pair.held = false;
    pair.heldSlope = pair.width = 0;
    const double x = at_.slip[pair.modelRow], y = at_.slip[pair.modelRow + 1], speed = std::hypot(x, y);
    // A slow slip keeps its reference direction, unless it is clearly another one, or its mode has begun with it for a zero.
    const bool isAstray = !pair.given && speed > still * pair.scale && along(pair) < 0.5 * speed;
    if (speed <= 10 * accuracy_ * pair.scale && !isAstray)
      continue;
    const double friction = slope(pair), cosine = (along(pair) + friction * across(pair)) / (std::hypot(1, friction) * speed);
    jumps = jumps || cosine < 1 - 0.5 * visible * visible;
    pair.c = x / speed;
    pair.s = y / speed;
    pair.grows = false;
  }
  return jumps;
}

void SlipDirections::hold(double part) {
  for (int k = 0; k < count(); ++k) {
    pairs_[k].held = part > 0 && isBelow(k, part);
    if (part == 0)
      pairs_[k].heldSlope = pairs_[k].width = 0;
  }
}

void SlipDirections::slopesOfSlips(double *slopes) const {
  for (const Pair &pair : pairs_)
    *slopes++ = across(pair) / along(pair);
}

// A slip that can only move along a curve turns evenly until it stops. One that is about to turn round does so ever faster.
void SlipDirections::aim(const double *earlier, const double *later, const double *slopes, double part) {
  constexpr double even = 0.2, steepest = 0.5;
  for (int k = 0; k < count(); ++k) {
    const bool isEven = std::abs(later[k] - earlier[k]) <= even * std::abs(later[k]) && std::abs(later[k]) <= steepest;
    pairs_[k].heldSlope = isEven ? slopes[k] : 0;
    pairs_[k].width = isEven ? part * pairs_[k].scale : 0;
  }
}

bool SlipDirections::holdStarts(double part) {
  bool isAny = false;
  for (int k = 0; k < count(); ++k) {
    Pair &pair = pairs_[k];
    pair.held = pair.starts && isBelow(k, part);
    isAny = isAny || pair.held;
  }
  return isAny;
}

bool SlipDirections::watchGrowth(const double *rates) {
  bool isAny = false;
  for (int k = 0; k < count(); ++k) {
    Pair &pair = pairs_[k];
    pair.starts = speed(k) <= 10 * still * pair.scale;
    pair.grows = pair.starts || rates[k] > 0;
    isAny = isAny || (pair.grows && isBelow(k, small));
  }
  return isAny;
}

bool SlipDirections::anyStarts() const {
  return std::any_of(pairs_.begin(), pairs_.end(), [](const Pair &pair) { return pair.starts; });
}

void SlipDirections::references(double *directions) const {
  for (const Pair &pair : pairs_) {
    *directions++ = pair.c;
    *directions++ = pair.s;
  }
}

void SlipDirections::setReferences(const double *directions) {
  for (Pair &pair : pairs_) {
    if (pair.starts) {
      pair.c = directions[0];
      pair.s = directions[1];
    }
    directions += 2;
  }
}

void SlipDirections::angles(double *values) const {
  for (const Pair &pair : pairs_)
    *values++ = pair.starts ? std::atan2(across(pair), along(pair)) : 0;
}

void SlipDirections::turn(Pair &pair, double cosine, double sine) {
  const double c = pair.c;
  pair.c = c * cosine - pair.s * sine;
  pair.s = pair.s * cosine + c * sine;
}

void SlipDirections::turnReferences(const double *angles) {
  for (Pair &pair : pairs_) {
    turn(pair, std::cos(*angles), std::sin(*angles));
    ++angles;
  }
}

void SlipDirections::turnToSlips() {
  for (Pair &pair : pairs_)
    if (const double x = along(pair), y = across(pair), size = std::hypot(x, y); size > 0)
      turn(pair, x / size, y / size);
}

double SlipDirections::turnToFriction() {
  constexpr double steepest = 0.5;
  double largest = 0;
  for (Pair &pair : pairs_) {
    if (!pair.starts)
      continue;
    const double slope = std::clamp(across(pair) / (2 * rounding(pair)), -steepest, steepest);
    const double cosine = 1 / std::hypot(1, slope);
    turn(pair, cosine, slope * cosine);
    largest = std::max(largest, std::abs(slope));
  }
  return largest;
}

bool SlipDirections::isBelow(int pair, double part) const { return speed(pair) <= part * pairs_[pair].scale; }

bool SlipDirections::turnBack() const {
  return std::any_of(pairs_.begin(), pairs_.end(), [this](const Pair &pair) { return pair.grows && along(pair) < -10 * rounding(pair); });
}

bool SlipDirections::anyBelow(double part) const {
  for (int k = 0; k < count(); ++k)
    if (isBelow(k, part))
      return true;
  return false;
}

bool SlipDirections::haveLaunched() const { return !anyBelow(small); }

double SlipDirections::rounding(const Pair &pair) const { return (pair.grows ? still : accuracy_) * pair.scale; }

double SlipDirections::smoothing(const Pair &pair) const { return pair.held ? pair.width : rounding(pair); }

double SlipDirections::along(const Pair &pair) const { return pair.c * at_.slip[pair.modelRow] + pair.s * at_.slip[pair.modelRow + 1]; }

double SlipDirections::across(const Pair &pair) const { return pair.c * at_.slip[pair.modelRow + 1] - pair.s * at_.slip[pair.modelRow]; }

double SlipDirections::speed(int pair) const {
  const int row = pairs_[pair].modelRow;
  return std::hypot(at_.slip[row], at_.slip[row + 1]);
}

// With x along and y across the reference direction, the direction of friction has the slope y/x, which goes on smoothly where x changes
// its sign. Below the rounding δ of slips the slope falls to 0 as x y/(x² + δ²), and to the slope s that a slip stops with as
// (x y + s δ²)/(x² + δ²).
double SlipDirections::slope(const Pair &pair) const {
  const double x = along(pair), slow = smoothing(pair), rest = pair.heldSlope * slow * slow;
  return pair.held && slow == 0 ? pair.heldSlope : (x * across(pair) + rest) / (x * x + slow * slow);
}

void SlipDirections::align(RowSystem &rows) const {
  for (const Pair &pair : pairs_) {
    const double tangent = slope(pair), cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
    rows.setFrame(pair.row, pair.c * cosine - pair.s * sine, pair.s * cosine + pair.c * sine);
  }
}

// d slip/dv is Jt; what slips depend on q by is no part of a compiled model and found by differences (of Jacobians only).
void SlipDirections::differentiate(double time, const double *state) {
  const tf_model &model = at_.model();
  const int columns = model.nq + model.nv;
  slipByState_.resize(2 * pairs_.size() * columns);
  if (pairs_.empty())
    return;
  const std::vector<int> owner = contactsOfTangents(model);
  std::vector<std::uint8_t> contacts(static_cast<std::size_t>(model.nc), 0);
  for (const Pair &pair : pairs_)
    if (const int contact = owner[static_cast<std::size_t>(pair.modelRow)]; contact >= 0)
      contacts[static_cast<std::size_t>(contact)] = 1;
  std::vector<double> point(state, state + at_.stateSize());
  const auto difference = [&](int k, double step, double factor, bool first) {
    point[k] = state[k] + step;
    at_.setPoint(time, point.data());
    at_.switching(ModelEvaluation::Slips, contacts.data());
    for (std::size_t p = 0; p < 2 * pairs_.size(); ++p) {
      double &target = slipByState_[p * columns + k];
      target = (first ? 0 : target) + factor * at_.slip[pairs_[p / 2].modelRow + p % 2];
    }
    point[k] = state[k];
  };
  for (int k = 0; k < model.nq; ++k) {
    const double step = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(at_.scales.nominal()[k], std::abs(state[k]));
    difference(k, step, 0.5 / step, true);
    difference(k, -step, -0.5 / step, false);
  }
  copySlipsByVelocity();
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips, contacts.data());
}

void SlipDirections::differentiateByVelocity() {
  slipByState_.assign(2 * pairs_.size() * (at_.model().nq + at_.model().nv), 0.0);
  copySlipsByVelocity();
}

void SlipDirections::copySlipsByVelocity() {
  const tf_model &model = at_.model();
  for (std::size_t p = 0; p < 2 * pairs_.size(); ++p)
    std::copy_n(at_.tangent.data() + (pairs_[p / 2].modelRow + static_cast<int>(p % 2)) * model.nv, model.nv,
                slipByState_.data() + p * (model.nq + model.nv) + model.nq);
}

void SlipDirections::slips(double *values) const {
  for (std::size_t p = 0; p < 2 * pairs_.size(); ++p)
    values[p] = at_.slip[pairs_[p / 2].modelRow + p % 2];
}

void SlipDirections::slipsByVelocity(double *rows) const {
  const int nv = at_.model().nv;
  for (const Pair &pair : pairs_)
    rows = std::copy_n(at_.tangent.data() + static_cast<std::ptrdiff_t>(pair.modelRow) * nv, 2 * nv, rows);
}

// The direction's slope is x y/(x² + δ²), see `align`. Where x is smaller than δ, that of δ stands for it: from a slip that is zero
// Newton's method then goes on along the reference, and finds how friction has to turn.
double SlipDirections::turning(int pair, int column) const {
  const Pair &p = pairs_[pair];
  if (p.held && p.width == 0)
    return 0;
  const std::ptrdiff_t columns = at_.model().nq + at_.model().nv;
  const double first = slipByState_[2 * pair * columns + column], second = slipByState_[(2 * pair + 1) * columns + column];
  const double dx = p.c * first + p.s * second, dy = p.c * second - p.s * first;
  const double exact = along(p), y = across(p);
  const double slow = smoothing(p), x = std::abs(exact) < slow ? slow : exact;
  const double square = x * x + slow * slow;
  const double slope = (x * y + p.heldSlope * slow * slow) / square;
  return ((x * dy + y * dx) / square - 2 * slope * x * dx / square) / (1 + slope * slope);
}

}  // namespace tf::runtime
