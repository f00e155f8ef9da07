// Forward and reverse differentiation (Griewank and Walther, Evaluating Derivatives, 2nd ed., chapters 3 and 6).
#include "compiler/ir/graph.h"
#include "compiler/ir/operations.h"
#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace tf::ir {

namespace {

// d f(a) / d a of a function of one argument; `id` is the node f(a).
NodeId unaryPartial(Graph &g, Op op, NodeId id, NodeId a) {
  const auto one = [&] { return g.constant(1); };
  switch (op) {
  case Op::Sqrt:
    return g.div(g.constant(0.5), id);
  case Op::Exp:
    return id;
  case Op::Log:
    return g.div(one(), a);
  case Op::Log10:
    return g.div(g.constant(1 / std::numbers::ln10), a);
  case Op::Sin:
    return g.unary(Op::Cos, a);
  case Op::Cos:
    return g.neg(g.unary(Op::Sin, a));
  case Op::Tan:
    return g.add(one(), g.mul(id, id));
  case Op::Asin:
    return g.div(one(), g.unary(Op::Sqrt, g.sub(one(), g.mul(a, a))));
  case Op::Acos:
    return g.div(g.constant(-1), g.unary(Op::Sqrt, g.sub(one(), g.mul(a, a))));
  case Op::Atan:
    return g.div(one(), g.add(one(), g.mul(a, a)));
  case Op::Sinh:
    return g.unary(Op::Cosh, a);
  case Op::Cosh:
    return g.unary(Op::Sinh, a);
  case Op::Tanh:
    return g.sub(one(), g.mul(id, id));
  case Op::Abs:
    return g.unary(Op::Sign, a);
  default:
    return g.constant(0);  // sign, floor, ceil and Booleans are piecewise constant
  }
}

// d a^b. The derivative to the base of a constant exponent has no logarithm, so that negative bases are right.
NodeId powerPartial(Graph &g, NodeId id, NodeId a, NodeId b, int k) {
  if (k == 1)
    return g.mul(id, g.unary(Op::Log, a));
  return g.mul(b, g.binary(Op::Pow, a, g.sub(b, g.constant(1))));
}

// d node / d operand k, of the operations that are neither linear, products nor choices.
NodeId partial(Graph &g, NodeId id, int k) {
  const Node node = g[id];
  const NodeId a = node.operands[0];
  const NodeId b = node.operands[1];
  if (node.op == Op::Pow)
    return powerPartial(g, id, a, b, k);
  if (node.op == Op::Atan2) {
    const NodeId squares = g.add(g.mul(a, a), g.mul(b, b));
    return g.div(k == 0 ? b : g.neg(a), squares);
  }
  return unaryPartial(g, node.op, id, a);
}

// d node in the direction in which its operands move by d[k].
NodeId tangent(Graph &g, NodeId id, const NodeId d[3]) {
  const Node node = g[id];
  const NodeId *x = node.operands;
  switch (node.op) {
  case Op::Neg:
    return g.neg(d[0]);
  case Op::Add:
    return g.add(d[0], d[1]);
  case Op::Sub:
    return g.sub(d[0], d[1]);
  case Op::Mul:
    return g.add(g.mul(d[0], x[1]), g.mul(x[0], d[1]));
  case Op::Div:
    return g.div(g.sub(d[0], g.mul(id, d[1])), x[1]);
  case Op::Min:
    return g.ternary(Op::IfElse, g.binary(Op::Less, x[1], x[0]), d[1], d[0]);
  case Op::Max:
    return g.ternary(Op::IfElse, g.binary(Op::Less, x[0], x[1]), d[1], d[0]);
  case Op::IfElse:
    return g.ternary(Op::IfElse, x[0], d[1], d[2]);
  case Op::Select:
    return g.add(g.mul(d[0], g.sub(x[1], x[2])), g.select(x[0], d[1], d[2]));
  default: {
    NodeId sum = g.constant(0);
    for (int k = 0; k < node.arity; ++k)
      if (!g.isConstant(d[k], 0))
        sum = g.add(sum, g.mul(partial(g, id, k), d[k]));
    return sum;
  }
  }
}

bool isChoice(Op op) { return op == Op::IfElse || op == Op::Select || op == Op::Min || op == Op::Max; }

// Its partial derivatives can be infinite or undefined at finite arguments.
bool isSingular(Op op) {
  switch (op) {
  case Op::Div:
  case Op::Pow:
  case Op::Sqrt:
  case Op::Exp:
  case Op::Log:
  case Op::Log10:
  case Op::Tan:
  case Op::Asin:
  case Op::Acos:
  case Op::Atan2:
  case Op::Sinh:
  case Op::Cosh:
    return true;
  default:
    return false;
  }
}

// The non-zero derivatives of a node: (index of the variable, node), ascending.
using SparseRow = std::vector<std::pair<int, NodeId>>;

// Derivatives of nodes with respect to several variables at once, by forward propagation of sparse rows, extended on demand.
class SparseForward {
public:
  SparseForward(Graph &graph, std::span<const NodeId> variables) : graph_(graph) {
    for (std::size_t k = 0; k < variables.size(); ++k) {
      assert(graph[variables[k]].op == Op::Symbol);
      rows_[variables[k]] = {{static_cast<int>(k), graph.constant(1)}};
    }
  }

