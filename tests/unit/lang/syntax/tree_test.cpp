// The structure of the tree: fields, spans, comments, lifetimes.
#include "tests/unit/lang/syntax/parsed.h"

#include <gtest/gtest.h>

namespace tf {
namespace {

using ast::ExprKind;
using ast::Operator;

const ast::Component &component(const test::Parsed &parsed, std::size_t element) {
  return parsed.firstClass().elements[element].component->components[0];
}

const ast::Equation &equation(const test::Parsed &parsed, std::size_t i) { return *parsed.firstClass().sections[0].equations[i]; }

TEST(Tree, ComponentClause) {
  const auto parsed = test::parse("model A\nprotected\n  final parameter input Real[3] a[2, :](unit = \"m\") = 1 if c \"text\";\nend A;\n");
  const ast::Element &element = parsed.firstClass().elements[0];
  EXPECT_TRUE(element.isProtected);
  EXPECT_TRUE(element.isFinal);
  const ast::ComponentClause &clause = *element.component;
  EXPECT_EQ(clause.variability, ast::Variability::Parameter);
  EXPECT_EQ(clause.causality, ast::Causality::Input);
  EXPECT_FALSE(clause.isCoordinate);
  EXPECT_EQ(parsed.sources.text(clause.prefixSpan), "parameter input");
  EXPECT_EQ(parsed.sources.text(clause.type.span), "Real");
  ASSERT_EQ(clause.subscripts.size(), 1U);
  const ast::Component &a = clause.components[0];
  EXPECT_EQ(a.name.text, "a");
  ASSERT_EQ(a.subscripts.size(), 2U);
  EXPECT_EQ(a.subscripts[1]->kind, ExprKind::Colon);
  EXPECT_EQ(a.modification->arguments[0].path.parts[0].name.text, "unit");
  EXPECT_EQ(a.modification->value->number, 1);
  EXPECT_EQ(a.condition->reference.parts[0].name.text, "c");
  EXPECT_EQ(a.comment.strings[0], "\"text\"");
  EXPECT_EQ(parsed.sources.text(a.span), "a[2, :](unit = \"m\") = 1 if c \"text\"");
  EXPECT_EQ(parsed.sources.text(element.span), "final parameter input Real[3] a[2, :](unit = \"m\") = 1 if c \"text\"");
}

TEST(Tree, CoordinateWithVelocity) {
  const auto parsed = test::parse("model A\n  coordinate Real q(start = 1, each der(start = 2));\n  coordinate q2;\nend A;\n");
  EXPECT_TRUE(parsed.firstClass().elements[0].component->isCoordinate);
  const ast::Argument &der = component(parsed, 0).modification->arguments[1];
  EXPECT_EQ(der.kind, ast::ArgumentKind::Der);
  EXPECT_TRUE(der.isEach);
  EXPECT_EQ(der.modification->arguments[0].path.parts[0].name.text, "start");
  EXPECT_EQ(parsed.sources.text(der.span), "each der(start = 2)");
  const ast::ComponentClause &named = *parsed.firstClass().elements[1].component;
  EXPECT_FALSE(named.isCoordinate);
  EXPECT_EQ(named.type.parts[0].name.text, "coordinate");
}

TEST(Tree, Operators) {
  const auto parsed = test::parseExpression("-a + b*c");
  const ast::Expr &sum = *parsed.tree.expression;
  ASSERT_EQ(sum.kind, ExprKind::Binary);
  EXPECT_EQ(sum.op, Operator::Plus);
  EXPECT_EQ(parsed.sources.text(sum.operatorSpan), "+");
  EXPECT_EQ(sum.operands[0]->kind, ExprKind::Unary);
  EXPECT_EQ(sum.operands[0]->op, Operator::Minus);
  EXPECT_EQ(sum.operands[1]->op, Operator::Times);
  EXPECT_EQ(parsed.sources.text(sum.operands[1]->span), "b*c");
  EXPECT_EQ(sum.height, 3);
}

TEST(Tree, Numbers) {
  const auto value = [](const char *text) { return test::parseExpression(text).tree.expression->number; };
  EXPECT_EQ(value("1.5e-3"), 1.5e-3);
  EXPECT_EQ(value("9007199254740993"), 9007199254740992.0);
  EXPECT_EQ(value("0.1"), 0.1);
  EXPECT_EQ(value("4.9e-324"), 4.9e-324);
  EXPECT_EQ(value("1e-400"), 0.0);
  EXPECT_EQ(value("true"), 1);
  EXPECT_EQ(value("false"), 0);
  EXPECT_EQ(test::parseExpression("12").tree.expression->kind, ExprKind::Integer);
  EXPECT_EQ(test::parseExpression("12.").tree.expression->kind, ExprKind::Real);
}

TEST(Tree, CallsAndReductions) {
  const auto parsed = test::parseExpression("f(1, a = 2, b = function g(c = 3))");
  const ast::Expr &call = *parsed.tree.expression;
  ASSERT_EQ(call.kind, ExprKind::Call);
  EXPECT_EQ(call.operands.size(), 1U);
  ASSERT_EQ(call.named.size(), 2U);
  EXPECT_EQ(call.named[1].value->kind, ExprKind::PartialFunction);
  const auto reduction = test::parseExpression("sum(i for i in 1:3, j)");
  ASSERT_EQ(reduction.tree.expression->iterators.size(), 2U);
  EXPECT_EQ(reduction.tree.expression->iterators[1].range, nullptr);
}

TEST(Tree, MatrixRowsAndTuples) {
  const auto parsed = test::parseExpression("[1, 2, 3; 4, 5, 6]");
  ASSERT_EQ(parsed.tree.expression->operands.size(), 2U);
  EXPECT_EQ(parsed.tree.expression->operands[0]->kind, ExprKind::Tuple);
  EXPECT_EQ(parsed.tree.expression->operands[1]->operands.size(), 3U);
  const auto tuple = test::parseExpression("(a, , b)");
  ASSERT_EQ(tuple.tree.expression->operands.size(), 3U);
  EXPECT_EQ(tuple.tree.expression->operands[1], nullptr);
}

TEST(Tree, ConditionsOfAnIfExpression) {
  const auto parsed = test::parseExpression("if a then 1 elseif b then 2 else 3");
  EXPECT_EQ(parsed.tree.expression->operands.size(), 5U);
}

TEST(Tree, ValuesAtATime) {
  const auto parsed = test::parse("optimization O\nconstraint\n  der(q)(finalTime) = 0;\n  q[1](2) <= 3;\n  q == 1;\nend O;\n");
  EXPECT_EQ(parsed.firstClass().sections[0].kind, ast::SectionKind::Constraint);
  const ast::Expr &value = *equation(parsed, 0).left;
  ASSERT_EQ(value.kind, ExprKind::ValueAt);
  EXPECT_EQ(value.operands[0]->kind, ExprKind::Call);
  EXPECT_EQ(value.operands[1]->reference.parts[0].name.text, "finalTime");
  EXPECT_EQ(equation(parsed, 1).kind, ast::EquationKind::Constraint);
  EXPECT_EQ(equation(parsed, 1).op, Operator::LessEqual);
  EXPECT_EQ(equation(parsed, 1).left->kind, ExprKind::Call);
  EXPECT_TRUE(equation(parsed, 1).left->reference.parts[0].hasSubscripts);
  EXPECT_EQ(equation(parsed, 2).op, Operator::Equal);
}

TEST(Tree, ConstraintIsReservedInOptimizationClassesOnly) {
  const auto parsed = test::parse("optimization O\n  model M\n    constraint c;\n  end M;\nconstraint\n  x = 1;\nend O;\n");
  ASSERT_EQ(parsed.errors(), "");
  EXPECT_EQ(parsed.firstClass().elements[0].classDefinition->elements[0].component->type.parts[0].name.text, "constraint");
  EXPECT_EQ(parsed.firstClass().sections.size(), 1U);
}

TEST(Tree, EquationsAndStatements) {
  const auto parsed = test::parse(R"(model A
equation
  if a then
    x = 1;
  else
    x = 2;
  end if;
  when b then
    y = 1;
  elsewhen c then
  end when;
  connect(p, q[1]);
  f(x) "call";
algorithm
  (u, v) := g(x);
  w := 1;
end A;
)");
  EXPECT_EQ(equation(parsed, 0).kind, ast::EquationKind::If);
  ASSERT_EQ(equation(parsed, 0).branches.size(), 2U);
  EXPECT_EQ(equation(parsed, 0).branches[1].condition, nullptr);
  EXPECT_EQ(equation(parsed, 1).kind, ast::EquationKind::When);
  EXPECT_EQ(equation(parsed, 1).branches[1].body.size(), 0U);
  EXPECT_EQ(equation(parsed, 2).kind, ast::EquationKind::Connect);
  EXPECT_EQ(parsed.sources.text(equation(parsed, 2).right->span), "q[1]");
  EXPECT_EQ(equation(parsed, 3).kind, ast::EquationKind::Call);
  EXPECT_EQ(parsed.sources.text(equation(parsed, 3).span), "f(x) \"call\"");
  const ast::Section &algorithm = parsed.firstClass().sections[1];
  EXPECT_EQ(algorithm.kind, ast::SectionKind::Algorithm);
  EXPECT_EQ(algorithm.statements[0]->kind, ast::StatementKind::MultiAssignment);
  EXPECT_EQ(algorithm.statements[1]->kind, ast::StatementKind::Assignment);
}

TEST(Tree, ClassForms) {
  const auto parsed = test::parse(R"(final encapsulated partial package P
  replaceable model M = N(a = 1) constrainedby O "text";
  type E = enumeration(one "first", two);
  function g = der(f, x, y);
  redeclare model extends Q(b = 2)
  end Q;
  function h
    external "C" y = sin(x) annotation(Library = "m");
    annotation(Inline = false);
  end h;
end P;
)");
  const ast::ClassDefinition &package = parsed.firstClass();
  EXPECT_TRUE(package.isFinal && package.isEncapsulated && package.isPartial);
  EXPECT_EQ(package.restriction, ast::Restriction::Package);
  EXPECT_EQ(package.endName.text, "P");
  const ast::ClassDefinition &replaceable = *package.elements[0].classDefinition;
  EXPECT_EQ(replaceable.form, ast::ClassForm::Short);
  EXPECT_TRUE(replaceable.hasConstraint);
  EXPECT_EQ(replaceable.constraintComment.strings[0], "\"text\"");
  EXPECT_EQ(package.elements[1].classDefinition->literals[0].comment.strings[0], "\"first\"");
  EXPECT_EQ(package.elements[2].classDefinition->derivativeVariables[1].text, "y");
  EXPECT_EQ(package.elements[3].classDefinition->form, ast::ClassForm::LongExtends);
  const ast::ClassDefinition &external = *package.elements[4].classDefinition;
  EXPECT_EQ(external.external->language, "\"C\"");
  EXPECT_EQ(external.external->function.text, "sin");
  EXPECT_EQ(external.external->annotation->arguments[0].path.parts[0].name.text, "Library");
  EXPECT_EQ(external.annotation->arguments.size(), 1U);
}

TEST(Tree, Imports) {
  const auto parsed = test::parse("model A\n  import X.Y;\n  import Z = X.Y;\n  import X.*;\n  import X.{a, b};\nend A;\n");
  const auto &elements = parsed.firstClass().elements;
  EXPECT_EQ(elements[0].import->kind, ast::ImportKind::Qualified);
  EXPECT_EQ(elements[1].import->kind, ast::ImportKind::Renaming);
  EXPECT_EQ(elements[1].import->alias.text, "Z");
  EXPECT_EQ(elements[2].import->kind, ast::ImportKind::Unqualified);
  EXPECT_EQ(elements[2].import->name.parts.size(), 1U);
  EXPECT_EQ(elements[3].import->kind, ast::ImportKind::List);
  EXPECT_EQ(elements[3].import->names[1].text, "b");
}

TEST(Tree, CommentsOfTheTextAreKept) {
  const auto parsed = test::parse("// one\nmodel A /* two */\nend A; // three");
  ASSERT_EQ(parsed.file().comments.size(), 3U);
  EXPECT_EQ(parsed.sources.text(parsed.file().comments[1]), "/* two */");
}

TEST(Tree, CanBeMoved) {
  auto parsed = test::parse("model A\n  Real x;\nend A;\n");
  ast::Tree tree = std::move(parsed.tree);
  EXPECT_EQ(tree.file->classes[0]->name.text, "A");
  tree = ast::Tree();
  EXPECT_EQ(tree.file, nullptr);
}

TEST(Tree, HeightsAreBounded) {
  std::string text = "1";
  for (int i = 1; i < ast::maxExpressionHeight; ++i)
    text += "+1";
  const auto highest = test::parseExpression(text);
  EXPECT_EQ(highest.errors(), "");
  EXPECT_EQ(highest.tree.expression->height, ast::maxExpressionHeight);
  EXPECT_EQ(test::parseExpression(text + "+1").diagnostics.errorCount(), 1);
}

}  // namespace
}  // namespace tf
