// The stabilised explicit method ROCK4 (see Rock4Tableau), for modes that are stiff by damping: the number of stages grows with the square
// root of the step, where other explicit methods need steps of bounded length.
#pragma once

#include "runtime/integrate/element_method.h"
#include "runtime/integrate/rock4_tableau.h"

namespace tf::runtime {

class Rock4 final : public ElementMethod {
public:
  explicit Rock4(int size);

  // h times the spectral radius, at most: that of the method with the most stages.
  [[nodiscard]] static double border() { return rock4Tableaus().back().border; }
  // At the most, of the elements to come; steps are as long as border()/radius at the most.
  void setRadius(double radius) { radius_ = radius; }

  void restart() override {}
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  // From both ends (StepEnds).
  void interpolate(double theta, double *y) const override;
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override { return largestError(scale) / tolerance; }
  [[nodiscard]] double errorOrder() const override { return 4; }
  [[nodiscard]] int interiorStages() const override { return tableau_->stages - 1; }
  // Beyond it implicit methods take fewer evaluations (measured on stiff springs and dampers, at tolerances from 1e-3 to 1e-8).
  [[nodiscard]] double stabilityRatio() const override { return h_ * radius_ / implicitBorder; }

private:
  static constexpr double implicitBorder = 300;

  bool solveRecurrence(ModeDynamics &dynamics, double t0);
  bool solveLast(ModeDynamics &dynamics, double t0);
  bool evaluate(ModeDynamics &dynamics, double time, const double *change, double *rate);
  void estimateError();

  double radius_ = 0;
  const Rock4Tableau *tableau_;
  double h_ = 0;
  int nq_ = 0;  // coordinates whose derivatives are the velocities
  std::vector<double> begin_, beginRate_;
  std::vector<double> before_, last_, next_;  // g less the state at the begin
  std::vector<double> lastRate_;              // at the last g but one
  std::vector<double> stages_, point_;        // rates at the last stages, n each
};

}  // namespace tf::runtime
