// ROCK4's coefficients: order, stability and the error estimate; the method on a mode, with its dense output.
#include "runtime/integrate/rock4.h"

#include "runtime/integrate/spectral_radius.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <vector>

namespace tf::runtime {
namespace {

// One step of y' = f(t, y) for anything that can be added; the error estimate with it.
template <class State, class Rate> State takeStep(const Rock4Tableau &t, double begin, State y, double h, const Rate &f, State *error) {
  State before = y, last = y, input = f(begin, y);
  for (std::size_t j = 0; j < t.mu.size(); ++j) {
    if (j > 0)
      input = f(begin + h * t.node[j - 1], last);
    const State next = last + t.kappa[j] * (last - before) + h * t.mu[j] * input;
    before = last;
    last = next;
  }
  std::array<State, Rock4Tableau::lastStages> rates;
  State end = last, estimate = h * t.error[0] * input;
  for (std::size_t s = 0; s < rates.size(); ++s) {
    State point = last;
    for (std::size_t j = 0; j < s; ++j)
      point += h * t.weights[s][j] * rates[j];
    rates[s] = f(begin + h * t.lastNode[s], point);
    end += h * t.result[s] * rates[s];
    estimate += h * t.error[s + 1] * rates[s];
  }
  if (error != nullptr)
    *error = estimate;
  return end;
}

// The stability polynomial.
double amplification(const Rock4Tableau &t, double x, double *error = nullptr) {
  return takeStep(t, 0.0, 1.0, 1.0, [x](double, double y) { return x * y; }, error);
}

// z' = i cos(t) z², whose solution is 1/(1 − i sin t): nonlinear and with time.
double convergenceError(const Rock4Tableau &t, int steps) {
  using Complex = std::complex<double>;
  const Complex i{0, 1};
  const double h = 1.0 / steps;
  Complex z = 1;
  for (int k = 0; k < steps; ++k)
    z = takeStep(t, k * h, z, h, [&](double time, Complex y) { return i * std::cos(time) * y * y; }, static_cast<Complex *>(nullptr));
  return std::abs(z - 1.0 / (1.0 - i * std::sin(1.0)));
}

TEST(Rock4Tableaus, HaveOrderFour) {
  for (const Rock4Tableau &t : rock4Tableaus())
    EXPECT_NEAR(std::log2(convergenceError(t, 32) / convergenceError(t, 64)), 4, 0.25) << t.stages << " stages";
}

TEST(Rock4Tableaus, AreStableOnALongRealInterval) {
  for (const Rock4Tableau &t : rock4Tableaus()) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    EXPECT_GE(t.border, 0.239 * t.stages * t.stages);
    if (t.stages > 20) {
      EXPECT_NEAR(t.border, 0.35 * t.stages * t.stages, 0.006 * t.stages * t.stages);
    }
    double worst = 0;
    for (int k = 0; k <= 4000; ++k)
      worst = std::max(worst, std::abs(amplification(t, -4 - (t.border - 4) * k / 4000)));
    EXPECT_LE(worst, 0.96);
    for (double x = -4; x <= 0; x += 0.05)
      EXPECT_LE(std::abs(amplification(t, x)), 1 + 1e-12) << x;
  }
}

// Stages in between stay of the size of the state, so that rounding errors do not grow.
TEST(Rock4Tableaus, AreStableInside) {
  for (const Rock4Tableau &t : rock4Tableaus()) {
    double largest = 0;
    for (int k = 0; k <= 400; ++k) {
      const double x = -t.border * k / 400;
      takeStep(
          t, 0.0, 1.0, 1.0, [&](double, double y) { return largest = std::max(largest, std::abs(y)), x * y; },
          static_cast<double *>(nullptr));
    }
    EXPECT_LE(largest, 20) << t.stages << " stages";
  }
}

// The estimate neither misses the error of an eigenvalue nor exceeds it by far, near zero and far from it.
TEST(Rock4Tableaus, EstimateTheirError) {
  for (const Rock4Tableau &t : rock4Tableaus())
    for (const double x : {-1.0, -2.0, -4.0, -8.0, -20.0, -50.0}) {
      if (-x > 0.9 * t.border)
        continue;
      double estimate = 0;
      const double error = std::abs(amplification(t, x, &estimate) - std::exp(x));
      EXPECT_GE(std::abs(estimate), 0.3 * error) << t.stages << " stages, " << x;
      EXPECT_LE(std::abs(estimate), 8 * error + 1e-3) << t.stages << " stages, " << x;
    }
}

TEST(Rock4Tableaus, AreChosenByTheBorder) {
  EXPECT_EQ(tableauFor(0, rock4Tableaus()).stages, 5);
  EXPECT_EQ(tableauFor(14, rock4Tableaus()).stages, 7);
  EXPECT_EQ(tableauFor(1e9, rock4Tableaus()).stages, rock4Tableaus().back().stages);
}

// The belt's mass in slip: x'' = -4 x + 1 with x(0) = 0, x'(0) = -0.1.
class Belt {
public:
  Belt() : instance_(test::beltModel()), inputs_(test::beltModel().nu), at_(test::beltModel(), inputs_), dynamics(at_) {
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

double positionAt(double t) { return 0.25 - 0.25 * std::cos(2 * t) - 0.05 * std::sin(2 * t); }
double velocityAt(double t) { return 0.5 * std::sin(2 * t) - 0.1 * std::cos(2 * t); }

struct DenseError {
  double position = 0, velocity = 0;
};

// The coordinate at the end is wrong by h⁵, which makes h⁴ of the velocities inside. One step with so many stages that h times the radius
// is 100.
DenseError denseError(double h) {
  Belt belt;
  Rock4 method(3);
  method.setRadius(100 / h);
  EXPECT_TRUE(method.solve(belt.dynamics, 0, belt.state, belt.rate, h, belt.scale, 0));
  DenseError error;
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

TEST(Rock4Test, HasADenseOutputOfItsOwnOrder) {
  const DenseError wide = denseError(0.1), narrow = denseError(0.05);
  EXPECT_NEAR(std::log2(wide.position / narrow.position), 5, 0.5);
  EXPECT_NEAR(std::log2(wide.velocity / narrow.velocity), 4, 0.5);
}

// An oscillation without damping is none that the method is for.
TEST(SpectralRadiusTest, TellsOscillationFromDamping) {
  Belt belt;
  SpectralRadius radius(3);
  radius.estimate(belt.dynamics, 0, belt.state, belt.rate, true, belt.scale);
  EXPECT_FALSE(radius.isDamping());
}

}  // namespace
}  // namespace tf::runtime
