// How sensitivities grow along a motion.
#include "runtime/simulate/sensitivities.h"

#include "runtime/integrate/collocation.h"
#include "runtime/simulate/sensitivity_differences.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

Sensitivities::Sensitivities(ModeDynamics &dynamics, const ModelInstance &instance, const InputSignals &inputs,
                             std::vector<std::int32_t> columns)
    : dynamics_(dynamics), instance_(instance), inputs_(inputs), n_(dynamics.model().tauIndex()), columns_(columns.size()),
      parameters_(instance.parameters().begin(), instance.parameters().end()), shifted_(parameters_),
      matrix_(Eigen::MatrixXd::Zero(n_, static_cast<Eigen::Index>(columns.size()))),
      eventTime_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()))), state_(static_cast<std::size_t>(dynamics.size())),
      rate_(static_cast<std::size_t>(dynamics.size())), refinement_(columns.size(), 1.0),
      gauss_(gaussNodes(), n_, static_cast<int>(columns.size())), damped_(dampedGaussNodes(), n_, static_cast<int>(columns.size())),
      largest_(matrix_) {
  for (std::size_t k = 0; k < columns.size(); ++k)
    columns_[k].variable = columns[k];
  hops_.resize(static_cast<std::size_t>(dynamics.model().model().nc));
  for (Hop &hop : hops_)
    hop.change = hop.rateChange = eventTime_;
  const auto full = static_cast<Eigen::Index>(dynamics.size());
  slopes_.assign(damped_.nodes().size(), Eigen::MatrixXd(n_, n_));
  offsets_.assign(damped_.nodes().size(), matrix_);
  jacobian_.resize(full, full);
  undamped_ = next_ = allowed_ = visible_ = rateAt_ = matrix_;
  for (Border *border : {&begin_, &end_})
    *border = {slopes_.front(), matrix_, false};
  still_.assign(static_cast<std::size_t>(n_), 0.0);
  point_.resize(state_.size());
  // Slips of a rigid body may depend on one another: what tells them apart, by rounding or by a slight tilt, would take large velocities.
  constexpr double dependent = 1e-7;
  velocityBySlip_.setThreshold(dependent);
}

// The starts, parameters and inputs of a copy of the instance in which θ has another value.
void Sensitivities::makeColumn(Column &column, double time) {
  const tf_model &model = instance_.model();
  const tf_variable &variable = model.variables[column.variable];
  const std::size_t parameters = parameters_.size(), inputs = static_cast<std::size_t>(model.nu);
  const auto all = [&](double s, double *values) {
    ModelInstance other = instance_;
    other.nudge(column.variable, s, time);
    const Starts starts = other.starts(time);
    double *place = std::copy(starts.q.begin(), starts.q.end(), values);
    place = std::copy(starts.v.begin(), starts.v.end(), place);
    place = std::copy(starts.z.begin(), starts.z.end(), place);
    place = std::copy(other.parameters().begin(), other.parameters().end(), place);
    std::copy(starts.u.begin(), starts.u.end(), place);
    return true;
  };
  std::vector<double> derivative(static_cast<std::size_t>(n_) + parameters + inputs);
  const double magnitude = variable.kind == TF_KIND_PARAMETER ? std::abs(parameters_[static_cast<std::size_t>(variable.index)]) : 0;
  const auto count = static_cast<int>(derivative.size());
  differenceOfSmooth(all, 1 / std::max({magnitude, std::abs(variable.nominal), 1e-300}), nullptr, count, derivative.data());
  const auto index = static_cast<Eigen::Index>(&column - columns_.data());
  std::copy_n(derivative.begin(), n_, matrix_.col(index).data());
  column.parameters.assign(derivative.begin() + n_, derivative.begin() + n_ + static_cast<std::ptrdiff_t>(parameters));
  column.inputs.assign(derivative.begin() + n_ + static_cast<std::ptrdiff_t>(parameters), derivative.end());
  for (std::size_t k = 0; k < inputs; ++k)
    if (inputs_.isGiven(static_cast<std::int32_t>(k)))
      column.inputs[k] = 0;
  if (variable.kind == TF_KIND_INPUT)
    column.inputs[static_cast<std::size_t>(variable.index)] = 1;
  const auto isNotZero = [](double value) { return value != 0; };
  column.movesModel = std::any_of(column.parameters.begin(), column.parameters.end(), isNotZero) ||
                      std::any_of(column.inputs.begin(), column.inputs.end(), isNotZero);
}

