// Expressions of time: decisions of a smooth piece and zeros.
#include "compiler/driver/smooth_piece.h"
#include "lang/semantics/instantiate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::driver {
namespace {

flat::ExprPtr expression(const std::string &text) {
  SourceManager sources;
  Diagnostics diagnostics;
  const FileId file = sources.add("expression", text);
  const flat::ExprPtr typed = typeExpression(
      sources, file, [](const std::string &name) { return name == "p" ? std::optional(0) : std::nullopt; }, {"p"}, diagnostics);
  EXPECT_FALSE(diagnostics.hasErrors()) << render(diagnostics, sources);
  return foldParameters(typed, [](flat::VariableId) { return 3.0; });
}

constexpr double resolution = 0.05;

// Of the piece that begins at `begin`.
double pieceValue(const std::string &text, double begin, double time) {
  std::vector<DecidingFunction> deciding;
  return valueAt(smoothPiece(expression(text), begin, resolution, deciding), time);
}

// Where the piece ends.
double pieceEnd(const std::string &text, double begin) {
  std::vector<DecidingFunction> deciding;
  static_cast<void>(smoothPiece(expression(text), begin, resolution, deciding));
  double end = std::numeric_limits<double>::infinity();
  for (const DecidingFunction &one : deciding)
    end = std::min(end, firstZero(one.function, one.from, 10, resolution));
  return end;
}

double zero(const std::string &text, double begin = 0, double horizon = 10) {
  return firstZero(expression(text), begin, horizon, resolution);
}

TEST(SmoothPiece, ParametersAreFolded) {
  EXPECT_EQ(expression("2*p + 1")->kind, flat::ExprKind::Literal);
  EXPECT_EQ(valueAt(expression("2*p + time"), 1), 7);
}

TEST(SmoothPiece, DecisionsAreThoseAfterItsBegin) {
  EXPECT_EQ(pieceValue("if time < 1 then 2*time else 5", 0.5, 1), 2);
  EXPECT_EQ(pieceValue("if time < 1 then 2*time else 5", 1.5, 1), 5);
  EXPECT_EQ(pieceValue("abs(time - 1)", 0.5, 2), -1);
  EXPECT_EQ(pieceValue("sign(time - 1)", 0.5, 2), -1);
  EXPECT_EQ(pieceValue("max(time, 1)", 0.5, 2), 1);
  EXPECT_EQ(pieceValue("min(time, 1)", 0.5, 2), 2);
  EXPECT_EQ(pieceValue("floor(time)", 1.5, 2), 1);
  EXPECT_EQ(pieceValue("ceil(time)", 1.5, 1), 2);
  EXPECT_EQ(pieceValue("mod(time, 2)", 3, 4), 2);
  EXPECT_EQ(pieceValue("div(time, 2)", 3, 4), 1);
  EXPECT_EQ(pieceValue("rem(time, 2)", 3, 4), 2);
}

TEST(SmoothPiece, WhatDecidesIsNoted) {
  std::vector<DecidingFunction> deciding;
  static_cast<void>(smoothPiece(expression("if time < 1 then abs(time - 0.5) else max(time, 3)"), 0.2, resolution, deciding));
  ASSERT_EQ(deciding.size(), 2U);  // the condition and abs, not the branch that is not taken
  EXPECT_EQ(firstZero(deciding[0].function, 0, 10, resolution), 1);
  EXPECT_EQ(firstZero(deciding[1].function, 0, 10, resolution), 0.5);
}

TEST(SmoothPiece, AFunctionThatTouchesZeroDecidesByItsSignAfterwards) {
  EXPECT_EQ(pieceValue("abs(cos(5*time) - 1)", 0, 0.5), 1 - std::cos(2.5));
  EXPECT_EQ(pieceValue("sign(1 - cos(time))", 0, 0.5), 1);
  EXPECT_EQ(pieceValue("max(cos(5*time), 1)", 0, 0.5), 1);
  EXPECT_EQ(pieceValue("min(cos(5*time), 1)", 0, 0.5), std::cos(2.5));
  EXPECT_EQ(pieceValue("if cos(5*time) < 1 then 1 else 2", 0, 0.5), 1);
  EXPECT_EQ(pieceValue("if sin(7*time) >= 1 then 1 else 2", std::acos(0.0) / 7, 0.5), 2);
  EXPECT_EQ(pieceValue("floor(sin(7*time))", std::acos(0.0) / 7, 0.5), 0);
  EXPECT_EQ(pieceValue("integer(exp(-time^2))", 0, 0.5), 0);
  EXPECT_EQ(pieceValue("ceil(1 + time^4)", 0, 0.5), 2);
  EXPECT_EQ(pieceValue("div(-time^2, 1)", 0, 0.5), 0);
  // It stays zero.
  EXPECT_EQ(pieceValue("sign(time - time)", 0, 0.5), 0);
  EXPECT_EQ(pieceValue("if 0*time >= 0 then 1 else 2", 0, 0.5), 1);
}

TEST(SmoothPiece, AFunctionThatTouchesZeroAtTheBeginEndsItWhereItPassesZero) {
  EXPECT_NEAR(pieceEnd("abs((cos(time) - 1)*(time - 0.7))", 0), 0.7, 1e-15);
  EXPECT_NEAR(pieceEnd("floor(1.5*cos(time) - 0.5)", 0), std::acos(1.0 / 3), 1e-15);
}

TEST(SmoothPiece, ArrayDecisionsAreFound) {
  EXPECT_NE(arrayDecision(expression("sum(abs({time, 1}))")), nullptr);
  EXPECT_EQ(arrayDecision(expression("sum({abs(time), 1})")), nullptr);
}

TEST(FirstZero, OfAffineFunctionsIsExact) {
  EXPECT_EQ(zero("time - 0.3"), 0.3);
  EXPECT_EQ(zero("1 - 4*(time - 1)/2"), 1.5);
  EXPECT_EQ(zero("time - 0.3", 0.3), std::numeric_limits<double>::infinity());
  EXPECT_EQ(zero("time - 11"), std::numeric_limits<double>::infinity());
}

TEST(FirstZero, OfOtherFunctionsIsLocatedToTheLastBits) {
  EXPECT_NEAR(zero("sin(time) - 0.5"), std::asin(0.5), 2e-16);
  EXPECT_NEAR(zero("time^3 - 2"), std::cbrt(2.0), 3e-16);
  EXPECT_NEAR(zero("cos(1000*time)"), std::acos(0.0) / 1000, 1e-18);  // many periods within the resolution
}

TEST(FirstZero, FindsADipBetweenSamples) {
  EXPECT_NEAR(zero("(time - 0.513)^2 - 1e-6"), 0.512, 1e-12);
  EXPECT_EQ(zero("(time - 0.513)^2 + 1e-6"), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace tf::driver
