// Every kind of syntax error: a text that triggers it and nothing else, its exact message, and its range, which is marked @{ }@ in the
// text.
#include "lang/syntax/syntax_diagnostics.h"
#include "tests/unit/lang/syntax/parsed.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace tf {
namespace {

using namespace syntax;

struct Case {
  const DiagnosticKind *kind;
  std::string marked;
  std::string message;
  bool isExpression = false;
};

std::ostream &operator<<(std::ostream &stream, const Case &each) { return stream << each.kind->name << ": " << each.marked; }

// A declaration, an equation, a statement in a class around it.
std::string declaration(const std::string &text) { return "model A\n  " + text + "\nend A;\n"; }
std::string equation(const std::string &text) { return "model A\nequation\n  " + text + "\nend A;\n"; }
std::string statement(const std::string &text) { return "function f\nalgorithm\n  " + text + "\nend f;\n"; }
std::string constraint(const std::string &text) { return "optimization O\nconstraint\n  " + text + "\nend O;\n"; }

std::string nested(int depth) { return std::string(static_cast<std::size_t>(depth), '('); }

std::string sum(int terms) {
  std::string text = "1";
  for (int i = 1; i < terms; ++i)
    text += " + 1";
  return text;
}

// clang-format off
const std::vector<Case> cases = {
    // ---- characters and words
    {&InvalidUtf8, declaration("Real x \"@{\xFF\xFE}@\";"), "the byte 0xFF is not valid UTF-8"},
    {&InvalidUtf8, std::string("@{\xFF\xFE}@m\0o\0", 11), "the file seems to be UTF-16, which is not valid UTF-8"},
    {&InvalidCharacter, declaration("Real x = @{$}@y;"), "unexpected character '$'"},
    {&InvalidCharacter, declaration("Real @{\xC3\xA9}@;"), "unexpected character '\xC3\xA9' (U+00E9)"},
    {&InvalidCharacter, declaration("Real gr@{\xC3\xB6\xC3\x9F}@e;"), "unexpected character '\xC3\xB6' (U+00F6)"},
    {&InvalidCharacter, declaration(std::string("Real x;@{\0\0}@", 13)), "unexpected character U+0000"},
    {&InvalidCharacter, declaration(std::string("Real x \"a@{\0}@b\";", 17)), "unexpected character U+0000 in a string"},
    {&InvalidCharacter, declaration("Real 'a@{\xC3\xA9}@';"), "unexpected character U+00E9; a quoted name consists of printable ASCII characters"},
    {&InvalidCharacter, equation("x = a @{?}@ b : c;"), "unexpected character '?'"},
    {&InvalidCharacter, equation("x = 1; @{#}@ comment\n  y = 2;"), "unexpected character '#'"},
    {&UnknownOperator, equation("x = a @{!=}@ b;"), "'!=' is not an operator; write '<>'"},
    {&UnknownOperator, equation("x = a @{&&}@ b;"), "'&&' is not an operator; write 'and'"},
    {&UnknownOperator, equation("x = a@{**}@2;"), "'**' is not an operator; write '^'"},
    {&UnterminatedString, declaration("Real x @{\"metres;}@\n  Real y \"feet\";"), "this string has no closing '\"'"},
    {&UnterminatedString, declaration("Real x @{\"metres;}@\n  Real y;"), "this string has no closing '\"'"},
    {&UnterminatedComment, declaration("Real x; @{/*}@ length\n  Real y;"), "this comment has no closing '*/'"},
    {&UnterminatedName, declaration("Real @{'x}@ = 2;"), "this quoted name has no closing \"'\" on its line"},
    {&InvalidEscape, declaration("String s = \"a@{\\q}@b\";"), "'\\q' is not an escape sequence"},
    {&MalformedNumber, declaration("Real x = @{1.5e}@;"), "the number '1.5e' has no digits in its exponent"},
    {&MalformedNumber, declaration("Real x = @{1e+}@;"), "the number '1e+' has no digits in its exponent"},
    {&NumberOutOfRange, declaration("Real x = @{1e999}@;"), "the number 1e999 is too large for a Real"},
    {&KeywordAsName, declaration("Real @{in}@;"), "'in' is a keyword and cannot be a name; quote it to use it as one: ''in''"},
    {&KeywordAsName, equation("x = a.@{when}@;"), "'when' is a keyword and cannot be a name; quote it to use it as one: ''when''"},
    {&EmptyName, declaration("Real @{''}@;"), "a quoted name needs at least one character"},

    // ---- tokens in the wrong place
    {&UnexpectedToken, declaration("Real x @{y}@;"), "expected ';', got 'y'"},
    {&UnexpectedToken, declaration("Real x(start = 1 @{2}@);"), "expected ',' or ')', got '2'"},
    {&UnexpectedToken, equation("x = [1 @{2}@];"), "expected ',', ';' or ']', got '2'"},
    {&UnexpectedToken, declaration("Real @{5}@;"), "expected the name of a component of class 'Real', got '5'"},
    {&UnexpectedToken, declaration("Real@{}@\n  ;"), "expected the name of a component of class 'Real', got ';'"},
    {&UnexpectedToken, declaration("parameter m @{=}@ 1;"), "expected the name of a component of class 'm', got '='"},
    {&UnexpectedToken, equation("if x > 1@{}@\n    y = 2;\n  end if;"), "expected 'then', got 'y'"},
    {&UnexpectedToken, equation("for i in 1:3@{}@\n    y[i] = 2;\n  end for;"), "expected 'loop', got 'y'"},
    {&UnexpectedToken, equation("if a then\n    y = 2;\n  @{elsif}@ b then\n    y = 3;\n  end if;"), "expected 'elseif', got 'elsif'"},
    {&UnexpectedToken, equation("if a then\n    y = 2;\n  @{endif}@;"), "expected 'end if', got 'endif'"},
    {&UnexpectedToken, equation("if a then\n    y = 2;\n  end@{;}@"), "expected 'end if', got ';'"},
    {&UnexpectedToken, equation("x = if a then b@{;}@"), "expected 'else', got ';'"},
    {&UnexpectedToken, declaration("body b(mass = 1@{;}@ position = q);"), "expected ',', got ';'"},
    {&UnexpectedToken, equation("for i in 1:2 loop\n    x = i;\n  @{end}@\n  y = 2;"), "expected 'end for', got 'end'"},
    {&UnexpectedToken, equation("x = initial@{;}@"), "expected '(', got ';'"},
    {&UnexpectedToken, declaration("Real x;\n  @{end when}@;"), "expected 'end A', got 'end when'"},
    {&UnexpectedToken, "model A\nend@{;}@\n", "expected 'end A', got ';'"},
    {&UnexpectedToken, "model @{3}@D\n  Real x;\nend 3D;\n", "expected the name of the class, got '3'"},
    {&UnexpectedToken, "model A@{;}@\n  Real x;\nend A;\n", "expected the elements of the class, got ';'"},
    {&UnexpectedToken, "pure @{model}@ A\nend A;\n", "expected 'function', got 'model'"},
    {&UnexpectedToken, "expandable @{model}@ A\nend A;\n", "expected 'connector', got 'model'"},
    {&UnexpectedToken, "encapsulated @{Real}@ x;\n", "expected a class, as in 'model' or 'function', got 'Real'"},
    {&UnexpectedToken, declaration("Real x(@{=}@ 1);"), "expected a modification 'name = value' or 'name(…)', got '='"},
    {&UnexpectedToken, equation("x = f(function g(@{1}@));"), "expected 'name = value', got a positional argument"},
    {&UnexpectedToken, declaration("Real x \"a\" + @{2}@;"), "expected a string, got '2'"},
    {&UnexpectedToken, declaration("@{)}@;"), "expected a declaration, got ')'"},
    {&MissingSemicolon, declaration("Real x@{}@\n  Real y;"), "missing ';' after 'x'"},
    {&MissingSemicolon, equation("x = 1@{}@\n  y = 2;"), "missing ';' after '1'"},
    {&MissingSemicolon, equation("connect(a, b)@{}@ end A;\nmodel A"), "missing ';' after ')'"},
    {&MissingSemicolon, "model A\nend A@{}@", "missing ';' after 'A'"},
    {&MissingBracket, equation("x = f(1, 2@{;}@"), "missing ')' before ';'"},
    {&MissingBracket, equation("x = f({1, 2@{)}@;"), "missing '}' before ')'"},
    {&MissingBracket, declaration("Real x(start = 1@{}@\n  Real y;"), "missing ')' before 'Real'"},
    {&MissingBracket, equation("x = [1, 2; 3@{}@;\n  y = 1;"), "missing ']' before ';'"},
    {&MissingBracket, equation("x = a[1@{;}@"), "missing ']' before ';'"},
    {&TrailingText, "2*g @{3}@", "'3' after the end of the expression", true},
    {&TrailingText, "2*g@{;}@", "';' after the end of the expression", true},
    {&TooDeep, equation("x = " + nested(248) + "@{(}@" + nested(100) + "1;"), "this nests more than 250 levels deep"},
    {&TooDeep, equation("x = " + sum(2000) + " + @{1}@ + 1;"), "this nests more than 2000 levels deep"},

    // ---- expressions
    {&MissingExpression, equation("x = 1 +@{;}@"), "expected an expression, got ';'"},
    {&MissingExpression, equation("x =@{}@"), "expected an expression, got 'end'"},
    {&MissingExpression, equation("x = 1 + @{if}@ a then b else c;"), "expected an expression, got 'if'; an if-expression inside another needs parentheses"},
    {&MissingExpression, equation("x = {1, @{,}@ 2};"), "expected an expression, got ','"},
    {&MissingExpression, equation("@{=}@ 3;"), "expected an expression, got '='"},
    {&MissingExpression, "@{}@", "expected an expression, got the end of the file", true},
    {&EqualInExpression, equation("x = (a @{=}@ b);"), "'=' in an expression; the comparison is written '=='"},
    {&EqualInExpression, equation("if a @{=}@ b then\n    x = 1;\n  end if;"), "'=' in an expression; the comparison is written '=='"},
    {&EqualInExpression, equation("a = b @{=}@ c;"), "'=' in an expression; the comparison is written '=='"},
    {&EqualInExpression, equation("x = f(a.b @{=}@ 2);"), "'=' in an expression; the comparison is written '=='"},
    {&AssignInExpression, equation("x = (a @{:=}@ b);"), "':=' in an expression"},
    {&ChainedRelation, equation("x = a < b @{<}@ c;"), "'<' cannot be chained; join two comparisons with 'and'"},
    {&ChainedPower, equation("x = a^b@{^}@c;"), "'^' is not associative; write parentheses"},
    {&SignAfterOperator, equation("x = a*@{-}@b;"), "a sign cannot follow '*'; write parentheses"},
    {&MissingExpression, equation("x++@{;}@"), "expected an expression, got ';'"},
    {&SignAfterOperator, equation("x = a^@{-}@2;"), "a sign cannot follow '^'; write parentheses"},
    {&PositionalAfterNamed, equation("x = f(a = 1, @{2}@);"), "a positional argument cannot follow a named one"},
    {&EndOutsideSubscript, equation("x = @{end}@;"), "'end' stands for the last index, in subscripts only"},
    {&NotCallable, equation("x = der(q)@{(}@1);"), "the value of a call cannot be called; values at a time are for optimization classes"},
    {&ArrayElementMissing, equation("x = @{{}}@;"), "an array constructor needs at least one element; an empty array is written 'zeros(0)' or 'fill(value, 0)'"},

    // ---- equations and statements
    {&AssignInEquation, equation("x @{:=}@ 1;"), "':=' in an equation; equations are written with '='"},
    {&EqualInStatement, statement("x @{=}@ 1;"), "'=' in a statement; assignments are written with ':='"},
    {&ComparisonAsEquation, equation("x @{==}@ 1;"), "'==' compares; equations are written with '='"},
    {&IncompleteEquation, equation("@{x + 1}@;"), "this is no equation: '=' is missing"},
    {&IncompleteStatement, statement("x@{;}@"), "expected ':=' or a call, got ';'"},
    {&InvalidTarget, statement("@{der(x)}@ := 1;"), "only a variable or a list of variables in parentheses can be assigned to"},
    {&InvalidTarget, statement("(a, @{1}@) := f(x);"), "only a variable or a list of variables in parentheses can be assigned to"},
    {&MultipleNeedsCall, statement("(a, b) := @{{1, 2}}@;"), "a list of variables can only be assigned the results of a function call"},
    {&StatementInEquations, equation("@{while}@ x > 1 loop\n    x := 2;\n  end while;"), "'while' is a statement; it belongs into an algorithm"},
    {&StatementInEquations, equation("@{break}@;"), "'break' is a statement; it belongs into an algorithm"},
    {&EquationInAlgorithm, statement("@{connect}@(a, b);"), "'connect' is an equation; it belongs into an equation section"},
    {&ConnectArgument, equation("connect(a, @{b + 1}@);"), "'connect' takes two component references"},
    {&ConnectArgument, equation("@{connect(a)}@;"), "'connect' takes two component references"},
    {&ConstraintNeedsRelation, constraint("@{x(finalTime)}@;"), "a constraint needs one of '=', '<=', '>='"},
    {&InvalidConstraint, constraint("@{when}@ a then\n    x = 1;\n  end when;"), "'when' cannot stand in a constraint section"},
    {&InvalidConstraint, constraint("@{connect}@(a, b);"), "'connect' cannot stand in a constraint section"},

    // ---- blocks and sections
    {&MismatchedEnd, "model A\nend @{B}@;\n", "'end B' closes 'A'; write 'end A'"},
    {&MismatchedEnd, equation("for i in 1:2 loop\n    x[i] = 1;\n  end @{if}@;"), "'end if' closes 'for'; write 'end for'"},
    {&MissingEnd, "model A\n  Real x;@{}@\n", "'A' has no 'end A'"},
    {&MissingEnd, "package P\n  model M\n    Real x;\n@{end P}@;\n", "'M' has no 'end M'"},
    {&MissingEnd, equation("@{when}@ x > 1 then\n    y = 2;"), "'when' has no 'end when'"},
    {&MissingEnd, equation("@{if}@ a then\n    y = 2;\n  else if b then\n    y = 3;\n  end if;"), "'if' has no 'end if'"},
    {&UnknownSection, declaration("Real x;\n@{equations}@\n  x = 1;"), "unknown section 'equations'; did you mean 'equation'?"},
    {&UnknownSection, "optimization O\n@{constraints}@\n  x(finalTime) = 1;\nend O;\n", "unknown section 'constraints'; did you mean 'constraint'?"},
    {&UnknownSection, declaration("Real x;\n@{Public}@\n  Real y;"), "unknown section 'Public'; did you mean 'public'?"},
    {&EquationOutsideSection, declaration("Real x;\n  @{x}@ = 1;\n  der(x) = 2;"), "an equation needs the keyword 'equation' before it"},
    {&EquationOutsideSection, declaration("@{when}@ x > 1 then\n    y = 2;\n  end when;\n  Real z;"), "an equation needs the keyword 'equation' before it"},
    {&EquationOutsideSection, "function f\n  input Real x;\n  output Real y;\n  @{y}@ := x;\nend f;\n", "a statement needs the keyword 'algorithm' before it"},
    {&EquationOutsideSection, declaration("@{while}@ x > 1 loop\n    x := 2;\n  end while;"), "a statement needs the keyword 'algorithm' before it"},
    {&DeclarationInSection, equation("@{Real}@ x = 1;"), "a declaration cannot stand in the section 'equation'; move it up or write 'public' before it"},
    {&DeclarationInSection, equation("@{parameter}@ Real x = 1;"), "a declaration cannot stand in the section 'equation'; move it up or write 'public' before it"},
    {&DeclarationInSection, equation("@{SI.Angle}@ phi;"), "a declaration cannot stand in the section 'equation'; move it up or write 'public' before it"},
    {&DeclarationInSection, statement("@{Real}@ x;"), "a declaration cannot stand in the section 'algorithm'; move it up or write 'public' before it"},
    {&MisplacedAnnotation, declaration("@{annotation}@(Icon());\n  Real x;"), "the annotation of a class stands once, at its end"},
    {&MisplacedExternal, "function f\n  @{external}@ \"C\";\n  input Real x;\nend f;\n", "'external' stands once, after all declarations and sections"},
    {&MisplacedExternal, "function f\n  external \"C\";\n  @{external}@ \"C\";\nend f;\n", "'external' stands once, after all declarations and sections"},
    {&MisplacedWithin, "model A\nend A;\n@{within}@ P;\n", "'within' stands once, at the start of the file"},
    {&MisplacedOptimization, "model A\n  @{optimization}@ O(finalTime = 1)\n    extends B;\n  constraint\n    x <= 1;\n  end O;\nend A;\n", "an optimization class stands at top level or in a package"},
    {&ExpectedClass, "@{x}@ = 1;\nmodel A\nend A;\n", "expected a class definition, got 'x'"},

    // ---- declarations and modifications
    {&PrefixConflict, declaration("parameter @{constant}@ Real x;"), "'parameter' and 'constant' exclude each other"},
    {&PrefixConflict, declaration("input @{output}@ Real x;"), "'input' and 'output' exclude each other"},
    {&PrefixConflict, declaration("parameter @{coordinate}@ Real x;"), "'parameter' and 'coordinate' exclude each other"},
    {&PrefixConflict, declaration("coordinate @{input}@ Real x;"), "'coordinate' and 'input' exclude each other"},
    {&PrefixOrder, declaration("input @{parameter}@ Real x;"), "'parameter' stands before 'input'"},
    {&PrefixOrder, declaration("parameter @{final}@ Real x;"), "'final' stands before 'parameter'"},
    {&PrefixOrder, declaration("inner @{final}@ Real x;"), "'final' stands before 'inner'"},
    {&PrefixOrder, declaration("A a(final @{each}@ b = 1);"), "'each' stands before 'final'"},
    {&PrefixOrder, "partial @{encapsulated}@ model A\nend A;\n", "'encapsulated' stands before 'partial'"},
    {&PrefixNotAllowed, declaration("@{final}@ import B;"), "'final' cannot stand before 'import'"},
    {&PrefixNotAllowed, declaration("@{each}@ Real x;"), "'each' cannot stand before a declaration; it is for modifications"},
    {&CoordinateBinding, declaration("coordinate Real x = @{3}@;"), "a coordinate has no binding; its initial value is 'x(start = …)'"},
    {&ConstrainedNotReplaceable, declaration("B b @{constrainedby}@ C;"), "'constrainedby' needs 'replaceable' before the element"},
    {&DerModifier, declaration("coordinate Real x(@{der}@ = 3);"), "'der' in a modification takes a list in parentheses, 'der(start = …)'"},
    {&LongClassInModifier, declaration("B b(redeclare model @{M}@ Real x; end M);"), "only a short class definition, 'M = …', can stand in a modification"},
    {&BreakOutsideExtends, declaration("B b(@{break}@ c);"), "'break' here is for the modification of an extends clause"},
    {&UnknownWord, declaration("@{paramter}@ Real x = 1;"), "unknown word 'paramter'; did you mean 'parameter'?"},
    {&UnknownWord, declaration("final @{cordinate}@ A.B[2] x(start = 1);"), "unknown word 'cordinate'; did you mean 'coordinate'?"},
    {&UnknownWord, "@{modle}@ A\n  Real x;\nend A;\n", "unknown word 'modle'; did you mean 'model'?"},
    {&UnknownWord, declaration("@{fucntion}@ f \"text\"\n    input Real x;\n  end f;"), "unknown word 'fucntion'; did you mean 'function'?"},
    {&UnknownSection, declaration("Real x;\n@{intial equation}@\n  x = 1;"), "unknown section 'intial equation'; did you mean 'initial equation'?"},
    {&ShortOptimization, "optimization O @{=}@ P;\n", "an optimization class has no short form"},
};
// clang-format on

class SyntaxDiagnostic : public testing::TestWithParam<Case> {};

TEST_P(SyntaxDiagnostic, HasMessageAndRange) {
  std::string text = GetParam().marked;
  const std::size_t begin = text.find("@{");
  ASSERT_NE(begin, std::string::npos);
  text.erase(begin, 2);
  const std::size_t end = text.find("}@", begin);
  ASSERT_NE(end, std::string::npos);
  text.erase(end, 2);
  const auto parsed = GetParam().isExpression ? test::parseExpression(text) : test::parse(text);
  ASSERT_EQ(parsed.diagnostics.all().size(), 1U) << parsed.errors();
  const Diagnostic &diagnostic = parsed.diagnostics.all()[0];
  EXPECT_EQ(diagnostic.kind, GetParam().kind) << diagnostic.kind->name;
  EXPECT_EQ(diagnostic.message, GetParam().message);
  EXPECT_EQ(diagnostic.span, (Span{0, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)})) << parsed.errors();
}

