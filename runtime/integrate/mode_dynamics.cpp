#include "runtime/integrate/mode_dynamics.h"

#include "runtime/contact/time_speed.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

bool allFinite(const double *values, int count) {
  double sum = 0;  // infinities and NaN survive multiplication by zero and addition
  for (int i = 0; i < count; ++i)
    sum += values[i] * 0;
  return sum == 0;
}

bool allFinite(const std::vector<double> &values) { return allFinite(values.data(), static_cast<int>(values.size())); }

}  // namespace

ModeDynamics::ModeDynamics(ModelEvaluation &evaluation)
    : at_(evaluation), isPaired_(evaluation.model().nt), mask_(evaluation.model().nc + evaluation.model().nf),
      slidingMask_(evaluation.model().ns), change_(evaluation.model().nv), constraintChange_(evaluation.model().nh),
      plus_(evaluation.stateSize()), minus_(evaluation.stateSize()), shifted_(evaluation.stateSize()) {
  const std::vector<int> pair = pairsOfTangents(evaluation.model());
  for (std::size_t j = 0; j < pair.size(); ++j)
    isPaired_[j] = pair[j] >= 0;
}

bool ModeDynamics::start(const Mode &mode, double time, const double *state, double *rate) {
  const tf_model &model = at_.model();
  mode_ = mode;
  std::vector<int> contacts, tangents;
  for (int i = 0; i < model.nc; ++i) {
    mask_[i] = mode.closed[i];
    if (mode.closed[i])
      contacts.push_back(i);
  }
  std::fill(mask_.begin() + model.nc, mask_.end(), std::uint8_t{1});
  for (int j = 0; j < model.nt; ++j)
    if (mode.tangent[j] != Tangent::None)
      tangents.push_back(j);
  problem_.resize(static_cast<int>(contacts.size()), static_cast<int>(tangents.size()));
  contactMode_.resize(problem_.normalCount, problem_.tangentCount);
  rows_.choose(model, contacts, tangents, problem_);
  std::fill(contactMode_.closed.begin(), contactMode_.closed.end(), std::uint8_t{1});
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    contactMode_.slip[j] = static_cast<std::int8_t>(mode.tangent[tangents[j]]);
    problem_.slipSign[j] = contactMode_.slip[j];
  }
  chooseDirections(time, state);
  rowChange_.assign(rows_.count(), 0.0);
  forceChange_ = cgX_ = cgR_ = cgP_ = cgQ_ = rowChange_;
  correctedRows_.assign(rows_.count(), 0);
  limitChange_.assign(tangents.size(), 0.0);
  closedForce_.assign(contacts.size(), 0.0);
  closedRate_.clear();
  for (int i : contacts)
    closedRate_.push_back(at_.rate[i]);
  std::fill(at_.normalForce.begin(), at_.normalForce.end(), 0.0);
  std::fill(at_.tangentForce.begin(), at_.tangentForce.end(), 0.0);

  sliding_.clear();
  for (int j = 0; j < model.ns; ++j) {
    slidingMask_[j] = mode.switches[j] == Switch::Sliding;
    if (slidingMask_[j])
      sliding_.push_back(j);
    else
      at_.stepVariable[j] = mode.switches[j] == Switch::One ? 1 : 0;
  }
  slidingResidual_.assign(sliding_.size(), 0.0);
  slidingMatrix_.resize(static_cast<Eigen::Index>(sliding_.size()), static_cast<Eigen::Index>(sliding_.size()));
  for (int j : sliding_)
    at_.stepVariable[j] = std::clamp(at_.stepVariable[j], 0.01, 0.99);

  starting_ = true;
  const bool good = evaluate(time, state, rate);
  starting_ = false;
  if (good)
    buildGuards();
  return good;
}

bool ModeDynamics::fail(EvaluationFailure failure) {
  failure_ = failure;
  return false;
}

bool ModeDynamics::frictionIsNegative() const {
  for (int j = 0; j < problem_.tangentCount; ++j)
    if ((problem_.owner[j] >= 0 ? problem_.friction[j] : problem_.bound[j]) < 0)
      return true;
  return false;
}

