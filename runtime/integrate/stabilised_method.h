// Stabilised explicit Runge–Kutta methods, for modes that are stiff by damping: the number of stages grows with the square root of the
// step, where other explicit methods need steps of bounded length. Each is a family with tableaus for several numbers of stages.
//
// The stability polynomial of each is w(x) P(x), where w is positive, of the degree of the method's order, and the P are orthogonal on
// [−border, −begin] with the weight w(x)²/√((x + border)(−begin − x)), so that P comes out of a recurrence of three terms, one evaluation
// each:
//     g_j = g_(j−1) + kappa_j (g_(j−1) − g_(j−2)) + h mu_j f(g_(j−1)),   j = 1 … recurrence,
// followed by stages that give the order and the factor w (Abdulle, Fourth order Chebyshev methods with recurrence relation, SIAM J. Sci.
// Comput. 23, 2002; Abdulle, Medovikov, Second order Chebyshev methods based on orthogonal polynomials, Numer. Math. 90, 2001).
#pragma once

#include "runtime/integrate/element_method.h"
#include "runtime/integrate/inside_states.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <vector>

namespace tf::runtime {

struct StabilisedTableau {
  int stages = 0;                       // evaluations of a step, the one at its end too
  double border = 0;                    // of stability on the negative real axis, with some damping but near zero
  std::vector<double> mu, kappa, node;  // of g_1, g_2, …; node: its time in parts of the step, which is for the family to fill in
};

// mu and kappa of `count` polynomials with P(0) = 1 into the tableau; `w` is the positive factor (its scale does not matter), 0 < begin <
// border.
void makeRecurrence(int count, double begin, double border, const std::function<double(double)> &w, StabilisedTableau &tableau);

// A family, out of the table of its stability polynomials.
template <class Tableau, class Polynomial, std::size_t count>
std::vector<Tableau> makeTableaus(const Polynomial (&polynomials)[count], Tableau (*make)(const Polynomial &)) {
  std::vector<Tableau> all;
  all.reserve(count);
  std::transform(polynomials, polynomials + count, std::back_inserter(all), make);
  return all;
}

// Of tableaus by growing number of stages, the first that is stable for real eigenvalues λ with −border ≤ h λ ≤ 0; the last where none is.
template <class Tableau> const Tableau &tableauFor(double border, const std::vector<Tableau> &all) {
  const auto first = std::find_if(all.begin(), all.end(), [border](const Tableau &tableau) { return tableau.border >= border; });
  return first != all.end() ? *first : all.back();
}

class StabilisedMethod : public ElementMethod {
public:
  // h times the spectral radius, at most: that of the tableau with the most stages.
  [[nodiscard]] virtual double border() const = 0;
  // At the most, of the elements to come; steps are as long as border()/radius at the most.
  void setRadius(double radius) { radius_ = radius; }

  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  [[nodiscard]] int interiorStages() const override { return stages_ - 1; }
  // Where the rates at the ends are too coarse for a curve through them, the first call after an element solves shorter ones
  // (InsideStates), and evaluates the dynamics at the end again.
  void interpolate(double theta, double *y) override;
  [[nodiscard]] bool isInterpolantDear() const override { return !hasExactRates() && !inside_.isTried(); }
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override;
  // The last element has leapt over a transient from its begin, which the estimate of a method that damps it does not show.
  [[nodiscard]] bool leapsTransient(const double *scale) const;
  // Beyond it implicit methods take fewer evaluations (measured with ROCK4 on stiff springs and dampers, at tolerances from 1e-3 to
  // 1e-8).
  [[nodiscard]] double stabilityRatio() const override { return h_ * radius_ / implicitBorder; }

protected:
  // Of coordinates whose derivatives are the velocities, out of the rates at the ends: with the second derivatives (StepEnds), whose
  // polynomial has velocities of its own that are off by the coordinate's error at the end divided by the step, or without.
  enum class Curve : std::uint8_t { Quintic, Cubic };
  // `tolerance`: what its elements are for; `lastStages`: those behind the recurrence; `insideCount`: states inside an element that are as
  // exact as the end where a polynomial passes through them and the ends.
  StabilisedMethod(int size, double tolerance, int lastStages, Curve curve, int insideCount);

  // Of the family, with which the element is solved.
  virtual const StabilisedTableau &chooseTableau(double border) = 0;
  // Behind the recurrence: the last stages, the end and the error. False: as solve().
  virtual bool solveLast(ModeDynamics &dynamics, double t0) = 0;
  // Where the state differs by `change` from that at the begin.
  bool evaluate(ModeDynamics &dynamics, double time, const double *change, double *rate);
  // Rates at last stage number s.
  [[nodiscard]] double *stage(std::size_t s) { return rates_.data() + s * n_; }

  double h_ = 0;
  std::vector<double> begin_, last_, next_;  // the state at the begin; the last g, and room for another one, less that
  std::vector<double> lastRate_;             // at the last g but one

private:
  static constexpr double implicitBorder = 300;

  // The state at t0 + h, and the error.
  bool advance(ModeDynamics &dynamics, double t0, double h);
  bool solveRecurrence(ModeDynamics &dynamics, double t0, const StabilisedTableau &tableau);
  [[nodiscard]] bool hasExactRates() const;
  void solveInside();

  std::vector<double> beginRate_, before_, rates_, point_;
  std::vector<double> bend_;  // h² y'' at the begin, by g_1 of the solve or advance before
  int stages_ = 0;            // of the last element
  double radius_ = 0;
  Curve curve_;
  int integrals_ = 0;  // of StepEnds
  double tolerance_;
  ModeDynamics *dynamics_ = nullptr;
  double t0_ = 0;
  InsideStates inside_;
};

}  // namespace tf::runtime
