#include "runtime/integrate/cvode_integrator.h"

#include "runtime/integrate/condensed_solver.h"
#include "runtime/integrate/damping_bound.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tf::runtime {

namespace {

// Local errors of a multistep method of order 5 add up over the more steps the tighter the tolerance is, and every event begins anew with
// order 1: the part of the tolerance that a step may take, measured on the examples with many events, so that the promise on global errors
// holds with a margin.
double stepShare(double tolerance) { return 0.01 * std::pow(tolerance / 1e-4, 0.25); }
constexpr double carefulFactor = 1e-3;

// What the callbacks work on.
struct Problem {
  ModeDynamics *dynamics;
  const double *scale;
  std::vector<double> rate;
  double tolerance = 0;
  double correction = 0;  // of the step's latest attempt
  double damping = 0;     // by the latest Jacobian, in 1/s
};

// Weights of the error norm: 1 / (tolerance · max(scale, |y|)). A function, since it may change from step to step.
int errorWeights(N_Vector state, N_Vector weights, void *data) {
  const auto *problem = static_cast<const Problem *>(data);
  for (int i = 0; i < problem->dynamics->size(); ++i)
    N_VGetArrayPointer(weights)[i] = 1 / (problem->tolerance * std::max(problem->scale[i], std::abs(N_VGetArrayPointer(state)[i])));
  return 0;
}

int evaluateRate(realtype time, N_Vector state, N_Vector rate, void *data) {
  ModeDynamics *dynamics = static_cast<Problem *>(data)->dynamics;
  return dynamics->evaluate(time, N_VGetArrayPointer(state), N_VGetArrayPointer(rate)) ? 0 : 1;
}

int evaluateJacobian(realtype time, N_Vector state, N_Vector rate, SUNMatrix matrix, void *data, N_Vector, N_Vector, N_Vector) {
  auto *problem = static_cast<Problem *>(data);
  ModeDynamics *dynamics = problem->dynamics;
  // The Jacobian is taken at the last evaluation's point.
  if (!dynamics->evaluate(time, N_VGetArrayPointer(state), N_VGetArrayPointer(rate)))
    return 1;
  if (!dynamics->jacobian(time, N_VGetArrayPointer(state), SUNDenseMatrix_Data(matrix)))
    return 1;
  problem->damping = dampingBound(dynamics->model().model(), SUNDenseMatrix_Data(matrix), dynamics->size(), problem->scale);
  return 0;
}

// Closed contacts and sticking rows stay on gap = 0, gap rate = 0, slip = 0.
int projectState(realtype time, N_Vector state, N_Vector correction, realtype /*epsilon*/, N_Vector /*error*/, void *data) {
  auto *problem = static_cast<Problem *>(data);
  N_VConst(0, correction);
  if (!problem->dynamics->needsProjection())
    return 0;
  if (!problem->dynamics->evaluate(time, N_VGetArrayPointer(state), problem->rate.data()))
    return 1;
  const int n = problem->dynamics->size();
  double *moved = problem->rate.data();
  std::copy_n(N_VGetArrayPointer(state), n, moved);
  problem->correction = problem->dynamics->project(time, moved, problem->scale);
  for (int i = 0; i < n; ++i)
    N_VGetArrayPointer(correction)[i] = moved[i] - N_VGetArrayPointer(state)[i];
  return 0;
}

void ignoreMessage(int, const char *, const char *, char *, void *) {}

}  // namespace

struct CvodeIntegrator::Solver {
  SUNContext context = nullptr;
  N_Vector state = nullptr, derivative = nullptr;
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  void *memory = nullptr;
  bool created = false;
  Problem problem;

  Solver(ModeDynamics &dynamics, const double *scale) : problem{&dynamics, scale, std::vector<double>(dynamics.size())} {
    const int n = dynamics.size();
    if (SUNContext_Create(nullptr, &context) != 0)
      throw std::bad_alloc();
    state = N_VNew_Serial(n, context);
    derivative = N_VNew_Serial(n, context);
    matrix = SUNDenseMatrix(n, n, context);
    const tf_model &model = dynamics.model().model();
    const bool isLarge = model.nv > RowSystem::narrow;
    linear = isLarge && model.kinematics == nullptr ? makeCondensedSolver(model.nq, n, context) : SUNLinSol_Dense(state, matrix, context);
    memory = CVodeCreate(CV_BDF, context);
    if (state == nullptr || derivative == nullptr || matrix == nullptr || linear == nullptr || memory == nullptr)
      throw std::bad_alloc();
  }
  Solver(const Solver &) = delete;
  Solver &operator=(const Solver &) = delete;
  ~Solver() {
    CVodeFree(&memory);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(derivative);
    N_VDestroy(state);
    SUNContext_Free(&context);
  }
};