bool ModeDynamics::prepare(double time, const double *state) {
  ++evaluations_;
  at_.setPoint(time, state);
  if (!pairs_.empty()) {
    at_.switching(ModelEvaluation::Slips);
    alignFrames();
  }
  if (!at_.dynamics())
    return fail(allFinite(at_.massMatrix) && allFinite(at_.constraintJacobian) ? EvaluationFailure::SingularMass
                                                                               : EvaluationFailure::NotFinite);
  if (rows_.count() > 0) {
    at_.contactTerms(mask_.data());
    rows_.assemble(at_, problem_.delassus, problem_);
    if (frictionIsNegative())
      return fail(EvaluationFailure::NegativeFriction);
  }
  return true;
}

bool ModeDynamics::solveForces() {
  at_.mobility.accelerate(at_.force.data(), at_.constraintBias.data(), at_.acceleration.data());
  if (rows_.count() == 0)
    return true;
  rows_.bias(at_, at_.acceleration.data(), problem_.bias);
  const bool solved = starting_ ? forces_.start(problem_, contactMode_) : forces_.evaluate(problem_);
  if (!solved)
    return fail(EvaluationFailure::SingularContact);
  rows_.accelerate(forces_.forces().data(), at_.acceleration.data());
  return true;
}

void ModeDynamics::conditionRates(double *rates) {
  const tf_model &model = at_.model();
  const int nx = at_.columns();
  std::vector<double> &qDot = shifted_;
  at_.kinematics(qDot.data());
  for (std::size_t s = 0; s < sliding_.size(); ++s) {
    const double *row = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(sliding_[s]) * nx;
    double sum = 0;
    for (int i = 0; i < model.nq; ++i)
      sum += *row++ * qDot[i];
    for (int i = 0; i < model.nv; ++i)
      sum += *row++ * at_.acceleration[i];
    for (int i = 0; i < model.nz; ++i)
      sum += *row++ * at_.stateRate[i];
    for (int i = 0; i < model.nu; ++i)
      sum += *row++ * at_.inputRate[i];
    rates[s] = sum + *row;
  }
}

void ModeDynamics::response(const double *forceChange, const double *constraintChange, const double *biasChange, const double *limitChange,
                            double *accelerationChange) {
  at_.mobility.accelerate(forceChange, constraintChange, accelerationChange);
  if (rows_.count() == 0)
    return;
  for (int i = 0; i < rows_.count(); ++i)
    rowChange_[i] = rows_.product(i, accelerationChange) + (biasChange != nullptr ? biasChange[i] : 0);
  if (limitChange != nullptr)
    std::copy_n(limitChange, limitChange_.size(), limitChange_.begin());
  else
    std::fill(limitChange_.begin(), limitChange_.end(), 0.0);
  forces_.forceRates(rowChange_, limitChange_, forceChange_);
  rows_.accelerate(forceChange_.data(), accelerationChange);
}

// Newton's method for d c_j/dt (alpha) = 0; one iteration where f is affine in the sliding step variables.
bool ModeDynamics::solveSliding() {
  const tf_model &model = at_.model();
  const int count = static_cast<int>(sliding_.size());
  const int nx = at_.columns();
  at_.switchGradients(slidingMask_.data());
  double previous = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 30; ++iteration) {
    conditionRates(slidingResidual_.data());
    at_.stepDerivatives();
    for (int k = 0; k < count; ++k) {
      std::vector<double> &column = minus_;
      for (int i = 0; i < model.nv; ++i)
        column[i] = at_.forceByStep[i * model.ns + sliding_[k]];
      response(column.data(), nullptr, nullptr, nullptr, change_.data());
      for (int s = 0; s < count; ++s) {
        const double *row = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(sliding_[s]) * nx + model.nq;
        double sum = 0;
        for (int i = 0; i < model.nv; ++i)
          sum += row[i] * change_[i];
        for (int i = 0; i < model.nz; ++i)
          sum += row[model.nv + i] * at_.stateRateByStep[i * model.ns + sliding_[k]];
        slidingMatrix_(s, k) = sum;
      }
    }
    slidingFactor_.compute(slidingMatrix_);
    const Eigen::Map<Eigen::VectorXd> residual(slidingResidual_.data(), count);
    const Eigen::VectorXd step = slidingFactor_.solve(residual);
    if (!step.allFinite())
      return fail(EvaluationFailure::SlidingDiverged);
    for (int k = 0; k < count; ++k)
      at_.stepVariable[sliding_[k]] -= step[k];
    at_.forces();
    if (!solveForces())
      return false;
    const double size = step.lpNorm<Eigen::Infinity>();
    if (size <= 1e-15 || (size >= previous && size <= 1e-12))
      return true;
    if (count == 1 && iteration == 1 && size <= 1e-13)
      return true;
    previous = size;
  }
  return fail(EvaluationFailure::SlidingDiverged);
}

