// Functions that make, measure and reduce arrays (MLS 10.3).
#include "lang/semantics/builtin_functions.h"
#include "lang/semantics/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tf::semantics {

using flat::Function;

namespace {

using Arguments = std::vector<ExprPtr>;

ExprPtr typeNdims(Typer &, const Arguments &arguments, const ast::Expr &call) {
  return makeInteger(static_cast<double>(arguments[0]->type.dims.size()), call.span);
}

ExprPtr typeSize(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const std::vector<int> &dims = arguments[0]->type.dims;
  if (arguments.size() == 1) {
    if (!expectArgument(typer, arguments[0], !dims.empty(), "an array"))
      return nullptr;
    return makeLiteral({Base::Integer, {static_cast<int>(dims.size())}}, {dims.begin(), dims.end()}, call.span);
  }
  const auto dimension = constantSize(typer, arguments[1], "a dimension");
  if (!dimension)
    return nullptr;
  if (*dimension < 1 || *dimension > static_cast<int>(dims.size())) {
    typer.diagnostics().report(diag::SubscriptRange, arguments[1]->span, *dimension, dims.size());
    return nullptr;
  }
  return makeInteger(dims[static_cast<std::size_t>(*dimension - 1)], call.span);
}

ExprPtr typeScalar(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const std::vector<int> &dims = arguments[0]->type.dims;
  if (!expectArgument(typer, arguments[0], std::ranges::all_of(dims, [](int n) { return n == 1; }), "an array with one element"))
    return nullptr;
  return elementAt(arguments[0], std::vector<int>(dims.size(), 1), call.span);
}

ExprPtr reshape(const ExprPtr &value, std::vector<int> dims, Function function, Span span) {
  if (value->type.dims == dims)
    return value;
  if (value->kind == flat::ExprKind::Literal && value->type.base != Base::String)
    return makeLiteral({value->type.base, std::move(dims)}, value->values, span);
  return makeCall(function, {value->type.base, std::move(dims)}, {value}, span);
}

ExprPtr typeVector(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const std::vector<int> &dims = arguments[0]->type.dims;
  const auto longDims = std::ranges::count_if(dims, [](int n) { return n != 1; });
  if (!expectArgument(typer, arguments[0], longDims <= 1, "an array with one dimension longer than 1"))
    return nullptr;
  return reshape(arguments[0], {sizeOf(dims)}, Function::Vector, call.span);
}

ExprPtr typeMatrixOf(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  std::vector<int> dims = arguments[0]->type.dims;
  const bool fits = dims.size() <= 2 || std::all_of(dims.begin() + 2, dims.end(), [](int n) { return n == 1; });
  if (!expectArgument(typer, arguments[0], fits, "an array with at most two dimensions longer than 1"))
    return nullptr;
  dims.resize(2, 1);
  return reshape(arguments[0], dims, Function::Matrix, call.span);
}

ExprPtr typeIdentity(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const auto size = constantSize(typer, arguments[0], "the size of an array");
  if (!size)
    return nullptr;
  const auto n = static_cast<std::size_t>(*size);
  if (n > 1000) {
    typer.diagnostics().report(diag::ArrayTooLarge, call.span, kMaximumArraySize);
    return nullptr;
  }
  std::vector<double> values(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    values[i * n + i] = 1;
  return makeLiteral({Base::Integer, {*size, *size}}, std::move(values), call.span);
}

ExprPtr typeDiagonal(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const ExprPtr &value = arguments[0];
  if (!expectArgument(typer, value, value->type.dims.size() == 1 && isNumeric(value->type.base), "a vector"))
    return nullptr;
  const int n = value->type.dims[0];
  return makeCall(Function::Diagonal, {value->type.base, {n, n}}, {value}, call.span);
}

ExprPtr filled(Typer &typer, const ExprPtr &value, const Arguments &sizes, std::size_t first, Span span) {
  std::vector<int> dims;
  double total = sizeOf(value->type.dims);
  for (std::size_t i = first; i < sizes.size(); ++i) {
    const auto size = constantSize(typer, sizes[i], "the size of an array");
    if (!size)
      return nullptr;
    dims.push_back(*size);
    total *= *size;
  }
  if (total > kMaximumArraySize) {
    typer.diagnostics().report(diag::ArrayTooLarge, span, kMaximumArraySize);
    return nullptr;
  }
  return total > 0 ? broadcast(value, dims) : makeBlank(value->type, dims, span);
}

ExprPtr typeZeros(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return filled(typer, makeInteger(0, call.span), arguments, 0, call.span);
}

ExprPtr typeOnes(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return filled(typer, makeInteger(1, call.span), arguments, 0, call.span);
}

ExprPtr typeFill(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return filled(typer, arguments[0], arguments, 1, call.span);
}

// linspace(a, b, n)[i] = a + (b − a)(i − 1)/(n − 1)
ExprPtr typeLinspace(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const auto size = constantSize(typer, arguments[2], "the size of an array");
  if (!size)
    return nullptr;
  if (*size < 2) {
    typer.diagnostics().report(diag::ArgumentType, arguments[2]->span, "at least 2", *size);
    return nullptr;
  }
  Diagnostics &diagnostics = typer.diagnostics();
  const ExprPtr range = makeBinary(flat::Operator::Minus, arguments[1], arguments[0], call.span, diagnostics);
  std::vector<ExprPtr> points;
  for (int i = 0; i < *size; ++i) {
    const ExprPtr share = makeReal(static_cast<double>(i) / (*size - 1), call.span);
    const ExprPtr offset = makeBinary(flat::Operator::Times, share, range, call.span, diagnostics);
    points.push_back(makeBinary(flat::Operator::Plus, arguments[0], offset, call.span, diagnostics));
  }
  return makeArray(std::move(points), call.span, diagnostics);
}

ExprPtr typeMinMax(Typer &typer, const Arguments &arguments, const ast::Expr &call, Function function) {
  if (arguments.size() == 1) {
    if (!expectArgument(typer, arguments[0], !arguments[0]->type.dims.empty(), "an array"))
      return nullptr;
    return foldArray(typer, function, arguments[0], call.span);
  }
  for (const ExprPtr &argument : arguments)
    if (!expectArgument(typer, argument, argument->type.dims.empty() && argument->type.base != Base::String, "a scalar"))
      return nullptr;
  ExprPtr left = arguments[0], right = arguments[1];
  if (left->type.base == Base::Real)
    right = toReal(right);
  if (right->type.base == Base::Real)
    left = toReal(left);
  if (left->type != right->type) {
    typer.diagnostics().report(diag::OperandTypes, call.span, typer.context().sources.text(call.reference.span), toString(left->type),
                               toString(right->type));
    return nullptr;
  }
  const Type type = left->type;
  return makeCall(function, type, {left, right}, call.span);
}

ExprPtr typeMin(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return typeMinMax(typer, arguments, call, Function::Min);
}
ExprPtr typeMax(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return typeMinMax(typer, arguments, call, Function::Max);
}

ExprPtr typeTotal(Typer &typer, const Arguments &arguments, const ast::Expr &call, Function function) {
  const ExprPtr &value = arguments[0];
  if (!expectArgument(typer, value, isNumeric(value->type.base), "an array of numbers"))
    return nullptr;
  if (value->type.dims.empty())
    return value;
  return makeCall(function, {value->type.base, {}}, {value}, call.span);
}

ExprPtr typeSum(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return typeTotal(typer, arguments, call, Function::Sum);
}
ExprPtr typeProduct(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return typeTotal(typer, arguments, call, Function::Product);
}

ExprPtr typeTranspose(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  std::vector<int> dims = arguments[0]->type.dims;
  if (!expectArgument(typer, arguments[0], dims.size() == 2, "a matrix"))
    return nullptr;
  std::swap(dims[0], dims[1]);
  return makeCall(Function::Transpose, {arguments[0]->type.base, dims}, {arguments[0]}, call.span);
}

ExprPtr typeOuterProduct(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  for (const ExprPtr &argument : arguments)
    if (!expectArgument(typer, argument, argument->type.dims.size() == 1 && isNumeric(argument->type.base), "a vector"))
      return nullptr;
  return makeCall(Function::OuterProduct, {Base::Real, {arguments[0]->type.dims[0], arguments[1]->type.dims[0]}},
                  {toReal(arguments[0]), toReal(arguments[1])}, call.span);
}

ExprPtr typeSymmetric(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const std::vector<int> &dims = arguments[0]->type.dims;
  if (!expectArgument(typer, arguments[0], dims.size() == 2 && dims[0] == dims[1], "a square matrix"))
    return nullptr;
  return makeCall(Function::Symmetric, arguments[0]->type, {arguments[0]}, call.span);
}

ExprPtr typeCross(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  for (const ExprPtr &argument : arguments)
    if (!expectArgument(typer, argument, argument->type.dims == std::vector<int>{3} && isNumeric(argument->type.base), "a vector of 3"))
      return nullptr;
  return makeCall(Function::Cross, {Base::Real, {3}}, {toReal(arguments[0]), toReal(arguments[1])}, call.span);
}

ExprPtr typeSkew(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  if (!expectArgument(typer, arguments[0], arguments[0]->type.dims == std::vector<int>{3} && isNumeric(arguments[0]->type.base),
                      "a vector of 3"))
    return nullptr;
  return makeCall(Function::Skew, {Base::Real, {3, 3}}, {toReal(arguments[0])}, call.span);
}

ExprPtr typeCat(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  const auto dimension = constantSize(typer, arguments[0], "a dimension");
  if (!dimension)
    return nullptr;
  const auto rank = static_cast<int>(arguments[1]->type.dims.size());
  if (*dimension < 1 || *dimension > rank) {
    typer.diagnostics().report(diag::SubscriptRange, arguments[0]->span, *dimension, rank);
    return nullptr;
  }
  return makeConcatenation({arguments.begin() + 1, arguments.end()}, *dimension - 1, call.span, typer.diagnostics());
}

ExprPtr typeArrayOf(Typer &typer, const Arguments &arguments, const ast::Expr &call) {
  return makeArray(arguments, call.span, typer.diagnostics());
}

BuiltinFunction special(std::string_view name, int minimum, int maximum, ExprPtr (*type)(Typer &, const Arguments &, const ast::Expr &),
                        std::array<std::string_view, 4> parameters = {}) {
  return {name, Signature::Special, Function::Abs, minimum, maximum, parameters, type};
}

}  // namespace

std::span<const BuiltinFunction> arrayFunctions() {
  static const std::array kFunctions = {
      special("ndims", 1, 1, typeNdims),
      special("size", 1, 2, typeSize),
      special("scalar", 1, 1, typeScalar),
      special("vector", 1, 1, typeVector),
      special("matrix", 1, 1, typeMatrixOf),
      special("identity", 1, 1, typeIdentity, {"n"}),
      special("diagonal", 1, 1, typeDiagonal, {"v"}),
      special("zeros", 1, -1, typeZeros),
      special("ones", 1, -1, typeOnes),
      special("fill", 2, -1, typeFill),
      special("linspace", 3, 3, typeLinspace, {"x1", "x2", "n"}),
      special("min", 1, 2, typeMin),
      special("max", 1, 2, typeMax),
      special("sum", 1, 1, typeSum),
      special("product", 1, 1, typeProduct),
      special("transpose", 1, 1, typeTranspose),
      special("outerProduct", 2, 2, typeOuterProduct, {"v1", "v2"}),
      special("symmetric", 1, 1, typeSymmetric),
      special("cross", 2, 2, typeCross, {"x", "y"}),
      special("skew", 1, 1, typeSkew, {"x"}),
      special("cat", 2, -1, typeCat),
      special("array", 1, -1, typeArrayOf),
  };
  return kFunctions;
}

// A balanced tree of calls of two arguments.
ExprPtr foldArray(Typer &typer, Function function, const ExprPtr &array, Span span) {
  std::vector<ExprPtr> parts = scalars(array, span);
  if (parts.empty()) {
    typer.diagnostics().report(diag::ExtremeOfNothing, span, function == Function::Min ? "min" : "max");
    return nullptr;
  }
  while (parts.size() > 1) {
    std::vector<ExprPtr> halves;
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2)
      halves.push_back(makeCall(function, parts[i]->type, {parts[i], parts[i + 1]}, span));
    if (parts.size() % 2 == 1)
      halves.push_back(parts.back());
    parts = std::move(halves);
  }
  return parts[0];
}

