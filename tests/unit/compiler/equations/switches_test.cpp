// What becomes a switching function: kinds, sharing, nesting (theory.md section 5).
#include "compiler/equations/equation_system.h"
#include "runtime/abi/tf_model.h"
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <cmath>

namespace tf::test {
namespace {

using enum ir::SymbolKind;

struct Expected {
  std::string text;
  int kind;
  bool zeroIsPositive;
  bool operator==(const Expected &) const = default;
};

std::ostream &operator<<(std::ostream &out, const Expected &e) { return out << e.text << " kind " << e.kind << " " << e.zeroIsPositive; }

std::vector<Expected> switchesOf(DerivedModel &model) {
  std::vector<Expected> all;
  for (const SwitchingFunction &switching : model->switches)
    all.push_back({switching.text, switching.kind, switching.zeroIsPositive});
  return all;
}

double derivativeAt(DerivedModel &model, Point point, std::vector<double> alphas, int state = 0) {
  for (std::size_t k = 0; k < alphas.size(); ++k)
    point(StepVariable, static_cast<int>(k)) = alphas[k];
  return point.evaluate(model->graph, model->stateDerivatives.at(static_cast<std::size_t>(state)));
}

DerivedModel model(const std::string &right, const std::string &declarations = "") {
  return DerivedModel("model M\n  parameter Real p = 2;\n  input Real u;\n  Real x(start = 1), y(start = 2);\n" + declarations +
                      "equation\n  der(x) = " + right + ";\n  der(y) = 1;\nend M;\n");
}

TEST(Switches, RelationsKeepWhatHoldsOnTheSurface) {
  for (const auto &[relation, zeroIsPositive] :
       {std::pair{"x > y", false}, std::pair{"x >= y", true}, std::pair{"x < y", false}, std::pair{"x <= y", true}}) {
    DerivedModel m = model(std::string("if ") + relation + " then 5 else 7");
    TF_ASSERT_DERIVED(m);
    EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{relation, TF_SWITCH_SLIDING, zeroIsPositive}}));
    const Point point(*m, 1);
    EXPECT_EQ(derivativeAt(m, point, {1}), 5);
    EXPECT_EQ(derivativeAt(m, point, {0}), 7);
    EXPECT_NEAR(derivativeAt(m, point, {0.25}), 6.5, 1e-15);
    const double difference = point.at({State, 0}) - point.at({State, 1});
    EXPECT_NEAR(point.evaluate(m->graph, m->switches[0].condition), std::string(relation)[2] == '>' ? difference : -difference, 1e-15);
  }
}

TEST(Switches, EqualUpToAConstantFactorShareOneStepVariable) {
  DerivedModel m =
      model("(if x > 2*y then 1 else 0) + (if 2*x - 4*y > 0 then 10 else 0) + (if y > x/2 then 100 else 0) + 1000*sign(6*y - 3*x)");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"x > 2*y", TF_SWITCH_SLIDING, false}, {"x > 2*y", TF_SWITCH_REST, false}}));
  EXPECT_EQ(m->switches[1].of, 0);
  const Point point(*m, 1);
  EXPECT_EQ(derivativeAt(m, point, {1, 0}), 1 + 10 + 0 - 1000);
  EXPECT_EQ(derivativeAt(m, point, {0, 0}), 0 + 0 + 100 + 1000);
}

// Where the condition stays zero each relation has the value that is written.
TEST(Switches, RelationsOfOneStepVariableAtRest) {
  DerivedModel m =
      model("(if x > y then 1 else 0) + (if x >= y then 10 else 0) + (if x < y then 100 else 0) + (if y >= x then 1000 else 0) + "
            "10000*sign(x - y)");
  TF_ASSERT_DERIVED(m);
  ASSERT_EQ(m->switches.size(), 2U);
  EXPECT_EQ(m->switches[1].kind, TF_SWITCH_REST);
  const Point point(*m, 1);
  EXPECT_EQ(derivativeAt(m, point, {1, 0}), 1 + 10 + 10000);
  EXPECT_EQ(derivativeAt(m, point, {0, 0}), 100 + 1000 - 10000);
  EXPECT_EQ(derivativeAt(m, point, {0, 1}), 10 + 1000);
  DerivedModel negative = model("(if x >= y then 1 else 0) + (if x < y then 10 else 0)");
  TF_ASSERT_DERIVED(negative);
  EXPECT_EQ(negative->switches.size(), 1U);
}

