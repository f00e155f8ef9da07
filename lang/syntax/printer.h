// Writing the syntax tree as canonical source: one clause, equation or statement per line, operations inside others in parentheses except
// in chains of operators that bind alike. Reading the text again gives the same text. What could not be read is written `<error>`.
#pragma once

#include "lang/syntax/ast.h"

#include <string>

namespace tf::ast {

class Printer {
public:
  void file(const File &file);
  void expression(const Expr &expression);
  [[nodiscard]] std::string take() { return std::move(out_); }

private:
  // ---- text
  void write(std::string_view text) { out_ += text; }
  void line() { out_.append("\n").append(2 * static_cast<std::size_t>(indent_), ' '); }
  template <class T, class Item> void separated(const List<T> &items, Item &&item, std::string_view separator = ", ");

  // ---- expressions
  static bool isChain(const Expr &left, Operator op);
  void operand(const Expr *expression);
  void reference(const Reference &reference);
  void subscripts(const List<Expr *> &subscripts);
  void arguments(const Expr &call);
  void iterators(const List<ForIndex> &indices);
  void ifExpression(const Expr &expression);
  void binary(const Expr &expression);
  void optional(const Expr *expression);

  // ---- modifications
  void classModification(const Modification &modification);
  void modification(const Modification *modification);
  void argument(const Argument &argument);
  void comment(const Comment &comment);
  void annotation(const Modification *annotation);

  // ---- declarations
  void classDefinition(const ClassDefinition &definition);
  void heading(const ClassDefinition &definition);
  void shortClass(const ClassDefinition &definition);
  void body(const ClassDefinition &definition);
  void element(const Element &element);
  void import(const Import &import);
  void extends(const Extends &extends);
  void componentClause(const ComponentClause &clause);
  void component(const Component &component);
  void external(const External &external);
  template <class Constrained> void constraining(const Constrained &node);

  // ---- equations and statements
  void section(const Section &section);
  void equation(const Equation &equation);
  void statement(const Statement &statement);
  template <class Body> void bodyLines(const List<Body *> &body);
  template <class Body> void branches(std::string_view word, std::string_view other, const List<Branch<Body>> &branches);
  void node(const Equation &item) { equation(item); }
  void node(const Statement &item) { statement(item); }

  std::string out_;
  int indent_ = 0;
};

template <class T, class Item> void Printer::separated(const List<T> &items, Item &&item, std::string_view separator) {
  bool first = true;
  for (const T &each : items) {
    if (!first)
      write(separator);
    first = false;
    item(each);
  }
}

}  // namespace tf::ast