CvodeIntegrator::CvodeIntegrator(ModeDynamics &dynamics, IntegratorSettings settings)
    : SmoothIntegrator(dynamics, std::move(settings)), solver_(std::make_unique<Solver>(dynamics_, settings_.scale.data())) {}

CvodeIntegrator::~CvodeIntegrator() = default;

void CvodeIntegrator::start(double time, const double *state, const double *rate, double firstStep) {
  beginTime_ = endTime_ = time;
  std::copy_n(state, n_, end_.begin());
  std::copy_n(rate, n_, endRate_.begin());
  std::copy_n(state, n_, N_VGetArrayPointer(solver_->state));
  Solver &s = *solver_;
  careful_ = false;
  s.problem.damping = 0;
  if (!s.created) {
    CVodeInit(s.memory, evaluateRate, time, s.state);
    CVodeWFtolerances(s.memory, errorWeights);
    CVodeSetUserData(s.memory, &s.problem);
    CVodeSetLinearSolver(s.memory, s.linear, s.matrix);
    CVodeSetJacFn(s.memory, evaluateJacobian);
    CVodeSetProjFn(s.memory, projectState);
    CVodeSetProjErrEst(s.memory, SUNFALSE);
    CVodeSetErrHandlerFn(s.memory, ignoreMessage, nullptr);
    CVodeSetMaxNumSteps(s.memory, 1000000);
    s.created = true;
  } else {
    restart(time);
  }
  setTolerance();
  CVodeSetInitStep(s.memory, settings_.fixedStep > 0 ? settings_.fixedStep : 0);
  next_ = firstStep;
}

void CvodeIntegrator::setTolerance() {
  const double share = stepShare(settings_.tolerance) * settings_.tolerance;
  solver_->problem.tolerance = careful_ ? std::clamp(carefulFactor * share, 1e-12, 1e-11) : std::max(share, 1e-13);
}

void CvodeIntegrator::setCareful(bool careful) {
  if (careful == careful_)
    return;
  careful_ = careful;
  setTolerance();
}

// A component may have more than the mean error, and errors of some steps add up: the bound of the mean error is 1e-12 at least, and a
// tenth of this at most.
double CvodeIntegrator::startingError() const { return std::clamp(0.03 * carefulFactor * settings_.tolerance, 1e-11, 1e-10); }

double CvodeIntegrator::correction() const { return solver_->problem.correction; }

double CvodeIntegrator::stiffness() const { return solver_->problem.damping; }

// CVODE's numbers since it was last initialised, beside those of before.
void CvodeIntegrator::readStatistics() {
  long failures = 0, unsolved = 0, jacobians = 0, iterations = 0;
  CVodeGetNumErrTestFails(solver_->memory, &failures);
  CVodeGetNumStepSolveFails(solver_->memory, &unsolved);
  CVodeGetNumJacEvals(solver_->memory, &jacobians);
  CVodeGetNumNonlinSolvIters(solver_->memory, &iterations);
  statistics_.rejected = before_.rejected + failures + unsolved;
  statistics_.jacobians = before_.jacobians + jacobians;
  statistics_.iterations = before_.iterations + iterations;
}

// From the state of the solver.
void CvodeIntegrator::restart(double time) {
  readStatistics();
  before_ = statistics_;
  CVodeReInit(solver_->memory, time, solver_->state);
}

// Back to the begin of the step.
void CvodeIntegrator::repeat(double limit) {
  std::copy(begin_.begin(), begin_.end(), N_VGetArrayPointer(solver_->state));
  restart(beginTime_);
  CVodeSetStopTime(solver_->memory, limit);
}

