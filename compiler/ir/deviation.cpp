#include "compiler/ir/deviation.h"

#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace tf::ir {

namespace {

class Deviation {
public:
  explicit Deviation(Graph &graph) : g_(graph) {}

  // Of node `id`, whose operands deviate by r[k], not all of them zero. `isSquare`: its first operand is nowhere negative.
  NodeId of(NodeId id, const NodeId r[3], bool isSquare) {
    const Node node = g_[id];
    const NodeId *x = node.operands;
    switch (node.op) {
    case Op::Add:
    case Op::Sub:
      return g_.add(r[0], r[1]);
    case Op::Mul:  // a b' − a b and so on: |a| s + r (|b| + s)
      return g_.add(g_.mul(abs(x[0]), r[1]), g_.mul(r[0], g_.add(abs(x[1]), r[1])));
    case Op::Div:
      return quotient(id, x[1], r);
    case Op::Pow:
      return power(x, r, isSquare);
    case Op::Min:
    case Op::Max:
      return larger(r[0], r[1]);
    case Op::Less:
    case Op::LessEqual:
    case Op::Equal:
    case Op::And:
    case Op::Or:
    case Op::Not:
      return g_.constant(1);
    case Op::IfElse:
    case Op::Select: {  // a step variable is between 0 and 1: so is its change
      const NodeId either = larger(r[1], r[2]);
      return g_.isConstant(r[0], 0) ? either : g_.add(abs(g_.sub(x[1], x[2])), either);
    }
    default:
      return ofFunction(id, x[0], r[0], isSquare);
    }
  }

private:
  NodeId ofFunction(NodeId id, NodeId a, NodeId r, bool isSquare) {
    switch (g_[id].op) {
    case Op::Neg:
    case Op::Abs:
      return r;
    case Op::Sin:
    case Op::Cos:
    case Op::Tanh:
      return atMost(r, 2);
    case Op::Atan:
      return atMost(r, std::numbers::pi);
    case Op::Sign:
      return g_.constant(2);
    case Op::Floor:
    case Op::Ceil:
      return g_.add(r, g_.constant(1));
    case Op::Sqrt: {  // √a − √(a − r), which is more than √(a + r) − √a; not a number where the function is none
      const NodeId least = isSquare ? larger(g_.sub(a, r), g_.constant(0)) : g_.sub(a, r);
      return g_.div(r, g_.add(id, g_.unary(Op::Sqrt, least)));
    }
    case Op::Exp:
      return g_.mul(id, g_.sub(g_.unary(Op::Exp, r), g_.constant(1)));
    case Op::Log:
    case Op::Log10: {  // not a number where zero is reached
      const NodeId natural = g_.unary(Op::Log, g_.div(a, g_.sub(a, r)));
      return g_[id].op == Op::Log ? natural : g_.mul(g_.constant(1 / std::numbers::ln10), natural);
    }
    default:
      return infinity();
    }
  }

  // |a'/b' − a/b| = |a' b − a b'|/|b b'| ≤ (r + |a/b| s)/(|b| − s)
  NodeId quotient(NodeId id, NodeId b, const NodeId r[3]) {
    const NodeId least = g_.sub(abs(b), r[1]);
    const NodeId bound = g_.div(g_.add(r[0], g_.mul(abs(id), r[1])), least);
    return g_.isConstant(r[1], 0) ? bound : g_.ternary(Op::IfElse, g_.binary(Op::Less, g_.constant(0), least), bound, infinity());
  }

  // A convex function of |a| for constant exponents of at least 1; below 1 it is Hölder continuous. Negative numbers have no broken powers.
  NodeId power(const NodeId x[3], const NodeId r[3], bool isSquare) {
    const Node exponent = g_[x[1]];
    if (exponent.op != Op::Constant || !(exponent.value > 0))
      return infinity();
    const NodeId size = abs(x[0]);
    const NodeId bound = exponent.value < 1 ? g_.binary(Op::Pow, r[0], x[1])
                                            : g_.sub(g_.binary(Op::Pow, g_.add(size, r[0]), x[1]), g_.binary(Op::Pow, size, x[1]));
    if (isSquare || std::trunc(exponent.value) == exponent.value)
      return bound;
    return g_.ternary(Op::IfElse, g_.binary(Op::Less, x[0], r[0]), infinity(), bound);
  }

  // What is not a number stays so.
  NodeId atMost(NodeId r, double limit) {
    const NodeId most = g_.constant(limit);
    return g_.ternary(Op::IfElse, g_.binary(Op::Less, most, r), most, r);
  }
  NodeId larger(NodeId a, NodeId b) {
    if (g_.isConstant(a, 0))
      std::swap(a, b);
    const NodeId rise = g_.sub(a, b);  // of two that are not a number none is less
    return g_.isConstant(b, 0) ? g_.ternary(Op::IfElse, g_.binary(Op::Less, a, b), b, a)
                               : g_.add(b, g_.ternary(Op::IfElse, g_.binary(Op::Less, rise, g_.constant(0)), g_.constant(0), rise));
  }

  NodeId abs(NodeId a) { return g_.unary(Op::Abs, a); }
  NodeId infinity() { return g_.constant(std::numeric_limits<double>::infinity()); }

  Graph &g_;
};

// By its form, as a sum of squares.
bool isNeverNegative(const Graph &graph, NodeId id, const std::function<bool(NodeId)> &isOperandNeverNegative) {
  const Node &node = graph[id];
  switch (node.op) {
  case Op::Constant:
    return node.value >= 0;
  case Op::Add:
  case Op::Div:
    return isOperandNeverNegative(node.operands[0]) && isOperandNeverNegative(node.operands[1]);
  case Op::Mul:
    return node.operands[0] == node.operands[1] || (isOperandNeverNegative(node.operands[0]) && isOperandNeverNegative(node.operands[1]));
  case Op::Abs:
  case Op::Sqrt:
  case Op::Exp:
    return true;
  default:
    return false;
  }
}

}  // namespace

std::vector<NodeId> deviationBounds(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &radius) {
  const Subgraph reached(graph, roots);
  const NodeId zero = graph.constant(0);
  std::vector<NodeId> bounds(static_cast<std::size_t>(reached.size()), zero);
  std::vector<std::uint8_t> neverNegative(static_cast<std::size_t>(reached.size()), 0);
  const auto isSquare = [&](NodeId id) { return neverNegative[static_cast<std::size_t>(reached.position(id))] != 0; };
  const auto boundOf = [&](NodeId id) { return bounds[static_cast<std::size_t>(reached.position(id))]; };
  Deviation deviation(graph);
  for (int k = 0; k < reached.size(); ++k) {
    const NodeId id = reached.node(k);
    const Node node = graph[id];
    neverNegative[static_cast<std::size_t>(k)] = isNeverNegative(graph, id, isSquare) ? 1 : 0;
    NodeId r[3] = {zero, zero, zero};
    bool moves = false;
    for (int j = 0; j < node.arity; ++j) {
      r[j] = boundOf(node.operands[j]);
      moves = moves || r[j] != zero;
    }
    if (node.op == Op::Symbol)
      bounds[static_cast<std::size_t>(k)] = radius(node.symbol);
    else if (moves)
      bounds[static_cast<std::size_t>(k)] = deviation.of(id, r, isSquare(node.operands[0]));
  }
  std::vector<NodeId> result;
  result.reserve(roots.size());
  std::ranges::transform(roots, std::back_inserter(result), boundOf);
  return result;
}

}  // namespace tf::ir
