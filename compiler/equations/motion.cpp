#include "compiler/equations/motion.h"

#include "compiler/equations/quaternions.h"

namespace tf::equations {

using ir::NodeId;
using ir::SymbolKind;

int Motion::addCoordinates(int count) {
  const int first = coordinates(), velocity = velocities();
  for (int k = 0; k < count; ++k)
    velocityOf_.push_back(velocity + k);
  return first;
}

int Motion::addRotation() {
  const int first = coordinates();
  const int velocity = velocities();
  velocityOf_.insert(velocityOf_.end(), 4, -1);
  rotations_.push_back({first, velocity});
  return first;
}

const RotationCoordinate *Motion::rotationOf(int coordinate) const {
  for (const RotationCoordinate &rotation : rotations_)
    if (coordinate >= rotation.coordinate && coordinate < rotation.coordinate + 4)
      return &rotation;
  return nullptr;
}

NodeId Motion::rate(ir::Graph &graph, int coordinate) const {
  const RotationCoordinate *rotation = rotationOf(coordinate);
  if (rotation == nullptr)
    return graph.symbol(SymbolKind::Velocity, velocityOf(coordinate));
  Quaternion q;
  for (int k = 0; k < 4; ++k)
    q[static_cast<std::size_t>(k)] = graph.symbol(SymbolKind::Coordinate, rotation->coordinate + k);
  Vector3 w;
  for (int k = 0; k < 3; ++k)
    w[static_cast<std::size_t>(k)] = graph.symbol(SymbolKind::Velocity, rotation->velocity + k);
  const Quaternion rate = product(graph, q, {graph.constant(0), w[0], w[1], w[2]});
  return graph.mul(graph.constant(0.5), rate[static_cast<std::size_t>(coordinate - rotation->coordinate)]);
}

}  // namespace tf::equations