  void extend(std::span<const NodeId> roots) {
    const Subgraph reached(graph_, roots);
    for (const NodeId id : reached.nodes())
      if (!rows_.contains(id))
        rows_.emplace(id, derive(id));
  }

  [[nodiscard]] const SparseRow &row(NodeId id) const { return rows_.at(id); }

private:
  SparseRow derive(NodeId id) {
    const Node node = graph_[id];
    SparseRow result;
    const SparseRow *rows[3] = {};
    std::size_t next[3] = {};
    for (int k = 0; k < node.arity; ++k)
      rows[k] = &rows_.at(node.operands[k]);
    const NodeId zero = graph_.constant(0);
    for (;;) {  // merges the operands' rows
      int variable = -1;
      for (int k = 0; k < node.arity; ++k)
        if (next[k] < rows[k]->size() && (variable < 0 || (*rows[k])[next[k]].first < variable))
          variable = (*rows[k])[next[k]].first;
      if (variable < 0)
        return result;
      NodeId d[3] = {zero, zero, zero};
      for (int k = 0; k < node.arity; ++k)
        if (next[k] < rows[k]->size() && (*rows[k])[next[k]].first == variable)
          d[k] = (*rows[k])[next[k]++].second;
      const NodeId value = tangent(graph_, id, d);
      if (!graph_.isConstant(value, 0))
        result.emplace_back(variable, value);
    }
  }

  Graph &graph_;
  std::unordered_map<NodeId, SparseRow> rows_;
};

// One reverse sweep over what the roots reach.
class Reverse {
public:
  Reverse(Graph &graph, std::span<const NodeId> roots, std::span<const NodeId> variables, SparseForward &branches)
      : graph_(graph), branches_(branches), reached_(graph, roots), zero_(graph.constant(0)),
        adjoints_(static_cast<std::size_t>(reached_.size()), zero_), active_(adjoints_.size(), 0), singular_(adjoints_.size(), 0),
        gradient_(variables.size(), zero_) {
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (const int position = reached_.position(variables[k]); position >= 0)
        active_[static_cast<std::size_t>(position)] = 1;
    for (std::size_t k = 0; k < active_.size(); ++k)
      classify(k);
  }

  void seed(NodeId root, NodeId weight) { accumulate(root, weight); }

  std::vector<NodeId> run(std::span<const NodeId> variables) {
    for (std::size_t k = adjoints_.size(); k-- > 0;)
      if (active_[k] != 0 && adjoints_[k] != zero_)
        pull(reached_.node(static_cast<int>(k)), adjoints_[k]);
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (const int position = reached_.position(variables[k]); position >= 0)
        gradient_[k] = graph_.add(gradient_[k], adjoints_[static_cast<std::size_t>(position)]);
    return std::move(gradient_);
  }

private:
  // Active: depends on the variables. Singular: 0·partial may be NaN somewhere between the variables and this node.
  void classify(std::size_t k) {
    const Node &node = graph_[reached_.node(static_cast<int>(k))];
    for (int j = 0; j < node.arity; ++j) {
      const auto operand = static_cast<std::size_t>(reached_.position(node.operands[j]));
      active_[k] |= active_[operand];
      singular_[k] |= singular_[operand];
    }
    if (active_[k] == 0)
      singular_[k] = 0;
    else if (isSingular(node.op))
      singular_[k] = 1;
  }

  void accumulate(NodeId id, NodeId contribution) {
    const int position = reached_.position(id);
    if (active_[static_cast<std::size_t>(position)] == 0)
      return;
    NodeId &adjoint = adjoints_[static_cast<std::size_t>(position)];
    adjoint = graph_.add(adjoint, contribution);
  }

