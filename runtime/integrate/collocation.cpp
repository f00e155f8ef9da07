#include "runtime/integrate/collocation.h"

#include <Eigen/Dense>

#include <cmath>

namespace tf::runtime {

std::vector<double> radauNodes(int stages) {
  if (stages == 1)
    return {1};
  if (stages == 2)
    return {1.0 / 3, 1};
  if (stages == 3)
    return {(4 - std::sqrt(6.0)) / 10, (4 + std::sqrt(6.0)) / 10, 1};
  // 35 x³ − 45 x² + 15 x − 1 = 0 by Newton from near its roots.
  std::vector<double> nodes = {0.0886, 0.4095, 0.7877, 1};
  for (int i = 0; i < 3; ++i) {
    long double x = nodes[i];
    for (int k = 0; k < 20; ++k)
      x -= (((35 * x - 45) * x + 15) * x - 1) / ((105 * x - 90) * x + 15);
    nodes[i] = static_cast<double>(x);
  }
  return nodes;
}

std::vector<double> interpolatoryWeights(const std::vector<double> &x, const std::vector<long double> &moments) {
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic> powers(n, n);
  Eigen::Matrix<long double, Eigen::Dynamic, 1> right(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index j = 0; j < n; ++j)
      powers(k, j) = std::pow(static_cast<long double>(x[j]), static_cast<long double>(k));
    right[k] = moments[k];
  }
  const Eigen::Matrix<long double, Eigen::Dynamic, 1> weights = powers.fullPivLu().solve(right);
  std::vector<double> result(x.size());
  for (Eigen::Index j = 0; j < n; ++j)
    result[j] = static_cast<double>(weights[j]);
  return result;
}

std::vector<long double> integralMoments(int count, long double end, long double gamma) {
  std::vector<long double> moments(count);
  for (int k = 0; k < count; ++k)
    moments[k] = std::pow(end, static_cast<long double>(k + 1)) / (k + 1) - (k == 0 ? gamma : 0);
  return moments;
}

std::vector<double> collocationCoefficients(const std::vector<double> &nodes) {
  std::vector<double> coefficients;
  for (const double node : nodes) {
    const std::vector<double> row = interpolatoryWeights(nodes, integralMoments(static_cast<int>(nodes.size()), node));
    coefficients.insert(coefficients.end(), row.begin(), row.end());
  }
  return coefficients;
}

std::vector<double> gaussNodes() {
  const double inner = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(6.0 / 5)), outer = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(6.0 / 5));
  return {0.5 * (1 - outer), 0.5 * (1 - inner), 0.5 * (1 + inner), 0.5 * (1 + outer)};
}

std::vector<double> dampedGaussNodes() {
  std::vector<double> nodes = gaussNodes();
  nodes.push_back(0.97);
  return nodes;
}

}  // namespace tf::runtime
