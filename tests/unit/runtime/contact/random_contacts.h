// Random contact problems of the tests and an independent check of their solutions.
#pragma once

#include "runtime/contact/contact_problem.h"

#include <Eigen/Dense>

#include <algorithm>
#include <random>
#include <vector>

namespace tf::runtime::test {

struct RandomContacts {
  std::mt19937 random;
  explicit RandomContacts(unsigned seed) : random(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }
  Eigen::MatrixXd matrix(int rows, int cols) {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [this] { return uniform(-1, 1); });
  }

  // n contacts of one slip direction on a system of nv velocities, and friction elements; slip of each row with probability
  // `slipping`. φ = J f of a random force f: redundant contacts (2 n > nv) are consistent.
  ContactProblem problem(int n, int elements, int nv, double largestFriction, double slipping) {
    const Eigen::MatrixXd J = matrix(2 * n + elements, nv);
    const Eigen::VectorXd f = matrix(nv, 1) * 5;
    ContactProblem result;
    result.resize(n, n + elements);
    result.delassus.map() = J * J.transpose();
    const Eigen::VectorXd phi = J * f;
    for (int r = 0; r < phi.size(); ++r)
      result.bias[r] = phi(r);
    for (int j = 0; j < n + elements; ++j) {
      result.owner[j] = j < n ? j : -1;
      result.friction[j] = uniform(0, largestFriction);
      result.bound[j] = uniform(0.1, 3);
      if (uniform(0, 1) < slipping)
        result.slipSign[j] = uniform(0, 1) < 0.5 ? -1 : 1;
    }
    return result;
  }
};

// Largest violation of the conditions of ContactProblem by λ alone, in its units.
inline double violationOf(const ContactProblem &problem, const std::vector<double> &force) {
  const int n = problem.normalCount;
  double worst = 0;
  const Eigen::Map<const Eigen::VectorXd> lambda(force.data(), problem.count());
  const Eigen::VectorXd w = problem.delassus.map() * lambda + Eigen::Map<const Eigen::VectorXd>(problem.bias.data(), problem.count());
  for (int i = 0; i < n; ++i)
    worst = std::max({worst, -force[i], -w(i), std::min(force[i], w(i))});
  for (int j = 0; j < problem.tangentCount; ++j) {
    const double limit = problem.owner[j] >= 0 ? problem.friction[j] * force[problem.owner[j]] : problem.bound[j];
    const double f = force[n + j], a = w(n + j);
    if (problem.slipSign[j] != 0)
      worst = std::max(worst, std::abs(f + problem.slipSign[j] * limit));
    else
      worst = std::max({worst, std::abs(f) - limit, std::min(f + limit, a), std::min(limit - f, -a)});
  }
  return worst;
}

}  // namespace tf::runtime::test
