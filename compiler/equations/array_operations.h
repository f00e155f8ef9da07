// Array operations of flat expressions on row-major arrays of nodes. Shapes are those that the flat model's types promise.
#pragma once

#include "compiler/ir/graph.h"
#include "lang/semantics/flat_model.h"

#include <vector>

namespace tf::equations {

struct Array {
  std::vector<int> dims;  // empty: scalar
  std::vector<ir::NodeId> nodes;
};

// Row-major positions that `indices` select out of an array of shape `dims`; dimensions beyond the last index are taken whole.
[[nodiscard]] std::vector<int> selectedPositions(const std::vector<int> &dims, const std::vector<flat::Selection> &indices);

// Scalar product, matrix product, matrix·vector and so on (MLS 10.6.4); a scalar on either side scales.
[[nodiscard]] Array multiply(ir::Graph &graph, const Array &a, const Array &b);
[[nodiscard]] Array matrixPower(ir::Graph &graph, const Array &a, int exponent);
// `parts` along dimension `axis`, where only that dimension may differ.
[[nodiscard]] Array concatenate(const std::vector<Array> &parts, int axis);

[[nodiscard]] Array transpose(const Array &a);
[[nodiscard]] Array cross(ir::Graph &graph, const Array &a, const Array &b);
[[nodiscard]] Array skew(ir::Graph &graph, const Array &a);
[[nodiscard]] Array diagonal(ir::Graph &graph, const Array &a);
[[nodiscard]] Array identity(ir::Graph &graph, int n);
[[nodiscard]] Array outerProduct(ir::Graph &graph, const Array &a, const Array &b);
// The upper triangle mirrored (MLS 10.3.5).
[[nodiscard]] Array symmetric(const Array &a);

}  // namespace tf::equations
