#include "compiler/codegen/unit_shape.h"

#include "compiler/codegen/loop_tables.h"

#include <array>
#include <gtest/gtest.h>

namespace tf::codegen {
namespace {

using ir::NodeId;
using ir::Op;

class UnitShapeTest : public ::testing::Test {
protected:
  ir::Graph g;
  NodeId x = g.symbol(ir::SymbolKind::State, 0), y = g.symbol(ir::SymbolKind::State, 1), q = g.symbol(ir::SymbolKind::Coordinate, 0);

  // Evaluates the nodes and stores the last one.
  static Unit unitOf(const std::vector<NodeId> &nodes, int position, int buffer = 0) {
    Unit unit;
    for (const NodeId node : nodes)
      unit.steps.push_back({Step::Kind::Evaluate, node, 0, 0, 0});
    unit.steps.push_back({Step::Kind::Store, nodes.back(), buffer, position, 1});
    return unit;
  }

  [[nodiscard]] std::vector<std::int64_t> codeOf(const Unit &unit) const { return shapeOf(unit, g, context).code; }

  ShapeContext context = {[](NodeId) { return false; }, [](NodeId) { return false; },
                          [this](NodeId id) {
                            const ir::Subgraph reached(g, std::array{id});
                            return likenesses(g, reached).back();
                          }};
};

TEST_F(UnitShapeTest, NumbersMayDiffer) {
  const NodeId a = g.mul(x, g.constant(3)), b = g.mul(y, g.constant(4));
  EXPECT_EQ(codeOf(unitOf({a}, 5)), codeOf(unitOf({b}, 9)));
  const UnitShape shape = shapeOf(unitOf({a}, 5), g, context);
  ASSERT_EQ(shape.places.size(), 3U);
  EXPECT_EQ(shape.places.back().kind, Place::Kind::Position);
}

TEST_F(UnitShapeTest, OperationsKindsAndBuffersMayNot) {
  const Unit unit = unitOf({g.mul(x, g.constant(3))}, 5);
  EXPECT_NE(codeOf(unit), codeOf(unitOf({g.add(x, g.constant(3))}, 5)));
  EXPECT_NE(codeOf(unit), codeOf(unitOf({g.mul(q, g.constant(3))}, 5)));
  EXPECT_NE(codeOf(unit), codeOf(unitOf({g.mul(x, g.constant(3))}, 5, 1)));
}

TEST_F(UnitShapeTest, TheSameOperandTwiceIsNotTwoOperands) {
  EXPECT_NE(codeOf(unitOf({g.mul(x, x)}, 0)), codeOf(unitOf({g.mul(x, y)}, 0)));
  const NodeId s = g.unary(Op::Exp, x), t = g.unary(Op::Exp, y);
  EXPECT_NE(codeOf(unitOf({s, t, g.sub(s, t)}, 0)), codeOf(unitOf({s, t, g.sub(t, s)}, 0)));
}

// Which of the operands of a sum has the smaller id is chance.
TEST_F(UnitShapeTest, SumsAreAlikeInAnyOrder) {
  const NodeId early = g.mul(g.constant(3), x), late = g.symbol(ir::SymbolKind::State, 7);
  const NodeId a = g.add(early, late), product = g.mul(g.constant(3), y), b = g.add(product, x);
  ASSERT_EQ(g[a].operands[0], early);
  ASSERT_EQ(g[b].operands[0], x);
  EXPECT_EQ(codeOf(unitOf({early, a}, 0)), codeOf(unitOf({product, b}, 0)));
}

TEST_F(UnitShapeTest, ExponentsThatAreMultipliedOutAreCode) {
  const auto power = [this](double exponent) { return codeOf(unitOf({g.binary(Op::Pow, x, g.constant(exponent))}, 0)); };
  EXPECT_NE(power(3), power(4));
  EXPECT_EQ(power(2.5), power(3.5));
}

// Numbers that all units share are no columns, nor are those that differ from another column by a constant.
TEST_F(UnitShapeTest, TablesHaveAColumnForWhatDiffers) {
  std::vector<Unit> units;
  for (int k = 0; k < 4; ++k) {
    const NodeId state = g.symbol(ir::SymbolKind::State, 2 * k), product = g.mul(state, g.constant(k + 0.5));
    units.push_back(unitOf({product, g.add(product, g.mul(q, g.constant(7)))}, 2 * k + 3));
    units.back().steps.insert(units.back().steps.begin() + 1, {Step::Kind::Evaluate, g.mul(q, g.constant(7)), 0, 0, 0});
    units.back().group = k * k;
  }
  const LoopTables tables = tabulate(units, g, context, [](NodeId) { return -1; });
  EXPECT_EQ(tables.wholeColumns, 4) << "of the groups, of how many are within 64 and within 8, and of states and positions";
  EXPECT_EQ(tables.realColumns, 1);
  EXPECT_EQ(tables.realRows, (std::vector{0.5, 1.5, 2.5, 3.5}));
  EXPECT_EQ(tables.second.column, -1);
  EXPECT_EQ(tables.second.offset, -1);
  constexpr std::array nearby = {3, 2, 2, 1};
  for (int row = 0; row < 4; ++row) {
    const auto value = [&](const WholeSource &source) {
      return source.offset + (source.column < 0 ? 0 : tables.wholeRows[static_cast<std::size_t>(4 * row + source.column)]);
    };
    EXPECT_EQ(value(tables.group), row * row);
    EXPECT_EQ(value(tables.skips[0]), 4 - row);
    EXPECT_EQ(value(tables.skips[1]), nearby[static_cast<std::size_t>(row)]);
    EXPECT_EQ(value(tables.wholes.back()), 2 * row + 3);
  }
}

}  // namespace
}  // namespace tf::codegen