void Sensitivities::start(double time) {
  for (Column &column : columns_)
    makeColumn(column, time);
  eventTime_.setZero();
  lastEventTime_ = eventTime_;
  for (Hop &hop : hops_)
    hop = {false, false, 0, eventTime_, eventTime_};
  eventsSinceStep_ = 0;
  jump_.resize(0, 0);
  largest_.setZero();
  piece_ = 0;
  roundings_ = 1;
  jumps_ = 0;
}

void Sensitivities::shift(const Column &column, double s) {
  if (!column.movesModel)
    return;
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    shifted_[i] = parameters_[i] + s * column.parameters[i];
  dynamics_.model().setParameters(shifted_.data());
  dynamics_.model().shiftInputs(column.inputs.data(), s);
}

// 1 / magnitude of s that changes something by as much as its own size.
double Sensitivities::scaleOf(const Column &column, const double *direction) const {
  const double *nominal = dynamics_.model().scales.nominal().data();
  double largest = 0;
  for (int i = 0; i < n_; ++i)
    largest = std::max(largest, std::abs(direction[i]) / std::max(nominal[i], std::abs(state_[static_cast<std::size_t>(i)])));
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (column.parameters[i] != 0)
      largest = std::max(largest, std::abs(column.parameters[i]) / (parameters_[i] != 0 ? std::abs(parameters_[i]) : 1.0));
  for (std::size_t i = 0; i < column.inputs.size(); ++i)
    largest = std::max(largest, std::abs(column.inputs[i]) / std::max(1.0, std::abs(dynamics_.model().input[i])));
  return largest > 0 ? largest : 1;
}

// b = ∂f/∂θ at fixed state, with A = ∂f/∂y there.
bool Sensitivities::inhomogeneity(double time, const double *state, const Eigen::MatrixXd &slope, Eigen::Ref<Eigen::MatrixXd> b) {
  fixSlips(time, state);
  bool isGood = true;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    auto target = b.col(static_cast<Eigen::Index>(k));
    target.setZero();
    if (!columns_[k].movesModel)
      continue;
    isGood = differenceRate(columns_[k], time, state, target) && isGood;
    if (movesState())
      target -= slope * Eigen::Map<const Eigen::VectorXd>(rateAndState_.data() + n_, n_);
  }
  return isGood;
}

// Friction turns with a slip of two components, the faster the smaller it is: differences of it need steps far smaller than the slip. So
// velocities change with θ such that such slips stay what they are; A tells what these velocities do.
void Sensitivities::fixSlips(double time, const double *state) {
  const int nv = dynamics_.model().model().nv;
  slips_.resize(dynamics_.turningSlipCount());
  if (slips_.size() == 0)
    return;
  slipChange_.resize(slips_.size());
  slipByVelocity_.resize(slips_.size(), nv);
  dynamics_.turningSlipsByVelocity(time, state, slipByVelocity_.data());
  velocityBySlip_.compute(slipByVelocity_);
  dynamics_.turningSlips(time, state, slips_.data());
}

// d/dθ of the rate along a motion in which slips of two components stay, into b; with that of its state, into rateAndState_. Rows that
// depend on each other have forces only where the state is what they hold, which θ moves: the state follows.
bool Sensitivities::differenceRate(Column &column, double time, const double *state, Eigen::Ref<Eigen::VectorXd> b) {
  const int first = dynamics_.model().model().nq, nv = dynamics_.model().model().nv;
  const int extra = movesState() ? n_ : 0;
  const bool follows = dynamics_.hasRedundantRows();
  const auto rate = [&](double s, double *values) {
    shift(column, s);
    std::copy_n(state, point_.size(), point_.begin());
    if (slips_.size() > 0) {
      dynamics_.turningSlips(time, state, slipChange_.data());
      slipChange_ = slips_ - slipChange_;
      Eigen::Map<Eigen::VectorXd>(point_.data() + first, nv) += velocityBySlip_.solve(slipChange_);
    }
    if (follows)
      dynamics_.project(time, point_.data(), scale_);
    if (!dynamics_.evaluate(time, point_.data(), rate_.data()))
      return false;
    std::copy_n(rate_.begin(), n_, values);
    std::copy_n(point_.begin(), extra, values + n_);
    return true;
  };
  rateAndState_.resize(2 * static_cast<std::size_t>(n_));
  const double scale = scaleOf(column, still_.data());
  // Forces of pairs, and those that redundant rows share, come out of iterations and thresholds.
  const bool isSmooth = !follows && !dynamics_.hasPairs();
  // Rows whose terms are small may have the rounding errors of others.
  const double largest = Eigen::Map<const Eigen::VectorXd>(rate_.data(), n_).lpNorm<Eigen::Infinity>();
  const Eigen::VectorXd magnitudes = rateTerms_.cwiseMax(largest);
  bool isGood = false;
  column.shortening = 1;
  if (!isSmooth) {
    isGood = difference(rate, scale, n_ + extra, rateAndState_.data());
  } else if (const auto shortening = differenceOfSmooth(rate, scale, magnitudes.data(), n_ + extra, rateAndState_.data())) {
    column.shortening = *shortening;
    isGood = true;
  }
  shift(column, 0);
  b = Eigen::Map<const Eigen::VectorXd>(rateAndState_.data(), n_);
  return isGood;
}

