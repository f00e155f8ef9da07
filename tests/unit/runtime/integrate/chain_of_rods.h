// Mass matrix and Jacobians of a chain of uniform rods, of length and mass 1 together.
#pragma once

#include <Eigen/Dense>

#include <cmath>
#include <vector>

namespace tf::runtime::test {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A chain of rods in the plane: a first node that is free or fixed, angles that are absolute or relative ones.
struct Chain {
  bool isFree = true, isRelative = false;
  std::vector<double> angles;  // absolute

  [[nodiscard]] int rods() const { return static_cast<int>(angles.size()); }
  [[nodiscard]] int size() const { return rods() + (isFree ? 2 : 0); }
  // Derivatives of node k (k = 0 the first one), moved along rod k by a part of it.
  [[nodiscard]] RowMajor jacobian(int node, double part = 0) const {
    RowMajor absolute = RowMajor::Zero(2, rods()), J = RowMajor::Zero(2, size());
    for (int i = 0; i <= node && i < rods(); ++i) {
      const double length = (i < node ? 1 : part) / rods();
      absolute(0, i) = -length * std::sin(angles[i]);
      absolute(1, i) = length * std::cos(angles[i]);
    }
    const int first = size() - rods();
    if (isFree)
      J.leftCols(2).setIdentity();
    for (int i = 0; i < rods(); ++i)
      J.col(first + i) = isRelative ? absolute.rightCols(rods() - i).rowwise().sum().eval() : absolute.col(i).eval();
    return J;
  }
  [[nodiscard]] RowMajor mass() const {
    RowMajor M = RowMajor::Zero(size(), size());
    const int first = size() - rods();
    for (int i = 0; i < rods(); ++i) {
      const RowMajor J = jacobian(i, 0.5);
      const double m = 1.0 / rods(), inertia = m / rods() / rods() / 12;
      M += m * J.transpose() * J;
      Eigen::VectorXd turn = Eigen::VectorXd::Zero(size());
      if (isRelative)
        turn.segment(first, i + 1).setOnes();
      else
        turn[first + i] = 1;
      M += inertia * turn * turn.transpose();
    }
    return M;
  }
};

}  // namespace tf::runtime::test