namespace {

// Arrays are added element by element (MLS 10.3.4.1).
ExprPtr sumOfArrays(Typer &typer, const std::vector<ExprPtr> &parts, bool isSum, Span span) {
  ExprPtr result = parts[0];
  for (std::size_t i = 1; i < parts.size(); ++i)
    result = makeBinary(isSum ? flat::Operator::Plus : flat::Operator::Times, result, parts[i], span, typer.diagnostics());
  return result;
}

}  // namespace

ExprPtr typeReduction(Typer &typer, std::string_view name, const ast::Expr &call) {
  const ast::Expr &body = *call.operands[0];
  const bool isSum = name == "sum", isProduct = name == "product";
  const auto asArray = [&] {
    ast::Expr comprehension = call;
    comprehension.kind = ast::ExprKind::Array;
    return typer.type(comprehension);
  };
  if (name == "array")
    return asArray();
  if (!isSum && !isProduct && name != "min" && name != "max") {
    typer.diagnostics().report(diag::NotAReduction, call.reference.span, name);
    return nullptr;
  }
  std::vector<ExprPtr> parts;
  const bool isRight = typer.unroll(call.iterators, {&body}, [&](const Locals *locals) {
    parts.push_back(typer.nested(locals)->type(body));
    return parts.back() != nullptr;
  });
  if (!isRight)
    return nullptr;
  if (parts.empty()) {
    const ExprPtr none = asArray();
    if (none == nullptr || !(isSum || isProduct))
      return none == nullptr ? nullptr : foldArray(typer, name == "min" ? Function::Min : Function::Max, none, call.span);
    const auto iterators = static_cast<std::ptrdiff_t>(call.iterators.size());
    return broadcast(makeInteger(isProduct ? 1 : 0, call.span), {none->type.dims.begin() + iterators, none->type.dims.end()});
  }
  const ExprPtr all = makeArray(parts, call.span, typer.diagnostics());
  if (all == nullptr)
    return nullptr;
  if (!isSum && !isProduct)
    return foldArray(typer, name == "min" ? Function::Min : Function::Max, all, call.span);
  if (!expectArgument(typer, all, isNumeric(all->type.base), "numbers"))
    return nullptr;
  if (!parts[0]->type.dims.empty())
    return sumOfArrays(typer, parts, isSum, call.span);
  return makeCall(isSum ? Function::Sum : Function::Product, {all->type.base, {}}, {all}, call.span);
}

}  // namespace tf::semantics