// Of a slip of two components that starts, the direction is known from the start on; that of the interpolant's slip is none while it is not
// faster than what it may be wrong by.
bool Sensitivities::evaluate(SmoothIntegrator &integrator, double time) {
  constexpr double margin = 10;
  integrator.interpolate(time, state_.data());
  if (dynamics_.turningSlipCount() == 0)
    return dynamics_.evaluate(time, state_.data(), rate_.data());
  dynamics_.holdDirections(0);
  if (!dynamics_.evaluate(time, state_.data(), rate_.data()))
    return false;
  if (held_ > 0) {
    dynamics_.holdDirections(held_);
    return dynamics_.evaluate(time, state_.data(), rate_.data());
  }
  return !dynamics_.holdStartingDirections(margin * integrator.settings().tolerance) ||
         dynamics_.evaluate(time, state_.data(), rate_.data());
}

// A and b at the point of the last evaluation.
bool Sensitivities::linearise(double time, Eigen::MatrixXd &slope, Eigen::MatrixXd &offset) {
  const bool rests = dynamics_.restsByItsRows(state_.data());
  if (!dynamics_.jacobian(time, state_.data(), jacobian_.data()))
    return false;
  rateTerms_ = Eigen::Map<const Eigen::VectorXd>(rate_.data(), n_).cwiseAbs();
  dynamics_.accelerationTerms(rateTerms_.data() + dynamics_.model().model().nq);
  slope = jacobian_.topLeftCorner(n_, n_);
  if (!inhomogeneity(time, state_.data(), slope, offset))
    return false;
  // Differences of forces that are found by iteration, as those within several cones, are no zeros.
  if (rests) {
    const tf_model &model = dynamics_.model().model();
    slope.middleRows(model.nq, model.nv).setZero();
    offset.middleRows(model.nq, model.nv).setZero();
  }
  return true;
}

// At the nodes of a piece of the integrator's last step.
bool Sensitivities::sample(SmoothIntegrator &integrator, double begin, double length) {
  for (std::size_t k = 0; k < damped_.nodes().size(); ++k) {
    const double time = begin + damped_.nodes()[k] * length;
    if (!evaluate(integrator, time))
      return false;
    isShareUnknown_ = dynamics_.isShareUnknown();
    if (isShareUnknown_ || !linearise(time, slopes_[k], offsets_[k]))
      return false;
  }
  return true;
}

// At the begin or end of a piece; it need not be known there.
void Sensitivities::sampleBorder(SmoothIntegrator &integrator, double time, Border &border) {
  border.isKnown = evaluate(integrator, time) && !dynamics_.isShareUnknown() && linearise(time, border.slope, border.offset);
}

// Of the rate's differences at the last node, over a piece, for differences by one: 1e-16 of the terms that the rate is the sum of.
Eigen::VectorXd Sensitivities::rounding(double length) {
  const Eigen::MatrixXd &slope = slopes_.back();
  const Eigen::Map<const Eigen::VectorXd> state(state_.data(), n_);
  const Eigen::VectorXd terms = rateTerms_ + slope.cwiseAbs() * state.cwiseAbs();
  return std::numeric_limits<double>::epsilon() * terms.cwiseQuotient((1 / length + slope.diagonal().cwiseAbs().array()).matrix());
}

