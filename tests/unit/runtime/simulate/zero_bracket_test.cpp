#include "runtime/simulate/zero_bracket.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace tf::runtime {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

TEST(ZeroBracket, TakesWhatIsProposedInside) {
  ZeroBracket bracket(1, 2);
  EXPECT_EQ(bracket.next(1.25), 1.25);
  bracket.narrow(1.5, false);
  EXPECT_EQ(bracket.next(1.75), 1.75);
}

TEST(ZeroBracket, TriesTheEndOfTheInterpolantBeforeItIsHalved) {
  ZeroBracket bracket(1, 2);
  bracket.narrow(1.5, false);
  EXPECT_EQ(bracket.next(5), 2);
  EXPECT_EQ(bracket.next(0.5), 2);
  EXPECT_EQ(bracket.next(none), 2);
}

TEST(ZeroBracket, IsHalvedBetweenStepsOfBothSigns) {
  ZeroBracket bracket(1, 2);
  bracket.narrow(2, true);
  EXPECT_EQ(bracket.next(3), 1.5);
  bracket.narrow(1.5, false);
  EXPECT_EQ(bracket.next(1.25), 1.75);
  bracket.narrow(1.75, true);
  EXPECT_EQ(bracket.next(none), 1.625);
  EXPECT_EQ(bracket.next(std::nan("")), 1.625);
}

// A zero a little beyond what the interpolant gave, as where its error is that of the step.
TEST(ZeroBracket, IsExtendedALittleBeyondTheEndOfTheInterpolant) {
  ZeroBracket bracket(1, 2);
  bracket.narrow(2, false);
  EXPECT_EQ(bracket.next(2.01), 2.01);
  bracket.narrow(2.01, true);
  EXPECT_EQ(bracket.next(0), 2.005);
}

// No step was seen to bring the guard below zero: the search ends after a few, at the last of them.
TEST(ZeroBracket, EndsWhereStepsHaveNoZero) {
  ZeroBracket bracket(1, 2);
  bracket.narrow(2, false);
  EXPECT_EQ(bracket.next(none), 2) << "a guard that does not fall";
  double last = 2;
  int extensions = 0;
  for (double next = bracket.next(100); next != last; next = bracket.next(100)) {
    EXPECT_NEAR(next, last + 0.1 * (last - 1), 1e-12);
    last = next;
    bracket.narrow(last, false);
    ++extensions;
  }
  EXPECT_EQ(extensions, 3);
}

}  // namespace
}  // namespace tf::runtime
