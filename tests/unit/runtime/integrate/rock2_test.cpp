// ROCK2's coefficients: order, stability and the error estimate; the method on a mode, with its dense output.
#include "runtime/integrate/rock2.h"

#include "tests/unit/runtime/integrate/stabilised_checks.h"

namespace tf::runtime {
namespace {

constexpr auto takeRock2Step = []<class State, class Rate>(const Rock2Tableau &t, double begin, State y, double h, const Rate &f,
                                                           State *error) {
  State input;
  const State last = test::takeRecurrence(t, begin, y, h, f, input);
  const State first = f(begin + h * t.lastNode[0], last);
  const State second = f(begin + h * t.lastNode[1], last + h * t.weight * first);
  if (error != nullptr)
    *error = h * (t.error[0] * input + t.error[1] * first + t.error[2] * second);
  return last + h * (t.result[0] * first + t.result[1] * second);
};

TEST(Rock2Tableaus, HaveOrderTwoAndEstimateTheErrorOfThatOrder) {
  for (const Rock2Tableau &t : rock2Tableaus()) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    double wide = 0, narrow = 0;
    const double error = test::convergenceError(t, takeRock2Step, 32, &wide),
                 smaller = test::convergenceError(t, takeRock2Step, 64, &narrow);
    EXPECT_NEAR(std::log2(error / smaller), 2, 0.15);
    EXPECT_NEAR(std::log2(wide / narrow), 2, 0.15);
    EXPECT_GE(narrow, 0.3 * smaller);
    EXPECT_LE(narrow, 10 * smaller);
  }
}

TEST(Rock2Tableaus, AreStableOnALongRealInterval) {
  for (const Rock2Tableau &t : rock2Tableaus())
    EXPECT_GE(t.border, 0.68 * t.stages * t.stages) << t.stages << " stages";
  test::expectStability(rock2Tableaus(), takeRock2Step, 2.5);
}

TEST(Rock2Tableaus, AreStableInside) { test::expectSmallStages(rock2Tableaus(), takeRock2Step); }

// The estimate does not miss the error of an eigenvalue, nor does it exceed it by far near zero; far from it it is bounded.
TEST(Rock2Tableaus, EstimateTheirError) {
  for (const Rock2Tableau &t : rock2Tableaus())
    for (const double x : {-0.5, -1.0, -2.0, -4.0, -8.0, -20.0, -50.0}) {
      if (-x > 0.9 * t.border)
        continue;
      double estimate = 0;
      const double error = std::abs(test::amplification(t, takeRock2Step, x, &estimate) - std::exp(x));
      EXPECT_GE(std::abs(estimate), 0.3 * error) << t.stages << " stages, " << x;
      EXPECT_LE(std::abs(estimate), x >= -2 ? 4 * error : 13) << t.stages << " stages, " << x;
    }
}

TEST(Rock2Tableaus, AreChosenByTheBorder) {
  EXPECT_EQ(tableauFor(0, rock2Tableaus()).stages, 3);
  EXPECT_EQ(tableauFor(14, rock2Tableaus()).stages, 5);
  EXPECT_EQ(tableauFor(1e9, rock2Tableaus()).stages, rock2Tableaus().back().stages);
}

// Both at the end and inside, with the estimate of the larger one.
TEST(Rock2Test, HasADenseOutputOfItsOwnOrder) {
  const test::DenseError wide = test::denseError<Rock2>(0.05), narrow = test::denseError<Rock2>(0.025);
  EXPECT_NEAR(std::log2(wide.position / narrow.position), 3, 0.4);
  EXPECT_NEAR(std::log2(wide.velocity / narrow.velocity), 3, 0.4);
  EXPECT_LE(std::max(wide.position, wide.velocity), 3 * wide.estimated);
  EXPECT_LE(std::max(narrow.position, narrow.velocity), 3 * narrow.estimated);
}

}  // namespace
}  // namespace tf::runtime