INSTANTIATE_TEST_SUITE_P(All, SyntaxDiagnostic, testing::ValuesIn(cases),
                         [](const auto &each) { return fmt::format("{}_{}", each.param.kind->name, each.index); });

const DiagnosticKind *const allKinds[] = {
#define TF_DIAGNOSTIC(name, code, severity, format) &name,
#include "lang/syntax/diagnostics.def"
#undef TF_DIAGNOSTIC
};

TEST(SyntaxDiagnostics, EveryKindHasACaseAndAPage) {
  for (const DiagnosticKind *kind : allKinds) {
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const Case &each) { return each.kind == kind; })) << kind->name;
    EXPECT_TRUE(std::filesystem::exists(fmt::format("{}/lang/reference/diagnostics/{}.md", TF_SOURCE_DIR, kind->code))) << kind->code;
  }
}

// The examples of a page, in the order of the page: the first one triggers the error and no other, the second one is right.
std::vector<std::string> examples(const std::string &code) {
  std::ifstream stream(fmt::format("{}/lang/reference/diagnostics/{}.md", TF_SOURCE_DIR, code));
  std::vector<std::string> blocks;
  bool isOpen = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("```")) {
      isOpen = !isOpen;
      if (isOpen)
        blocks.emplace_back();
    } else if (isOpen) {
      blocks.back() += line + "\n";
    }
  }
  return blocks;
}

