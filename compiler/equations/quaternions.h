// Rotations as unit quaternions q = (w, x, y, z) of nodes: R(q) r takes a vector of the body's frame to the world's.
#pragma once

#include "compiler/ir/graph.h"

#include <array>
#include <span>
#include <vector>

namespace tf::equations {

using Quaternion = std::array<ir::NodeId, 4>;
using Vector3 = std::array<ir::NodeId, 3>;

[[nodiscard]] inline Quaternion quaternion(std::span<const ir::NodeId> nodes) { return {nodes[0], nodes[1], nodes[2], nodes[3]}; }

// a ⊗ b: first b, then a.
[[nodiscard]] Quaternion product(ir::Graph &graph, const Quaternion &a, const Quaternion &b);
[[nodiscard]] Quaternion conjugate(ir::Graph &graph, const Quaternion &q);
// The entries of R(q) are shared by all vectors that it turns.
[[nodiscard]] Vector3 rotate(ir::Graph &graph, const Quaternion &q, const Vector3 &r);
// By `angle` about `axis`, which need not have length 1 but must not be 0.
[[nodiscard]] Quaternion rotationAbout(ir::Graph &graph, const Vector3 &axis, ir::NodeId angle);
// In the body's frame, of the quaternion's rate: ω = 2 vec(q* ⊗ q').
[[nodiscard]] Vector3 angularVelocity(ir::Graph &graph, const Quaternion &q, const Quaternion &rate);
// q / |q|.
[[nodiscard]] Quaternion normalised(ir::Graph &graph, const Quaternion &q);

[[nodiscard]] Vector3 cross(ir::Graph &graph, const Vector3 &a, const Vector3 &b);

}  // namespace tf::equations