TEST(Switches, SignOfAParameter) {
  DerivedModel m = model("sign(p - 2)");
  TF_ASSERT_DERIVED(m);
  Point point(*m, 1);
  for (const double p : {1.0, 2.0, 3.0}) {
    point(Parameter) = p;
    EXPECT_EQ(derivativeAt(m, point, {}), p - 2);
  }
}

TEST(Switches, DifferentConstantsAreDifferentSurfaces) {
  DerivedModel m = model("(if x > 1 then 1 else 0) + (if x > 2 then 10 else 0)");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(m->switches.size(), 2U);
}

TEST(Switches, Kinds) {
  DerivedModel m = model("abs(x) + min(x, y) + max(y, u) + sign(u) + (if time > p then 1 else 0) + (if p > 1 then 1 else 0)");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"abs(x)", TF_SWITCH_CONTINUOUS, true},
                                                  {"min(x, y)", TF_SWITCH_CONTINUOUS, true},
                                                  {"max(y, u)", TF_SWITCH_CONTINUOUS, true},
                                                  {"sign(u)", TF_SWITCH_SLIDING, true},
                                                  {"sign(u)", TF_SWITCH_REST, false},
                                                  {"time > p", TF_SWITCH_TIME, false}}));
}

TEST(Switches, AJumpOnTheSurfaceOfAKinkCanSlide) {
  DerivedModel m = model("abs(x) - sign(x)");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"abs(x)", TF_SWITCH_SLIDING, true}, {"abs(x)", TF_SWITCH_REST, false}}));
}

TEST(Switches, DerivativeOfAKinkCanSlide) {
  DerivedModel m = model("-a", "  Real h = abs(y);\n  Real a = der(h);\n");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"abs(y)", TF_SWITCH_SLIDING, true}}));
  EXPECT_EQ(derivativeAt(m, Point(*m, 1), {1}), -1);
  EXPECT_EQ(derivativeAt(m, Point(*m, 1), {0}), 1);
}

TEST(Switches, GradientOfAPotentialWithAKinkCanSlide) {
  DerivedModel m("model M\n  coordinate Real x;\n  body b(mass = 1, position = {x, 0});\n  potential v(energy = 3*abs(x));\nend M;\n");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"abs(x)", TF_SWITCH_SLIDING, true}}));
}

TEST(Switches, KinksOfResultsAloneAreRelations) {
  DerivedModel m =
      model("if y > 0 then max(x, 1) else 0", "  Real d = abs(x - y) + abs(abs(x + y) - (if x > 2 then 1 else 0)) + max(x, 1);\n");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m),
            (std::vector<Expected>{
                {"x > 2", TF_SWITCH_SLIDING, false}, {"max(x, 1)", TF_SWITCH_CONTINUOUS, true}, {"y > 0", TF_SWITCH_SLIDING, false}}));
  Point point(*m, 1);
  for (const double x : {-3.0, 0.5, 4.0})
    for (const double y : {-2.5, -0.25, 0.75}) {
      point(State, 0) = x;
      point(State, 1) = y;
      for (const int k : {0, 1, 2})
        point(StepVariable, k) = point.evaluate(m->graph, m->switches[static_cast<std::size_t>(k)].condition) > 0 ? 1 : 0;
      EXPECT_EQ(point.evaluate(m->graph, m->stateDerivatives[0]), y > 0 ? std::max(x, 1.0) : 0);
      const double d = point.evaluate(m->graph, m->outputs.at(static_cast<std::size_t>(m.quantity("d")->index)));
      EXPECT_NEAR(d, std::abs(x - y) + std::abs(std::abs(x + y) - (x > 2 ? 1 : 0)) + std::max(x, 1.0), 1e-15);
    }
}

