// How events change sensitivities: their times move with each column, and maps of the state are differentiated there.
#include "runtime/simulate/sensitivity_differences.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// The difference of derivatives to both sides that is a kink, relative to the magnitude of their change.
constexpr double visibleKink = 1e-3;

// The change of a derivative by a map that is no rounding error of its differences, alike.
constexpr double visibleMove = 1e-7;

}  // namespace

// How the guard's value moves with time where the state moves along its rate, and with each column at fixed time. False: they could not be
// evaluated, or the guard only touches zero.
bool Sensitivities::differentiateGuard(double time, const double *state, const double *rate, int guard, double &slope,
                                       Eigen::VectorXd &change) {
  std::copy_n(state, state_.size(), state_.begin());
  // The guard along (δt, δy, δθ).
  const auto along = [&](double timeChange, const double *direction, const Column *column, double scale, double &derivative) {
    const auto value = [&](double s, double *values) {
      for (int i = 0; i < n_; ++i)
        point_[static_cast<std::size_t>(i)] = state[i] + s * direction[i];
      point_.back() = state[n_];
      if (column != nullptr)
        shift(*column, s);
      if (!dynamics_.evaluate(time + s * timeChange, point_.data(), rate_.data()))
        return false;
      *values = dynamics_.guardValue(guard);
      return true;
    };
    const bool isGood = difference(value, scale, 1, &derivative);
    if (column != nullptr)
      shift(*column, 0);
    return isGood;
  };
  const double *nominal = dynamics_.model().scales.nominal().data();
  double largest = 1;
  for (int i = 0; i < n_; ++i)
    largest = std::max(largest, std::abs(rate[i]) / std::max(nominal[i], std::abs(state[i])));
  if (!along(1, rate, nullptr, largest, slope) || !(std::abs(slope) > 1e-9 * largest * dynamics_.guards()[guard].scale))
    return false;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto index = static_cast<Eigen::Index>(k);
    if (!along(0, matrix_.col(index).data(), &columns_[k], scaleOf(columns_[k], matrix_.col(index).data()), change[index]))
      return false;
  }
  return true;
}

// The same of a contact's gap. Impacts that accumulate are slow in the end, and what a derivative of the gap is wrong by moves their times
// by as much over the gap's rate: the derivative by the state is that of the generated code, without rounding errors of differences.
bool Sensitivities::differentiateGap(double time, const double *state, int contact, double &slope, Eigen::VectorXd &change) {
  ModelEvaluation &at = dynamics_.model();
  const int nq = at.model().nq, nv = at.model().nv;
  std::copy_n(state, state_.size(), state_.begin());
  at.setPoint(time, state_.data());
  at.switchingOf(contact);
  slope = at.gapRate[contact];
  if (!(std::abs(slope) > 1e-11 * at.scales.gapRate(contact, state + nq)))
    return false;
  if (const Hop &hop = hops_[static_cast<std::size_t>(contact)]; hop.isFollowed && eventsSinceStep_ == 0) {
    change = hop.change;
    return change.allFinite();
  }
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(at.model().nc + at.model().nf), 0);
  mask[static_cast<std::size_t>(contact)] = 1;
  at.contactTerms(mask.data());
  at.kinematicsDerivatives();
  const Eigen::RowVectorXd normal = Eigen::Map<const Eigen::RowVectorXd>(at.normal.data() + static_cast<std::ptrdiff_t>(contact) * nv, nv);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (at.model().kinematics == nullptr)
    change = (normal * matrix_.topRows(nq)).transpose();
  else
    change = (normal * Eigen::Map<const RowMajor>(at.kinematicMatrix.data(), nq, nv).colPivHouseholderQr().solve(matrix_.topRows(nq)))
                 .transpose();
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    if (!columns_[k].movesModel)
      continue;
    const auto gap = [&](double s, double *values) {
      shift(columns_[k], s);
      at.setPoint(time, state_.data());
      at.switchingOf(contact);
      *values = at.gap[contact];
      return true;
    };
    double byModel = 0;
    const double magnitude = at.scales.gap(contact, state_.data());
    differenceOfSmooth(gap, scaleOf(columns_[k], still_.data()), &magnitude, 1, &byModel);
    shift(columns_[k], 0);
    change[static_cast<Eigen::Index>(k)] += byModel;
  }
  return change.allFinite();
}

