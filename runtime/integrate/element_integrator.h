// Error-controlled (or fixed-step) integration with a one-step method. With error control, motions without accelerations that change are
// followed in closed form.
#pragma once

#include "runtime/integrate/element_method.h"
#include "runtime/integrate/smooth_integrator.h"
#include "runtime/integrate/uniform_motion.h"

#include <limits>
#include <memory>
#include <span>

namespace tf::runtime {

class ElementIntegrator final : public SmoothIntegrator {
public:
  ElementIntegrator(ModeDynamics &dynamics, IntegratorSettings settings, std::unique_ptr<ElementMethod> method);

  void start(double time, const double *state, const double *rate, double firstStep) override;
  StepStatus step(double limit) override;
  bool shorten(double time) override;
  bool isResolved() override;
  bool moveInside(double time) override { return isUniform_ ? shorten(time) : SmoothIntegrator::moveInside(time); }
  void interpolate(double time, double *state) override;
  [[nodiscard]] bool holdsToleranceInside() const override { return method_->holdsToleranceInside(); }
  [[nodiscard]] bool hasExactStages() const override { return method().hasExactStages(); }
  [[nodiscard]] bool isInterpolantDear() const override { return method().isInterpolantDear(); }
  // The interpolant's second derivative is off by its error times a few tens: at 1e-2 of a step beyond the end the state is off by some
  // 1e-3 of the interpolant's error, which is of the order of the tolerance.
  [[nodiscard]] double reach() const override { return settings_.fixedStep > 0 ? 1e-5 : 1e-2; }
  [[nodiscard]] bool isUniform() const override { return isUniform_; }
  [[nodiscard]] bool isExactInside() const override {
    return isUniform_ || (settings_.fixedStep <= 0 && error_ <= negligible && !dynamics_.hasTurningSlips());
  }
  [[nodiscard]] Quadrature quadrature() const override { return method().quadrature(); }
  // In uniform motion contact forces are constant.
  [[nodiscard]] bool samplesInside() const override { return isUniform_ || method_->interiorStages() >= 2; }
  // Errors at the border of stability die out in the motion, but add up in what is integrated along its rates.
  [[nodiscard]] bool isStiff() const override { return unstableSteps_ >= (settings().isDifferentiated ? 4 : 15); }
  [[nodiscard]] bool isStabilised() const override { return method().isStabilised(); }
  [[nodiscard]] double stiffness() const override { return method().stiffness(dynamics_.model().model(), settings_.scale.data()); }
  // None where the error of the step does not tell; infinity where there was none, so that any step will do while the accelerations stay.
  [[nodiscard]] double suggestedStep() const override {
    return isExactInside() ? std::numeric_limits<double>::infinity() : error_ > 1e-3 || dynamics_.hasTurningSlips() ? next_ : 0;
  }
  [[nodiscard]] double correction() const override { return dynamics_.correction(); }
  // The rate of a state so near is as good for the next step, but where friction turns with the slip, faster and faster as that ends.
  [[nodiscard]] double negligibleCorrection() const override {
    return settings_.fixedStep > 0 || dynamics_.hasTurningSlips() ? 1e-13 : 0.1 * settings_.tolerance;
  }
  void resetStatistics() override;
  void forget() override {
    method_->forget();
    changingStarts_ = 0;
  }

private:
  // An error of the step, relative to the tolerance: the motion is a polynomial that the method has no error of but rounding.
  static constexpr double negligible = 1e-4;

  [[nodiscard]] ElementMethod &method() { return isUniform_ ? static_cast<ElementMethod &>(uniform_) : *method_; }
  [[nodiscard]] const ElementMethod &method() const { return isUniform_ ? static_cast<const ElementMethod &>(uniform_) : *method_; }
  bool startsUniform();
  void moveUniformly(double limit);
  [[nodiscard]] double stepAccuracy() const;
  [[nodiscard]] double lengthBeyondEvent() const;
  bool solve(double h, double accuracy);
  [[nodiscard]] bool watchesPeaks() const { return settings_.fixedStep <= 0 && !isUniform_ && dynamics_.frictionMayPeak(); }
  double defectAt(double theta);
  bool meetsPeak(std::span<const double> places);
  void adopt(double time);
  double initialStep(double limit);
  void updateScale();
  void watchStability();

  std::unique_ptr<ElementMethod> method_;
  UniformMotion uniform_;
  bool isUniform_ = false;  // the last step is uniform_'s
  bool isHeld_ = false;     // at rest, as long as the mode lasts
  std::vector<double> scale_;
  double next_ = 0;            // suggested length
  double error_ = 0;           // of the last step, relative to the tolerance
  bool isShortened_ = false;   // the last step has been
  double shortenedError_ = 0;  // then
  double length_ = 0;          // of the last element that was solved
  double elementEnd_ = 0;
  bool first_ = true;
  bool moved_ = false;  // the end of the last step was accepted and is the next begin
  // Modes in a row whose accelerations were found to change at their start. After so many that is looked for in some of the modes only,
  // where a length is suggested.
  static constexpr int mostChangingStarts = 4, startsPerLook = 8;
  int changingStarts_ = 0;
  int unstableSteps_ = 0, stableSteps_ = 0;
  std::vector<double> trial_, trialRate_, slope_;
};

}  // namespace tf::runtime