bool ModeDynamics::evaluate(double time, const double *state, double *rate) {
  const tf_model &model = at_.model();
  if (!prepare(time, state) || !solveForces())
    return false;
  if (!sliding_.empty() && !solveSliding())
    return false;
  const int normals = rows_.normalCount();
  if (rows_.count() > 0) {
    const auto forces = forces_.forces();
    for (int i = 0; i < normals; ++i)
      at_.normalForce[rows_.contacts()[i]] = closedForce_[i] = std::max(forces[i], 0.0);
    rows_.spreadTangentForces(forces.data() + normals, at_.tangentForce.data());
  }
  timeSpeed_ = normals > 0 ? tf::runtime::timeSpeed(closedForce_, closedRate_) : 1;
  at_.kinematics(rate);
  std::copy_n(at_.acceleration.data(), model.nv, rate + model.nq);
  std::copy_n(at_.stateRate.data(), model.nz, rate + model.nq + model.nv);
  rate[size() - 1] = 1 / timeSpeed_;
  if (!allFinite(rate, size()))
    return fail(EvaluationFailure::NotFinite);
  return true;
}

void ModeDynamics::differenceJacobian(double time, const double *state, double *matrix) {
  const int n = size();
  std::copy_n(state, n, shifted_.begin());
  std::vector<double> point(state, state + n);
  for (int k = 0; k < n - 1; ++k) {
    const double step = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(state[k]));
    point[k] = state[k] + step;
    std::vector<double> plus(n), minus(n);
    const bool up = evaluate(time, point.data(), plus.data());
    point[k] = state[k] - step;
    const bool down = evaluate(time, point.data(), minus.data());
    point[k] = state[k];
    for (int i = 0; i < n; ++i)
      matrix[k * n + i] = up && down ? (plus[i] - minus[i]) / (2 * step) : 0;
  }
}

// d q'/d y_k
void ModeDynamics::kinematicColumn(int k, double *column) const {
  const tf_model &model = at_.model();
  const int velocity = k - model.nq;
  if (velocity >= model.nv)
    return;
  if (model.kinematics == nullptr) {
    if (velocity >= 0)
      column[velocity] = 1;
    return;
  }
  for (int i = 0; i < model.nq; ++i)
    column[i] = velocity < 0 ? at_.kinematicsByCoordinate[i * model.nq + k] : at_.kinematicMatrix[i * model.nv + velocity];
}

void ModeDynamics::solveMultipliers() {
  const tf_model &model = at_.model();
  if (model.nh == 0)
    return;
  std::copy(at_.force.begin(), at_.force.end(), change_.begin());
  if (rows_.count() > 0)
    rows_.addForces(forces_.forces().data(), change_.data());
  at_.mobility.multipliers(change_.data(), at_.constraintBias.data(), at_.multiplier.data());
}

