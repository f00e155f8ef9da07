// Symbolic execution of a function's algorithm: every variable's value is an expression of the arguments. Loops run over ranges that are
// known; where a condition is not known, both branches are executed and their results joined by if-expressions.
#pragma once

#include "lang/semantics/typing.h"

#include <deque>

namespace tf::semantics {

class FunctionBody {
public:
  // `isUnreached`: as of Scope.
  FunctionBody(Context &context, Class &function, bool isUnreached)
      : context_(context), function_(function), scope_(&function), isUnreached_(isUnreached) {}

  // Declares a variable; a null value: none yet.
  void declare(std::string_view name, Type type, ExprPtr value);
  // Runs all algorithm sections. False if there is an error: reported.
  bool run();
  // A typer for expressions of the body, with the present values.
  [[nodiscard]] Typer typer() const { return {context_, scopeWith(top())}; }
  // The value of a variable; null if it has none.
  [[nodiscard]] ExprPtr value(std::string_view name) const;
  // The type that a variable has been declared with.
  [[nodiscard]] const Type &typeOf(std::string_view name) const;

private:
  enum class Flow : std::uint8_t { Next, Break, Return, Error };

  [[nodiscard]] Scope scopeWith(const Locals *locals) const { return {scope_, locals, true, isUnreached_}; }
  [[nodiscard]] const Locals *top() const { return variables_.empty() ? nullptr : &variables_.back(); }
  Locals *find(std::string_view name);
  Flow runSections(Class &scope);
  Flow runAll(const ast::List<ast::Statement *> &statements, const Locals *iterators);
  Flow runStatement(const ast::Statement &statement, const Locals *iterators);
  Flow runIf(const ast::Statement &statement, std::size_t branch, const Locals *iterators);
  Flow joinBranches(const ast::Statement &statement, std::size_t branch, const ExprPtr &condition, const Locals *iterators);
  Flow runFor(const ast::Statement &statement, std::size_t level, const Locals *iterators);
  Flow runWhile(const ast::Statement &statement, const Locals *iterators);
  Flow runCall(const ast::Statement &statement, const Locals *iterators);
  Flow assignOutputs(const ast::Statement &statement, const Locals *iterators);
  Flow assign(const ast::Expr &target, const ExprPtr &value, const Locals *iterators);
  Flow fail(Span span, std::string_view what);
  ExprPtr type(const ast::Expr &expr, const Locals *iterators);
  // The value of a condition; nothing if it depends on anything but constants and parameters that are structural already.
  std::optional<bool> known(const flat::Expr &condition);
  // As well of other parameters, which become structural, as those do that sizes are on.
  std::optional<bool> settled(const flat::Expr &condition);
  bool isOverLimit(Span span);

  Context &context_;
  Class &function_;
  Class *scope_;  // the function or the base class whose algorithm runs
  bool isUnreached_;
  std::deque<Locals> variables_;
  long steps_ = 0;
};

}  // namespace tf::semantics
