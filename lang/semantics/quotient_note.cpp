#include "lang/semantics/quotient_note.h"

#include "lang/syntax/printer.h"

#include <fmt/format.h>

#include <algorithm>

namespace tf::semantics {

namespace {

// Without the parentheses that an argument does not need.
std::string textOf(const ast::Expr &expression) {
  if (expression.kind == ast::ExprKind::Tuple && expression.operands.size() == 1)
    return textOf(*expression.operands[0]);
  ast::Printer printer;
  printer.expression(expression);
  return printer.take();
}

}  // namespace

void noteQuotient(Diagnostic &diagnostic, const ast::Expr &written, const flat::Expr &value) {
  const bool isQuotient = value.kind == flat::ExprKind::Binary && value.op == flat::Operator::Divide &&
                          written.kind == ast::ExprKind::Binary && written.op == ast::Operator::Divide;
  if (!isQuotient ||
      !std::ranges::all_of(value.args, [](const flat::ExprPtr &arg) { return arg->type == flat::Type{flat::Base::Integer, {}}; }))
    return;
  diagnostic.note(written.span, fmt::format("'/' gives a Real; the whole part is 'div({}, {})'", textOf(*written.operands[0]),
                                            textOf(*written.operands[1])));
}

}  // namespace tf::semantics
