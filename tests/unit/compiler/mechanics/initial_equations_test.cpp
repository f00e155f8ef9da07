// Starts that follow from initial equations.
#include "tests/unit/compiler/mechanics/derived_model.h"

namespace tf::test {
namespace {

double stateStart(DerivedModel &model, int state) {
  return Point(*model, 1).evaluate(model->graph, model->stateStarts.at(static_cast<std::size_t>(state)));
}

TEST(InitialEquations, SteadyState) {
  DerivedModel model(R"(
model M
  parameter Real x0 = 2, k = 4;
  coordinate Real q(start = x0, der(start = 1));
  body b(mass = 1, position = q);
  Real z, w(start = 7);
initial equation
  der(z) = 0;
equation
  der(z) = q + der(q) - k*z;
  der(w) = 1;
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_DOUBLE_EQ(stateStart(model, 0), 3.0 / 4);
  EXPECT_DOUBLE_EQ(stateStart(model, 1), 7);
}

TEST(InitialEquations, InOrderOfNeedWithSwitches) {
  DerivedModel model(R"(
model M
  Real a, b, c(start = 3, fixed = true);
equation
  der(a) = 1;
  der(b) = if c > 2 then b - 5 else b + 5;
  der(c) = 0;
initial equation
  2*a = b + 1;
  der(b) = 0;
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_DOUBLE_EQ(stateStart(model, 0), 3);
  EXPECT_DOUBLE_EQ(stateStart(model, 1), 5);
}

TEST(InitialEquations, CoordinatesThatAreNotFixed) {
  DerivedModel model(R"(
model M
  coordinate Real x(start = 1, fixed = false), y(start = 2, der(fixed = false));
  body b(mass = 1, position = {x, y});
initial equation
  x + y = 5;
  der(y) = 3*x;
end M;
)");
  TF_ASSERT_DERIVED(model);
  const Point point(*model, 1);
  EXPECT_DOUBLE_EQ(point.evaluate(model->graph, model->coordinateStarts[0]), 3);
  EXPECT_DOUBLE_EQ(point.evaluate(model->graph, model->velocityStarts[1]), 9);
}

TEST(InitialEquations, Refused) {
  for (const auto &[initial, why] : {std::pair{"a^2 = 4", "it is not linear in 'a' (not supported yet)"},
                                     std::pair{"a + b = 1;\n  a - b = 2", "it depends on others in a circle (not supported yet)"},
                                     std::pair{"a = 1;\n  a = 2", "all variables in it have start values already"},
                                     std::pair{"a*time + a = a*(1 + time) + 1", "'a' cancels out"}}) {
    const DerivedModel model(std::string("model M\n  Real a, b;\nequation\n  der(a) = 1;\n  der(b) = 1;\ninitial equation\n  ") + initial +
                             ";\nend M;\n");
    EXPECT_FALSE(model.system.has_value());
    EXPECT_NE(model.errors().find(why), std::string::npos) << model.errors();
  }
}

}  // namespace
}  // namespace tf::test