bool ModeDynamics::jacobian(double time, const double *state, double *matrix) {
  const tf_model &model = at_.model();
  const int n = size();
  const int nx = at_.columns();
  std::fill_n(matrix, n * n, 0.0);
  // Second derivatives of the conditions are not part of a compiled model.
  if (!sliding_.empty()) {
    differenceJacobian(time, state, matrix);
    return true;
  }
  solveMultipliers();
  at_.dynamicsDerivatives(mask_.data());
  at_.kinematicsDerivatives();
  differenceSlips(time, state);
  const int normals = rows_.normalCount();
  std::vector<double> forceChange(model.nv), constraintChange(model.nh), biasChange(rows_.count()), limitChange(rows_.tangents().size()),
      column(model.nv);
  for (int k = 0; k < n - 1; ++k) {
    for (int i = 0; i < model.nv; ++i)
      forceChange[i] = -at_.residualByState[i * nx + k];
    for (int i = 0; i < model.nh; ++i)
      constraintChange[i] = at_.constraintByState[i * nx + k];
    for (int i = 0; i < rows_.count(); ++i)
      biasChange[i] = i < normals ? at_.normalByState[rows_.contacts()[i] * nx + k]
                                  : rows_.tangentValue(at_.tangentByState.data() + k, nx, i - normals);
    for (std::size_t p = 0; p < pairs_.size() && k < model.nq + model.nv; ++p) {
      const int across = normals + pairs_[p].row + 1;
      const double change = forces_.forces()[across - 1] * turning(p, k);
      for (int i = 0; i < model.nv; ++i)
        forceChange[i] += rows_.jacobian(across)[i] * change;
    }
    for (std::size_t j = 0; j < limitChange.size(); ++j) {
      const int owner = problem_.owner[j];
      limitChange[j] = owner >= 0 ? at_.frictionByState[rows_.contacts()[owner] * nx + k] * closedForce_[owner]
                                  : at_.boundByState[rows_.tangents()[j] * nx + k];
    }
    response(forceChange.data(), constraintChange.data(), biasChange.data(), limitChange.data(), column.data());
    double *target = matrix + static_cast<std::ptrdiff_t>(k) * n;
    std::copy(column.begin(), column.end(), target + model.nq);
    for (int i = 0; i < model.nz; ++i)
      target[model.nq + model.nv + i] = at_.stateRateByState[i * nx + k];
    kinematicColumn(k, target);
  }
  return allFinite(matrix, n * n);
}

void ModeDynamics::accelerationRates(const RowSystem &rows, const double *rate, std::vector<double> &accelerationRate,
                                     std::vector<double> &frictionRate, std::vector<double> &boundRate) {
  const tf_model &model = at_.model();
  const int nx = at_.columns();
  const std::vector<std::uint8_t> all(mask_.size(), 1);
  solveMultipliers();
  at_.dynamicsDerivatives(all.data());
  std::vector<double> direction(rate, rate + model.nq + model.nv + model.nz);
  direction.insert(direction.end(), at_.inputRate.begin(), at_.inputRate.end());
  direction.push_back(1);
  const auto along = [&](const std::vector<double> &matrix, int row) {
    double sum = 0;
    for (int k = 0; k < nx; ++k)
      sum += matrix[row * nx + k] * direction[k];
    return sum;
  };
  std::vector<double> jerk(model.nv);
  for (int i = 0; i < model.nv; ++i)
    jerk[i] = -along(at_.residualByState, i);
  // Friction turns with the slip: ds/dt = (across acceleration) / ‖v_t‖ times the direction across.
  for (const SlipPair &pair : pairs_) {
    const int across = rows_.normalCount() + pair.row + 1;
    const double speed = std::hypot(at_.slip[pair.modelRow], at_.slip[pair.modelRow + 1]);
    if (speed <= 10 * slipRounding_)
      continue;
    const double acceleration =
        rows_.product(across, at_.acceleration.data()) + rows_.tangentValue(at_.tangentBias.data(), 1, pair.row + 1);
    for (int i = 0; i < model.nv; ++i)
      jerk[i] += rows_.jacobian(across)[i] * forces_.forces()[across - 1] * acceleration / speed;
  }
  std::vector<double> constraintChange(model.nh);
  for (int i = 0; i < model.nh; ++i)
    constraintChange[i] = along(at_.constraintByState, i);
  at_.mobility.accelerate(jerk.data(), constraintChange.data(), jerk.data());
  const int normals = rows.normalCount();
  std::vector<double> modelRate(model.nt);
  for (int row : rows.tangents())
    modelRate[row] = along(at_.tangentByState, row);
  const auto tangentRate = [&](int j) { return rows.tangentValue(modelRate.data(), 1, j); };
  for (int i = 0; i < rows.count(); ++i)
    accelerationRate[i] =
        rows.product(i, jerk.data()) + (i < normals ? along(at_.normalByState, rows.contacts()[i]) : tangentRate(i - normals));
  const std::vector<int> owner = contactsOfTangents(model);
  for (std::size_t j = 0; j < rows.tangents().size(); ++j) {
    const int row = rows.tangents()[j];
    frictionRate[j] = owner[row] >= 0 ? along(at_.frictionByState, owner[row]) : 0;
    boundRate[j] = owner[row] < 0 ? along(at_.boundByState, row) : 0;
  }
}

