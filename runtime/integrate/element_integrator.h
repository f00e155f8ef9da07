// Error-controlled (or fixed-step) integration with a one-step method.
#pragma once

#include "runtime/integrate/element_method.h"
#include "runtime/integrate/smooth_integrator.h"

#include <memory>

namespace tf::runtime {

class ElementIntegrator final : public SmoothIntegrator {
public:
  ElementIntegrator(ModeDynamics &dynamics, IntegratorSettings settings, std::unique_ptr<ElementMethod> method);

  void start(double time, const double *state, const double *rate, double firstStep) override;
  StepStatus step(double limit) override;
  bool shorten(double time) override;
  void interpolate(double time, double *state) override;
  // The interpolant's second derivative is off by its error times a few tens: at 1e-3 of a step beyond the end the state is off by some
  // 1e-5 of the interpolant's error, which is of the order of the tolerance.
  [[nodiscard]] double reach() const override { return settings_.fixedStep > 0 ? 1e-5 : 1e-3; }
  [[nodiscard]] bool isStiff() const override { return unstableSteps_ >= 15; }
  [[nodiscard]] double suggestedStep() const override { return next_; }

private:
  [[nodiscard]] double stepAccuracy() const;
  bool solve(double h, double accuracy);
  void adopt(double time);
  double initialStep(double limit);
  void updateScale();
  void watchStability();

  std::unique_ptr<ElementMethod> method_;
  std::vector<double> scale_;
  double next_ = 0;  // suggested length
  double elementEnd_ = 0;
  bool first_ = true;
  bool moved_ = false;  // the end of the last step was accepted and is the next begin
  int unstableSteps_ = 0, stableSteps_ = 0;
  std::vector<double> trial_, trialRate_;
};

}  // namespace tf::runtime
