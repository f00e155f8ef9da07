// One-step methods on a finite element [t0, t0 + h] of one mode.
#pragma once

#include "runtime/integrate/collocation.h"
#include "runtime/integrate/mode_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tf::runtime {

// Weights of the error norm: |error_i| ≤ tolerance · scale_i is acceptable. All arrays have ModeDynamics::size() entries.
class ElementMethod {
public:
  explicit ElementMethod(int size) : end_(size), endRate_(size), error_(size), n_(size) {}
  virtual ~ElementMethod() = default;
  ElementMethod(const ElementMethod &) = delete;
  ElementMethod &operator=(const ElementMethod &) = delete;

  // Forgets what it knows of earlier elements (a new mode, a jump). `slipsTurn`: the mode has slips of two components, whose direction
  // turns ever faster as they end.
  virtual void restart(bool /*slipsTurn*/) {}
  // Solves the element from (t0, y0) with dy/dt(t0) = f0. Implicit equations are solved to `accuracy` relative to `scale`. The dynamics'
  // last evaluation is at the end then. False: it did not converge or the dynamics cannot be evaluated.
  virtual bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
                     double accuracy) = 0;
  // y(t0 + theta h), 0 ≤ theta ≤ 1, of the last element. The dynamics' last evaluation is as before, or at the end of the element.
  virtual void interpolate(double theta, double *y) = 0;
  // The error of interpolate() is a few tolerances at most where that of the end is within one.
  [[nodiscard]] virtual bool holdsToleranceInside() const { return true; }
  // So are the stages, as those of collocation.
  [[nodiscard]] virtual bool hasExactStages() const { return false; }
  // The next interpolate() evaluates the dynamics.
  [[nodiscard]] virtual bool isInterpolantDear() const { return false; }
  // The last element becomes the past that starting values are taken from.
  virtual void accept() {}
  // What it has learnt from the steps of a run and would make use of in other modes.
  virtual void forget() {}
  // The length of the next element from (t0, y0) with the rate f0, where one of h is wanted: at most h.
  virtual double adjustStep(double h, ModeDynamics & /*dynamics*/, double /*t0*/, const double * /*y0*/, const double * /*f0*/,
                            const double * /*scale*/) {
    return h;
  }
  // The last element's error was too large; or the element is a step with this error norm.
  virtual void reject(const double * /*scale*/) {}
  virtual void finish(double /*error*/, const double * /*scale*/) {}

  // The next element begins so many of its lengths after a switch: rates behind that may be powers of the time since then, of which an
  // estimate that is made for smooth ones shows a part only.
  void setDistance(double lengths) { distance_ = lengths; }
  // max_i |error_i| / (tolerance scale_i): at most 1 is acceptable; it grows with h to the power errorOrder().
  [[nodiscard]] virtual double errorNorm(const double *scale, double tolerance) const = 0;
  [[nodiscard]] virtual double errorOrder() const = 0;
  // How many stages lie inside the element.
  [[nodiscard]] virtual int interiorStages() const = 0;

  // Places inside the element at which the solution obeys the equations, with the weights of a quadrature; none: at no place better than at
  // others.
  [[nodiscard]] virtual Quadrature quadrature() const { return {}; }

  // h times an estimate of the largest eigenvalue of the Jacobian, relative to the border of the stability region: above 1 the step is
  // limited by stability. 0 of methods that have no such limit.
  [[nodiscard]] virtual double stabilityRatio() const { return 0; }
  // The last element was that of a method for stiff damping.
  [[nodiscard]] virtual bool isStabilised() const { return false; }
  // The spectral radius where damping has been found stiff by the last element, in 1/s, else 0; `scale` [n] as of `solve`.
  [[nodiscard]] virtual double stiffness(const tf_model & /*model*/, const double * /*scale*/) const { return 0; }

  // The estimate of the last element.
  [[nodiscard]] const double *error() const { return error_.data(); }
  [[nodiscard]] double *end() { return end_.data(); }
  [[nodiscard]] double *endRate() { return endRate_.data(); }

  long long jacobians = 0, iterations = 0;

protected:
  // The largest |error_i| / scale_i. tau is a result that nothing depends on: its errors add up, but are not amplified as those of the
  // others, and may be larger in a step. (Where two contact forces change their order, its rate has all but a kink, which a step control
  // that resolves it would pay for with most of its steps.)
  [[nodiscard]] double largestError(const double *scale) const {
    constexpr double allowanceOfTau = 10;
    double norm = std::abs(error_[n_ - 1]) / (allowanceOfTau * scale[n_ - 1]);
    for (int i = 0; i < n_ - 1; ++i)
      norm = std::max(norm, std::abs(error_[i]) / scale[i]);
    return norm;
  }

  std::vector<double> end_, endRate_, error_;
  int n_;
  double distance_ = std::numeric_limits<double>::infinity();
};

}  // namespace tf::runtime
