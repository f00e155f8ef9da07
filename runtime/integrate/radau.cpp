#include "runtime/integrate/radau.h"

#include "runtime/integrate/collocation.h"
#include "runtime/integrate/damping_bound.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// γ of the error estimate h [γ f0 + Σ (b̂_i − b_i) F_i] of order h^(s+1) (Hairer, Wanner II, (IV.8.17)).
double errorCoefficient(int stages) { return 1.0 / (stages * stages); }

}  // namespace

Radau::Radau(int size, int stages, Accuracy accuracy)
    : ElementMethod(size), stages_(stages), nodes_(radauNodes(stages)), coefficients_(collocationCoefficients(nodes_)),
      stage_(static_cast<std::size_t>(size) * stages), rate_(stage_.size()), begin_(size), point_(size), pastBegin_(size),
      pastStage_(stage_.size()), turning_(size, coefficients_), errorTurning_(size, {errorCoefficient(stages)}), residual_(size * stages) {
  assert(stages >= 1 && stages <= 4);
  const double gamma = errorCoefficient(stages);
  const std::vector<double> weights = interpolatoryWeights(nodes_, integralMoments(stages, 1, gamma));
  embedded_.push_back(gamma);
  equations_ = std::make_unique<StageEquations>(size, coefficients_);
  errorEquations_ = std::make_unique<StageEquations>(size, std::vector{gamma});
  for (int i = 0; i < stages; ++i)
    embedded_.push_back(weights[i] - coefficients_[(stages - 1) * stages + i]);
  // The estimate has order s + 1, the local error 2s; relative to the scale of the solution the latter is the former to the power
  // 2s/(s+1). Halfway between that and no correction is taken, on the safe side. The interpolant's error is of the estimate's order.
  errorPower_ = accuracy == Accuracy::OfEnd ? 0.5 * (1 + 2.0 * stages / (stages + 1)) : 1;
  std::vector<double> all = {0};
  all.insert(all.end(), nodes_.begin(), nodes_.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    double weight = 1;
    for (std::size_t j = 0; j < all.size(); ++j)
      if (j != i)
        weight /= all[i] - all[j];
    barycentric_.push_back(weight);
  }
}

void Radau::restart(bool /*slipsTurn*/) {
  hasPast_ = false;
  stiff_ = false;
}

void Radau::accept() {
  pastBegin_ = begin_;
  pastStage_ = stage_;
  pastH_ = h_;
  hasPast_ = true;
}

void Radau::predictAlongTangent(double h, const double *f0) {
  for (int s = 0; s < stages_; ++s)
    for (int i = 0; i < n_; ++i)
      stage_[s * n_ + i] = nodes_[s] * h * f0[i];
}

// Along the tangent, but for slips of two components, which have to be in the direction of their friction.
bool Radau::predictTurning(ModeDynamics &dynamics, double t0, double h, const double *scale) {
  if (!dynamics.slipsStart())
    return continueSlips(dynamics, t0, h, scale, 0, stages_);
  constexpr int mostTurns = 5;
  constexpr double straight = 0.05;
  const auto count = static_cast<std::size_t>(dynamics.turningSlipCount());
  std::vector<double> reference(count), directions;
  dynamics.slipReferences(reference.data());
  for (int s = 0; s < stages_; ++s)
    directions.insert(directions.end(), reference.begin(), reference.end());
  double turn = 1;
  bool good = true;
  for (int k = 0; k < mostTurns && good && turn > straight; ++k) {
    for (int s = 0; s < stages_ && good; ++s) {
      dynamics.setSlipReferences(directions.data() + s * count);
      good = continueSlips(dynamics, t0, h, scale, s, s + 1) && evaluateWithJacobian(dynamics, t0, h, s);
    }
    if (!good)
      break;
    factoriseEquations(h);
    correct(h, scale);
    turn = 0;
    for (int s = 0; s < stages_; ++s) {
      dynamics.setSlipReferences(directions.data() + s * count);
      pointOfStage(s);
      turn = std::max(turn, dynamics.turnToFriction(t0 + nodes_[s] * h, point_.data()));
      dynamics.slipReferences(directions.data() + s * count);
    }
  }
  dynamics.setSlipReferences(reference.data());
  return good;
}

// Gives the slips of some stages the values that are expected of them.
bool Radau::continueSlips(ModeDynamics &dynamics, double t0, double h, const double *scale, int first, int end) {
  for (int s = first; s < end; ++s) {
    pointOfStage(s);
    if (!dynamics.evaluate(t0 + nodes_[s] * h, point_.data(), rate_.data() + s * n_))
      return false;
    dynamics.continueSlips(nodes_[s] * h, point_.data(), scale);
    for (int i = 0; i < n_; ++i)
      stage_[s * n_ + i] = point_[i] - begin_[i];
  }
  return true;
}