// How the time of the guard's zero near (time, state) with rate f⁻ moves with each column. False: the guard only touches zero.
bool Sensitivities::eventTimes(double time, const double *state, const double *rate, int guard, Eigen::VectorXd &times) {
  const Guard which = dynamics_.guards()[guard];
  double slope = 0;
  const bool isGood = which.kind == GuardKind::Gap ? differentiateGap(time, state, which.index, slope, times)
                                                   : differentiateGuard(time, state, rate, guard, slope, times);
  times /= -slope;
  return isGood;
}

EventDerivative Sensitivities::beginEvent(double time, const double *state, const double *rate, const std::vector<int> &guards) {
  eventTime_.setZero();
  landings_.clear();
  for (std::size_t k = 0; k < guards.size(); ++k) {
    Eigen::VectorXd times = eventTime_;
    if (!eventTimes(time, state, rate, guards[k], times))
      return EventDerivative::Touches;
    constexpr double together = 1e-6;
    if (k > 0 && (times - eventTime_).lpNorm<Eigen::Infinity>() > together * std::max(1.0, eventTime_.lpNorm<Eigen::Infinity>()))
      return EventDerivative::Parts;
    if (k == 0)
      eventTime_ = times;
    if (const Guard &guard = dynamics_.guards()[guards[k]]; guard.kind == GuardKind::Gap)
      landings_.push_back(guard.index);
  }
  matrix_ += Eigen::Map<const Eigen::VectorXd>(rate, n_) * eventTime_.transpose();
  return EventDerivative::Exists;
}

template <class Function> auto Sensitivities::along(const Function &values, double time, const double *state, int column) {
  return [&values, this, time, state, column](double s, double *result) {
    const double *direction = matrix_.col(column).data();
    for (int i = 0; i < n_; ++i)
      point_[static_cast<std::size_t>(i)] = state[i] + s * direction[i];
    point_.back() = state[n_];
    shift(columns_[static_cast<std::size_t>(column)], s);
    return values(time + s * eventTime_[column], point_.data(), result);
  };
}

double Sensitivities::alongScale(int column) const {
  return std::max(scaleOf(columns_[static_cast<std::size_t>(column)], matrix_.col(column).data()), std::abs(eventTime_[column]));
}

bool Sensitivities::differentiate(const std::function<bool(double time, double *state, double *values)> &values, double time,
                                  const double *state, int column, int count, double *derivative) {
  std::copy_n(state, state_.size(), state_.begin());
  const auto place = static_cast<std::size_t>(column);
  const bool isGood = difference(along(values, time, state, column), alongScale(column) * refinement_[place], count, derivative);
  shift(columns_[place], 0);
  return isGood;
}

// What the map changes the state by, as values at a point: differences of what it does not change have no rounding errors.
auto Sensitivities::displacement(const Map &map) {
  return [&map, this](double time, double *state, double *values) {
    std::copy_n(state, n_, values);
    if (!map(time, state))
      return false;
    for (int i = 0; i < n_; ++i)
      values[i] = state[i] - values[i];
    return true;
  };
}

bool Sensitivities::mapColumns(const Map &map, double time, const double *state, double rounding) {
  Eigen::MatrixXd mapped(n_, columnCount());
  for (int k = 0; k < columnCount(); ++k) {
    if (!differentiate(displacement(map), time, state, k, n_, mapped.col(k).data()))
      return false;
    if (mapped.col(k).lpNorm<Eigen::Infinity>() <= rounding * alongScale(k))
      mapped.col(k).setZero();
  }
  matrix_ += mapped;
  return matrix_.allFinite();
}

// Derivatives of what contacts and constraints hold are those of points that they hold: what they are off by, as after an event or where a
// gap has a bend, would stay, and grow where rows depend on each other.
bool Sensitivities::holdRows(SmoothIntegrator &integrator, double time) {
  constexpr double rounding = 1e-11;
  if (!dynamics_.needsProjection())
    return true;
  const double *scale = integrator.settings().scale.data();
  const auto project = [this, scale](double at, double *state) {
    dynamics_.project(at, state, scale);
    return true;
  };
  return evaluate(integrator, time) && mapColumns(project, time, state_.data(), rounding);
}