TEST(Switches, ConditionsThatTurnOutParametric) {
  DerivedModel m = model("if q > 1 then 5 else 7", "  Real q = p - 0.5;\n");
  TF_ASSERT_DERIVED(m);
  EXPECT_TRUE(m->switches.empty());
  Point point(*m, 1);
  EXPECT_EQ(derivativeAt(m, point, {}), 5);
  point(Parameter) = 0;
  EXPECT_EQ(derivativeAt(m, point, {}), 7);
}

TEST(Switches, NoEventAndSmooth) {
  DerivedModel m =
      model("noEvent(if x > 0 then abs(y) else sign(y)) + smooth(2, if y > 0 then y^3 else 0) + smooth(0, if u > 0 then u else 0)");
  TF_ASSERT_DERIVED(m);
  EXPECT_EQ(switchesOf(m), (std::vector<Expected>{{"u > 0", TF_SWITCH_CONTINUOUS, false}}));
  Point point(*m, 1);
  point(State, 0) = 1;
  point(State, 1) = -2;
  EXPECT_EQ(derivativeAt(m, point, {0}), 2);
  point(State, 0) = -1;
  EXPECT_EQ(derivativeAt(m, point, {0}), -1);
}

TEST(Switches, BooleansCombineMultiAffinely) {
  DerivedModel m = model("if a and not b or c then 1 else 0", "  Boolean a = x > 0, b = y > 0, c = u > 0;\n");
  TF_ASSERT_DERIVED(m);
  ASSERT_EQ(m->switches.size(), 3U);
  for (int bits = 0; bits < 8; ++bits) {
    const double a = bits & 1, b = bits >> 1 & 1, c = bits >> 2;
    EXPECT_EQ(derivativeAt(m, Point(*m, 1), {a, b, c}), (a != 0 && b == 0) || c != 0 ? 1 : 0);
  }
  const double both = 0.5 * (1 - 0.25);
  EXPECT_NEAR(derivativeAt(m, Point(*m, 1), {0.5, 0.25, 0.1}), both + 0.1 - both * 0.1, 1e-15);
}

TEST(Switches, NestedConditionsComeInOrder) {
  DerivedModel m = model("if h > 1 then 1 else 2", "  Real h = if y > 0 then y else 2*u;\n");
  TF_ASSERT_DERIVED(m);
  ASSERT_EQ(m->switches.size(), 2U);
  EXPECT_EQ(m->switches[0].text, "y > 0");
  EXPECT_EQ(m->switches[1].text, "h > 1");
  EXPECT_TRUE(ir::dependsOn(m->graph, m->switches[1].condition, [](ir::Symbol s) { return s.kind == StepVariable && s.index == 0; }));
}

// α = 0 or 1 selects: the other branch may be not a number.
TEST(Switches, TheOtherBranchIsNotMultiplied) {
  DerivedModel m = model("if x > 0 then sqrt(x) else 1/(x - x*u)");
  TF_ASSERT_DERIVED(m);
  Point point(*m, 1);
  point(State, 0) = -1;
  point(Input) = 0.5;
  EXPECT_EQ(derivativeAt(m, point, {0}), -2);
}

TEST(NormalForm, ConstantFactorsDropOut) {
  ir::Graph graph;
  const ir::NodeId x = graph.symbol(State, 0), y = graph.symbol(State, 1), xy = graph.mul(x, y);
  const ir::NodeId c = graph.add(graph.sub(xy, graph.mul(graph.constant(3), y)), graph.constant(5));
  const ir::NodeId d = graph.div(
      graph.sub(graph.mul(graph.constant(6), y), graph.add(graph.mul(graph.constant(2), xy), graph.constant(10))), graph.constant(4));
  const equations::LinearForm first = equations::normalForm(graph, c), second = equations::normalForm(graph, d);
  EXPECT_EQ(first.terms, second.terms);
  EXPECT_DOUBLE_EQ(second.scale / first.scale, -0.5);
  EXPECT_NE(equations::normalForm(graph, graph.add(c, graph.constant(1))).terms, first.terms);
}

}  // namespace
}  // namespace tf::test
