#include "compiler/ir/function.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::ir {
namespace {

class PrintTest : public ::testing::Test {
protected:
  Graph g;
  NodeId x = g.symbol(SymbolKind::State, 0);
  NodeId y = g.symbol(SymbolKind::State, 1);
  NodeId z = g.symbol(SymbolKind::State, 2);
  static std::string name(Symbol s) { return std::string(1, static_cast<char>('x' + s.index)); }
  std::string text(NodeId node) { return print(g, node, name); }
  NodeId c(double value) { return g.constant(value); }
};

TEST_F(PrintTest, NumbersAreTheShortestThatReadBack) {
  EXPECT_EQ(text(c(9.81)), "9.81");
  EXPECT_EQ(text(c(1)), "1");
  EXPECT_EQ(text(c(-0.1)), "-0.1");
  EXPECT_EQ(text(c(1e-20)), "1e-20");
}

TEST_F(PrintTest, ParenthesesOnlyWhereNeeded) {
  EXPECT_EQ(text(g.mul(g.add(x, y), z)), "z*(x + y)");
  EXPECT_EQ(text(g.sub(x, g.add(y, z))), "x - (y + z)");
  EXPECT_EQ(text(g.add(x, g.add(y, z))), "x + y + z");
  EXPECT_EQ(text(g.sub(x, g.mul(y, z))), "x - y*z");
  EXPECT_EQ(text(g.div(x, g.mul(y, z))), "x/(y*z)");
  EXPECT_EQ(text(g.mul(x, g.mul(y, z))), "x*y*z");
  EXPECT_EQ(text(g.neg(g.mul(x, y))), "-x*y");
  EXPECT_EQ(text(g.neg(g.add(x, y))), "-(x + y)");
  EXPECT_EQ(text(g.mul(x, x)), "x^2");
  EXPECT_EQ(text(g.mul(y, g.mul(x, x))), "y*x^2");
  EXPECT_EQ(text(g.binary(Op::Pow, g.add(x, y), c(3))), "(x + y)^3");
  EXPECT_EQ(text(g.binary(Op::Pow, x, c(-3))), "x^(-3)");
  EXPECT_EQ(text(g.mul(c(-3), x)), "-3*x");
  EXPECT_EQ(text(g.div(x, g.neg(y))), "-x/y");
  EXPECT_EQ(text(g.add(x, c(1))), "x + 1");
  EXPECT_EQ(text(g.binary(Op::Pow, g.mul(c(-3), x), c(3))), "(-3*x)^3");
  EXPECT_EQ(text(g.mul(g.mul(c(-3), x), y)), "-3*y*x");
  EXPECT_EQ(text(g.sub(x, g.mul(y, g.mul(c(-3), z)))), "x + 3*y*z");
  EXPECT_EQ(text(g.mul(z, g.mul(c(-3), g.add(x, y)))), "-3*z*(x + y)");
  EXPECT_EQ(text(g.neg(g.mul(z, g.mul(c(-3), y)))), "3*z*y");
  EXPECT_EQ(text(g.mul(g.mul(x, y), g.mul(x, z))), "x^2*y*z");
  EXPECT_EQ(text(g.mul(x, g.div(y, z))), "x*y/z");
  EXPECT_EQ(text(g.mul(g.div(y, z), g.div(x, z))), "y/z*x/z");
  EXPECT_EQ(text(g.add(g.add(x, y), g.add(z, x))), "2*x + y + z");
  const NodeId difference = g.sub(x, y), complement = g.sub(c(1), z);
  EXPECT_EQ(text(g.add(difference, complement)), "x - y - z + 1");
  EXPECT_EQ(text(g.sub(c(1), x)), "1 - x");
  const NodeId third = g.mul(c(0.3), g.mul(x, y)), withY = g.add(third, y), withZ = g.add(third, z);
  EXPECT_EQ(text(g.add(withY, withZ)), "y + 0.6*x*y + z");
  const NodeId negative = g.mul(y, g.mul(c(-3), z)), sine = g.unary(Op::Sin, x), first = g.add(negative, sine), second = g.add(negative, x);
  EXPECT_EQ(text(g.add(first, second)), "-6*y*z + sin(x) + x");
}

TEST_F(PrintTest, FunctionsRelationsAndChoices) {
  EXPECT_EQ(text(g.binary(Op::Atan2, g.add(x, y), z)), "atan2(x + y, z)");
  const NodeId less = g.binary(Op::Less, x, y);
  EXPECT_EQ(text(g.unary(Op::Not, less)), "x >= y");
  EXPECT_EQ(text(g.binary(Op::Or, g.binary(Op::And, less, g.binary(Op::Equal, x, z)), g.binary(Op::LessEqual, z, y))),
            "x < y and x == z or z <= y");
  EXPECT_EQ(text(g.mul(z, g.ternary(Op::IfElse, less, x, c(0)))), "z*(if x < y then x else 0)");
  EXPECT_EQ(text(g.select(z, x, y)), "select(z, x, y)");
}

TEST_F(PrintTest, MuchSharedExpressionsStayShort) {
  NodeId node = x;
  for (int k = 0; k < 200; ++k)
    node = g.mul(g.unary(Op::Sin, node), g.add(node, y));
  const std::string written = text(node);
  EXPECT_LT(written.size(), 20000U);
  EXPECT_THAT(written, ::testing::HasSubstr(" where t1 = "));
}

TEST_F(PrintTest, FunctionListing) {
  const NodeId s = g.unary(Op::Sin, x);
  const Function function{"f", {2}, 1, {{0, 0, g.mul(s, y), -1}, {0, 1, g.add(s, z), 0}}};
  EXPECT_EQ(print(function, g, name), "function f\n  t1 = sin(x)\n  out[0][0] = y*t1\n  out[0][1] = z + t1  if mask[0]\n");
}

TEST_F(PrintTest, VerifierFindsBadStores) {
  const auto error = [&](Store store) { return verify(Function{"f", {2}, 1, {{0, 0, x, -1}, store}}, g); };
  EXPECT_EQ(error({0, 1, y, 0}), "");
  EXPECT_THAT(error({1, 0, y, 0}), ::testing::HasSubstr("no such buffer"));
  EXPECT_THAT(error({0, 2, y, 0}), ::testing::HasSubstr("beyond the buffer's end"));
  EXPECT_THAT(error({0, 1, 99, 0}), ::testing::HasSubstr("no node 99"));
  EXPECT_THAT(error({0, 1, y, 1}), ::testing::HasSubstr("no group 1"));
  EXPECT_THAT(error({0, 0, y, 0}), ::testing::HasSubstr("stored twice"));
}

}  // namespace
}  // namespace tf::ir
