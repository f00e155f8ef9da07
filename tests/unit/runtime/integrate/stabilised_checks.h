// What the tests of the families of stabilised methods have in common. A step of a family is a function (tableau, begin, y, h, f, error):
// the state behind one step of y' = f(t, y), and the error's estimate into `error` (may be null), for anything that can be added.
#pragma once

#include "runtime/integrate/stabilised_method.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tf::runtime::test {

// The recurrence: the last g, and into `input` the rate at the one before it.
template <class State, class Rate>
State takeRecurrence(const StabilisedTableau &t, double begin, const State &y, double h, const Rate &f, State &input) {
  State before = y, last = y;
  input = f(begin, y);
  for (std::size_t j = 0; j < t.mu.size(); ++j) {
    if (j > 0)
      input = f(begin + h * t.node[j - 1], last);
    const State next = last + t.kappa[j] * (last - before) + h * t.mu[j] * input;
    before = last;
    last = next;
  }
  return last;
}

// The stability polynomial.
template <class Tableau, class Step> double amplification(const Tableau &t, const Step &step, double x, double *error = nullptr) {
  return step(t, 0.0, 1.0, 1.0, [x](double, double y) { return x * y; }, error);
}

// z' = i cos(t) z², whose solution is 1/(1 − i sin t): nonlinear and with time. The sum of the estimates' sizes into `estimated`.
template <class Tableau, class Step> double convergenceError(const Tableau &t, const Step &step, int steps, double *estimated) {
  using Complex = std::complex<double>;
  const Complex i{0, 1};
  const double h = 1.0 / steps;
  Complex z = 1;
  *estimated = 0;
  for (int k = 0; k < steps; ++k) {
    Complex error;
    z = step(t, k * h, z, h, [&](double time, Complex y) { return i * std::cos(time) * y * y; }, &error);
    *estimated += std::abs(error);
  }
  return std::abs(z - 1.0 / (1.0 - i * std::sin(1.0)));
}

// On the real interval from −border, with damping up to −begin.
template <class Tableau, class Step> void expectStability(const std::vector<Tableau> &tableaus, const Step &step, double begin) {
  for (const Tableau &t : tableaus) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    double worst = 0;
    for (int k = 0; k <= 4000; ++k)
      worst = std::max(worst, std::abs(amplification(t, step, -begin - (t.border - begin) * k / 4000)));
    EXPECT_LE(worst, 0.96);
    for (double x = -begin; x <= 0; x += 0.05)
      EXPECT_LE(std::abs(amplification(t, step, x)), 1 + 1e-12) << x;
  }
}

// Stages in between stay of the size of the state, so that rounding errors do not grow.
template <class Tableau, class Step> void expectSmallStages(const std::vector<Tableau> &tableaus, const Step &step) {
  for (const Tableau &t : tableaus) {
    double largest = 0;
    for (int k = 0; k <= 400; ++k) {
      const double x = -t.border * k / 400;
      const auto rate = [&](double, double y) {
        largest = std::max(largest, std::abs(y));
        return x * y;
      };
      step(t, 0.0, 1.0, 1.0, rate, static_cast<double *>(nullptr));
    }
    EXPECT_LE(largest, 20) << t.stages << " stages";
  }
}

// The belt's mass in slip: x'' = -4 x + 1 with x(0) = 0, x'(0) = -0.1.
class Belt {
public:
  Belt() : instance_(beltModel()), inputs_(beltModel().nu), at_(beltModel(), inputs_), dynamics(at_) {
    EXPECT_TRUE(at_.setParameters(instance_.parameters().data()));
    at_.setSegment(0.5);
    EXPECT_TRUE(dynamics.start({{}, {Tangent::SlipNegative}, {}}, 0, state));
    EXPECT_TRUE(dynamics.evaluate(0, state, rate));
  }

private:
  ModelInstance instance_;
  InputSignals inputs_;
  ModelEvaluation at_;

public:
  ModeDynamics dynamics;
  double state[3] = {0, -0.1, 0}, rate[3] = {};
  const double scale[3] = {1, 1, 1};
};

inline double positionAt(double t) { return 0.25 - 0.25 * std::cos(2 * t) - 0.05 * std::sin(2 * t); }
inline double velocityAt(double t) { return 0.5 * std::sin(2 * t) - 0.1 * std::cos(2 * t); }

struct DenseError {
  double position = 0, velocity = 0, estimated = 0;
};

// Of one step on the belt with so many stages that h times the radius is 100: inside and at its end.
template <class Method> DenseError denseError(double h) {
  Belt belt;
  Method method(3, 1);
  method.setRadius(100 / h);
  EXPECT_TRUE(method.solve(belt.dynamics, 0, belt.state, belt.rate, h, belt.scale, 0));
  DenseError error;
  error.estimated = method.errorNorm(belt.scale, 1);
  double inside[3];
  for (const double theta : {0.15, 0.4, 0.65, 0.9, 1.0}) {
    method.interpolate(theta, inside);
    error.position = std::max(error.position, std::abs(inside[0] - positionAt(theta * h)));
    error.velocity = std::max(error.velocity, std::abs(inside[1] - velocityAt(theta * h)));
  }
  EXPECT_NEAR(inside[0], method.end()[0], 1e-15);
  EXPECT_NEAR(inside[1], method.end()[1], 1e-15);
  return error;
}

}  // namespace tf::runtime::test
