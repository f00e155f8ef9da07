#include "compiler/equations/scalariser.h"

#include "compiler/equations/diagnostics.h"

#include <cassert>
#include <cmath>

namespace tf::equations {

using flat::Expr;
using flat::ExprKind;
using flat::Function;
using flat::Operator;
using ir::NodeId;
using ir::SymbolKind;

std::vector<NodeId> Scalariser::operator()(const Expr &expression) {
  const Array &value = array(expression);
  assert(static_cast<int>(value.nodes.size()) == expression.type.size());
  return value.nodes;
}

std::vector<NodeId> Scalariser::known(const Expr &expression) {
  for (const Events events : {Events::Discontinuous, Events::Continuous, Events::None})
    if (const auto found = known_.find({&expression, events}); found != known_.end())
      return found->second.nodes;
  return (*this)(expression);
}

const Array &Scalariser::array(const Expr &expression) {
  const std::pair key{&expression, events_};
  if (const auto found = known_.find(key); found != known_.end())
    return found->second;
  return known_[key] = compute(expression);
}

std::vector<Array> Scalariser::arrays(const std::vector<flat::ExprPtr> &expressions) {
  std::vector<Array> all;
  all.reserve(expressions.size());
  for (const flat::ExprPtr &expression : expressions)
    all.push_back(array(*expression));
  return all;
}

Array Scalariser::compute(const Expr &expression) {
  switch (expression.kind) {
  case ExprKind::Literal: {
    Array result{expression.type.dims, {}};
    for (const double value : expression.values)
      result.nodes.push_back(graph_.constant(value));
    return result;
  }
  case ExprKind::Variable:
    return variable(expression);
  case ExprKind::Attribute: {
    Array whole = elementValue_(expression);
    Array result{expression.type.dims, {}};
    for (const int position : selectedPositions(whole.dims, expression.indices))
      result.nodes.push_back(whole.nodes[static_cast<std::size_t>(position)]);
    return result;
  }
  case ExprKind::Time:
    return {{}, {graph_.symbol(SymbolKind::Time)}};
  case ExprKind::Unary:
    return unary(expression);
  case ExprKind::Binary:
    return binary(expression);
  case ExprKind::If:
    return conditional(expression);
  case ExprKind::Call:
    return call(expression);
  case ExprKind::Array: {
    Array result{expression.type.dims, {}};
    for (const flat::ExprPtr &arg : expression.args) {
      const Array part = array(*arg);
      result.nodes.insert(result.nodes.end(), part.nodes.begin(), part.nodes.end());
    }
    return result;
  }
  case ExprKind::Concatenate: {
    return concatenate(arrays(expression.args), expression.axis);
  }
  case ExprKind::Index: {
    const Array whole = array(*expression.args[0]);
    Array result{expression.type.dims, {}};
    for (const int position : selectedPositions(whole.dims, expression.indices))
      result.nodes.push_back(whole.nodes[static_cast<std::size_t>(position)]);
    return result;
  }
  case ExprKind::Derivative:
    return {expression.type.dims, timeDerivative(array(*expression.args[0]).nodes, expression.span)};
  }
  return {};
}

Array Scalariser::variable(const Expr &expression) {
  const flat::Variable &owner = variables_.model().variables[static_cast<std::size_t>(expression.variable)];
  const Place place = variables_.place(expression.variable);
  Array result{expression.type.dims, {}};
  Array constants;
  if (place.role == Role::Constant && owner.binding)
    constants = array(*owner.binding);
  for (const int position : selectedPositions(owner.type.dims, expression.indices)) {
    const int index = place.first + position;
    switch (place.role) {
    case Role::Parameter:
      result.nodes.push_back(graph_.symbol(SymbolKind::Parameter, index));
      break;
    case Role::Coordinate:
      result.nodes.push_back(graph_.symbol(SymbolKind::Coordinate, index));
      break;
    case Role::Velocity:
      result.nodes.push_back(graph_.symbol(SymbolKind::Velocity, index));
      break;
    case Role::Input:
      result.nodes.push_back(graph_.symbol(SymbolKind::Input, index));
      break;
    case Role::Unknown:
      result.nodes.push_back(graph_.symbol(SymbolKind::Unknown, provisionals_.variable(index, 0, expression.span)));
      break;
    case Role::Constant:
    case Role::Text:
      result.nodes.push_back(constants.nodes.empty() ? graph_.constant(0) : constants.nodes[static_cast<std::size_t>(position)]);
      break;
    }
  }
  return result;
}

template <class Operation> Array Scalariser::elementWise(const Expr &expression, const std::vector<Array> &args, Operation operation) {
  Array result{expression.type.dims, {}};
  const auto size = static_cast<std::size_t>(expression.type.size());
  std::vector<NodeId> scalars(args.size());
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t j = 0; j < args.size(); ++j)
      scalars[j] = args[j].dims.empty() ? args[j].nodes[0] : args[j].nodes[k];
    result.nodes.push_back(operation(std::span<const NodeId>(scalars)));
  }
  return result;
}