void Radau::pointOfStage(int s) {
  for (int i = 0; i < n_; ++i)
    point_[i] = begin_[i] + stage_[s * n_ + i];
}

// The past element's polynomial continued, or the tangent.
void Radau::predict(double h, const double *f0) {
  if (!hasPast_) {
    predictAlongTangent(h, f0);
    return;
  }
  const double *last = pastStage_.data() + (stages_ - 1) * n_;
  for (int s = 0; s < stages_; ++s) {
    const double theta = 1 + nodes_[s] * h / pastH_;
    double product = theta;
    for (double c : nodes_)
      product *= theta - c;
    double *target = stage_.data() + s * n_;
    for (int i = 0; i < n_; ++i)
      target[i] = -last[i];
    for (int k = 0; k < stages_; ++k) {
      const double weight = product * barycentric_[k + 1] / (theta - nodes_[k]);
      for (int i = 0; i < n_; ++i)
        target[i] += weight * pastStage_[k * n_ + i];
    }
  }
}

bool Radau::evaluateStages(ModeDynamics &dynamics, double t0, double h) {
  for (int s = 0; s < stages_; ++s) {
    pointOfStage(s);
    if (!dynamics.evaluate(t0 + nodes_[s] * h, point_.data(), rate_.data() + s * n_))
      return false;
  }
  return true;
}

// Z ← h A F; returns the change relative to the scale.
double Radau::update(double h, const double *scale) {
  double change = 0;
  for (int s = 0; s < stages_; ++s)
    for (int i = 0; i < n_; ++i) {
      double sum = 0;
      for (int k = 0; k < stages_; ++k)
        sum += coefficients_[s * stages_ + k] * rate_[k * n_ + i];
      double &z = stage_[s * n_ + i];
      change = std::max(change, std::abs(h * sum - z) / scale[i]);
      z = h * sum;
    }
  return change;
}

Radau::Iteration Radau::fixedPoint(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy) {
  double previous = 0;
  for (int k = 0; k < 20; ++k) {
    ++iterations;
    if (!evaluateStages(dynamics, t0, h))
      return Iteration::Failed;
    const double change = update(h, scale);
    if (!std::isfinite(change))
      return Iteration::Failed;
    const double contraction = previous > 0 ? change / previous : 0.1;
    if (change * std::min(contraction, 1.0) <= accuracy || change <= 1e-16)
      return Iteration::Converged;
    if (k >= 2 && contraction > 0.4)
      return change <= 1e3 * accuracy && change <= 1e-14 ? Iteration::Converged : Iteration::Slow;
    previous = change;
  }
  return Iteration::Slow;
}

bool Radau::factorise(ModeDynamics &dynamics, double t0, double h) {
  // The Jacobian at the element's begin; the last row (tau, a quadrature) is zero.
  if (!dynamics.evaluate(t0, begin_.data(), point_.data()) || !dynamics.jacobian(t0, begin_.data(), equations_->jacobian(0).data()))
    return false;
  ++jacobians;
  for (int s = 1; s < stages_; ++s)
    equations_->jacobian(s) = equations_->jacobian(0);
  equations_->factorise(h);
  return true;
}

bool Radau::evaluateWithJacobian(ModeDynamics &dynamics, double t0, double h, int s) {
  const double time = t0 + nodes_[s] * h;
  pointOfStage(s);
  if (!dynamics.evaluate(time, point_.data(), rate_.data() + s * n_))
    return false;
  if (linearisation_ == Linearisation::Turning) {
    dynamics.turningDerivatives(turning_.left(s).data(), turning_.right(s).data());
    return true;
  }
  ++jacobians;
  return dynamics.jacobian(time, point_.data(), equations_->jacobian(s).data());
}

void Radau::factoriseEquations(double h) {
  if (linearisation_ == Linearisation::Turning)
    turning_.factorise(h);
  else
    equations_->factorise(h);
}

// Evaluates all stages, with the Jacobian of each.
bool Radau::factoriseStages(ModeDynamics &dynamics, double t0, double h) {
  for (int s = 0; s < stages_; ++s)
    if (!evaluateWithJacobian(dynamics, t0, h, s))
      return false;
  factoriseEquations(h);
  return true;
}

// One step of Newton's method from the rates of the stages; returns the change relative to the scale.
double Radau::correct(double h, const double *scale) {
  for (int s = 0; s < stages_; ++s)
    for (int i = 0; i < n_; ++i) {
      double sum = 0;
      for (int j = 0; j < stages_; ++j)
        sum += coefficients_[s * stages_ + j] * rate_[j * n_ + i];
      residual_[s * n_ + i] = h * sum - stage_[s * n_ + i];
    }
  if (linearisation_ == Linearisation::Turning)
    turning_.solve(residual_);
  else
    equations_->solve(residual_);
  double change = 0;
  for (int s = 0; s < stages_; ++s)
    for (int i = 0; i < n_; ++i) {
      stage_[s * n_ + i] += residual_[s * n_ + i];
      change = std::max(change, std::abs(residual_[s * n_ + i]) / scale[i]);
    }
  return residual_.allFinite() ? change : std::numeric_limits<double>::infinity();
}

