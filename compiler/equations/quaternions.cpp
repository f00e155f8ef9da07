#include "compiler/equations/quaternions.h"

namespace tf::equations {

using ir::NodeId;

namespace {

NodeId length(ir::Graph &graph, std::span<const NodeId> vector) {
  std::vector<NodeId> squares;
  for (const NodeId component : vector)
    squares.push_back(graph.mul(component, component));
  return graph.unary(ir::Op::Sqrt, graph.sum(squares));
}

}  // namespace

Quaternion product(ir::Graph &graph, const Quaternion &a, const Quaternion &b) {
  // Row k: the signs and places of b's components that a's multiply.
  static constexpr int kPlace[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
  static constexpr int kSign[4][4] = {{1, -1, -1, -1}, {1, 1, 1, -1}, {1, -1, 1, 1}, {1, 1, -1, 1}};
  Quaternion result{};
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<NodeId, 4> terms{};
    for (std::size_t j = 0; j < 4; ++j) {
      const NodeId term = graph.mul(a[j], b[static_cast<std::size_t>(kPlace[k][j])]);
      terms[j] = kSign[k][j] > 0 ? term : graph.neg(term);
    }
    result[k] = graph.sum(terms);
  }
  return result;
}

Quaternion conjugate(ir::Graph &graph, const Quaternion &q) { return {q[0], graph.neg(q[1]), graph.neg(q[2]), graph.neg(q[3])}; }

Vector3 rotate(ir::Graph &graph, const Quaternion &q, const Vector3 &r) {
  const auto twice = [&](NodeId a) { return graph.mul(graph.constant(2), a); };
  const auto square = [&](std::size_t k) { return graph.mul(q[k], q[k]); };
  const auto diagonal = [&](std::size_t j, std::size_t k) { return graph.sub(graph.constant(1), twice(graph.add(square(j), square(k)))); };
  const auto sum = [&](std::size_t j, std::size_t k, std::size_t l) {
    return twice(graph.add(graph.mul(q[j], q[k]), graph.mul(q[0], q[l])));
  };
  const auto difference = [&](std::size_t j, std::size_t k, std::size_t l) {
    return twice(graph.sub(graph.mul(q[j], q[k]), graph.mul(q[0], q[l])));
  };
  const NodeId matrix[3][3] = {{diagonal(2, 3), difference(1, 2, 3), sum(1, 3, 2)},
                               {sum(1, 2, 3), diagonal(1, 3), difference(2, 3, 1)},
                               {difference(1, 3, 2), sum(2, 3, 1), diagonal(1, 2)}};
  Vector3 result{};
  for (std::size_t i = 0; i < 3; ++i)
    result[i] = graph.sum(std::array{graph.mul(matrix[i][0], r[0]), graph.mul(matrix[i][1], r[1]), graph.mul(matrix[i][2], r[2])});
  return result;
}

Quaternion rotationAbout(ir::Graph &graph, const Vector3 &axis, NodeId angle) {
  const NodeId half = graph.mul(graph.constant(0.5), angle);
  const NodeId sine = graph.unary(ir::Op::Sin, half), norm = length(graph, axis);
  Quaternion result{graph.unary(ir::Op::Cos, half)};
  for (std::size_t k = 0; k < 3; ++k)
    result[k + 1] = graph.mul(graph.div(axis[k], norm), sine);
  return result;
}

Vector3 angularVelocity(ir::Graph &graph, const Quaternion &q, const Quaternion &rate) {
  const Quaternion half = product(graph, conjugate(graph, q), rate);
  Vector3 result{};
  for (std::size_t k = 0; k < 3; ++k)
    result[k] = graph.mul(graph.constant(2), half[k + 1]);
  return result;
}

Quaternion normalised(ir::Graph &graph, const Quaternion &q) {
  const NodeId norm = length(graph, q);
  Quaternion result{};
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = graph.div(q[k], norm);
  return result;
}

Vector3 cross(ir::Graph &graph, const Vector3 &a, const Vector3 &b) {
  Vector3 result{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    result[k] = graph.sub(graph.mul(a[next], b[last]), graph.mul(a[last], b[next]));
  }
  return result;
}

}  // namespace tf::equations
