// One case for each production of lang/reference/grammar.ebnf: what is accepted, and as what it is read (the canonical text shows the
// structure); and close relatives that are not accepted.
#include "tests/unit/lang/syntax/parsed.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace tf {
namespace {

std::string canonical(const std::string &text) {
  const auto parsed = test::parse(text);
  return parsed.diagnostics.hasErrors() ? parsed.errors() : ast::print(parsed.file());
}

std::string canonicalExpression(const std::string &text) {
  const auto parsed = test::parseExpression(text);
  return parsed.diagnostics.hasErrors() ? parsed.errors() : ast::print(*parsed.tree.expression);
}

// ---- what is canonical already is kept ---------------------------------------------------------------------------------------------

class Kept : public testing::TestWithParam<const char *> {};

std::string inModel(const std::string &line) { return "model M\n  " + line + "\nend M;\n"; }
std::string inEquations(const std::string &lines) { return "model M\nequation\n  " + lines + "\nend M;\n"; }
std::string inAlgorithm(const std::string &lines) { return "function f\nalgorithm\n  " + lines + "\nend f;\n"; }

class KeptFile : public Kept {};
TEST_P(KeptFile, IsReadAndPrinted) { EXPECT_EQ(canonical(GetParam()), GetParam()); }
INSTANTIATE_TEST_SUITE_P(
    Grammar, KeptFile,
    testing::Values("", "within;\n", "within A.B;\nmodel M\nend M;\n", "final model M\nend M;\nmodel N\nend N;\n",
                    "encapsulated partial model M \"a\" + \"b\"\nend M;\n", "class C\nend C;\n", "block B\nend B;\n", "record R\nend R;\n",
                    "operator record R\nend R;\n", "connector C\nend C;\n", "expandable connector C\nend C;\n", "type T\nend T;\n",
                    "package P\nend P;\n", "operator O\nend O;\n", "function f\nend f;\n", "pure function f\nend f;\n",
                    "impure function f\nend f;\n", "operator function f\nend f;\n", "pure operator function f\nend f;\n",
                    "model extends M(a = 1) \"more\"\nend M;\n", "type T = Real(unit = \"m\") \"length\";\n", "connector C = input Real;\n",
                    "connector C = output .A.B[3, :];\n", "type E = enumeration(a, 'b' \"c\");\n", "type E = enumeration(:);\n",
                    "type E = enumeration();\n", "optimization O(objective = der(q)(finalTime) ^ 2)\nend O;\n",
                    "function g = der(f, x, y) \"derivative\";\n", "function g = f(a = 1) annotation(Inline = true);\n",
                    "optimization O\nend O;\n",
                    "optimization O(finalTime(free = true)) \"fast\"\n  extends M;\nconstraint\n  x <= 1;\nend O;\n",
                    "package P\n  optimization O(objective = x)\n  end O;\nend P;\n",
                    "model M\nprotected\n  Real x;\npublic\n  Real y;\nend M;\n",
                    "model M\nequation\ninitial equation\nalgorithm\ninitial algorithm\nend M;\n", "function f\nexternal;\nend f;\n",
                    "function f\nexternal \"C\" y = g(x, 1);\nend f;\n",
                    "function f\nexternal g() annotation(Library = \"m\");\n  annotation(Inline = true);\nend f;\n"));

class KeptElement : public Kept {};
TEST_P(KeptElement, IsReadAndPrinted) { EXPECT_EQ(canonical(inModel(GetParam())), inModel(GetParam())); }
INSTANTIATE_TEST_SUITE_P(
    Grammar, KeptElement,
    testing::Values("import A.B;", "import C = A.B \"text\";", "import A.*;", "import A.{b, c};", "extends A;",
                    "extends .A.B(x = 1) annotation(x);", "extends A(break c, break connect(a.p, b[1].n), x = 1);", "Real x;",
                    "Real x, y[2], z(start = 1) = 2 \"text\";", "Real[2, :] x = {1, 2};", ".A.B[n] x if n > 1 \"text\" annotation(y = 1);",
                    "flow Real x;", "stream output Real x;", "discrete input Real x;", "parameter output Real x = 1;",
                    "constant Integer n := 1;", "redeclare final inner outer replaceable Real x;",
                    "replaceable A x \"a\" constrainedby B(y = 1) \"b\";",
                    "replaceable package P = Q \"a\" constrainedby R \"b\" annotation(x = 1);", "model N\n  end N;",
                    "replaceable type T = Real constrainedby Real;", "A x(each final p.q(r = 1) = 2 \"text\", s = break);",
                    "A x(redeclare each final replaceable B y[2] = 1 \"a\" constrainedby C(z = 1));", "A x(replaceable model M = N);",
                    "A x(redeclare package P = Q(y = 1));", "A x(redeclare parameter Real y = 1 \"a\" annotation(b = 1));",
                    "A x(redeclare type E = enumeration(a, b));", "A x(redeclare function g = der(f, y));", "A x();",
                    "coordinate Real x(start = 1, der(start = 2, fixed = false)) \"text\", y[2];", "coordinate .A.B[2] x;",
                    "coordinate coordinate x;", "coordinate x;", "coordinate x[2];", "coordinate coordinate;", "A coordinate;",
                    "body b(mass = 1, position = q);", "Real body, contact, constraint, friction, gravity, force, potential;",
                    "optimization o;", "optimization o(x = 1);", "body block(mass = 1);", "A type[2], record;"));

class KeptEquation : public Kept {};
TEST_P(KeptEquation, IsReadAndPrinted) { EXPECT_EQ(canonical(inEquations(GetParam())), inEquations(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Grammar, KeptEquation,
                         testing::Values("x = 1 \"text\" annotation(y = 1);", "(a, , b) = f(x);", "0 = x;", "f(x);", "A.f(x, y = 1);",
                                         "connect(a.b[1], c) annotation(y = 1);",
                                         "if a then\n    x = 1;\n  elseif b then\n  else\n    x = 2;\n  end if;",
                                         "for i in 1:n, j in {1, 2}, k loop\n    x[i, j, k] = 1;\n  end for;",
                                         "when a then\n    reinit(x, 1);\n  elsewhen {b, c} then\n    y = 2;\n  end when;",
                                         "x = if a then b else c;", "block.x = 1;"));

class KeptConstraint : public Kept {};
TEST_P(KeptConstraint, IsReadAndPrinted) {
  const std::string text = std::string("optimization O\nconstraint\n  ") + GetParam() + "\nend O;\n";
  EXPECT_EQ(canonical(text), text);
}
INSTANTIATE_TEST_SUITE_P(Grammar, KeptConstraint,
                         testing::Values("x = 1;", "x <= 1;", "x >= y;", "x < 1;", "x > 1;", "q(finalTime) = {3, 0};",
                                         "der(q)(finalTime) = {0, 0};", "q[1](startTime) <= 2;",
                                         "for i in 1:2 loop\n    x[i] <= 1;\n  end for;", "if a then\n    x = 1;\n  end if;"));

class KeptStatement : public Kept {};
TEST_P(KeptStatement, IsReadAndPrinted) { EXPECT_EQ(canonical(inAlgorithm(GetParam())), inAlgorithm(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Grammar, KeptStatement,
                         testing::Values("x := 1 \"text\";", "x[1].y := {1, 2};", "(a, , b[1]) := f(x);", "() := f();", "f(x, y = 1);",
                                         "break;", "return;", "if a then\n    x := 1;\n  elseif b then\n    x := 2;\n  else\n  end if;",
                                         "for i in 1:2 loop\n    x := i;\n  end for;", "for i loop\n  end for;",
                                         "while x > 1 loop\n    x := x - 1;\n  end while;",
                                         "when a then\n    x := 1;\n  elsewhen b then\n    x := 2;\n  end when;"));

class KeptExpression : public Kept {};
TEST_P(KeptExpression, IsReadAndPrinted) { EXPECT_EQ(canonicalExpression(GetParam()), GetParam()); }
INSTANTIATE_TEST_SUITE_P(Grammar, KeptExpression,
                         testing::Values("1", "1.5e-3", ".5", "2.", "true", "false", "\"a\\\"b\"", "x", ".a.b[1, :].c", "'q r'.s", "a[end]",
                                         "a[end - 1, 2:end]", "f()", "f(1, g(2), b = 3)", "f(a = function g(b = 1), c = 2)",
                                         "f(function g(), 1)", "sum(i * j for i in 1:3, j)", "der(x)", "initial()", "pure(f(x))", "{1, 2}",
                                         "{i for i in {1, 2}}", "[1, 2; 3, 4]", "[[1], 2; x]", "(1)", "(a, , b)", "()", "(a)[1, end]",
                                         "1:2", "1:2:3", "-a", "not a", "if a then b elseif c then d else e", "a.block.model"));

// ---- precedence and association ----------------------------------------------------------------------------------------------------

struct Precedence {
  const char *text, *canonical;
};

std::ostream &operator<<(std::ostream &stream, const Precedence &each) { return stream << each.text; }

class Binding : public testing::TestWithParam<Precedence> {};
TEST_P(Binding, IsAsInModelica) { EXPECT_EQ(canonicalExpression(GetParam().text), GetParam().canonical); }
INSTANTIATE_TEST_SUITE_P(Grammar, Binding,
                         testing::Values(Precedence{"a+b*c^d", "a + (b * (c ^ d))"}, Precedence{"a-b-c", "a - b - c"},
                                         Precedence{"a-(b-c)", "a - (b - c)"}, Precedence{"a/b*c", "a / b * c"},
                                         Precedence{"-a*b", "-(a * b)"}, Precedence{"-a+b", "(-a) + b"}, Precedence{"-a^2", "-(a ^ 2)"},
                                         Precedence{"not a and b", "(not a) and b"}, Precedence{"not a<b", "not (a < b)"},
                                         Precedence{"a or b and c", "a or (b and c)"}, Precedence{"a or b or c", "a or b or c"},
                                         Precedence{"a<b+1", "a < (b + 1)"}, Precedence{"1:n+1", "1:(n + 1)"},
                                         Precedence{"a.*b.^c", "a .* (b .^ c)"}, Precedence{"2.*x", "2. * x"},
                                         Precedence{"if a then b else c+1", "if a then b else c + 1"}));

// ---- what is not accepted ----------------------------------------------------------------------------------------------------------

class Rejected : public testing::TestWithParam<const char *> {};
TEST_P(Rejected, HasAnError) { EXPECT_TRUE(test::parse(GetParam()).diagnostics.hasErrors()); }
INSTANTIATE_TEST_SUITE_P(
    Grammar, Rejected,
    testing::Values("model M end M", "model M end N;", "model end M;", "model M = ;", "type E = enumeration(a b);", "type E = enumeration;",
                    "function g = der(f);", "function g = der();", "operator M end M;;", "within 1;", "within a",
                    "model M import A.*.B; end M;", "model M import A.{}; end M;", "model M import A = B.*; end M;",
                    "model M extends; end M;", "model M Real; end M;", "model M Real x[]; end M;", "model M Real x(; end M;",
                    "model M Real x = ; end M;", "model M parameter parameter Real x; end M;", "model M flow stream Real x; end M;",
                    "model M replaceable x; end M;", "model M A x(redeclare y = 1); end M;", "model M A x(redeclare A y z); end M;",
                    "model M A x(a.b[1] = 2); end M;", "model M coordinate Real x = 1; end M;",
                    "model M coordinate Real[2] x := {1, 2}; end M;", "model M equation x; end M;", "model M equation connect(a); end M;",
                    "model M equation connect(a, 1); end M;", "model M equation if a then end M;",
                    "model M equation if then x = 1; end if; end M;", "model M equation when a then else x = 1; end when; end M;",
                    "model M equation for i in 1:2 x = 1; end for; end M;", "model M equation return; end M;",
                    "model M algorithm x = 1; end M;", "model M algorithm (a, b) := 1; end M;", "model M algorithm connect(a, b); end M;",
                    "model M equation x = (1; end M;", "model M equation x = 1); end M;", "model M equation x = f(a = ); end M;",
                    "model M equation x = f(1,); end M;", "model M equation x = {1,}; end M;", "model M equation x = []; end M;",
                    "model M equation x = [1;]; end M;", "model M equation x = a[end]]; end M;", "model M equation x = a b; end M;",
                    "model M equation x = 1 2; end M;", "model M equation x = not not a; end M;", "model M equation x = a < b < c; end M;",
                    "model M equation x = 1:2:3:4; end M;", "model M equation x = der; end M;", "model M equation x = a.1; end M;",
                    "model M equation x = f(x)[1]; end M;", "model M equation x = function f(); end M;",
                    "model M equation x = \"a\" \"b\" \"c\"; end M;", "model M equation x = q(1)(2); end M;",
                    "model M constraint x <= 1; end M;", "optimization O constraint x; end O;", "model M annotation; end M;",
                    "model M equation x = 1; Real y; end M;", "function f external \"C\" x.y(); end f;"));

// ---- whole files -------------------------------------------------------------------------------------------------------------------

TEST(Grammar, TheSeedsOfTheFuzzerAreAcceptedAndCanonicalAfterOnePrint) {
  int files = 0;
  for (const char *name : {"classes", "declarations", "equations", "algorithms", "expressions", "optimization", "mechanics"}) {
    std::ifstream stream(std::string(TF_SOURCE_DIR) + "/tests/fuzz/corpus/parse/" + name + ".tf");
    std::ostringstream text;
    text << stream.rdbuf();
    ASSERT_FALSE(text.str().empty()) << name;
    const std::string printed = canonical(text.str());
    EXPECT_EQ(canonical(printed), printed) << name;
    ++files;
  }
  EXPECT_EQ(files, 7);
}

TEST(Grammar, LinesMayEndInAnyWay) {
  for (const std::string end : {"\n", "\r\n", "\r"})
    EXPECT_EQ(canonical("model M // a" + end + "  Real x; // b" + end + "end M;" + end), "model M\n  Real x;\nend M;\n");
}

}  // namespace
}  // namespace tf
