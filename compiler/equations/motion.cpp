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

Quaternion Motion::quaternion(ir::Graph &graph, const RotationCoordinate &rotation) const {
  Quaternion q{};
  for (int k = 0; k < 4; ++k)
    q[static_cast<std::size_t>(k)] = graph.symbol(SymbolKind::Coordinate, rotation.coordinate + k);
  return q;
}

Vector3 Motion::velocity(ir::Graph &graph, const RotationCoordinate &rotation) const {
  Vector3 w{};
  for (int k = 0; k < 3; ++k)
    w[static_cast<std::size_t>(k)] = graph.symbol(SymbolKind::Velocity, rotation.velocity + k);
  return w;
}

NodeId Motion::rate(ir::Graph &graph, int coordinate) const {
  const RotationCoordinate *rotation = rotationOf(coordinate);
  if (rotation == nullptr)
    return graph.symbol(SymbolKind::Velocity, velocityOf(coordinate));
  const Vector3 w = velocity(graph, *rotation);
  const Quaternion twice = product(graph, quaternion(graph, *rotation), {graph.constant(0), w[0], w[1], w[2]});
  return graph.mul(graph.constant(0.5), twice[static_cast<std::size_t>(coordinate - rotation->coordinate)]);
}

Vector3 Motion::angularVelocity(ir::Graph &graph, const Quaternion &q, const TimeDerivative &derivative) const {
  if (const ir::Node &first = graph[q[0]]; first.op == ir::Op::Symbol && first.symbol.kind == SymbolKind::Coordinate)
    if (const RotationCoordinate *rotation = rotationOf(first.symbol.index); rotation != nullptr && q == quaternion(graph, *rotation))
      return velocity(graph, *rotation);
  const std::vector<NodeId> rate = derivative(q);
  return equations::angularVelocity(graph, q, {rate[0], rate[1], rate[2], rate[3]});
}

}  // namespace tf::equations