Array Scalariser::unary(const Expr &expression) {
  const bool isNot = expression.op == Operator::Not;
  return elementWise(expression, {array(*expression.args[0])},
                     [&](std::span<const NodeId> a) { return isNot ? negation(a[0]) : graph_.neg(a[0]); });
}

Array Scalariser::binary(const Expr &expression) {
  if (expression.op == Operator::Power)
    return power(expression);
  const Array a = array(*expression.args[0]);
  const Array b = array(*expression.args[1]);
  if (expression.op == Operator::Times)
    return multiply(graph_, a, b);
  return elementWise(expression, {a, b}, [&](std::span<const NodeId> s) { return scalarBinary(expression, s[0], s[1]); });
}

Array Scalariser::power(const Expr &expression) {
  const Array base = array(*expression.args[0]);
  const Array exponent = array(*expression.args[1]);
  if (base.dims.empty())
    return {{}, {graph_.binary(ir::Op::Pow, base.nodes[0], exponent.nodes[0])}};
  const ir::Node &power = graph_[exponent.nodes[0]];
  if (power.op != ir::Op::Constant)
    return unsupported(expression, "a power of a matrix whose exponent is not constant");
  return matrixPower(graph_, base, static_cast<int>(power.value));
}

Array Scalariser::conditional(const Expr &expression) {
  const NodeId condition = array(*expression.args[0]).nodes[0];
  return elementWise(expression, {array(*expression.args[1]), array(*expression.args[2])},
                     [&](std::span<const NodeId> s) { return select(condition, s[0], s[1]); });
}

Array Scalariser::call(const Expr &expression) {
  switch (expression.function) {
  case Function::NoEvent: {
    const Events outer = std::exchange(events_, Events::None);
    Array result = array(*expression.args[0]);
    events_ = outer;
    return result;
  }
  case Function::Smooth:
    return smooth(expression);
  case Function::Initial:
  case Function::Terminal:
  case Function::Pre:
  case Function::Edge:
  case Function::Change:
  case Function::Sample:
  case Function::String: {
    static constexpr std::string_view kNames[] = {"'initial'", "'terminal'", "'pre'", "'edge'", "'change'", "'sample'", "'String'"};
    return unsupported(expression, kNames[static_cast<int>(expression.function) - static_cast<int>(Function::Initial)]);
  }
  default:
    break;
  }
  if (expression.function >= Function::Sum && expression.function <= Function::Matrix)
    return arrayCall(expression);
  if (expression.function >= Function::Rotate && expression.function <= Function::AngularVelocity)
    return rotationCall(expression);
  return elementWise(expression, arrays(expression.args), [&](std::span<const NodeId> s) { return scalarCall(expression, s); });
}

Array Scalariser::arrayCall(const Expr &expression) {
  const std::vector<int> &dims = expression.type.dims;
  if (expression.function == Function::Identity)
    return identity(graph_, dims[0]);
  const Array a = array(*expression.args[0]);
  switch (expression.function) {
  case Function::Sum:
    return {{}, {graph_.sum(a.nodes)}};
  case Function::Product: {
    NodeId product = graph_.constant(1);
    for (const NodeId factor : a.nodes)
      product = graph_.mul(product, factor);
    return {{}, {product}};
  }
  case Function::Transpose:
    return transpose(a);
  case Function::Cross:
    return cross(graph_, a, array(*expression.args[1]));
  case Function::Skew:
    return skew(graph_, a);
  case Function::Diagonal:
    return diagonal(graph_, a);
  case Function::OuterProduct:
    return outerProduct(graph_, a, array(*expression.args[1]));
  case Function::Symmetric:
    return symmetric(a);
  case Function::Fill:
    return {dims, std::vector<NodeId>(static_cast<std::size_t>(expression.type.size()), a.nodes[0])};
  default:  // scalar, vector, matrix: the same numbers in another shape
    return {dims, a.nodes};
  }
}

