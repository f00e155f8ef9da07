// Integration of one mode, step by step; the caller looks for events inside each step and may shorten it.
#pragma once

#include "runtime/integrate/collocation.h"
#include "runtime/integrate/mode_dynamics.h"

#include <limits>
#include <vector>

namespace tf::runtime {

struct IntegratorSettings {
  double tolerance = 1e-6;
  double fixedStep = 0;           // > 0: steps of this length without error control
  bool isDifferentiated = false;  // sensitivities are integrated along the steps: rates inside them count
  std::vector<double> scale;      // [n] nominal magnitudes: |error_i| ≤ tolerance · max(scale_i, |y_i|)
};

enum class StepStatus : std::uint8_t {
  Done,
  TooSmall,   // the step length fell to rounding: the tolerance cannot be met
  Unsolvable  // the dynamics cannot be evaluated (ModeDynamics::failure)
};

struct IntegratorStatistics {
  long long steps = 0, rejected = 0, jacobians = 0, iterations = 0;
};

class SmoothIntegrator {
public:
  SmoothIntegrator(ModeDynamics &dynamics, IntegratorSettings settings)
      : dynamics_(dynamics), settings_(std::move(settings)), n_(dynamics.size()), begin_(n_), beginRate_(n_), end_(n_), endRate_(n_) {}
  virtual ~SmoothIntegrator() = default;
  SmoothIntegrator(const SmoothIntegrator &) = delete;
  SmoothIntegrator &operator=(const SmoothIntegrator &) = delete;

  // Begins at (time, state) in the dynamics' mode; `rate` is dy/dt there. A suggested first step ≤ 0 means: find one; infinity: to the
  // limit.
  virtual void start(double time, const double *state, const double *rate, double firstStep) = 0;
  // Of the last switch, before start: rates behind it may be powers of the time since then.
  void setSwitchTime(double time) { switchTime_ = time; }
  // The next step may meet an event at that time, behind which the mode may have no motion worth following; infinity: none is expected.
  void expectEvent(double time) { expected_ = time; }
  // One step from where the last one ended, not beyond `limit`.
  virtual StepStatus step(double limit) = 0;
  // The last step again, from the same begin to `time` inside it (or barely beyond it), to full accuracy.
  virtual bool shorten(double time) = 0;
  // The step that has been shortened is within the tolerance: at its end there is nothing that the step had passed unseen, as a peak of
  // friction where a slip ends. The dynamics' last evaluation is at the end.
  virtual bool isResolved() { return true; }
  // State inside the last step, or beyond its end by at most reach() of its length.
  virtual void interpolate(double time, double *state) = 0;
  // What is inside the step is as near the solution as its end, up to a few tolerances.
  [[nodiscard]] virtual bool holdsToleranceInside() const { return true; }
  // The rate is evaluated inside a step at states that are as near the solution.
  [[nodiscard]] virtual bool hasExactStages() const { return false; }
  // It evaluates the dynamics the next time.
  [[nodiscard]] virtual bool isInterpolantDear() const { return false; }
  // The same from the states and rates at both ends alone (StepEnds): no evaluation, but the error is no part of the step's.
  void interpolateEnds(double time, double *state) const;
  // As far the interpolant goes on smoothly, with the state and the rate that the step has at its end.
  [[nodiscard]] virtual double reach() const { return 0; }
  // The interpolant is as good as the step, far within the tolerance: the end may be moved to any time inside the step.
  [[nodiscard]] virtual bool isExactInside() const { return false; }
  // Its coordinates are parabolas.
  [[nodiscard]] virtual bool isUniform() const { return false; }
  // Parts of the last step at whose ends the state obeys the equations, with the weights of a quadrature; none: at no place better than at
  // others.
  [[nodiscard]] virtual Quadrature quadrature() const { return {}; }
  // The step has evaluated the dynamics at several places inside it (ModeDynamics::leastMargin).
  [[nodiscard]] virtual bool samplesInside() const { return false; }
  // The caller has moved the end of the step by a trifle.
  void moveEnd(double time) { endTime_ = time; }
  // Moves the end of a step that is exact inside to a time there, at which the dynamics is evaluated. False: it cannot be.
  virtual bool moveInside(double time);
  // While a gap grows from zero its sign depends on errors far below the tolerance: a method whose first steps are of low order must be
  // more accurate then.
  virtual void setCareful(bool /*careful*/) {}
  // Error of a guard that starts at zero in the first steps of a mode, relative to its scale.
  [[nodiscard]] virtual double startingError() const { return 1e-12; }
  // The state keeps its accuracy to rounding over the first instants of a mode, so that a gap's hop from zero can be followed there.
  [[nodiscard]] virtual bool startsToRounding() const { return true; }
  // Stability, not accuracy, limits the steps of this mode.
  [[nodiscard]] virtual bool isStiff() const { return false; }
  // The last step was made by the stabilised explicit method.
  [[nodiscard]] virtual bool isStabilised() const { return false; }
  // The spectral radius of damping where that is known, in 1/s, else 0.
  [[nodiscard]] virtual double stiffness() const { return 0; }
  // Length that the error control would take next, in the same mode; 0: it does not know, infinity: any.
  [[nodiscard]] virtual double suggestedStep() const = 0;

  [[nodiscard]] double beginTime() const { return beginTime_; }
  [[nodiscard]] double endTime() const { return endTime_; }
  [[nodiscard]] const double *begin() const { return begin_.data(); }
  [[nodiscard]] const double *beginRate() const { return beginRate_.data(); }
  // The caller may project the end of a step; it then tells the rate there, where the correction is not negligible.
  [[nodiscard]] double *end() { return end_.data(); }
  [[nodiscard]] double *endRate() { return endRate_.data(); }
  // What the step has projected its end by already, relative to the scale.
  [[nodiscard]] virtual double correction() const = 0;
  [[nodiscard]] virtual double negligibleCorrection() const { return 1e-13; }
  [[nodiscard]] const IntegratorStatistics &statistics() const { return statistics_; }
  virtual void resetStatistics() { statistics_ = {}; }
  // What it has learnt from the steps of a run and would make use of in other modes.
  virtual void forget() {}
  [[nodiscard]] const IntegratorSettings &settings() const { return settings_; }

protected:
  // How long the next step may be, from end_ on. Where forces may act at a place only (tf_locality) and the motion has been uniform up to
  // there, errors do not show how far the next place is: coordinates move by a part of their magnitudes. Infinity of other motions.
  [[nodiscard]] double longestUniform() const;

  ModeDynamics &dynamics_;
  IntegratorSettings settings_;
  int n_;
  double beginTime_ = 0, endTime_ = 0;
  double expected_ = std::numeric_limits<double>::infinity();
  double switchTime_ = -std::numeric_limits<double>::infinity();
  std::vector<double> begin_, beginRate_, end_, endRate_;
  IntegratorStatistics statistics_;
};

}  // namespace tf::runtime
