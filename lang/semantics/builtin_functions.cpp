#include "lang/semantics/builtin_functions.h"

#include "lang/semantics/diagnostics.h"

#include <algorithm>

namespace tf::semantics {

using flat::Function;

std::span<const BuiltinFunction> mathFunctions() {
  static const std::array kFunctions = {
      BuiltinFunction{"sqrt", Signature::Elementwise, Function::Sqrt, 1, 1, {"v"}},
      BuiltinFunction{"sin", Signature::Elementwise, Function::Sin, 1, 1, {"u"}},
      BuiltinFunction{"cos", Signature::Elementwise, Function::Cos, 1, 1, {"u"}},
      BuiltinFunction{"tan", Signature::Elementwise, Function::Tan, 1, 1, {"u"}},
      BuiltinFunction{"asin", Signature::Elementwise, Function::Asin, 1, 1, {"u"}},
      BuiltinFunction{"acos", Signature::Elementwise, Function::Acos, 1, 1, {"u"}},
      BuiltinFunction{"atan", Signature::Elementwise, Function::Atan, 1, 1, {"u"}},
      BuiltinFunction{"sinh", Signature::Elementwise, Function::Sinh, 1, 1, {"u"}},
      BuiltinFunction{"cosh", Signature::Elementwise, Function::Cosh, 1, 1, {"u"}},
      BuiltinFunction{"tanh", Signature::Elementwise, Function::Tanh, 1, 1, {"u"}},
      BuiltinFunction{"exp", Signature::Elementwise, Function::Exp, 1, 1, {"u"}},
      BuiltinFunction{"log", Signature::Elementwise, Function::Log, 1, 1, {"u"}},
      BuiltinFunction{"log10", Signature::Elementwise, Function::Log10, 1, 1, {"u"}},
      BuiltinFunction{"abs", Signature::Keeping, Function::Abs, 1, 1, {"v"}},
      BuiltinFunction{"sign", Signature::ToInteger, Function::Sign, 1, 1, {"v"}},
      BuiltinFunction{"integer", Signature::ToInteger, Function::Integer, 1, 1, {"x"}},
      BuiltinFunction{"floor", Signature::Rounding, Function::Floor, 1, 1, {"x"}},
      BuiltinFunction{"ceil", Signature::Rounding, Function::Ceil, 1, 1, {"x"}},
      BuiltinFunction{"div", Signature::Quotient, Function::Div, 2, 2, {"x", "y"}},
      BuiltinFunction{"mod", Signature::Quotient, Function::Mod, 2, 2, {"x", "y"}},
      BuiltinFunction{"rem", Signature::Quotient, Function::Rem, 2, 2, {"x", "y"}},
      BuiltinFunction{"atan2", Signature::TwoReals, Function::Atan2, 2, 2, {"u1", "u2"}},
  };
  return kFunctions;
}

const BuiltinFunction *findBuiltin(std::string_view name) {
  for (const auto functions : {mathFunctions(), operatorFunctions(), arrayFunctions()}) {
    const auto found = std::ranges::find(functions, name, &BuiltinFunction::name);
    if (found != functions.end())
      return &*found;
  }
  return nullptr;
}

bool isBuiltinFunction(std::string_view name) { return findBuiltin(name) != nullptr; }

bool expectArgument(Typer &typer, const ExprPtr &argument, bool isRight, std::string_view wanted) {
  if (!isRight)
    typer.diagnostics().report(diag::ArgumentType, argument->span, wanted, toString(argument->type));
  return isRight;
}

std::optional<int> constantSize(Typer &typer, const ExprPtr &value, std::string_view what) {
  if (!expectArgument(typer, value, value->type == Type{Base::Integer, {}}, "an Integer"))
    return std::nullopt;
  const auto known = constantValue(typer.context(), *value);
  if (!known) {
    reportNotConstant(typer.context(), *value, value->span, what);
    return std::nullopt;
  }
  // What is not needed may be of any size.
  if (typer.scope().isUnreached && (*known)[0] < 0)
    return 0;
  if ((*known)[0] < 0 || (*known)[0] > kMaximumArraySize) {
    typer.diagnostics().report(diag::DimensionNegative, value->span, (*known)[0]);
    return std::nullopt;
  }
  return static_cast<int>((*known)[0]);
}

namespace {

// Positional, then named arguments, in the order of the parameters. Nothing if they do not fit: reported.
std::optional<std::vector<const ast::Expr *>> arrangeArguments(Typer &typer, const BuiltinFunction &function, const ast::Expr &call) {
  std::vector<const ast::Expr *> arguments(call.operands.begin(), call.operands.end());
  for (const ast::NamedArgument &named : call.named) {
    const auto parameter = std::ranges::find(function.parameters, named.name.text);
    if (named.name.text.empty() || parameter == function.parameters.end()) {
      std::vector<std::string> names;
      for (const std::string_view name : function.parameters)
        if (!name.empty())
          names.emplace_back(name);
      typer.diagnostics().report(diag::UnknownArgument, named.name.span, function.name, named.name.text).suggest(named.name.text, names);
      return std::nullopt;
    }
    const auto position = static_cast<std::size_t>(parameter - function.parameters.begin());
    if (arguments.size() <= position)
      arguments.resize(position + 1, nullptr);
    if (arguments[position] != nullptr) {
      typer.diagnostics().report(diag::ArgumentTwice, named.name.span, named.name.text);
      return std::nullopt;
    }
    arguments[position] = named.value;
  }
  const auto count = static_cast<int>(arguments.size());
  const bool isComplete = std::ranges::none_of(arguments, [](const ast::Expr *argument) { return argument == nullptr; });
  if (count < function.minimum || (function.maximum >= 0 && count > function.maximum) || !isComplete) {
    const std::string range = function.maximum == function.minimum ? std::to_string(function.minimum)
                              : function.maximum < 0               ? fmt::format("at least {}", function.minimum)
                                                                   : fmt::format("{} to {}", function.minimum, function.maximum);
    const std::string wanted = range + (range == "1" || range == "at least 1" ? " argument" : " arguments");
    typer.diagnostics().report(diag::ArgumentCount, call.span, function.name, wanted, count);
    return std::nullopt;
  }
  return arguments;
}

ExprPtr typeQuotient(Typer &typer, const BuiltinFunction &function, std::vector<ExprPtr> arguments, Span span) {
  for (const ExprPtr &argument : arguments)
    if (!expectArgument(typer, argument, isNumeric(argument->type.base), "a number"))
      return nullptr;
  Base base = Base::Integer;
  for (const ExprPtr &argument : arguments)
    if (argument->type.base == Base::Real)
      base = Base::Real;
  if (function.signature == Signature::TwoReals || base == Base::Real)
    for (ExprPtr &argument : arguments)
      argument = toReal(argument);
  for (std::size_t i = 0; i < 2; ++i)
    if (arguments[i]->type.dims.empty())
      arguments[i] = broadcast(arguments[i], arguments[1 - i]->type.dims);
  if (arguments[0]->type.dims != arguments[1]->type.dims) {
    typer.diagnostics().report(diag::OperandTypes, span, function.name, toString(arguments[0]->type), toString(arguments[1]->type));
    return nullptr;
  }
  const Type type{function.signature == Signature::TwoReals ? Base::Real : base, arguments[0]->type.dims};
  return makeCall(function.function, type, std::move(arguments), span);
}

ExprPtr typeMath(Typer &typer, const BuiltinFunction &function, const std::vector<ExprPtr> &arguments, Span span) {
  if (function.signature == Signature::Quotient || function.signature == Signature::TwoReals)
    return typeQuotient(typer, function, arguments, span);
  const ExprPtr &argument = arguments[0];
  if (!expectArgument(typer, argument, isNumeric(argument->type.base), "a number"))
    return nullptr;
  switch (function.signature) {
  case Signature::Keeping:
    return makeCall(function.function, argument->type, {argument}, span);
  case Signature::ToInteger:
    return makeCall(function.function, {Base::Integer, argument->type.dims}, {toReal(argument)}, span);
  default:
    return makeCall(function.function, {Base::Real, argument->type.dims}, {toReal(argument)}, span);
  }
}

}  // namespace

ExprPtr typeBuiltinCall(Typer &typer, std::string_view name, const ast::Expr &call) {
  if (!call.iterators.empty())
    return typeReduction(typer, name, call);
  const BuiltinFunction &function = *findBuiltin(name);
  const auto arranged = arrangeArguments(typer, function, call);
  if (!arranged)
    return nullptr;
  std::vector<ExprPtr> arguments;
  for (const ast::Expr *argument : *arranged)
    arguments.push_back(typer.type(*argument));
  if (std::ranges::any_of(arguments, [](const ExprPtr &argument) { return argument == nullptr; }))
    return nullptr;
  for (const ExprPtr &argument : arguments)
    if (argument->type.base == Base::Rotation && !function.takesRotations) {
      (void)expectArgument(typer, argument, false, "a number or an array of numbers");
      return nullptr;
    }
  if (function.signature != Signature::Special)
    return typeMath(typer, function, arguments, call.span);
  return function.type(typer, arguments, call);
}

}  // namespace tf::semantics
