#include "lang/base/trigonometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace tf {
namespace {

// In units of the last place of the exact value, which long double has eleven bits more of.
double unitsOff(double value, long double exact) {
  const double rounded = std::fabs(static_cast<double>(exact));
  const double unit = std::nextafter(rounded, std::numeric_limits<double>::infinity()) - rounded;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - exact)) / unit;
}

double unitsOff(double angle) {
  const SineAndCosine both = sineAndCosine(angle);
  return std::max(unitsOff(both.sine, std::sin(static_cast<long double>(angle))),
                  unitsOff(both.cosine, std::cos(static_cast<long double>(angle))));
}

TEST(SineAndCosine, AreWithinOneUnitOfTheLastPlace) {
  std::mt19937_64 random(1);
  for (const double range : {1e-3, 1.0, 4.0, 100.0, 1e4, largestReducedAngle}) {
    std::uniform_real_distribution<double> angles(-range, range);
    for (int k = 0; k < 20000; ++k) {
      const double angle = angles(random);
      ASSERT_LT(unitsOff(angle), 1) << angle;
    }
  }
}

TEST(SineAndCosine, KeepTheirRelativeAccuracyNearTheirZeros) {
  const long double halfPi = std::acos(-1.0L) / 2;
  for (int k = -600000; k <= 600000; k += k > -300 && k < 300 ? 1 : 997) {
    const double angle = static_cast<double>(k * halfPi);
    for (const double near : {angle, std::nextafter(angle, 1e9), std::nextafter(angle, -1e9)})
      ASSERT_LT(unitsOff(near), 1) << k;
  }
}

TEST(SineAndCosine, AtZeroAndAtTinyAngles) {
  for (const double angle : {0.0, -0.0, 1e-320, -1e-300, 1e-9}) {
    EXPECT_EQ(sineAndCosine(angle).sine, angle);
    EXPECT_EQ(std::signbit(sineAndCosine(angle).sine), std::signbit(angle));
    EXPECT_EQ(sineAndCosine(angle).cosine, 1);
  }
}

TEST(SineAndCosine, AreThoseOfTheLibraryBeyondTheRange) {
  for (const double angle : {largestReducedAngle, -3e17, 1e300}) {
    EXPECT_EQ(sineAndCosine(angle).sine, std::sin(angle));
    EXPECT_EQ(sineAndCosine(angle).cosine, std::cos(angle));
  }
  for (const double angle : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(std::isnan(sineAndCosine(angle).sine) && std::isnan(sineAndCosine(angle).cosine));
}

}  // namespace
}  // namespace tf