Radau::Iteration Radau::newton(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy) {
  if (!factorise(dynamics, t0, h))
    return Iteration::Failed;
  double previous = 0;
  for (int k = 0; k < 15; ++k) {
    ++iterations;
    if (!evaluateStages(dynamics, t0, h))
      return Iteration::Failed;
    const double change = correct(h, scale);
    if (!std::isfinite(change))
      return Iteration::Failed;
    const double contraction = previous > 0 ? change / previous : 1e-3;
    if (change * std::min(contraction, 1.0) <= accuracy || change <= 1e-15)
      return Iteration::Converged;
    if (k >= 2 && contraction > 0.9)
      return change <= 1e3 * accuracy && change <= 1e-13 ? Iteration::Converged : Iteration::Slow;
    previous = change;
  }
  return Iteration::Slow;
}

// The rate at the element's begin. Where slips start there it is the limit of the rates behind it, with the directions to which those of
// the stages lead back: the ones that the mode begins with are those of other forces where these are redundant.
const double *Radau::startRate(ModeDynamics &dynamics, double t0, const double *f0) {
  const auto pairs = static_cast<std::size_t>(dynamics.turningSlipCount() / 2);
  std::vector<double> angles(pairs), limits(pairs, 0.0);
  for (int s = 0; s < stages_; ++s) {
    double weight = 1;
    for (int k = 0; k < stages_; ++k)
      weight *= k == s ? 1 : nodes_[k] / (nodes_[k] - nodes_[s]);
    pointOfStage(s);
    dynamics.slipAngles(t0 + nodes_[s] * h_, point_.data(), angles.data());
    for (std::size_t pair = 0; pair < pairs; ++pair)
      limits[pair] += weight * angles[pair];
  }
  startRate_.resize(n_);
  return dynamics.evaluateTurned(t0, begin_.data(), limits.data(), startRate_.data()) ? startRate_.data() : f0;
}

// A solution of the stage equations in which a slip does not go where it grows.
bool Radau::turnsBack(ModeDynamics &dynamics, double t0, double h) {
  for (int s = 0; s < stages_; ++s) {
    pointOfStage(s);
    if (dynamics.slipsTurnBack(t0 + nodes_[s] * h, point_.data()))
      return true;
  }
  return false;
}

// The last iteration has left the directions of slips that start as they were: velocities that are small beside the tolerance may have
// quite another direction in the next one.
bool Radau::startsAreSteady(ModeDynamics &dynamics, double t0, double h) {
  constexpr double most = 0.01;
  if (!dynamics.slipsStart())
    return true;
  const auto pairs = static_cast<std::size_t>(dynamics.turningSlipCount() / 2);
  previousAngles_.swap(angles_);
  angles_.resize(stages_ * pairs);
  for (int s = 0; s < stages_; ++s) {
    pointOfStage(s);
    dynamics.slipAngles(t0 + nodes_[s] * h, point_.data(), angles_.data() + s * pairs);
  }
  return angles_.size() == previousAngles_.size() && std::equal(angles_.begin(), angles_.end(), previousAngles_.begin(),
                                                                [](double now, double before) { return std::abs(now - before) <= most; });
}

// The direction of friction changes by the change of a slip over its size, which differs from stage to stage by powers of ten where a slip
// starts from zero: a matrix serves for more than one iteration only once it is that of the solution.
Radau::Iteration Radau::turningNewton(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy) {
  constexpr double fast = 0.02;
  // What is not linearised contracts by the same factor in each iteration, each of which costs little.
  const double slowest = linearisation_ == Linearisation::Turning ? 0.5 : 0.9;
  const int most = linearisation_ == Linearisation::Turning ? 40 : 20;
  double previous = 0, contraction = 1;
  angles_.clear();
  for (int k = 0; k < most; ++k) {
    ++iterations;
    if (!(contraction > fast ? factoriseStages(dynamics, t0, h) : evaluateStages(dynamics, t0, h)))
      return Iteration::Failed;
    const double change = correct(h, scale);
    if (!std::isfinite(change))
      return Iteration::Failed;
    if (k > 0)
      contraction = change / previous;
    const bool isSteady = startsAreSteady(dynamics, t0, h);
    if ((isSteady && change * std::min(contraction, 1.0) <= accuracy) || change <= 1e-15)
      return turnsBack(dynamics, t0, h) ? Iteration::Failed : Iteration::Converged;
    if (k >= 5 && contraction > slowest)
      return change <= 1e3 * accuracy && change <= 1e-13 ? Iteration::Converged : Iteration::Slow;
    previous = change;
  }
  return Iteration::Slow;
}