// What each derivative may be wrong by over a piece: the tolerance of what it has been up to now, or of a part of what the column has; not
// less than rounding, nor than where another value of the parameter, twice the one, moves the state by a part of its tolerance: what begins
// as rounding, as k*(1 − cos(time)), is resolved from there on.
void Sensitivities::allowErrors(const IntegratorSettings &settings, double length) {
  constexpr double part = 1e-3, smallPart = 1e-6, solutionRounding = 1e-14, margin = 10;
  const Eigen::Map<const Eigen::VectorXd> scale(settings.scale.data(), n_);
  const Eigen::VectorXd rounded = rounding(length);
  seen_ = largest_.cwiseMax(next_.cwiseAbs());
  for (Eigen::Index k = 0; k < next_.cols(); ++k) {
    const Column &column = columns_[static_cast<std::size_t>(k)];
    const double whole = seen_.col(k).cwiseQuotient(scale).maxCoeff();
    const double relative = column.movesModel ? scaleOf(column, still_.data()) : 0;
    const double noise = margin * roundings_ * column.shortening * relative / differenceStep;
    // Rows whose terms are small may have the rounding errors of others, which go into them through M.
    const double mixed = noise * rounded.cwiseQuotient(scale).maxCoeff();
    for (Eigen::Index i = 0; i < n_; ++i) {
      allowed_(i, k) = std::max(settings.tolerance * std::max({seen_(i, k), part * whole * scale[i], smallPart * relative * scale[i]}),
                                noise * rounded[i] + solutionRounding * whole * scale[i]);
      visible_(i, k) = std::max(allowed_(i, k), mixed * scale[i]);
    }
  }
}

// By how much the two methods differ.
double Sensitivities::pieceError() const {
  double error = 0;
  for (Eigen::Index k = 0; k < next_.size(); ++k)
    if (const double difference = std::abs(next_(k) - undamped_(k)); difference > 0)
      error = std::max(error, difference / allowed_(k));
  return error;
}

// Where A or b jump inside the piece (a force that has a bend there), both methods may be wrong by as much. The polynomial through S' at
// the nodes does not lead to S' at the borders then. Of a smooth S it misses it by some q⁵ of S' where the methods' error, which is
// allowed, is some q⁹: a larger miss is a jump. The most that one of this size may do, relative to what is allowed or visible; 0 where it
// is none.
double Sensitivities::jumpError(double length) {
  double error = 0;
  damped_.largestRate(largestRate_);
  const auto compare = [&](const Border &border, const Eigen::MatrixXd &there) {
    rateAt_.noalias() = border.slope * there;
    for (Eigen::Index k = 0; k < there.size(); ++k) {
      const double miss = length * std::abs(rateAt_(k) + border.offset(k) - extrapolated_(k));
      if (miss > visible_(k) && miss * miss > allowed_(k) * length * largestRate_(k))
        error = std::max(error, miss / visible_(k));
    }
  };
  if (begin_.isKnown) {
    damped_.rateAtBegin(extrapolated_);
    compare(begin_, matrix_);
  }
  if (end_.isKnown) {
    damped_.rateAtEnd(extrapolated_);
    compare(end_, next_);
  }
  return error;
}

// Near a jump every other piece or so is divided, a few times until one passes it, and pieces grow again behind it. Where they do not, the
// jumps are rounding errors, which are larger than they were taken for; from then on they are not. The error of the jump, 1 at the most
// if it is none.
double Sensitivities::judgeJump(const IntegratorSettings &settings, double length, double jump) {
  constexpr double growth = 10, most = 1e3;
  constexpr int patience = 12;
  if (++jumps_ <= patience)
    return jump;
  for (; jump > 1 && roundings_ < most; roundings_ *= growth) {
    allowErrors(settings, length);
    jump = jumpError(length);
  }
  jumps_ = 0;
  return jump;
}

// A piece's length from its errors, relative to what is allowed. A jump's error is of order 1.
double Sensitivities::nextPiece(double length, double error, double jump) {
  constexpr double order = 9, shortest = 0.05, longest = 5, safety = 0.9;
  const double factor = safety * std::pow(error, -1 / order);
  return length * std::clamp(jump > 0 ? std::min(factor, safety / jump) : factor, shortest, longest);
}

