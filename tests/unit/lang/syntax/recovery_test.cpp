// After an error the rest of the file is read: the tree keeps what is right, and one mistake is one message.
#include "tests/unit/lang/syntax/parsed.h"

#include <gmock/gmock.h>

namespace tf {
namespace {

using testing::ElementsAre;

std::vector<std::string> codesAndLines(const test::Parsed &parsed) {
  std::vector<std::string> result;
  for (const Diagnostic &diagnostic : parsed.diagnostics.all())
    result.push_back(fmt::format("{}:{}", diagnostic.kind->code, parsed.sources.file(0).lineColumn(diagnostic.span.begin).line));
  return result;
}

std::vector<std::string> componentNames(const ast::ClassDefinition &definition) {
  std::vector<std::string> names;
  for (const ast::Element &element : definition.elements) {
    if (element.component != nullptr)
      for (const ast::Component &component : element.component->components)
        names.emplace_back(component.name.text);
  }
  return names;
}

TEST(Recovery, SeveralErrorsInOneRun) {
  const auto parsed = test::parse(R"(model A
  Real x y;
  Real u = f(1, 2;
  Real v
  parameter Real w = ;
equation
  x := 1;
  v == 3;
  w = (2;
  u = 1;
end B;
)");
  EXPECT_THAT(codesAndLines(parsed),
              ElementsAre("TF0120:2", "TF0122:3", "TF0121:4", "TF0130:5", "TF0140:7", "TF0142:8", "TF0122:9", "TF0160:11"))
      << parsed.errors();
  EXPECT_THAT(componentNames(parsed.firstClass()), ElementsAre("x", "u", "v", "w"));
  ASSERT_EQ(parsed.firstClass().sections.size(), 1U);
  EXPECT_EQ(parsed.firstClass().sections[0].equations.size(), 4U);
}

TEST(Recovery, AMissingBracketCostsOneDeclaration) {
  const auto parsed = test::parse("model A\n  Real x(start = 1;\n  Real y;\nequation\n  x = y;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0122:2"));
  EXPECT_THAT(componentNames(parsed.firstClass()), ElementsAre("x", "y"));
  EXPECT_EQ(parsed.firstClass().sections.size(), 1U);
}

TEST(Recovery, TheSemicolonsOfAMatrixDoNotEndTheEquation) {
  const auto parsed = test::parse("model A\nequation\n  x = [1 2; 3, 4; 5, 6];\n  y = 1;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0120:3"));
  EXPECT_EQ(parsed.firstClass().sections[0].equations.size(), 2U);
}

TEST(Recovery, AnEndInASubscriptDoesNotEndTheClass) {
  const auto parsed = test::parse("model A\nequation\n  x = a b + c[end] + d[1:end];\n  y = 1;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0120:3"));
  EXPECT_EQ(parsed.firstClass().sections[0].equations.size(), 2U);
}

TEST(Recovery, ABrokenHeadKeepsItsBlock) {
  const auto parsed = test::parse(R"(model A
equation
  if x > then
    y = 1;
  elseif = then
    y = 2;
  end if;
  for i = 1:3 loop
    z[i] = 1;
  end for;
  when x > 1
    y = 2;
  end when;
  w = 1;
end A;
)");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0130:3", "TF0130:5", "TF0120:8", "TF0120:11")) << parsed.errors();
  ASSERT_EQ(parsed.firstClass().sections[0].equations.size(), 4U);
  EXPECT_EQ(parsed.firstClass().sections[0].equations[0]->branches.size(), 2U);
  EXPECT_EQ(parsed.firstClass().sections[0].equations[1]->body.size(), 1U);
}

TEST(Recovery, ABrokenHeadingKeepsItsClass) {
  const auto parsed = test::parse("package P\n  model 3D\n    Real x;\n  end 3D;\n  model B\n    Real y;\n  end B;\nend P;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0120:2"));
  ASSERT_EQ(parsed.firstClass().elements.size(), 2U);
  EXPECT_THAT(componentNames(*parsed.firstClass().elements[0].classDefinition), ElementsAre("x"));
  EXPECT_THAT(componentNames(*parsed.firstClass().elements[1].classDefinition), ElementsAre("y"));
}