double ModeDynamics::normalForce(int contact) const {
  for (int i = 0; i < rows_.normalCount(); ++i)
    if (rows_.contacts()[i] == contact)
      return forces_.forces()[i];
  return 0;
}

int ModeDynamics::jammedContact() const {
  constexpr double jammed = 1e-6;
  const int normals = rows_.normalCount();
  for (int j = 0; j < problem_.tangentCount; ++j) {
    const int i = problem_.owner[j];
    if (i < 0 || contactMode_.slip[j] == 0)
      continue;
    const double own = problem_.delassus(i, i);
    if (own - contactMode_.slip[j] * problem_.friction[j] * problem_.delassus(i, normals + j) <= jammed * own)
      return rows_.contacts()[i];
  }
  return -1;
}

double ModeDynamics::frictionPower() {
  double power = 0;
  if (rows_.tangents().empty())
    return power;
  at_.switching(ModelEvaluation::Slips);
  for (const int row : rows_.tangents())
    power += at_.tangentForce[row] * at_.slip[row];
  return power;
}

double ModeDynamics::reactionPower() {
  const tf_model &model = at_.model();
  const double *velocities = at_.velocities();
  double power = 0;
  for (int i = 0; i < rows_.count(); ++i)
    power += forces_.forces()[i] * rows_.product(i, velocities);
  solveMultipliers();
  for (int row = 0; row < model.nh; ++row)
    for (int k = 0; k < model.nv; ++k)
      power += at_.multiplier[row] * at_.constraintJacobian[row * model.nv + k] * velocities[k];
  return power;
}

void ModeDynamics::buildGuards() {
  const tf_model &model = at_.model();
  guards_.clear();
  for (int i = 0; i < model.nc; ++i)
    if (!mode_.closed[i])
      guards_.push_back({GuardKind::Gap, i, 1, model.contacts[i].nominal});
  double largest = 0;
  if (rows_.count() > 0) {
    for (double force : forces_.forces())
      largest = std::max(largest, std::abs(force));
    for (std::size_t k = 0; k < forces_.margins().size(); ++k)
      guards_.push_back({GuardKind::Force, static_cast<int>(k), 1, std::max(largest, 1e-6)});
  }
  for (int j = 0; j < model.nt; ++j)
    if (!isPaired_[j] && (mode_.tangent[j] == Tangent::SlipPositive || mode_.tangent[j] == Tangent::SlipNegative))
      guards_.push_back({GuardKind::Slip, j, mode_.tangent[j] == Tangent::SlipPositive ? 1.0 : -1.0, 1});
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    guards_.push_back({GuardKind::SlipAlong, static_cast<int>(k), 1, slipRounding_ / 1e-12});
  for (int j = 0; j < model.ns; ++j) {
    if (mode_.switches[j] == Switch::Sliding) {
      guards_.push_back({GuardKind::StepLow, j, 1, 1});
      guards_.push_back({GuardKind::StepHigh, j, -1, 1});
    } else {
      guards_.push_back({GuardKind::Condition, j, mode_.switches[j] == Switch::One ? 1.0 : -1.0, 1});
    }
  }
}