  void pull(NodeId id, NodeId adjoint) {
    Graph &g = graph_;
    const Node node = g[id];
    const NodeId *x = node.operands;
    if (isChoice(node.op)) {
      pullChoice(id, adjoint);
      return;
    }
    switch (node.op) {
    case Op::Neg:
      accumulate(x[0], g.neg(adjoint));
      break;
    case Op::Add:
      accumulate(x[0], adjoint);
      accumulate(x[1], adjoint);
      break;
    case Op::Sub:
      accumulate(x[0], adjoint);
      accumulate(x[1], g.neg(adjoint));
      break;
    case Op::Mul:
      accumulate(x[0], g.mul(adjoint, x[1]));
      accumulate(x[1], g.mul(adjoint, x[0]));
      break;
    case Op::Div: {
      const NodeId share = g.div(adjoint, x[1]);
      accumulate(x[0], share);
      accumulate(x[1], g.neg(g.mul(share, id)));
      break;
    }
    default:
      for (int k = 0; k < node.arity; ++k)
        if (active_[static_cast<std::size_t>(reached_.position(x[k]))] != 0)
          accumulate(x[k], g.mul(adjoint, partial(g, id, k)));
    }
  }

  // The adjoint of a branch that is not taken is 0, and 0 times an infinite partial derivative inside it would be NaN. Where that is
  // possible, the choice is differentiated forwards, which selects derivatives instead of multiplying them.
  void pullChoice(NodeId id, NodeId adjoint) {
    const int position = reached_.position(id);
    if (singular_[static_cast<std::size_t>(position)] != 0) {
      branches_.extend(std::array{id});
      for (const auto &[variable, derivative] : branches_.row(id)) {
        NodeId &entry = gradient_[static_cast<std::size_t>(variable)];
        entry = graph_.add(entry, graph_.mul(adjoint, derivative));
      }
      return;
    }
    const Node node = graph_[id];
    NodeId direction[3] = {zero_, zero_, zero_};
    for (int k = 0; k < node.arity; ++k) {
      const bool isCondition = node.op == Op::IfElse && k == 0;
      if (isCondition || active_[static_cast<std::size_t>(reached_.position(node.operands[k]))] == 0)
        continue;
      if (node.op == Op::Select && k == 0) {
        accumulate(node.operands[0], graph_.mul(adjoint, graph_.sub(node.operands[1], node.operands[2])));
        continue;
      }
      direction[k] = adjoint;
      accumulate(node.operands[k], tangent(graph_, id, direction));
      direction[k] = zero_;
    }
  }

  Graph &graph_;
  SparseForward &branches_;
  Subgraph reached_;
  NodeId zero_;
  std::vector<NodeId> adjoints_;
  std::vector<char> active_, singular_;
  std::vector<NodeId> gradient_;
};

}  // namespace

std::vector<NodeId> forwardDerivative(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &seed) {
  const Subgraph reached(graph, roots);
  const NodeId zero = graph.constant(0);
  std::vector<NodeId> directions(static_cast<std::size_t>(reached.size()), zero);
  const auto directionOf = [&](NodeId id) { return directions[static_cast<std::size_t>(reached.position(id))]; };
  for (int k = 0; k < reached.size(); ++k) {
    const NodeId id = reached.node(k);
    const Node node = graph[id];
    if (node.op == Op::Symbol) {
      directions[static_cast<std::size_t>(k)] = seed(node.symbol);
      continue;
    }
    NodeId d[3] = {zero, zero, zero};
    bool moves = false;
    for (int j = 0; j < node.arity; ++j) {
      d[j] = directionOf(node.operands[j]);
      moves = moves || d[j] != zero;
    }
    if (moves)
      directions[static_cast<std::size_t>(k)] = tangent(graph, id, d);
  }
  std::vector<NodeId> result;
  result.reserve(roots.size());
  for (const NodeId root : roots)
    result.push_back(directionOf(root));
  return result;
}

std::vector<NodeId> reverseDerivative(Graph &graph, std::span<const NodeId> roots, std::span<const NodeId> weights,
                                      std::span<const NodeId> variables) {
  assert(roots.size() == weights.size());
  SparseForward branches(graph, variables);
  Reverse sweep(graph, roots, variables, branches);
  for (std::size_t k = 0; k < roots.size(); ++k)
    sweep.seed(roots[k], weights[k]);
  return sweep.run(variables);
}

std::vector<NodeId> jacobian(Graph &graph, std::span<const NodeId> roots, std::span<const NodeId> variables) {
  std::vector<NodeId> result(roots.size() * variables.size(), graph.constant(0));
  SparseForward forward(graph, variables);
  if (roots.size() < variables.size()) {
    for (std::size_t i = 0; i < roots.size(); ++i) {
      Reverse sweep(graph, roots.subspan(i, 1), variables, forward);
      sweep.seed(roots[i], graph.constant(1));
      const std::vector<NodeId> row = sweep.run(variables);
      std::copy(row.begin(), row.end(), result.begin() + static_cast<std::ptrdiff_t>(i * variables.size()));
    }
    return result;
  }
  forward.extend(roots);
  for (std::size_t i = 0; i < roots.size(); ++i)
    for (const auto &[variable, derivative] : forward.row(roots[i]))
      result[i * variables.size() + static_cast<std::size_t>(variable)] = derivative;
  return result;
}

}  // namespace tf::ir
