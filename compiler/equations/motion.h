// How coordinates move with the velocities: q' = N(q) v.
//
// A plain coordinate has a velocity of its own. The four coordinates of a rotation are a unit quaternion q = (w, x, y, z), which takes
// vectors of the body's frame to the world's; its velocity is the angular velocity ω in the body's frame, q' = ½ q ⊗ (0, ω) (theory.md
// section 1).
#pragma once

#include "compiler/equations/quaternions.h"

#include <functional>
#include <vector>

namespace tf::equations {

struct RotationCoordinate {
  int coordinate = 0;  // the first of four
  int velocity = 0;    // the first of three
};

class Motion {
public:
  // Numbers coordinates and velocities in the order of the calls; both return the first coordinate.
  int addCoordinates(int count);
  int addRotation();

  [[nodiscard]] int coordinates() const { return static_cast<int>(velocityOf_.size()); }
  [[nodiscard]] int velocities() const { return coordinates() - static_cast<int>(rotations_.size()); }
  [[nodiscard]] const std::vector<RotationCoordinate> &rotations() const { return rotations_; }
  // The velocity of a plain coordinate; −1 for parts of quaternions.
  [[nodiscard]] int velocityOf(int coordinate) const { return velocityOf_[static_cast<std::size_t>(coordinate)]; }
  // The rotation that the coordinate is a part of; null for plain ones.
  [[nodiscard]] const RotationCoordinate *rotationOf(int coordinate) const;

  // The coordinate's time derivative in terms of the symbols Coordinate and Velocity.
  [[nodiscard]] ir::NodeId rate(ir::Graph &graph, int coordinate) const;

  // Of nodes in terms of the rates of symbols.
  using TimeDerivative = std::function<std::vector<ir::NodeId>(std::span<const ir::NodeId>)>;
  // Angular velocity in the body's frame of the rotation `q`, linear in the velocities: that of a rotation coordinate is its velocity.
  [[nodiscard]] Vector3 angularVelocity(ir::Graph &graph, const Quaternion &q, const TimeDerivative &derivative) const;

private:
  [[nodiscard]] Quaternion quaternion(ir::Graph &graph, const RotationCoordinate &rotation) const;
  [[nodiscard]] Vector3 velocity(ir::Graph &graph, const RotationCoordinate &rotation) const;

  std::vector<int> velocityOf_;
  std::vector<RotationCoordinate> rotations_;
};

}  // namespace tf::equations