bool Sensitivities::addStep(SmoothIntegrator &integrator, double begin, double end, double held) {
  if (!(end > begin) || columns_.empty() || n_ == 0)
    return true;
  held_ = held;
  followHopsFrom(integrator, begin);
  const bool isKnown = addPieces(integrator, begin, end) && holdRows(integrator, end);
  if (isKnown)
    followHopsTo(integrator, end, end - begin);
  else
    matrix_.setConstant(std::numeric_limits<double>::quiet_NaN());
  dynamics_.holdDirections(0);
  return isKnown;
}

bool Sensitivities::addPieces(SmoothIntegrator &integrator, double begin, double end) {
  // Of oscillations both methods' errors have the same sign, and their difference is a fifth of them.
  constexpr double likeness = 5, smallest = 1e-8;
  // More attempts at pieces of a step are no progress: differences of the rate are not as exact as the tolerance asks for.
  constexpr int mostAttempts = 20000;
  const double h = end - begin;
  const IntegratorSettings &settings = integrator.settings();
  scale_ = settings.scale.data();
  const bool isControlled = settings.fixedStep <= 0;
  // Friction that turns with a slip of two components is steep where that is small, which the methods' difference shows.
  const bool watchesJumps = isControlled && dynamics_.turningSlipCount() == 0;
  constexpr int several = 3;
  int attempts = 0, undivided = 0;  // undivided: in a row
  largest_ = largest_.cwiseMax(matrix_.cwiseAbs());
  begin_.isKnown = end_.isKnown = false;
  if (watchesJumps)
    sampleBorder(integrator, begin, begin_);
  for (double time = begin, left = h; left > 0; left = end - time) {
    double length = isControlled && piece_ > 0 && piece_ < left ? piece_ : left;
    while (true) {
      if (++attempts > mostAttempts || !sample(integrator, time, length))
        return false;
      damped_.step(length, slopes_, offsets_, matrix_, next_);
      if (!next_.allFinite())
        return false;
      if (!isControlled)
        break;
      gauss_.step(length, slopes_, offsets_, matrix_, undamped_);
      allowErrors(settings, length);
      const double error = likeness * pieceError();
      double jump = 0;
      end_.isKnown = false;
      if (watchesJumps && error <= 1) {
        sampleBorder(integrator, time + length, end_);
        jump = jumpError(length);
        if (jump > 1)
          jump = judgeJump(settings, length, jump);
      }
      piece_ = nextPiece(length, error, jump);
      if (std::max(error, jump) <= 1 || length <= smallest * h)
        break;
      length = std::max(std::min(piece_, 0.9 * length), smallest * h);
      undivided = 0;
    }
    time = length < left ? time + length : end;
    if (++undivided >= several)
      jumps_ = 0;
    std::swap(matrix_, next_);
    std::swap(begin_, end_);
    largest_ = largest_.cwiseMax(matrix_.cwiseAbs());
  }
  return true;
}

std::size_t Sensitivities::numberCount() const {
  const auto columns = static_cast<std::size_t>(lastEventTime_.size());
  return 2 * static_cast<std::size_t>(matrix_.size()) + columns + hops_.size() * (2 * columns + 3) + 4;
}

void Sensitivities::write(double *numbers) const {
  const auto give = [&numbers](const auto &values) { numbers = std::copy_n(values.data(), values.size(), numbers); };
  give(matrix_);
  give(largest_);
  give(lastEventTime_);
  for (const Hop &hop : hops_) {
    give(hop.change);
    give(hop.rateChange);
    for (const double number : {hop.begins ? 1.0 : 0.0, hop.isFollowed ? 1.0 : 0.0, hop.rate})
      *numbers++ = number;
  }
  *numbers++ = eventsSinceStep_;
  *numbers++ = piece_;
  *numbers++ = roundings_;
  *numbers = jumps_;
}

void Sensitivities::read(const double *numbers) {
  const auto take = [&numbers](auto &values) {
    std::copy_n(numbers, values.size(), values.data());
    numbers += values.size();
  };
  take(matrix_);
  take(largest_);
  take(lastEventTime_);
  for (Hop &hop : hops_) {
    take(hop.change);
    take(hop.rateChange);
    hop.begins = *numbers++ != 0;
    hop.isFollowed = *numbers++ != 0;
    hop.rate = *numbers++;
  }
  eventsSinceStep_ = static_cast<int>(*numbers++);
  piece_ = *numbers++;
  roundings_ = *numbers++;
  jumps_ = static_cast<int>(*numbers);
  eventTime_.setZero();
  jump_.resize(0, 0);
}

}  // namespace tf::runtime
