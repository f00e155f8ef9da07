#include "runtime/simulate/rest_series.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tf::runtime {

namespace {

constexpr std::size_t mostEstimates = 6;
// Estimates with more of the time left than this share of the one before are no halving of it.
constexpr double leastChange = 0.75;

bool anyOf(const std::vector<std::uint8_t> &flags) {
  return std::any_of(flags.begin(), flags.end(), [](std::uint8_t flag) { return flag != 0; });
}

}  // namespace

void RestSeries::forget() {
  estimates_.clear();
  best_.clear();
}

void RestSeries::restart() {
  forget();
  std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
  std::fill(alternates_.begin(), alternates_.end(), std::uint8_t{0});
}

bool RestSeries::alternates() const { return anyOf(alternates_) || anyOf(changed_); }

bool RestSeries::isWanted(double remaining) const {
  return isEmpty() || remaining <= leastChange * last().remaining || remaining > last().remaining;
}

bool RestSeries::add(RestEstimate estimate) {
  const bool isOther =
      !isEmpty() && (last().point.contacts != estimate.point.contacts || estimate.remaining > leastChange * last().remaining);
  if (isOther)
    forget();
  if (estimates_.size() == mostEstimates)
    estimates_.erase(estimates_.begin());
  estimates_.push_back(std::move(estimate));
  std::swap(alternates_, changed_);
  std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
  return isOther;
}

// That extrapolate values at x to 0, for the powers 1, x², x³, …, and x where switches change on the way.
Eigen::VectorXd RestSeries::weights(const Eigen::VectorXd &x) const {
  const Eigen::Index m = x.size();
  const double first = anyOf(alternates_) ? 1 : 2;
  Eigen::MatrixXd powers(m, m);
  for (Eigen::Index k = 0; k < m; ++k)
    for (Eigen::Index e = 0; e < m; ++e)
      powers(e, k) = e == 0 ? 1 : std::pow(x(k) / x(0), first + static_cast<double>(e - 1));
  return powers.fullPivLu().solve(Eigen::VectorXd::Unit(m, 0));
}

// T of the latest ones.
Eigen::VectorXd RestSeries::remaining(std::size_t estimates) const {
  Eigen::VectorXd x(static_cast<Eigen::Index>(estimates));
  for (std::size_t k = 0; k < estimates; ++k)
    x(static_cast<Eigen::Index>(k)) = latest(estimates)[k].remaining;
  return x;
}

double RestSeries::difference(const std::vector<double> &a, const std::vector<double> &b, const double *scale, double timeScale) const {
  double largest = 0;
  for (int i = 0; i <= size_; ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]) / (i < size_ ? std::max(scale[i], std::abs(a[i])) : timeScale));
  return largest;
}

// State and time from the latest estimates.
std::vector<double> RestSeries::extrapolated(std::size_t estimates) const {
  const Eigen::VectorXd weight = weights(remaining(estimates));
  std::vector<double> values(static_cast<std::size_t>(size_) + 1, 0.0);
  for (std::size_t k = 0; k < estimates; ++k) {
    const RestPoint &point = latest(estimates)[k].point;
    for (int i = 0; i < size_; ++i)
      values[i] += weight(static_cast<Eigen::Index>(k)) * point.state[i];
    values[size_] += weight(static_cast<Eigen::Index>(k)) * point.time;
  }
  return values;
}

bool RestSeries::extrapolate(double tolerance, const double *scale, double timeScale) {
  std::vector<double> previous, best;
  double error = std::numeric_limits<double>::infinity();
  for (std::size_t m = 1; m <= estimates_.size(); ++m) {
    std::vector<double> now = extrapolated(m);
    if (const double change = m > 1 ? difference(now, previous, scale, timeScale) : error; change < error) {
      error = change;
      best = now;
      extrapolatedFrom_ = m;
    }
    previous = std::move(now);
  }
  const bool agrees = error <= tolerance && !best_.empty() && difference(best, best_, scale, timeScale) <= tolerance;
  best_ = std::move(best);
  if (!agrees)
    return false;
  point_ = last().point;
  point_.time = best_[size_];
  std::copy_n(best_.begin(), size_, point_.state.begin());
  extrapolateTotals();
  return true;
}

// Of what comes together until the point is reached, beyond what had done so when it was estimated last.
void RestSeries::extrapolateTotals() {
  const Eigen::VectorXd weight = weights(remaining(extrapolatedFrom_));
  const std::vector<double> &lastTotals = last().totals;
  for (std::size_t i = 0; i < lastTotals.size(); ++i) {
    double total = 0;
    for (std::size_t k = 0; k < extrapolatedFrom_; ++k)
      total += weight(static_cast<Eigen::Index>(k)) * latest(extrapolatedFrom_)[k].totals[i];
    point_.accumulated[i] += total - lastTotals[i];
  }
}

// Of (q, v, z) and time at the point from the latest estimates, by each sensitivity: of the values and of the weights.
std::vector<double> RestSeries::extrapolatedDerivatives(std::size_t estimates, int columns) const {
  constexpr double step = 1e-3;
  const int n = size_ - 1, count = n + 2;  // tau, the last of the state, has none
  const RestEstimate *first = latest(estimates);
  const Eigen::VectorXd x = remaining(estimates), weight = weights(x);
  Eigen::VectorXd change(x.size());
  std::vector<double> all;
  for (int column = 0; column < columns; ++column) {
    for (std::size_t k = 0; k < estimates; ++k)
      change(static_cast<Eigen::Index>(k)) = first[k].derivatives[static_cast<std::size_t>(count) * column + n + 1];
    const double h = step / std::max(change.cwiseQuotient(x).lpNorm<Eigen::Infinity>(), 1e-300);
    const auto shifted = [&](double s) { return weights(x + s * h * change); };
    const Eigen::VectorXd turn = (8 * (shifted(1) - shifted(-1)) - (shifted(2) - shifted(-2))) / (12 * h);
    for (int i = 0; i <= n; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < estimates; ++k)
        sum += weight(static_cast<Eigen::Index>(k)) * first[k].derivatives[static_cast<std::size_t>(count) * column + i] +
               turn(static_cast<Eigen::Index>(k)) * (i < n ? first[k].point.state[i] : first[k].point.time);
      all.push_back(sum);
    }
  }
  return all;
}

bool RestSeries::derivativesAgree(double tolerance, int columns) {
  const double accepted = std::max(1e-6, 100 * tolerance);
  point_.derivatives = extrapolatedDerivatives(extrapolatedFrom_, columns);
  const std::vector<double> fewer = extrapolatedDerivatives(extrapolatedFrom_ - 1, columns);
  for (std::size_t k = 0; k < fewer.size(); ++k)
    if (!(std::abs(point_.derivatives[k] - fewer[k]) <= accepted * std::max(1.0, std::abs(fewer[k]))))
      return false;
  return true;
}

}  // namespace tf::runtime
