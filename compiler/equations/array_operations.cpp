#include "compiler/equations/array_operations.h"

#include <algorithm>
#include <cassert>

namespace tf::equations {

namespace {

std::size_t at(int row, int columns, int column) { return static_cast<std::size_t>(row) * columns + column; }

}  // namespace

std::vector<int> selectedPositions(const std::vector<int> &dims, const std::vector<flat::Selection> &indices) {
  assert(indices.size() <= dims.size());
  std::vector<int> positions{0};
  for (std::size_t k = 0; k < dims.size(); ++k) {
    std::vector<int> next;
    for (const int base : positions) {
      if (k < indices.size())
        for (const int index : indices[k].positions)
          next.push_back(base * dims[k] + index - 1);
      else
        for (int index = 0; index < dims[k]; ++index)
          next.push_back(base * dims[k] + index);
    }
    positions = std::move(next);
  }
  return positions;
}

Array multiply(ir::Graph &graph, const Array &a, const Array &b) {
  if (a.dims.empty() || b.dims.empty()) {
    const bool isLeft = a.dims.empty();
    Array result = isLeft ? b : a;
    for (ir::NodeId &node : result.nodes)
      node = isLeft ? graph.mul(a.nodes[0], node) : graph.mul(node, b.nodes[0]);
    return result;
  }
  const int inner = b.dims[0];
  const int rows = a.dims.size() == 2 ? a.dims[0] : 1;
  const int columns = b.dims.size() == 2 ? b.dims[1] : 1;
  assert(a.dims.back() == inner);
  Array result;
  if (a.dims.size() == 2)
    result.dims.push_back(rows);
  if (b.dims.size() == 2)
    result.dims.push_back(columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      std::vector<ir::NodeId> terms;
      terms.reserve(static_cast<std::size_t>(inner));
      for (int k = 0; k < inner; ++k)
        terms.push_back(graph.mul(a.nodes[at(i, inner, k)], b.nodes[at(k, columns, j)]));
      result.nodes.push_back(graph.sum(terms));
    }
  return result;
}

Array matrixPower(ir::Graph &graph, const Array &a, int exponent) {
  assert(a.dims.size() == 2 && exponent >= 0);
  Array result = identity(graph, a.dims[0]);
  Array factor = a;
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1)
      result = multiply(graph, result, factor);
    if (exponent > 1)
      factor = multiply(graph, factor, factor);
  }
  return result;
}

Array concatenate(const std::vector<Array> &parts, int axis) {
  assert(!parts.empty());
  const auto k = static_cast<std::size_t>(axis);
  Array result;
  result.dims = parts[0].dims;
  result.dims[k] = 0;
  std::size_t outer = 1, inner = 1;
  for (std::size_t d = 0; d < result.dims.size(); ++d) {
    if (d < k)
      outer *= static_cast<std::size_t>(parts[0].dims[d]);
    if (d > k)
      inner *= static_cast<std::size_t>(parts[0].dims[d]);
  }
  for (const Array &part : parts)
    result.dims[k] += part.dims[k];
  for (std::size_t block = 0; block < outer; ++block)
    for (const Array &part : parts) {
      const std::size_t length = static_cast<std::size_t>(part.dims[k]) * inner;
      const auto first = part.nodes.begin() + static_cast<std::ptrdiff_t>(block * length);
      result.nodes.insert(result.nodes.end(), first, first + static_cast<std::ptrdiff_t>(length));
    }
  return result;
}

Array transpose(const Array &a) {
  Array result{{a.dims[1], a.dims[0]}, {}};
  for (int j = 0; j < a.dims[1]; ++j)
    for (int i = 0; i < a.dims[0]; ++i)
      result.nodes.push_back(a.nodes[at(i, a.dims[1], j)]);
  return result;
}

Array cross(ir::Graph &graph, const Array &a, const Array &b) {
  Array result{{3}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    result.nodes.push_back(graph.sub(graph.mul(a.nodes[j], b.nodes[k]), graph.mul(a.nodes[k], b.nodes[j])));
  }
  return result;
}

Array skew(ir::Graph &graph, const Array &a) {
  const ir::NodeId zero = graph.constant(0);
  const auto &x = a.nodes;
  return {{3, 3}, {zero, graph.neg(x[2]), x[1], x[2], zero, graph.neg(x[0]), graph.neg(x[1]), x[0], zero}};
}

Array diagonal(ir::Graph &graph, const Array &a) {
  const int n = a.dims[0];
  Array result{{n, n}, std::vector<ir::NodeId>(static_cast<std::size_t>(n * n), graph.constant(0))};
  for (int i = 0; i < n; ++i)
    result.nodes[at(i, n, i)] = a.nodes[static_cast<std::size_t>(i)];
  return result;
}

Array identity(ir::Graph &graph, int n) {
  return diagonal(graph, {{n}, std::vector<ir::NodeId>(static_cast<std::size_t>(n), graph.constant(1))});
}

Array outerProduct(ir::Graph &graph, const Array &a, const Array &b) {
  Array result{{a.dims[0], b.dims[0]}, {}};
  for (const ir::NodeId left : a.nodes)
    for (const ir::NodeId right : b.nodes)
      result.nodes.push_back(graph.mul(left, right));
  return result;
}

Array symmetric(const Array &a) {
  Array result = a;
  const int n = a.dims[0];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      result.nodes[at(i, n, j)] = a.nodes[at(j, n, i)];
  return result;
}

}  // namespace tf::equations
