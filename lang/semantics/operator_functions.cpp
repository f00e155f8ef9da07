// der, noEvent, smooth, initial and other operators with function syntax (MLS 3.7).
#include "lang/semantics/builtin_functions.h"
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"

#include <algorithm>

namespace tf::semantics {

using flat::Function;

namespace {

// The first part of an expression that has no derivative: an input, a discrete variable, a result of an element (language.md 3).
const flat::Expr *findUndifferentiable(const Context &context, const flat::Expr &expr) {
  if (expr.variability <= Variability::Parameter)
    return nullptr;
  if (expr.kind == flat::ExprKind::Attribute)
    return &expr;
  if (expr.kind == flat::ExprKind::Variable) {
    // Those of an expression without a model are its user's business.
    if (context.model.variables.empty())
      return nullptr;
    const flat::Variable &variable = context.model.variables[static_cast<std::size_t>(expr.variable)];
    return variable.causality == flat::Causality::Input || variable.variability == Variability::Discrete ? &expr : nullptr;
  }
  for (const ExprPtr &arg : expr.args)
    if (const flat::Expr *found = findUndifferentiable(context, *arg))
      return found;
  return nullptr;
}

ExprPtr typeDer(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const ExprPtr &operand = arguments[0];
  if (operand->type.base == Base::Rotation) {
    const std::string text(typer.context().sources.text(operand->span));
    typer.diagnostics().report(diag::NoDerivative, operand->span, text,
                               fmt::format("a rotation; its angular velocity in the body's frame is '{}.w'", text));
    return nullptr;
  }
  if (!expectArgument(typer, operand, isNumeric(operand->type.base), "Real"))
    return nullptr;
  if (operand->variability <= Variability::Parameter)
    return broadcast(makeReal(0, call.span), operand->type.dims);
  if (const flat::Expr *wrong = findUndifferentiable(typer.context(), *operand)) {
    const bool isInput = wrong->kind == flat::ExprKind::Variable &&
                         typer.context().model.variables[static_cast<std::size_t>(wrong->variable)].causality == flat::Causality::Input;
    const std::string_view what = wrong->kind == flat::ExprKind::Attribute ? "a result of an element" : isInput ? "an input" : "discrete";
    typer.diagnostics().report(diag::NoDerivative, wrong->span, typer.context().sources.text(wrong->span), what);
    return nullptr;
  }
  return makeDerivative(operand, call.span);
}

ExprPtr typeNoEvent(Typer &, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  return makeCall(Function::NoEvent, arguments[0]->type, {arguments[0]}, call.span);
}

ExprPtr typeSmooth(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const auto order = constantSize(typer, arguments[0], "the order of smooth");
  if (!order)
    return nullptr;
  return makeCall(Function::Smooth, arguments[1]->type, {makeInteger(*order, arguments[0]->span), arguments[1]}, call.span);
}

ExprPtr typeInitial(Typer &, const std::vector<ExprPtr> &, const ast::Expr &call) {
  flat::Expr result;
  result.kind = flat::ExprKind::Call;
  result.function = Function::Initial;
  result.type = {Base::Boolean, {}};
  result.variability = Variability::Discrete;
  result.span = call.span;
  return std::make_shared<const flat::Expr>(std::move(result));
}

ExprPtr typeHomotopy(Typer &, const std::vector<ExprPtr> &arguments, const ast::Expr &) { return arguments[0]; }

// `semiLinear(x, k1, k2)` is `smooth(0, if x >= 0 then k1*x else k2*x)` (MLS 3.7.2.5).
ExprPtr typeSemiLinear(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const auto times = [&](const ExprPtr &slope) {
    return makeBinary(flat::Operator::Times, slope, arguments[0], call.span, typer.diagnostics());
  };
  const ExprPtr condition = makeBinary(flat::Operator::GreaterEqual, arguments[0], makeReal(0, call.span), call.span, typer.diagnostics());
  const ExprPtr value = makeIf(condition, times(arguments[1]), times(arguments[2]), call.span, typer.diagnostics());
  return value == nullptr ? nullptr : makeCall(Function::Smooth, value->type, {makeInteger(0, call.span), value}, call.span);
}

ExprPtr typeIntegerOf(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const ExprPtr &value = arguments[0];
  if (!expectArgument(typer, value, value->type.base == Base::Enumeration && value->type.dims.empty(), "an enumeration"))
    return nullptr;
  return makeCall(Function::Integer, {Base::Integer, {}}, {value}, call.span);
}

ExprPtr typeStringOf(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const ExprPtr &value = arguments[0];
  if (!expectArgument(typer, value, value->type.dims.empty(), "a scalar"))
    return nullptr;
  return makeCall(Function::String, {Base::String, {}}, {value}, call.span);
}

ExprPtr typeEventOperator(Typer &typer, const std::vector<ExprPtr> &, const ast::Expr &call) {
  typer.diagnostics().report(diag::NotSupported, call.reference.span,
                             fmt::format("'{}'", typer.context().sources.text(call.reference.span)));
  return nullptr;
}

ExprPtr typeInverse(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const ExprPtr &rotation = arguments[0];
  if (!expectArgument(typer, rotation, isRotation(rotation->type), "a Rotation"))
    return nullptr;
  return makeCall(Function::Inverse, rotation->type, {rotation}, call.span);
}

// Constant axes must have a direction.
ExprPtr typeRotationAbout(Typer &typer, const std::vector<ExprPtr> &arguments, const ast::Expr &call) {
  const ExprPtr axis = toReal(arguments[0]), angle = toReal(arguments[1]);
  if (!expectArgument(typer, axis, axis->type == Type{Base::Real, {3}}, "an axis of 3 elements") ||
      !expectArgument(typer, angle, angle->type == Type{Base::Real, {}}, "an angle"))
    return nullptr;
  const bool isZero = axis->kind == flat::ExprKind::Literal && std::ranges::all_of(axis->values, [](double v) { return v == 0; });
  if (!expectArgument(typer, axis, !isZero, "an axis that is not 0"))
    return nullptr;
  return makeCall(Function::RotationAbout, {Base::Rotation, {4}}, {axis, angle}, call.span);
}

ExprPtr typeStatement(Typer &typer, const std::vector<ExprPtr> &, const ast::Expr &call) {
  typer.diagnostics().report(diag::StatementAsValue, call.reference.span, typer.context().sources.text(call.reference.span));
  return nullptr;
}

BuiltinFunction special(std::string_view name, int minimum, int maximum,
                        ExprPtr (*type)(Typer &, const std::vector<ExprPtr> &, const ast::Expr &),
                        std::array<std::string_view, 4> parameters = {}, bool takesRotations = false) {
  return {name, Signature::Special, Function::Abs, minimum, maximum, parameters, type, takesRotations};
}

}  // namespace

std::span<const BuiltinFunction> operatorFunctions() {
  static const std::array kFunctions = {
      special("der", 1, 1, typeDer, {"expr"}, true),
      special("noEvent", 1, 1, typeNoEvent, {"expr"}, true),
      special("smooth", 2, 2, typeSmooth, {"p", "expr"}, true),
      special("initial", 0, 0, typeInitial),
      special("homotopy", 1, 2, typeHomotopy, {"actual", "simplified"}),
      special("semiLinear", 3, 3, typeSemiLinear, {"x", "k1", "k2"}),
      special("Integer", 1, 1, typeIntegerOf, {"e"}),
      special("String", 1, 4, typeStringOf, {"value", "significantDigits", "minimumLength", "leftJustified"}),
      special("inverse", 1, 1, typeInverse, {"R"}, true),
      special("rotation", 2, 2, typeRotationAbout, {"axis", "angle"}),
      special("pre", 1, 1, typeEventOperator),
      special("edge", 1, 1, typeEventOperator),
      special("change", 1, 1, typeEventOperator),
      special("sample", 1, 5, typeEventOperator),
      special("previous", 1, 1, typeEventOperator),
      special("hold", 1, 1, typeEventOperator),
      special("Clock", 0, 4, typeEventOperator),
      special("delay", 2, 3, typeEventOperator),
      special("terminal", 0, 0, typeEventOperator),
      special("cardinality", 1, 1, typeEventOperator),
      special("inStream", 1, 1, typeEventOperator),
      special("actualStream", 1, 1, typeEventOperator),
      special("spatialDistribution", 4, 6, typeEventOperator),
      special("getInstanceName", 0, 0, typeEventOperator),
      special("assert", 0, -1, typeStatement),
      special("terminate", 0, -1, typeStatement),
      special("reinit", 0, -1, typeStatement),
  };
  return kFunctions;
}

}  // namespace tf::semantics