double ModeDynamics::readGuard(const Guard &guard) const {
  switch (guard.kind) {
  case GuardKind::Gap:
    return at_.gap[guard.index];
  case GuardKind::Force:
    return forces_.marginValues()[guard.index];
  case GuardKind::Slip:
    return guard.sign * at_.slip[guard.index];
  case GuardKind::SlipAlong:
    return along(pairs_[guard.index]);
  case GuardKind::Condition:
    return guard.sign * at_.condition[guard.index];
  case GuardKind::StepLow:
    return at_.stepVariable[guard.index];
  case GuardKind::StepHigh:
    return 1 - at_.stepVariable[guard.index];
  }
  return 0;
}

double ModeDynamics::guardValue(int guard) {
  const Guard &g = guards_[guard];
  if (g.kind == GuardKind::Gap)
    at_.switching(ModelEvaluation::Gaps);
  else if (g.kind == GuardKind::Slip || g.kind == GuardKind::SlipAlong)
    at_.switching(ModelEvaluation::Slips);
  else if (g.kind == GuardKind::Condition)
    at_.switching(ModelEvaluation::Conditions);
  return readGuard(g);
}

void ModeDynamics::guardValues(double *values) {
  const tf_model &model = at_.model();
  int parts = 0;
  if (model.nc > 0)
    parts |= ModelEvaluation::Gaps;
  if (!rows_.tangents().empty())
    parts |= ModelEvaluation::Slips;
  if (model.ns > 0)
    parts |= ModelEvaluation::Conditions;
  if (parts != 0)
    at_.switching(parts);
  for (std::size_t k = 0; k < guards_.size(); ++k)
    values[k] = readGuard(guards_[k]);
}

void ModeDynamics::guardRates(double *rates) const {
  for (std::size_t k = 0; k < guards_.size(); ++k)
    rates[k] = guards_[k].kind == GuardKind::Gap ? at_.gapRate[guards_[k].index] : std::numeric_limits<double>::quiet_NaN();
}

bool ModeDynamics::rechoose(int guard) {
  assert(guards_[guard].kind == GuardKind::Force);
  if (forces_.cross(guards_[guard].index) != MarginOutcome::Rechosen)
    return false;
  buildGuards();
  return true;
}

void ModeDynamics::correct(double *target) {
  const int rows = rows_.count();
  std::fill(cgX_.begin(), cgX_.end(), 0.0);
  std::copy(cgR_.begin(), cgR_.end(), cgP_.begin());
  double norm = 0;
  for (int i = 0; i < rows; ++i)
    norm += cgR_[i] * cgR_[i];
  const double first = norm;
  double trace = 0;
  for (int i = 0; i < rows; ++i)
    trace += problem_.delassus(i, i);
  // Conjugate gradients: exact after as many iterations as D has rank, also where D is singular and the residual consistent.
  for (int iteration = 0; iteration < 2 * rows && norm > 1e-28 * first; ++iteration) {
    double curvature = 0, length = 0;
    for (int i = 0; i < rows; ++i) {
      cgQ_[i] = 0;
      for (int j = 0; correctedRows_[i] && j < rows; ++j)
        cgQ_[i] += problem_.delassus(i, j) * cgP_[j];
      curvature += cgP_[i] * cgQ_[i];
      length += cgP_[i] * cgP_[i];
    }
    // What is left is rounding that no motion of redundant rows can remove.
    if (!(curvature > 1e-12 * trace * length))
      break;
    const double step = norm / curvature;
    double next = 0;
    for (int i = 0; i < rows; ++i) {
      cgX_[i] += step * cgP_[i];
      cgR_[i] -= step * cgQ_[i];
      next += cgR_[i] * cgR_[i];
    }
    for (int i = 0; i < rows; ++i)
      cgP_[i] = cgR_[i] + next / norm * cgP_[i];
    norm = next;
  }
  rows_.accelerate(cgX_.data(), target);
}

