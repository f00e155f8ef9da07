// The builtin functions and operators with function syntax (MLS 3.7, 10.3).
#pragma once

#include "lang/semantics/typing.h"

#include <array>
#include <span>

namespace tf::semantics {

enum class Signature : std::uint8_t {
  Elementwise,  // Real function of one number
  Keeping,      // of one number, keeps its base type: abs
  ToInteger,    // of one number: integer, sign
  Rounding,     // of one number, the result is Real and changes in steps: floor, ceil
  Quotient,     // of two numbers, keeps Integer: div, mod, rem
  TwoReals,     // atan2
  Special,      // typed by a function of its own
};

struct BuiltinFunction {
  std::string_view name;
  Signature signature = Signature::Special;
  flat::Function function = flat::Function::Abs;
  int minimum = 1, maximum = 1;                                                         // number of arguments
  std::array<std::string_view, 4> parameters = {};                                      // names for named arguments
  ExprPtr (*type)(Typer &, const std::vector<ExprPtr> &, const ast::Expr &) = nullptr;  // Special
  bool takesRotations = false;
};

[[nodiscard]] std::span<const BuiltinFunction> mathFunctions();
[[nodiscard]] std::span<const BuiltinFunction> arrayFunctions();
[[nodiscard]] std::span<const BuiltinFunction> operatorFunctions();
[[nodiscard]] const BuiltinFunction *findBuiltin(std::string_view name);

// `sum(e for i in r)` and the like.
[[nodiscard]] ExprPtr typeReduction(Typer &typer, std::string_view name, const ast::Expr &call);
// Sum, product, minimum or maximum of all scalars of an array.
[[nodiscard]] ExprPtr foldArray(Typer &typer, flat::Function function, const ExprPtr &array, Span span);

// A non-negative Integer known now. Reported otherwise.
[[nodiscard]] std::optional<int> constantSize(Typer &typer, const ExprPtr &value, std::string_view what);
// Reports an argument of a wrong type.
[[nodiscard]] bool expectArgument(Typer &typer, const ExprPtr &argument, bool isRight, std::string_view wanted);

}  // namespace tf::semantics