TEST(SyntaxDiagnostics, ExamplesOfThePagesAreWrongAndRight) {
  int pages = 0;
  for (const DiagnosticKind *kind : allKinds) {
    const std::vector<std::string> blocks = examples(kind->code);
    if (blocks.empty())
      continue;
    ++pages;
    ASSERT_EQ(blocks.size(), 2U) << kind->code;
    const auto wrong = test::parse(blocks[0]);
    ASSERT_EQ(wrong.diagnostics.all().size(), 1U) << kind->code << "\n" << wrong.errors();
    EXPECT_EQ(wrong.diagnostics.all()[0].kind, kind) << wrong.errors();
    const auto right = test::parse(blocks[1]);
    EXPECT_EQ(right.errors(), "") << kind->code;
  }
  EXPECT_GT(pages, 40);
}

TEST(SyntaxDiagnostics, AFileOfStrayBytesBehindAStringIsNotRight) {
  using namespace std::string_literals;
  const auto parsed = test::parse("model s\nq x\"\n\"\0x\xFF"s);
  EXPECT_TRUE(parsed.diagnostics.hasErrors());
}

// Recovery reads no text twice on each level of nesting: 2^60 readings would never end.
TEST(SyntaxDiagnostics, AnEquationInNestedUnfinishedModelsIsReadOnce) {
  std::string text = "model A ";
  for (int level = 0; level < 60; ++level)
    text += "model A ";
  EXPECT_TRUE(test::parse(text + "model ne outer r = ").diagnostics.hasErrors());
}

TEST(SyntaxDiagnostics, CodesAreUnique) {
  std::set<std::string> codes;
  for (const DiagnosticKind *kind : allKinds)
    EXPECT_TRUE(codes.insert(kind->code).second) << kind->code;
}

}  // namespace
}  // namespace tf
