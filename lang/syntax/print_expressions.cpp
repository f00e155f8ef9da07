// Expressions and modifications as text.
#include "lang/syntax/printer.h"

#include <algorithm>
#include <initializer_list>

namespace tf::ast {

namespace {

constexpr std::string_view error = "<error>";

std::string_view operatorText(Operator op) {
  switch (op) {
  case Operator::None:
    return "";
  case Operator::Plus:
    return "+";
  case Operator::Minus:
    return "-";
  case Operator::Times:
    return "*";
  case Operator::Divide:
    return "/";
  case Operator::Power:
    return "^";
  case Operator::DotPlus:
    return ".+";
  case Operator::DotMinus:
    return ".-";
  case Operator::DotTimes:
    return ".*";
  case Operator::DotDivide:
    return "./";
  case Operator::DotPower:
    return ".^";
  case Operator::And:
    return "and";
  case Operator::Or:
    return "or";
  case Operator::Not:
    return "not ";
  case Operator::Less:
    return "<";
  case Operator::LessEqual:
    return "<=";
  case Operator::Greater:
    return ">";
  case Operator::GreaterEqual:
    return ">=";
  case Operator::Equal:
    return "==";
  case Operator::NotEqual:
    return "<>";
  }
  return "";
}

}  // namespace

// A chain of operators that bind alike, `a - b + c`, needs no parentheses.
bool Printer::isChain(const Expr &left, Operator op) {
  const auto isIn = [&](std::initializer_list<Operator> level) {
    return std::find(level.begin(), level.end(), op) != level.end() && std::find(level.begin(), level.end(), left.op) != level.end();
  };
  return left.kind == ExprKind::Binary &&
         (isIn({Operator::Plus, Operator::Minus, Operator::DotPlus, Operator::DotMinus}) || isIn({Operator::And}) || isIn({Operator::Or}) ||
          isIn({Operator::Times, Operator::Divide, Operator::DotTimes, Operator::DotDivide}));
}

void Printer::operand(const Expr *expression) {
  const bool isCompound = expression->kind == ExprKind::Unary || expression->kind == ExprKind::Binary ||
                          expression->kind == ExprKind::Range || expression->kind == ExprKind::If;
  if (isCompound)
    write("(");
  this->expression(*expression);
  if (isCompound)
    write(")");
}

void Printer::optional(const Expr *expression) {
  if (expression != nullptr)
    this->expression(*expression);
}

void Printer::subscripts(const List<Expr *> &subscripts) {
  write("[");
  separated(subscripts, [&](const Expr *subscript) { expression(*subscript); });
  write("]");
}

void Printer::reference(const Reference &reference) {
  if (reference.leadingDot)
    write(".");
  separated(
      reference.parts,
      [&](const ReferencePart &part) {
        write(part.name.text.empty() ? error : part.name.text);
        if (part.hasSubscripts)
          subscripts(part.subscripts);
      },
      ".");
}

void Printer::iterators(const List<ForIndex> &indices) {
  separated(indices, [&](const ForIndex &index) {
    write(index.name.text);
    if (index.range != nullptr) {
      write(" in ");
      expression(*index.range);
    }
  });
}

void Printer::arguments(const Expr &call) {
  write("(");
  separated(call.operands, [&](const Expr *argument) { expression(*argument); });
  if (!call.operands.empty() && !call.named.empty())
    write(", ");
  separated(call.named, [&](const NamedArgument &argument) {
    write(argument.name.text);
    write(" = ");
    expression(*argument.value);
  });
  if (!call.iterators.empty()) {
    write(" for ");
    iterators(call.iterators);
  }
  write(")");
}

void Printer::ifExpression(const Expr &expression) {
  const auto &operands = expression.operands;
  for (std::size_t i = 0; i + 1 < operands.size(); i += 2) {
    write(i == 0 ? "if " : " elseif ");
    this->expression(*operands[i]);
    write(" then ");
    this->expression(*operands[i + 1]);
  }
  write(" else ");
  this->expression(*operands[operands.size() - 1]);
}

void Printer::binary(const Expr &expression) {
  if (isChain(*expression.operands[0], expression.op))
    this->expression(*expression.operands[0]);
  else
    operand(expression.operands[0]);
  write(" ");
  write(operatorText(expression.op));
  write(" ");
  operand(expression.operands[1]);
}

void Printer::expression(const Expr &expression) {
  const auto &operands = expression.operands;
  switch (expression.kind) {
  case ExprKind::Integer:
  case ExprKind::Real:
  case ExprKind::String:
  case ExprKind::Boolean:
    return write(expression.text);
  case ExprKind::Reference:
    return reference(expression.reference);
  case ExprKind::Unary:
    write(operatorText(expression.op));
    return operand(operands[0]);
  case ExprKind::Binary:
    return binary(expression);
  case ExprKind::Range:
    return separated(operands, [&](const Expr *part) { operand(part); }, ":");
  case ExprKind::If:
    return ifExpression(expression);
  case ExprKind::Call:
    reference(expression.reference);
    return arguments(expression);
  case ExprKind::PartialFunction:
    write("function ");
    reference(expression.reference);
    return arguments(expression);
  case ExprKind::Array:
    write("{");
    separated(operands, [&](const Expr *element) { this->expression(*element); });
    if (!expression.iterators.empty()) {
      write(" for ");
      iterators(expression.iterators);
    }
    return write("}");
  case ExprKind::Matrix:
    write("[");
    separated(operands, [&](const Expr *row) { separated(row->operands, [&](const Expr *element) { this->expression(*element); }); }, "; ");
    return write("]");
  case ExprKind::Tuple:
    write("(");
    separated(operands, [&](const Expr *element) { optional(element); });
    return write(")");
  case ExprKind::Subscripted:
    this->expression(*operands[0]);
    return subscripts({operands.data + 1, operands.count - 1});
  case ExprKind::ValueAt:
    this->expression(*operands[0]);
    write("(");
    this->expression(*operands[1]);
    return write(")");
  case ExprKind::End:
    return write("end");
  case ExprKind::Colon:
    return write(":");
  case ExprKind::Error:
    return write(error);
  }
}

// ---- modifications ---------------------------------------------------------------------------------------------------------------

void Printer::classModification(const Modification &modification) {
  write("(");
  separated(modification.arguments, [&](const Argument &each) { argument(each); });
  write(")");
}

void Printer::modification(const Modification *modification) {
  if (modification == nullptr)
    return;
  if (modification->hasArguments)
    classModification(*modification);
  if (modification->value == nullptr && !modification->isBreak)
    return;
  write(modification->isAssignment ? " := " : " = ");
  if (modification->isBreak)
    write("break");
  else
    expression(*modification->value);
}

void Printer::argument(const Argument &argument) {
  if (argument.isRedeclare)
    write("redeclare ");
  if (argument.isEach)
    write("each ");
  if (argument.isFinal)
    write("final ");
  if (argument.isReplaceable)
    write("replaceable ");
  switch (argument.kind) {
  case ArgumentKind::Element:
    reference(argument.path);
    modification(argument.modification);
    break;
  case ArgumentKind::Der:
    write("der");
    modification(argument.modification);
    break;
  case ArgumentKind::RedeclareClass:
    classDefinition(*argument.classDefinition);
    break;
  case ArgumentKind::RedeclareComponent:
    componentClause(*argument.component);
    break;
  case ArgumentKind::BreakComponent:
    write("break ");
    reference(argument.path);
    break;
  case ArgumentKind::BreakConnect:
    write("break ");
    equation(*argument.connect);
    break;
  }
  comment(argument.comment);
}

void Printer::annotation(const Modification *annotation) {
  write("annotation");
  classModification(*annotation);
}

void Printer::comment(const Comment &comment) {
  if (!comment.strings.empty())
    write(" ");
  separated(comment.strings, [&](std::string_view string) { write(string); }, " + ");
  if (comment.annotation != nullptr) {
    write(" ");
    annotation(comment.annotation);
  }
}

}  // namespace tf::ast
