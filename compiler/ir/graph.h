// The expression graph: hash-consed, acyclic, of real scalars; integer ids into one store.
//
// Semantics. Every node is a double. Booleans are 0 and 1. Division by zero, sqrt of a negative number and so on have IEEE values; nothing
// traps. `Select(alpha, a, b)` is a where alpha = 1, b where alpha = 0 (the other is not evaluated into the value: 0·NaN cannot occur) and
// alpha·a + (1 − alpha)·b between (theory.md section 5). `IfElse(c, a, b)` selects on a Boolean. A node's operands have smaller ids.
// Building a node simplifies it: constants are folded (never to a NaN or infinity), 0 + x, 1·x, 0·x, x − x, −(−x), x^1, x^2 → x·x, equal
// branches…
#pragma once

#include "lang/base/source.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tf::ir {

using NodeId = std::int32_t;

enum class SymbolKind : std::uint8_t {
  Time,
  Coordinate,
  Velocity,
  State,
  Input,
  Parameter,
  StepVariable,
  Acceleration,
  NormalForce,
  TangentForce,
  Multiplier,
  StateDerivative,
  Radius,   // half the width of a box in which a coordinate moves; after those of the coordinates, that of time
  Seed,     // component of the direction in which a sweep goes (function.h); occurs in what is linear in the seeds
  Unknown,  // a variable that an equation is yet to be solved for; occurs in no HybridSystem
};

struct Symbol {
  SymbolKind kind = SymbolKind::Time;
  std::int32_t index = 0;
  bool operator==(const Symbol &) const = default;
};

enum class Op : std::uint8_t {
  Constant,
  Symbol,
  Neg,
  Add,
  Sub,
  Mul,
  Div,
  Pow,  // Pow(a, b): integer constants b are multiplied out by code generation
  Sqrt,
  Exp,
  Log,
  Log10,
  Sin,
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Atan2,
  Sinh,
  Cosh,
  Tanh,
  Abs,
  Sign,
  Min,
  Max,
  Floor,
  Ceil,  // inside noEvent or where no event may happen
  Less,
  LessEqual,
  Equal,
  And,
  Or,
  Not,
  IfElse,
  Select,
};

struct Node {
  Op op = Op::Constant;
  std::uint8_t arity = 0;
  Symbol symbol;     // Op::Symbol
  double value = 0;  // Op::Constant
  NodeId operands[3] = {-1, -1, -1};
};

class Graph {
public:
  Graph();

  NodeId constant(double value);
  NodeId symbol(SymbolKind kind, int index = 0);
  NodeId unary(Op op, NodeId a);
  NodeId binary(Op op, NodeId a, NodeId b);
  NodeId ternary(Op op, NodeId a, NodeId b, NodeId c);

  NodeId add(NodeId a, NodeId b) { return binary(Op::Add, a, b); }
  NodeId sub(NodeId a, NodeId b) { return binary(Op::Sub, a, b); }
  NodeId mul(NodeId a, NodeId b) { return binary(Op::Mul, a, b); }
  NodeId div(NodeId a, NodeId b) { return binary(Op::Div, a, b); }
  NodeId neg(NodeId a) { return unary(Op::Neg, a); }
  // A balanced sum; the constant 0 for none.
  NodeId sum(std::span<const NodeId> terms);
  NodeId select(NodeId alpha, NodeId a, NodeId b) { return ternary(Op::Select, alpha, a, b); }

  [[nodiscard]] const Node &operator[](NodeId id) const { return nodes_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] bool isConstant(NodeId id, double value) const;

private:
  NodeId insert(const Node &node);
  NodeId operation(Op op, std::span<const NodeId> operands);  // as it stands, without simplification
  NodeId addition(NodeId a, NodeId b);
  NodeId subtraction(NodeId a, NodeId b);
  NodeId product(NodeId a, NodeId b);
  NodeId quotient(NodeId a, NodeId b);
  NodeId power(NodeId a, NodeId b);
  NodeId logical(Op op, NodeId a, NodeId b);
  void rehash(std::size_t slots);

  std::vector<Node> nodes_;
  std::vector<NodeId> table_;  // open addressing over nodes_; −1 free; a power of two of slots, at most half of them used
};

// Directional derivative (forward mode): d roots[k] along the direction that `seed` gives for each symbol (the constant 0 for those that do
// not move). One memoised sweep over everything the roots reach: its size is a constant times theirs.
[[nodiscard]] std::vector<NodeId> forwardDerivative(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &seed);

// Gradient of sum_k weights[k]·roots[k] with respect to `variables` (reverse mode, one sweep). `variables` are symbol nodes.
// Weights are treated as constants even where they depend on the variables. A branch that a Select or IfElse did not take never reaches the
// gradient, not even as 0·NaN.
[[nodiscard]] std::vector<NodeId> reverseDerivative(Graph &graph, std::span<const NodeId> roots, std::span<const NodeId> weights,
                                                    std::span<const NodeId> variables);

// Jacobian d roots[i] / d variables[j], row-major; structural zeros are the constant 0. Fewer rows than columns: one reverse sweep per row
// over what that row reaches; otherwise one forward sweep that carries only the non-zero derivatives of each node.
[[nodiscard]] std::vector<NodeId> jacobian(Graph &graph, std::span<const NodeId> roots, std::span<const NodeId> variables);

// The same nodes with symbols replaced (chain rule, elimination of solved variables). `replacement` returns -1 to keep a symbol.
[[nodiscard]] std::vector<NodeId> substitute(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &replacement);

// Symbols that each root depends on, sorted, without repetition (sparsity).
[[nodiscard]] std::vector<std::vector<Symbol>> dependencies(const Graph &graph, std::span<const NodeId> roots);
[[nodiscard]] bool dependsOn(const Graph &graph, NodeId root, const std::function<bool(Symbol)> &predicate);
// Whether one of the roots does: one pass over what they reach.
[[nodiscard]] bool dependsOn(const Graph &graph, std::span<const NodeId> roots, const std::function<bool(Symbol)> &predicate);

// Numerical value of the roots (tests, constant starts). Reference semantics of the operations for every back end.
[[nodiscard]] std::vector<double> evaluate(const Graph &graph, std::span<const NodeId> roots, const std::function<double(Symbol)> &value);
[[nodiscard]] double applyOperation(Op op, std::span<const double> operands);
// As evaluate() does: with constant integer powers multiplied out.
[[nodiscard]] double applyNode(const Graph &graph, const Node &node, std::span<const double> operands);

// Infix text with as few parentheses as the meaning needs; names of symbols by `name`. Where sharing would make the text much longer than
// the graph, shared subexpressions are named: "t7*t7 where t7 = sin(x)".
[[nodiscard]] std::string print(const Graph &graph, NodeId root, const std::function<std::string(Symbol)> &name);

// First violation of the graph's invariants (operand order, arity, uniqueness), empty if none.
[[nodiscard]] std::string verify(const Graph &graph);

}  // namespace tf::ir