// All but the turn of friction is stiff in few models.
Radau::Iteration Radau::solveTurning(ModeDynamics &dynamics, double t0, double h, const double *scale, const double *f0, double accuracy) {
  turning_.setRank(dynamics.turningPairCount());
  Iteration outcome = Iteration::Failed;
  for (const Linearisation linearisation : {Linearisation::Turning, Linearisation::Full}) {
    linearisation_ = linearisation;
    predictAlongTangent(h, f0);
    if (predictTurning(dynamics, t0, h, scale))
      outcome = turningNewton(dynamics, t0, h, scale, accuracy);
    if (outcome == Iteration::Converged)
      break;
  }
  return outcome;
}

bool Radau::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale, double accuracy) {
  h_ = h;
  linearisation_ = Linearisation::None;
  std::copy_n(y0, n_, begin_.begin());
  predict(h, f0);
  Iteration outcome = Iteration::Slow;
  const bool turns = dynamics.slipsGrowSlowly(t0, y0);
  if (!stiff_ && !turns)
    outcome = fixedPoint(dynamics, t0, h, scale, accuracy);
  if (outcome != Iteration::Converged) {
    if (turns) {
      outcome = solveTurning(dynamics, t0, h, scale, f0, accuracy);
    } else {
      linearisation_ = Linearisation::Full;
      predictAlongTangent(h, f0);
      outcome = newton(dynamics, t0, h, scale, accuracy);
    }
    if (outcome != Iteration::Converged)
      return false;
    stiff_ = stiff_ || linearisation_ == Linearisation::Full;
  }
  const double *start = turns && dynamics.slipsStart() ? startRate(dynamics, t0, f0) : f0;
  for (int i = 0; i < n_; ++i)
    end_[i] = begin_[i] + stage_[(stages_ - 1) * n_ + i];
  if (!dynamics.evaluate(t0 + h, end_.data(), endRate_.data()))
    return false;
  std::copy_n(endRate_.begin(), n_, rate_.begin() + (stages_ - 1) * n_);
  estimateError(start, h);
  return true;
}

double Radau::stiffness(const tf_model &model, const double *scale) const {
  return linearisation_ == Linearisation::Full ? dampingBound(model, equations_->jacobian(0).data(), n_, scale) : 0;
}

void Radau::estimateError(const double *f0, double h) {
  for (int i = 0; i < n_; ++i) {
    double sum = embedded_[0] * f0[i];
    for (int k = 0; k < stages_; ++k)
      sum += embedded_[k + 1] * rate_[k * n_ + i];
    error_[i] = h * sum;
  }
  if (linearisation_ != Linearisation::None)
    dampError(h);
}

// The stiff components, whose errors the explicit f0 exaggerates.
void Radau::dampError(double h) {
  Eigen::Map<Eigen::VectorXd> error(error_.data(), n_);
  errorResidual_ = error;
  if (linearisation_ == Linearisation::Turning) {
    errorTurning_.setRank(static_cast<int>(turning_.left(stages_ - 1).cols()));
    errorTurning_.left(0) = turning_.left(stages_ - 1);
    errorTurning_.right(0) = turning_.right(stages_ - 1);
    errorTurning_.factorise(h);
    errorTurning_.solve(errorResidual_);
  } else {
    errorEquations_->jacobian(0) = equations_->jacobian(stages_ - 1);
    errorEquations_->factorise(h);
    errorEquations_->solve(errorResidual_);
  }
  error = errorResidual_;
}

void Radau::interpolate(double theta, double *y) {
  double product = theta;
  for (int k = 0; k < stages_; ++k) {
    if (theta == nodes_[k]) {
      for (int i = 0; i < n_; ++i)
        y[i] = begin_[i] + stage_[k * n_ + i];
      return;
    }
    product *= theta - nodes_[k];
  }
  std::copy(begin_.begin(), begin_.end(), y);
  for (int k = 0; k < stages_; ++k) {
    const double weight = product * barycentric_[k + 1] / (theta - nodes_[k]);
    for (int i = 0; i < n_; ++i)
      y[i] += weight * stage_[k * n_ + i];
  }
}

double Radau::errorNorm(const double *scale, double tolerance) const {
  double norm = 0;
  for (int i = 0; i < n_; ++i)
    norm = std::max(norm, std::abs(error_[i]) / scale[i]);
  // Behind a switch the local error may be of no higher order than the estimate.
  return (distance_ < 1 ? norm : std::pow(norm, errorPower_)) / tolerance;
}

}  // namespace tf::runtime
