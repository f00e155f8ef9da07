// SUNDIALS CVODE: BDF with Newton's method on the mode's reduced system, for stiff stretches and as the fallback (theory.md section 6).
#pragma once

#include "runtime/integrate/smooth_integrator.h"

#include <memory>

namespace tf::runtime {

class CvodeIntegrator final : public SmoothIntegrator {
public:
  CvodeIntegrator(ModeDynamics &dynamics, IntegratorSettings settings);
  ~CvodeIntegrator() override;

  void start(double time, const double *state, const double *rate, double firstStep) override;
  StepStatus step(double limit) override;
  bool shorten(double time) override;
  bool isResolved() override;
  void interpolate(double time, double *state) override;
  void setCareful(bool careful) override;
  [[nodiscard]] double startingError() const override;
  [[nodiscard]] double correction() const override;
  [[nodiscard]] double stiffness() const override;
  [[nodiscard]] bool startsToRounding() const override { return false; }
  [[nodiscard]] double suggestedStep() const override { return next_; }

private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
  double next_ = 0;
  bool careful_ = false;
  std::vector<double> trial_;
  IntegratorStatistics before_;  // CVODE was initialised last

  void setTolerance();
  void readStatistics();
  void restart(double time);
  void repeat(double limit);
  bool hasDefect(double end);
};

}  // namespace tf::runtime
