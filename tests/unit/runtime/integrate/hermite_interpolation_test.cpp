#include "runtime/integrate/hermite_interpolation.h"

#include <array>
#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

// q = 1 − 2t + t³/2 − t⁵, v = q', z = 3 + t − t³ over [0.3, 1.1]: what the polynomials have no error of.
std::array<double, 3> state(double t) {
  return {1 - 2 * t + 0.5 * t * t * t - t * t * t * t * t, -2 + 1.5 * t * t - 5 * t * t * t * t, 3 + t - t * t * t};
}
std::array<double, 3> rate(double t) { return {state(t)[1], 3 * t - 20 * t * t * t, 1 - 3 * t * t}; }

TEST(HermiteInterpolation, IsExactForPolynomials) {
  constexpr double begin = 0.3, length = 0.8;
  const auto y0 = state(begin), f0 = rate(begin), y1 = state(begin + length), f1 = rate(begin + length);
  for (const double theta : {0.0, 0.2, 0.5, 0.9, 1.0, 1.05}) {
    std::array<double, 3> y{};
    interpolateBetween({y0.data(), f0.data(), y1.data(), f1.data(), length, 3, 1}, theta, y.data());
    for (std::size_t i = 0; i < y.size(); ++i)
      EXPECT_NEAR(y[i], state(begin + theta * length)[i], 1e-14) << theta;
  }
}

// Without integrals all variables are cubics.
TEST(HermiteInterpolation, OfRatesAloneIsCubic) {
  const double y0[] = {1, 0}, f0[] = {0, 3}, y1[] = {2, 1}, f1[] = {0, -1};
  double y[2];
  interpolateBetween({y0, f0, y1, f1, 2, 2, 0}, 0.5, y);
  EXPECT_DOUBLE_EQ(y[0], 1.5);
  EXPECT_DOUBLE_EQ(y[1], 0.5 + 2 * (3 + 1) / 8.0);
}

}  // namespace
}  // namespace tf::runtime