TEST(Recovery, AMissingEndOfAClassIsOneError) {
  const auto parsed = test::parse("package P\n  model A\n    Real x;\n  model B\n    Real y;\n  end B;\nend P;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0161:7"));
  EXPECT_EQ(parsed.diagnostics.all()[0].message, "'A' has no 'end A'");
}

TEST(Recovery, AMissingEndOfABlockIsOneError) {
  const auto parsed = test::parse("model A\nequation\n  for i in 1:3 loop\n    if a then\n      x[i] = 1;\n  end for;\n  y = 1;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0161:4"));
  EXPECT_EQ(parsed.firstClass().sections[0].equations.size(), 2U);
}

TEST(Recovery, EquationsWithoutTheirKeywordAreKept) {
  const auto parsed = test::parse("model A\n  Real x;\n  der(x) = -x;\n  x = 1;\n  Real y;\nequation\n  y = 1;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0163:3"));
  EXPECT_EQ(parsed.firstClass().sections.size(), 3U);
  EXPECT_THAT(componentNames(parsed.firstClass()), ElementsAre("x", "y"));
}

TEST(Recovery, TextBetweenClassesIsOneError) {
  const auto parsed = test::parse("foo bar baz;\nqux;\nmodel A\nend A;\nend B;\nmodel C\nend C;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0169:1", "TF0169:5"));
  EXPECT_EQ(parsed.file().classes.size(), 2U);
}

TEST(Recovery, LexicalAndSyntaxErrorsComeInTheOrderOfTheText) {
  const auto parsed = test::parse("model A\n  Real x\n  Real y = $1;\n  Real z w;\n  Real v = 1e;\nend A;\n");
  EXPECT_THAT(codesAndLines(parsed), ElementsAre("TF0121:2", "TF0102:3", "TF0120:4", "TF0108:5"));
}

TEST(Recovery, OfVeryManyErrorsTheFirstAreListed) {
  std::string text = "model A\nequation\n";
  for (int i = 0; i < 1000; ++i)
    text += "  x = ;\n";
  const auto parsed = test::parse(text + "end A;\n");
  ASSERT_EQ(parsed.diagnostics.errorCount(), 100);
  ASSERT_EQ(parsed.diagnostics.all().back().notes.size(), 1U);
  EXPECT_EQ(parsed.diagnostics.all().back().notes[0].message, "900 more errors follow, which are not listed");
}

TEST(Recovery, DeepNestingIsAnErrorAndNoOverflow) {
  for (const char *piece : {"(", "{", "[", "a[", "f(", "if a then ", "-(", "not (", "f(function g(a = "}) {
    std::string text = "model A\nequation\n  x = ";
    for (int i = 0; i < 100000; ++i)
      text += piece;
    const auto parsed = test::parse(text);
    ASSERT_TRUE(parsed.diagnostics.hasErrors()) << piece;
    EXPECT_EQ(parsed.diagnostics.all()[0].kind->code, std::string("TF0124")) << piece;
  }
  for (const char *piece : {"model A ", "package P ", "A a(b", "model A equation if a then ", "function f algorithm for i in 1 loop "}) {
    std::string text;
    for (int i = 0; i < 20000; ++i)
      text += piece;
    EXPECT_TRUE(test::parse(text).diagnostics.hasErrors()) << piece;
  }
}

TEST(Recovery, EveryPrefixOfAFileIsHandled) {
  const std::string text =
      R"(within A; model M "text" import A.{b, c}; parameter Real x[2](each unit = "m") = {1, 2} if a "d" annotation(e = 1);
coordinate Real q(start = 1, der(start = 2)); replaceable model N = O(redeclare type P = Real) constrainedby Q;
initial equation x = [1, 2; 3, 4]; algorithm for i in 1:2 loop (a, , b) := f(x, g = function h(i = 1)); end for;
equation if a then b = 'c d'; elseif not e then f(1); else connect(g, h[end]); end if; when a then reinit(b, 1.5e3); end when;
annotation(experiment(StopTime = 1)); end M;)";
  EXPECT_EQ(test::parse(text).errors(), "");
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto parsed = test::parse(text.substr(0, length));
    ASSERT_NE(parsed.tree.file, nullptr);
    (void)ast::print(parsed.file());
    EXPECT_LE(parsed.diagnostics.errorCount(), 3) << text.substr(0, length) << "\n" << parsed.errors();
  }
}

}  // namespace
}  // namespace tf