bool ModeDynamics::needsProjection() const {
  const tf_model &model = at_.model();
  return rows_.count() > 0 || model.nh > 0 || model.nr > 0;
}

// Newton's method with the rows of the last evaluation: its error after one correction is the product of the correction and the change of
// the rows.
void ModeDynamics::projectCoordinates(double *state) {
  const tf_model &model = at_.model();
  constexpr int mostCorrections = 5;
  constexpr double rounding = 1e-14;
  double previous = std::numeric_limits<double>::infinity();
  for (int correction = 0; correction < mostCorrections; ++correction) {
    double worst = 0;
    std::fill(change_.begin(), change_.end(), 0.0);
    if (model.nh > 0) {
      at_.constraintResiduals();
      for (int k = 0; k < model.nk; ++k)
        for (int row = model.constraints[k].row_first; row < model.constraints[k].row_first + model.constraints[k].row_count; ++row) {
          constraintChange_[row] = model.constraints[k].holonomic ? -at_.residual[row] : 0;
          worst = std::max(worst, std::abs(constraintChange_[row]) / model.constraints[k].nominal);
        }
      at_.mobility.correct(constraintChange_.data(), change_.data());
    }
    if (rows_.count() > 0)
      at_.switching(ModelEvaluation::Gaps);
    for (int i = 0; i < rows_.count(); ++i) {
      const bool isNormal = i < rows_.normalCount();
      correctedRows_[i] = isNormal;
      cgR_[i] = isNormal ? -at_.gap[rows_.contacts()[i]] - rows_.product(i, change_.data()) : 0;
      if (isNormal)
        worst = std::max(worst, std::abs(cgR_[i]) / model.contacts[rows_.contacts()[i]].nominal);
    }
    if (correction > 0 && (worst <= rounding || worst > 0.5 * previous))
      return;
    previous = worst;
    correct(change_.data());
    at_.moveCoordinates(state, change_.data());
  }
}

void ModeDynamics::projectVelocities(double *velocities, int stoppedRow) {
  const tf_model &model = at_.model();
  std::fill(change_.begin(), change_.end(), 0.0);
  if (model.nh > 0) {
    at_.constraintResiduals();
    for (int row = 0; row < model.nh; ++row)
      constraintChange_[row] = -at_.residualRate[row];
    at_.mobility.correct(constraintChange_.data(), change_.data());
  }
  const int rows = rows_.count(), normals = rows_.normalCount();
  if (rows > 0)
    at_.switching(ModelEvaluation::Gaps | (rows > normals ? ModelEvaluation::Slips : 0));
  for (int i = 0; i < rows; ++i) {
    const int j = i - normals;
    correctedRows_[i] = i < normals || contactMode_.slip[j] == 0 || (stoppedRow >= 0 && (j == stoppedRow || j == stoppedRow + 1));
    const double rate = i < normals ? at_.gapRate[rows_.contacts()[i]] : rows_.tangentValue(at_.slip.data(), 1, j);
    cgR_[i] = correctedRows_[i] ? -rate - rows_.product(i, change_.data()) : 0;
  }
  correct(change_.data());
  for (int i = 0; i < model.nv; ++i)
    velocities[i] += change_[i];
}

double ModeDynamics::project(double *state, const double *scale, int stopped) {
  if (!needsProjection())
    return 0;
  const tf_model &model = at_.model();
  at_.setPoint(at_.time(), state);
  std::copy_n(state, model.nq + model.nv, shifted_.begin());
  projectCoordinates(state);
  projectVelocities(state + model.nq, stopped >= 0 ? pairs_[guards_[stopped].index].row : -1);
  double size = 0;
  for (int k = 0; k < model.nq + model.nv; ++k)
    size = std::max(size, std::abs(state[k] - shifted_[k]) / scale[k]);
  return size;
}

}  // namespace tf::runtime
