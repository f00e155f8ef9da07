// `--set u=…`: typing of free-standing expressions and their evaluation.
#include "lang/semantics/instantiate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf {
namespace {

struct Typed {
  SourceManager sources;
  Diagnostics diagnostics;
  flat::ExprPtr expression;

  explicit Typed(const std::string &text) {
    const std::vector<std::string> names = {"g", "arm.k", "u[1]", "u[2]"};
    const auto resolve = [&](const std::string &name) -> std::optional<int> {
      for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name)
          return static_cast<int>(i);
      return std::nullopt;
    };
    expression = typeExpression(sources, sources.add("--set", text), resolve, names, diagnostics);
  }

  [[nodiscard]] double at(double time) const {
    const auto value = evaluate(*expression, time, [](flat::VariableId id) { return std::vector<double>{10.0 * (id + 1)}; });
    return value ? value->at(0) : std::nan("");
  }
  [[nodiscard]] std::string message() const { return diagnostics.all().empty() ? "" : diagnostics.all()[0].message; }
};

TEST(FreeExpression, dependsOnTimeAndParameters) {
  const Typed typed("if time < 1 then 0 else 2*g*(time-1)");
  ASSERT_NE(typed.expression, nullptr) << typed.message();
  EXPECT_EQ(typed.at(0.5), 0);
  EXPECT_EQ(typed.at(1.5), 10);
}

TEST(FreeExpression, namesWithDotsAndSubscripts) {
  const Typed typed("arm.k + u[1 + 1]");
  ASSERT_NE(typed.expression, nullptr) << typed.message();
  EXPECT_EQ(typed.at(0), 20 + 40);
}

TEST(FreeExpression, functionsAndArrays) {
  EXPECT_DOUBLE_EQ(Typed("sum({sin(i*time) for i in 1:3})").at(0.5), std::sin(0.5) + std::sin(1.0) + std::sin(1.5));
  EXPECT_DOUBLE_EQ(Typed("{1, 2}*[1, 2; 3, 4]*{1, 1}").at(0), 17);
  EXPECT_DOUBLE_EQ(Typed("max(mod(-1, 3), 2^0.5)").at(0), 2);
  EXPECT_DOUBLE_EQ(Typed("cross({1, 0, 0}, {0, 1, 0})*{5, 6, 7}").at(0), 7);
}

TEST(FreeExpression, unknownNameWithSuggestion) {
  const Typed typed("2*arm.j");
  EXPECT_EQ(typed.expression, nullptr);
  EXPECT_EQ(typed.message(), "'arm.j' is not declared; did you mean 'arm.k'?");
}

TEST(FreeExpression, mustBeAScalar) {
  const Typed typed("{1, 2}");
  EXPECT_EQ(typed.expression, nullptr);
  EXPECT_EQ(typed.message(), "this argument must be a scalar, got Integer[2]");
}

TEST(FreeExpression, syntaxErrorsAreReported) {
  const Typed typed("2*(g");
  EXPECT_EQ(typed.expression, nullptr);
  EXPECT_TRUE(typed.diagnostics.hasErrors());
}

}  // namespace
}  // namespace tf
