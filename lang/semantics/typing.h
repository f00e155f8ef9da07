// From syntax trees of expressions to typed expressions.
#pragma once

#include "lang/semantics/context.h"
#include "lang/semantics/expressions.h"

#include <functional>
#include <memory>

namespace tf::semantics {

// Iterators and function variables, innermost first. An array of a function may have values for some of its elements only: then `value` is
// null and `elements` has them, row-major.
struct Locals {
  const Locals *outer = nullptr;
  std::string_view name;
  ExprPtr value;
  Type type = {};
  std::vector<ExprPtr> elements = {};
};

// Where an expression stands.
struct Scope {
  Class *enclosing = nullptr;
  const Locals *locals = nullptr;
  bool isFunctionBody = false;
  bool isUnreached = false;  // behind a condition that is decided: its value is not needed
};

class Typer {
public:
  Typer(Context &context, Scope scope) : context_(context), scope_(scope) {}
  virtual ~Typer() = default;
  Typer(const Typer &) = delete;
  Typer &operator=(const Typer &) = delete;

  // Null if there is an error: it was reported.
  ExprPtr type(const ast::Expr &expr);

  // What a name stands for; the default looks it up in the scope.
  virtual ExprPtr reference(const ast::Reference &reference, Span span);
  virtual ExprPtr call(const ast::Expr &expr);

  // Positions that a subscript selects along a dimension.
  std::optional<flat::Selection> selection(const ast::Expr &subscript, int size);
  // One per subscript; nothing if there is an error. `span` covers the reference.
  std::optional<std::vector<flat::Selection>> selections(const ast::List<ast::Expr *> &subscripts, const std::vector<int> &dims, Span span);
  // The values of an iterator's range as literals.
  std::optional<std::vector<ExprPtr>> iteration(const ast::ForIndex &index, const std::vector<const ast::Expr *> &bodies);
  // Calls `body` with a typer for every combination of the iterators' values, the last one fastest. False if there is an error.
  bool unroll(const ast::List<ast::ForIndex> &iterators, const std::vector<const ast::Expr *> &bodies,
              const std::function<bool(const Locals *)> &body);

  [[nodiscard]] Context &context() { return context_; }
  [[nodiscard]] const Scope &scope() const { return scope_; }
  [[nodiscard]] Diagnostics &diagnostics() { return context_.diagnostics; }

  // The same scope with further local names.
  [[nodiscard]] std::unique_ptr<Typer> nested(const Locals *locals);

protected:
  [[nodiscard]] virtual std::unique_ptr<Typer> makeNested(const Locals *locals);

private:
  ExprPtr typeUnguarded(const ast::Expr &expr);
  bool isWithinLimits(const ExprPtr &typed, Span span);
  ExprPtr combine(const ast::Expr &expr, const ExprPtr &left, const ExprPtr &right);
  ExprPtr typeString(const ast::Expr &expr);
  ExprPtr typeBinary(const ast::Expr &expr);
  ExprPtr typeRange(const ast::Expr &expr);
  ExprPtr typeIf(const ast::Expr &expr);
  ExprPtr typeArray(const ast::Expr &expr);
  ExprPtr typeComprehension(const ast::Expr &expr, std::size_t level, const Locals *locals);
  ExprPtr typeEmpty(const ast::Expr &expr, std::size_t level, const Locals *locals);
  ExprPtr typeMatrix(const ast::Expr &expr);
  ExprPtr typeSubscripted(const ast::Expr &expr);
  ExprPtr typeReference(const ast::Reference &reference, Span span);
  ExprPtr typeLocal(const Locals &local, const ast::ReferencePart &part, Span span);
  bool unrollLevel(const ast::List<ast::ForIndex> &iterators, std::size_t level, const Locals *locals,
                   const std::vector<const ast::Expr *> &bodies, const std::function<bool(const Locals *)> &body);

  Context &context_;
  Scope scope_;
  std::vector<int> ends_;  // sizes of the dimensions whose subscripts are being typed: `end`
};

// Types an expression in `scope`.
[[nodiscard]] ExprPtr typeExpression(Context &context, const ast::Expr &expr, const Scope &scope);

// How a part of an expression is typed in a scope.
using PartTyping = std::function<ExprPtr(const ast::Expr &, const Scope &)>;
// Types an `if`. A condition on iterators, constants and sizes is decided: values behind it that are not needed are checked in a scope that
// says so. Their subscripts may leave their dimensions, as in if i == 1 then 0 else x[i - 1], and arrays may have another size.
[[nodiscard]] ExprPtr typeConditional(Context &context, const ast::Expr &expr, Scope scope, const PartTyping &typeCondition,
                                      const PartTyping &typeValue);

// Value known now: constants and parameters, which become structural. Not reported if there is none.
[[nodiscard]] std::optional<std::vector<double>> constantValue(Context &context, const flat::Expr &expr);
// Reports that `expr`, `what` is at `span`, has none; but not where a variable that it reads has a wrong binding, which has been reported.
void reportNotConstant(Context &context, const flat::Expr &expr, Span span, std::string_view what);
// The same of constants and parameters that are structural already, as sizes and ranges that have been typed make them.
[[nodiscard]] std::optional<std::vector<double>> settledValue(Context &context, const flat::Expr &expr);

// Calls of builtin functions (builtin_functions.cpp). `name` is the last part of the callee, e.g. "sin".
[[nodiscard]] bool isBuiltinFunction(std::string_view name);
[[nodiscard]] ExprPtr typeBuiltinCall(Typer &typer, std::string_view name, const ast::Expr &call);

// Calls of functions written in the language: their bodies are executed symbolically (function_call.cpp).
[[nodiscard]] ExprPtr typeFunctionCall(Typer &typer, Class &function, const ast::Expr &call);
// The same for all outputs. Nothing if there is an error: reported.
[[nodiscard]] std::optional<std::vector<ExprPtr>> typeFunctionOutputs(Typer &typer, Class &function, const ast::Expr &call);
// The function that a call's name stands for; null if it is a builtin one or unknown.
[[nodiscard]] Class *calledFunction(Typer &typer, const ast::Expr &call);

}  // namespace tf::semantics
