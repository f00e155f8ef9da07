#include "runtime/simulate/cubic_hermite.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <utility>

namespace tf::runtime {
namespace {

// (x − 1)(x − 2)(x − 4), which has a minimum beyond 2.
double value(double x) { return (x - 1) * (x - 2) * (x - 4); }
double slope(double x) { return (x - 2) * (x - 4) + (x - 1) * (x - 4) + (x - 1) * (x - 2); }
CubicHermite between(double a, double b) { return {value(a), slope(a), value(b), slope(b), b - a}; }

TEST(CubicHermite, IsExactForCubics) {
  const CubicHermite cubic = between(0.5, 5);
  for (const double s : {0.0, 0.2, 0.77, 1.0}) {
    EXPECT_NEAR(cubic.value(s), value(0.5 + 4.5 * s), 1e-12);
    EXPECT_NEAR(cubic.slope(s), 4.5 * slope(0.5 + 4.5 * s), 1e-12);
  }
}

TEST(CubicHermite, FindsItsInteriorMinimum) {
  const double bottom = (7 + std::sqrt(7.0)) / 3;
  EXPECT_NEAR(between(0.5, 5).interiorMinimum(), value(bottom), 1e-12);
  EXPECT_EQ(between(3.5, 5).interiorMinimum(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(between(0, 2).interiorMinimum(), std::numeric_limits<double>::infinity());
}

TEST(CubicHermite, FindsItsLastZero) {
  EXPECT_NEAR(1.2 + 1.2 * between(1.2, 2.4).lastZero(), 2, 1e-9);
  // Parabolas 3 + 2 x − x² and 1 − 2 x − x², to rounding.
  EXPECT_NEAR((5 * CubicHermite{3, 2, -12, -8, 5}.lastZero()), 3, 1e-15 * 8);
  EXPECT_NEAR((2 * CubicHermite{1, -2, -7, -6, 2}.lastZero()), std::sqrt(2.0) - 1, 1e-15);
  // It rises at the end.
  EXPECT_EQ(between(3.5, 3.9).lastZero(), -1);
}

TEST(CubicHermite, KnowsItsLeastSecant) {
  for (const auto &[a, b] : {std::pair{1.0, 5.0}, std::pair{1.0, 1.9}, std::pair{2.0, 4.5}}) {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= 100000; ++k)
      least = std::min(least, (value(a + (b - a) * k / 1e5) - value(a)) / (k / 1e5));
    EXPECT_NEAR(between(a, b).leastSecant(), least, 1e-3);
  }
}

}  // namespace
}  // namespace tf::runtime