// Differences of order 2 to both sides, one less the other. False: not both can be evaluated.
template <class Function> bool Sensitivities::kink(const Function &function, double scale, double *jump) {
  const double h = differenceStep / scale;
  samples_.resize(5 * static_cast<std::size_t>(n_));
  for (int k = 0; k < 5; ++k)
    if (!function((k - 2) * h, samples_.data() + static_cast<std::ptrdiff_t>(k) * n_))
      return false;
  const Eigen::Map<const Eigen::MatrixXd> all(samples_.data(), n_, 5);
  Eigen::Map<Eigen::VectorXd>(jump, n_) = (4 * (all.col(3) + all.col(1)) - all.col(4) - all.col(0) - 6 * all.col(2)) / (2 * h);
  return true;
}

// Of each column, the difference of the map's derivatives to both sides into jump_, zero where it has no kink; then, too, refinement_ is
// that of the differences that do not reach one nearby. False: no column has a kink.
bool Sensitivities::findKink(const Map &map, double time, const double *state) {
  constexpr double finest = 1e3;
  const auto values = displacement(map);
  bool found = false;
  jump_.setZero(n_, columnCount());
  std::copy_n(state, state_.size(), state_.begin());
  for (int k = 0; k < columnCount(); ++k) {
    const double scale = alongScale(k);
    auto jump = jump_.col(k);
    bool isThere = true;
    // A kink nearby is out of reach of smaller steps.
    for (double &finer = refinement_[static_cast<std::size_t>(k)] = 1; isThere; finer *= 10) {
      isThere = kink(along(values, time, state, k), scale * finer, jump.data()) && jump.allFinite() &&
                jump.lpNorm<Eigen::Infinity>() > visibleKink * scale;
      if (!isThere || finer >= finest)
        break;
    }
    shift(columns_[static_cast<std::size_t>(k)], 0);
    if (!isThere)
      jump.setZero();
    found = found || isThere;
  }
  return found;
}

bool Sensitivities::propagate(const Map &map, double time, const double *state) {
  const Eigen::MatrixXd before = matrix_;
  const bool isGood = mapBothSides(map, time, state);
  hasMoved_ = false;
  for (int k = 0; k < columnCount(); ++k)
    hasMoved_ = hasMoved_ || (matrix_.col(k) - before.col(k)).lpNorm<Eigen::Infinity>() > visibleMove * alongScale(k);
  return isGood;
}

bool Sensitivities::mapBothSides(const Map &map, double time, const double *state) {
  if (jump_.size() == 0) {
    const bool hasKink = findKink(map, time, state);
    if (!hasKink)
      jump_.resize(0, 0);
    const bool isGood = mapColumns(map, time, state);
    std::fill(refinement_.begin(), refinement_.end(), 1.0);
    return isGood;
  }
  const Eigen::MatrixXd mean = matrix_, half = 0.5 * jump_;
  matrix_ = mean + half;
  if (!mapColumns(map, time, state))
    return false;
  const Eigen::MatrixXd above = matrix_;
  matrix_ = mean - half;
  if (!mapColumns(map, time, state))
    return false;
  jump_ = above - matrix_;
  matrix_ = 0.5 * (above + matrix_);
  return true;
}

bool Sensitivities::isOneSided() {
  bool found = false;
  for (Eigen::Index k = 0; k < jump_.cols(); ++k)
    found = found || jump_.col(k).lpNorm<Eigen::Infinity>() > visibleKink * alongScale(static_cast<int>(k));
  jump_.resize(0, 0);
  return found;
}

void Sensitivities::endEvent(const double *rate) {
  matrix_ -= Eigen::Map<const Eigen::VectorXd>(rate, n_) * eventTime_.transpose();
  lastEventTime_ = eventTime_;
  eventTime_.setZero();
  ++eventsSinceStep_;
  for (const int contact : landings_)
    hops_[static_cast<std::size_t>(contact)].begins = true;
  landings_.clear();
}

void Sensitivities::reopenEvent(const double *rate) {
  eventTime_ = lastEventTime_;
  --eventsSinceStep_;
  matrix_ += Eigen::Map<const Eigen::VectorXd>(rate, n_) * eventTime_.transpose();
}

void Sensitivities::setEvent(const double *derivatives) {
  const Eigen::Map<const Eigen::MatrixXd> all(derivatives, n_ + 1, columnCount());
  matrix_ = all.topRows(n_);
  eventTime_ = all.row(n_);
}

}  // namespace tf::runtime
