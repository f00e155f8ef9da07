#include "runtime/integrate/dormand_prince.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr double nodes[] = {1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1};
constexpr double weights[5][5] = {
    {1.0 / 5, 0, 0, 0, 0},
    {3.0 / 40, 9.0 / 40, 0, 0, 0},
    {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
};
// Of k1, k3, k4, k5, k6 (k2 has weight 0).
constexpr double result[] = {35.0 / 384, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84};
// Of k1, k3, k4, k5, k6, k7.
constexpr double difference[] = {71.0 / 57600, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
constexpr double dense[] = {-12715105075.0 / 11282082432.0,  87487479700.0 / 32700410799.0, -10690763975.0 / 1880347072.0,
                            701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,   69997945.0 / 29380423.0};

}  // namespace

DormandPrince::DormandPrince(int size)
    : ElementMethod(size), stages_(static_cast<std::size_t>(size) * 5), dense_(static_cast<std::size_t>(size) * 4), point_(size),
      begin_(size), beginRate_(size) {}

// k_(s + 2) out of those before it.
template <int s> bool DormandPrince::solveStage(ModeDynamics &dynamics, double t0) {
  const int n = n_;
  const double h = h_;
  const double *y0 = begin_.data(), *f0 = beginRate_.data(), *k = stages_.data();
  double *point = point_.data();
  for (int i = 0; i < n; ++i) {
    double sum = weights[s][0] * f0[i];
    for (int j = 1; j <= s; ++j)
      sum += weights[s][j] * k[(j - 1) * n + i];
    point[i] = y0[i] + h * sum;
  }
  return dynamics.evaluate(t0 + nodes[s] * h, point, stages_.data() + s * n);
}

bool DormandPrince::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
                          double /*accuracy*/) {
  h_ = h;
  hasDense_ = false;
  for (int i = 0; i < n_; ++i) {
    begin_[i] = y0[i];
    beginRate_[i] = f0[i];
  }
  if (!solveStage<0>(dynamics, t0) || !solveStage<1>(dynamics, t0) || !solveStage<2>(dynamics, t0) || !solveStage<3>(dynamics, t0) ||
      !solveStage<4>(dynamics, t0))
    return false;
  const double *const k[] = {stages_.data(), stages_.data() + n_, stages_.data() + 2 * n_, stages_.data() + 3 * n_,
                             stages_.data() + 4 * n_};
  for (int i = 0; i < n_; ++i)
    end_[i] = y0[i] + h * (result[0] * f0[i] + result[1] * k[1][i] + result[2] * k[2][i] + result[3] * k[3][i] + result[4] * k[4][i]);
  // The rate at the end serves the next step as well: it is to be that of the projected state.
  if (!dynamics.evaluateProjected(t0 + h, end_.data(), endRate_.data(), scale))
    return false;
  for (int i = 0; i < n_; ++i)
    error_[i] = h * (difference[0] * f0[i] + difference[1] * k[1][i] + difference[2] * k[2][i] + difference[3] * k[3][i] +
                     difference[4] * k[4][i] + difference[5] * endRate_[i]);
  return true;
}

// y(theta) = y0 + theta (c0 + (1 − theta) (c1 + theta (c2 + (1 − theta) c3)))
void DormandPrince::makeDense() const {
  const double *k3 = stages_.data() + n_, *k4 = k3 + n_, *k5 = k4 + n_, *k6 = k5 + n_;
  for (int i = 0; i < n_; ++i) {
    double *c = dense_.data() + static_cast<std::ptrdiff_t>(i) * 4;
    c[0] = end_[i] - begin_[i];
    c[1] = h_ * beginRate_[i] - c[0];
    c[2] = c[0] - h_ * endRate_[i] - c[1];
    c[3] = h_ *
           (dense[0] * beginRate_[i] + dense[1] * k3[i] + dense[2] * k4[i] + dense[3] * k5[i] + dense[4] * k6[i] + dense[5] * endRate_[i]);
  }
  hasDense_ = true;
}

void DormandPrince::interpolate(double theta, double *y) const {
  if (!hasDense_)
    makeDense();
  const double rest = 1 - theta;
  for (int i = 0; i < n_; ++i) {
    const double *c = dense_.data() + static_cast<std::ptrdiff_t>(i) * 4;
    y[i] = begin_[i] + theta * (c[0] + rest * (c[1] + theta * (c[2] + rest * c[3])));
  }
}

double DormandPrince::stabilityRatio() const {
  const double *k6 = stages_.data() + 4 * static_cast<std::ptrdiff_t>(n_);
  double rates = 0, states = 0;
  for (int i = 0; i < n_; ++i) {
    rates += (endRate_[i] - k6[i]) * (endRate_[i] - k6[i]);
    states += (end_[i] - point_[i]) * (end_[i] - point_[i]);
  }
  constexpr double border = 3.25;
  return states > 0 ? std::abs(h_) * std::sqrt(rates / states) / border : 0;
}

double DormandPrince::errorNorm(const double *scale, double tolerance) const { return largestError(scale) / tolerance; }

}  // namespace tf::runtime