StepStatus CvodeIntegrator::step(double limit) {
  Solver &s = *solver_;
  limit = std::min(limit, endTime_ + longestUniform());
  beginTime_ = endTime_;
  begin_ = end_;
  beginRate_ = endRate_;
  CVodeSetStopTime(s.memory, limit);
  double reached = beginTime_, stop = limit;
  s.problem.correction = 0;
  int outcome = CVode(s.memory, limit, s.state, &reached, CV_ONE_STEP);
  // Rounding errors of the model may be larger than the share of the tolerance: up to a tenth of it (theory.md section 6). Steps fail then,
  // or they become ever shorter, which makes such errors no smaller; towards a pole they do so, too.
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  const auto isHindered = [&] {
    const bool vanishes =
        outcome >= 0 && reached < limit && reached - beginTime_ <= rounding * std::abs(beginTime_) && !dynamics_.mayTurnBeyondPole();
    return outcome == CV_CONV_FAILURE || outcome == CV_ERR_FAILURE || vanishes;
  };
  while (isHindered() && 3 * s.problem.tolerance <= 0.1 * settings_.tolerance) {
    s.problem.tolerance *= 3;
    repeat(limit);
    outcome = CVode(s.memory, limit, s.state, &reached, CV_ONE_STEP);
  }
  // Shorter steps find the pole.
  const double shortest = 1e-12 * std::max(std::abs(beginTime_), std::abs(reached));
  for (double length = reached - beginTime_; outcome >= 0 && dynamics_.mayTurnBeyondPole() && length > shortest && hasDefect(reached);
       length = reached - beginTime_) {
    constexpr double shorter = 1.0 / 8;
    stop = beginTime_ + 2 * shorter * length;
    repeat(stop);
    ++before_.rejected;
    CVodeSetInitStep(s.memory, shorter * length);
    outcome = CVode(s.memory, limit, s.state, &reached, CV_ONE_STEP);
    CVodeSetInitStep(s.memory, settings_.fixedStep > 0 ? settings_.fixedStep : 0);
  }
  if (outcome == CV_CONV_FAILURE || outcome == CV_ERR_FAILURE || outcome == CV_TOO_CLOSE)
    return StepStatus::TooSmall;
  if (outcome < 0)
    return StepStatus::Unsolvable;
  readStatistics();
  ++statistics_.steps;
  CVodeGetCurrentStep(s.memory, &next_);
  endTime_ = outcome == CV_TSTOP_RETURN ? stop : reached;
  // Towards a singularity CVODE goes on with steps that no longer change the time.
  if (endTime_ <= beginTime_)
    return StepStatus::TooSmall;
  std::copy_n(N_VGetArrayPointer(s.state), n_, end_.begin());
  return dynamics_.evaluate(endTime_, end_.data(), endRate_.data()) ? StepStatus::Done : StepStatus::Unsolvable;
}

// Whether the polynomial of the step to `end` fails to obey the equations inside it: the tolerance allows for a multiple of what the share
// of a step does.
bool CvodeIntegrator::hasDefect(double end) {
  Solver &s = *solver_;
  const double length = end - beginTime_;
  trial_.resize(n_);
  for (const double theta : {0.5, 0.875}) {
    const double time = beginTime_ + theta * length;
    interpolate(time, trial_.data());
    if (!dynamics_.evaluate(time, trial_.data(), s.problem.rate.data()) || CVodeGetDky(s.memory, time, 1, s.derivative) != CV_SUCCESS)
      return true;
    const double *slope = N_VGetArrayPointer(s.derivative);
    for (int i = 0; i < n_ - 1; ++i)
      if (!(length * std::abs(s.problem.rate[i] - slope[i]) <= settings_.tolerance * std::max(settings_.scale[i], std::abs(trial_[i]))))
        return true;
  }
  return false;
}

bool CvodeIntegrator::shorten(double time) {
  interpolate(time, end_.data());
  endTime_ = time;
  return dynamics_.evaluate(time, end_.data(), endRate_.data());
}

// By the defect of the polynomial at the end.
bool CvodeIntegrator::isResolved() {
  const Solver &s = *solver_;
  if (CVodeGetDky(s.memory, endTime_, 1, s.derivative) != CV_SUCCESS)
    return true;
  const double *slope = N_VGetArrayPointer(s.derivative), length = endTime_ - beginTime_;
  for (int i = 0; i < n_; ++i)
    if (length * std::abs(endRate_[i] - slope[i]) > settings_.tolerance * std::max(settings_.scale[i], std::abs(end_[i])))
      return false;
  return true;
}

void CvodeIntegrator::interpolate(double time, double *state) {
  Solver &s = *solver_;
  if (CVodeGetDky(s.memory, time, 0, s.derivative) == CV_SUCCESS)
    std::copy_n(N_VGetArrayPointer(s.derivative), n_, state);
  else
    std::copy(end_.begin(), end_.end(), state);
}

}  // namespace tf::runtime
