// ROCK4's coefficients: order, stability and the error estimate; the method on a mode, with its dense output.
#include "runtime/integrate/rock4.h"

#include "runtime/integrate/spectral_radius.h"
#include "tests/unit/runtime/integrate/stabilised_checks.h"

#include <array>

namespace tf::runtime {
namespace {

constexpr auto takeRock4Step = []<class State, class Rate>(const Rock4Tableau &t, double begin, State y, double h, const Rate &f,
                                                           State *error) {
  State input;
  const State last = test::takeRecurrence(t, begin, y, h, f, input);
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
};

TEST(Rock4Tableaus, HaveOrderFour) {
  for (const Rock4Tableau &t : rock4Tableaus()) {
    double estimated = 0;
    const double wide = test::convergenceError(t, takeRock4Step, 32, &estimated),
                 narrow = test::convergenceError(t, takeRock4Step, 64, &estimated);
    EXPECT_NEAR(std::log2(wide / narrow), 4, 0.25) << t.stages << " stages";
  }
}

TEST(Rock4Tableaus, AreStableOnALongRealInterval) {
  for (const Rock4Tableau &t : rock4Tableaus()) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    EXPECT_GE(t.border, 0.239 * t.stages * t.stages);
    if (t.stages > 20) {
      EXPECT_NEAR(t.border, 0.35 * t.stages * t.stages, 0.006 * t.stages * t.stages);
    }
  }
  test::expectStability(rock4Tableaus(), takeRock4Step, 4);
}

TEST(Rock4Tableaus, AreStableInside) { test::expectSmallStages(rock4Tableaus(), takeRock4Step); }

// The estimate neither misses the error of an eigenvalue nor exceeds it by far, near zero and far from it.
TEST(Rock4Tableaus, EstimateTheirError) {
  for (const Rock4Tableau &t : rock4Tableaus())
    for (const double x : {-1.0, -2.0, -4.0, -8.0, -20.0, -50.0}) {
      if (-x > 0.9 * t.border)
        continue;
      double estimate = 0;
      const double error = std::abs(test::amplification(t, takeRock4Step, x, &estimate) - std::exp(x));
      EXPECT_GE(std::abs(estimate), 0.3 * error) << t.stages << " stages, " << x;
      EXPECT_LE(std::abs(estimate), 8 * error + 1e-3) << t.stages << " stages, " << x;
    }
}

TEST(Rock4Tableaus, AreChosenByTheBorder) {
  EXPECT_EQ(tableauFor(0, rock4Tableaus()).stages, 5);
  EXPECT_EQ(tableauFor(14, rock4Tableaus()).stages, 7);
  EXPECT_EQ(tableauFor(1e9, rock4Tableaus()).stages, rock4Tableaus().back().stages);
}

// Through states inside it, which are as exact as the end.
TEST(Rock4Test, HasADenseOutputOfItsOwnOrder) {
  const test::DenseError wide = test::denseError<Rock4>(0.1), narrow = test::denseError<Rock4>(0.05);
  EXPECT_NEAR(std::log2(wide.position / narrow.position), 5, 0.5);
  EXPECT_NEAR(std::log2(wide.velocity / narrow.velocity), 5, 0.5);
}

// An oscillation without damping is none that the method is for.
TEST(SpectralRadiusTest, TellsOscillationFromDamping) {
  test::Belt belt;
  SpectralRadius radius(3);
  radius.estimate(belt.dynamics, 0, belt.state, belt.rate, true, belt.scale);
  EXPECT_FALSE(radius.isDamping());
}

}  // namespace
}  // namespace tf::runtime