Array Scalariser::rotationCall(const Expr &expression) {
  std::vector<Quaternion> q;
  std::vector<NodeId> others;
  for (const Array &arg : arrays(expression.args))
    if (arg.nodes.size() == 4)
      q.push_back({arg.nodes[0], arg.nodes[1], arg.nodes[2], arg.nodes[3]});
    else
      others.insert(others.end(), arg.nodes.begin(), arg.nodes.end());
  const auto of = [&](const auto &nodes) { return Array{expression.type.dims, {nodes.begin(), nodes.end()}}; };
  switch (expression.function) {
  case Function::Rotate:
    return of(rotate(graph_, q[0], {others[0], others[1], others[2]}));
  case Function::RotationProduct:
    return of(product(graph_, q[0], q[1]));
  case Function::Inverse:
    return of(conjugate(graph_, q[0]));
  case Function::RotationAbout:
    return of(rotationAbout(graph_, {others[0], others[1], others[2]}, others[3]));
  case Function::AngularVelocity:
    return of(angularVelocity(q[0], expression.span));
  default:  // its four numbers
    return of(q[0]);
  }
}

Vector3 Scalariser::angularVelocity(const Quaternion &q, Span span) {
  return variables_.motion().angularVelocity(graph_, q, [&](std::span<const NodeId> nodes) { return timeDerivative(nodes, span); });
}

Array Scalariser::smooth(const Expr &expression) {
  const ir::Node order = graph_[array(*expression.args[0]).nodes[0]];
  // From two continuous derivatives on, an integrator does not see the seam; below it is located, but cannot slide.
  const Events inside = order.op == ir::Op::Constant && order.value >= 2 ? Events::None : Events::Continuous;
  const Events outer = std::exchange(events_, events_ == Events::None ? Events::None : inside);
  Array result = array(*expression.args[1]);
  events_ = outer;
  return result;
}

Array Scalariser::unsupported(const Expr &expression, std::string_view name) {
  diagnostics_.report(diag::UnsupportedFunction, expression.span, name);
  return {expression.type.dims, std::vector<NodeId>(static_cast<std::size_t>(expression.type.size()), graph_.constant(0))};
}

std::vector<NodeId> Scalariser::timeDerivative(std::span<const NodeId> nodes, Span span) {
  const auto seed = [&](ir::Symbol symbol) -> NodeId {
    const auto index = static_cast<std::size_t>(symbol.index);
    switch (symbol.kind) {
    case SymbolKind::Time:
      return graph_.constant(1);
    case SymbolKind::Coordinate:
      return variables_.motion().rate(graph_, symbol.index);
    case SymbolKind::Velocity:
      return graph_.symbol(SymbolKind::Acceleration, symbol.index);
    case SymbolKind::Input:
      diagnostics_.report(diag::DerivativeOfInput, span, variables_.name(variables_.scalars(Role::Input)[index]));
      return graph_.constant(0);
    case SymbolKind::Acceleration:
    case SymbolKind::NormalForce:
    case SymbolKind::TangentForce:
    case SymbolKind::Multiplier:
      diagnostics_.report(diag::DerivativeOfForce, span, names_.describe(symbol));
      return graph_.constant(0);
    case SymbolKind::Unknown: {
      const Provisional of = provisionals_[symbol.index];
      // A step variable is constant within a mode; the derivative of a kink jumps.
      if (of.kind == Provisional::Kind::Switch) {
        provisionals_.makeDiscontinuous(of.index);
        return graph_.constant(0);
      }
      return graph_.symbol(SymbolKind::Unknown, provisionals_.variable(of.index, of.order + 1, span));
    }
    default:
      return graph_.constant(0);
    }
  };
  return ir::forwardDerivative(graph_, nodes, seed);
}

}  // namespace tf::equations
