// Rigid bodies in space with random contact points above a floor: contact rows of the tests.
#pragma once

#include <Eigen/Dense>

#include <cstddef>
#include <random>
#include <vector>

namespace tf::runtime::test {

// Velocities (v, ω) of the centre; normal rows (e_z at each point), then two slip rows for each point.
struct SpatialBody {
  Eigen::MatrixXd mass, rows;
};

inline SpatialBody spatialBody(double mass, const Eigen::Matrix3d &inertia, const std::vector<Eigen::Vector3d> &points) {
  SpatialBody body;
  body.mass = Eigen::MatrixXd::Zero(6, 6);
  body.mass.topLeftCorner<3, 3>() = mass * Eigen::Matrix3d::Identity();
  body.mass.bottomRightCorner<3, 3>() = inertia;
  const int count = static_cast<int>(points.size());
  body.rows.resize(3 * count, 6);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d &r = points[static_cast<std::size_t>(i)];
    // The velocity of the point, v + ω × r.
    Eigen::Matrix<double, 3, 6> point;
    point << 1, 0, 0, 0, r.z(), -r.y(), 0, 1, 0, -r.z(), 0, r.x(), 0, 0, 1, r.y(), -r.x(), 0;
    body.rows.row(i) = point.row(2);
    body.rows.middleRows<2>(count + 2 * i) = point.topRows<2>();
  }
  return body;
}

inline SpatialBody spatialBody(std::mt19937 &generator, int contacts) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Matrix3d inertia = Eigen::Vector3d(0.3 + 0.2 * uniform(generator), 0.5 + 0.2 * uniform(generator), 0.6).asDiagonal();
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(contacts));
  for (int i = 0; i < contacts; ++i)
    points.emplace_back(uniform(generator), uniform(generator), -0.8 + 0.2 * uniform(generator));
  return spatialBody(1, inertia, points);
}

}  // namespace tf::runtime::test
