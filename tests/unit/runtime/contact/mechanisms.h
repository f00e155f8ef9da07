// Planar mechanisms of the tests: mass matrix and contact Jacobians, and contact problems made of them.
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/frozen_phase.h"

#include <Eigen/Dense>

#include <cmath>
#include <vector>

namespace tf::runtime::test {

// Contact i has the normal row i of `normal` and the slip row i of `tangent` (nc × nv).
struct Mechanism {
  Eigen::MatrixXd mass, normal, tangent;
  double friction = 0;

  [[nodiscard]] int contacts() const { return static_cast<int>(normal.rows()); }
  [[nodiscard]] Eigen::MatrixXd jacobian() const {
    Eigen::MatrixXd rows(2 * contacts(), normal.cols());
    rows << normal, tangent;
    return rows;
  }
  [[nodiscard]] Eigen::MatrixXd delassus() const { return jacobian() * mass.ldlt().solve(jacobian().transpose()); }
};

// A rigid body (m, J) at angle th with contact points given in its frame, against the floor y = 0. q = (x, y, th).
inline Mechanism body(double m, double J, double th, const std::vector<Eigen::Vector2d> &points, double mu) {
  Mechanism result;
  result.mass = Eigen::Vector3d(m, m, J).asDiagonal();
  result.normal.resize(static_cast<int>(points.size()), 3);
  result.tangent.resize(static_cast<int>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = std::cos(th) * points[i].x() - std::sin(th) * points[i].y();
    const double y = std::sin(th) * points[i].x() + std::cos(th) * points[i].y();
    result.normal.row(static_cast<int>(i)) << 0, 1, x;
    result.tangent.row(static_cast<int>(i)) << 1, 0, -y;
  }
  result.friction = mu;
  return result;
}

// Chain of uniform rods (length l, mass m each), q = (x0, y0, th_1 …) of the first end, whose nodes are the contact points.
inline Mechanism chain(const std::vector<double> &th, double l, double m, double mu) {
  const int rods = static_cast<int>(th.size()), nv = rods + 2;
  Mechanism result;
  result.mass = Eigen::MatrixXd::Zero(nv, nv);
  result.normal = result.tangent = Eigen::MatrixXd::Zero(rods + 1, nv);
  Eigen::RowVectorXd dx = Eigen::RowVectorXd::Zero(nv), dy = Eigen::RowVectorXd::Zero(nv);  // of the node
  dx(0) = dy(1) = 1;
  for (int k = 0; k <= rods; ++k) {
    result.tangent.row(k) = dx;
    result.normal.row(k) = dy;
    if (k == rods)
      break;
    Eigen::RowVectorXd cx = dx, cy = dy;
    cx(2 + k) -= 0.5 * l * std::sin(th[k]);
    cy(2 + k) += 0.5 * l * std::cos(th[k]);
    result.mass += m * (cx.transpose() * cx + cy.transpose() * cy);
    result.mass(2 + k, 2 + k) += m * l * l / 12;
    dx(2 + k) -= l * std::sin(th[k]);
    dy(2 + k) += l * std::cos(th[k]);
  }
  result.friction = mu;
  return result;
}

// The given contacts at velocity v: one tangential row each.
inline FrozenProblem frozen(const Mechanism &mechanism, const Eigen::VectorXd &v, const std::vector<int> &contacts) {
  const int n = static_cast<int>(contacts.size());
  Eigen::MatrixXd rows(2 * n, v.size());
  for (int i = 0; i < n; ++i) {
    rows.row(i) = mechanism.normal.row(contacts[i]);
    rows.row(n + i) = mechanism.tangent.row(contacts[i]);
  }
  FrozenProblem problem;
  problem.resize(n, n);
  problem.delassus.map() = rows * mechanism.mass.ldlt().solve(rows.transpose());
  const Eigen::VectorXd velocity = rows * v;
  for (int i = 0; i < n; ++i) {
    problem.owner[i] = i;
    problem.friction[i] = mechanism.friction;
    problem.normalVelocity[i] = velocity(i);
    problem.slipVelocity[i] = velocity(n + i);
  }
  return problem;
}

// v⁺ = v + W J impulse.
inline Eigen::VectorXd velocityAfter(const Mechanism &mechanism, const Eigen::VectorXd &v, const std::vector<int> &contacts,
                                     const std::vector<double> &impulse) {
  const int n = static_cast<int>(contacts.size());
  Eigen::VectorXd momentum = Eigen::VectorXd::Zero(v.size());
  for (int i = 0; i < n; ++i) {
    momentum += mechanism.normal.row(contacts[i]).transpose() * impulse[i];
    momentum += mechanism.tangent.row(contacts[i]).transpose() * impulse[n + i];
  }
  return v + mechanism.mass.ldlt().solve(momentum);
}

// The contact problem of all contacts at accelerations without contact forces `free` (2 nc: normal, tangential), with slips.
inline ContactProblem accelerationProblem(const Mechanism &mechanism, const Eigen::VectorXd &free, const std::vector<int> &slipSign) {
  const int n = mechanism.contacts();
  ContactProblem problem;
  problem.resize(n, n);
  problem.delassus.map() = mechanism.delassus();
  for (int r = 0; r < 2 * n; ++r)
    problem.bias[r] = free(r);
  for (int i = 0; i < n; ++i) {
    problem.owner[i] = i;
    problem.friction[i] = mechanism.friction;
    problem.slipSign[i] = slipSign[i];
  }
  return problem;
}

}  // namespace tf::runtime::test
