// One step by extrapolation: to rounding on smooth ways, given up early where it goes past a pole.
#include "runtime/contact/extrapolation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

// y' = y², y(0) = 1: y = 1/(1 − t).
struct Pole {
  int rates = 0;
  double part = 0;

  bool rate(const Eigen::VectorXd &y, Eigen::VectorXd &f) {
    ++rates;
    f = y.cwiseProduct(y);
    return true;
  }
  bool factor(double at) {
    part = at;
    return true;
  }
  void solve(Eigen::VectorXd &x) const { x /= 1 - part * 2; }
};

bool stepOf(Extrapolation &extrapolation, Pole &pole, double h) {
  extrapolation.start(Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1));
  return extrapolation.step(h, 1e-14, pole);
}

TEST(Extrapolation, OfASmoothWayIsExactAndMayBeLonger) {
  Extrapolation extrapolation;
  Pole pole;
  for (const double h : {1e-6, 1e-4, 1e-2, 0.1}) {
    ASSERT_TRUE(stepOf(extrapolation, pole, h)) << h;
    EXPECT_NEAR(extrapolation.end()[0], 1 / (1 - h), 2e-15);
  }
  const double growth = extrapolation.longer();
  ASSERT_TRUE(stepOf(extrapolation, pole, 1e-6));
  EXPECT_GT(extrapolation.longer(), growth);
}

TEST(Extrapolation, PastAPoleIsGivenUpBeforeTheTableIsFull) {
  Extrapolation extrapolation;
  Pole pole;
  EXPECT_FALSE(stepOf(extrapolation, pole, 1.5));
  EXPECT_LT(pole.rates, 2 + 6 + 10 + 14 + 22 + 34);
  const double shorter = extrapolation.shorter();
  EXPECT_LT(shorter, 0.5);
  EXPECT_GE(shorter, 0.1);
  // What it says to try next leads to a step that succeeds, in a few attempts.
  double h = 1.5;
  int attempts = 0;
  for (; !stepOf(extrapolation, pole, h); ++attempts)
    h *= extrapolation.shorter();
  EXPECT_LE(attempts, 4);
  EXPECT_NEAR(extrapolation.end()[0], 1 / (1 - h), 1e-14);
}

}  // namespace
}  // namespace tf::runtime
