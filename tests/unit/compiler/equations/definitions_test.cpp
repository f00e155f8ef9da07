// Ordinary equations of models given as text: definitions, states, chain rule, array operations.
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <cmath>

namespace tf::test {
namespace {

using enum ir::SymbolKind;

// The value of a quantity of kind output, or of what an alias stands for.
double valueOf(DerivedModel &model, const Point &point, const std::string &name) {
  const Quantity *quantity = model.quantity(name);
  if (quantity == nullptr) {
    ADD_FAILURE() << "no quantity " << name;
    return std::nan("");
  }
  EXPECT_EQ(quantity->kind, 9) << name << " is no output";
  return point.evaluate(model->graph, model->outputs.at(static_cast<std::size_t>(quantity->index)));
}

std::vector<std::string> stateNames(DerivedModel &model) {
  std::vector<std::string> names;
  for (int k = 0; k < model->nz; ++k)
    names.push_back(model->symbolName({State, k}));
  return names;
}

TEST(Definitions, EquationsInAnyOrderAndForm) {
  DerivedModel model(R"(
model M
  parameter Real p = 3;
  Real a, b, c, d;
equation
  2*c + 1 = a - b*p;
  b/2 = time + p;
  0 = a - sin(b);
  d*(1 + time^2) = c - d;
end M;
)");
  TF_ASSERT_DERIVED(model);
  const Point point(*model, 1);
  const double t = point.at({Time, 0}), b = 2 * (t + 3), a = std::sin(b), c = (a - 3 * b - 1) / 2;
  EXPECT_NEAR(valueOf(model, point, "a"), a, 1e-14);
  EXPECT_NEAR(valueOf(model, point, "b"), b, 1e-14);
  EXPECT_NEAR(valueOf(model, point, "c"), c, 1e-14);
  EXPECT_NEAR(valueOf(model, point, "d"), c / (2 + t * t), 1e-14);
}

TEST(Definitions, DerivativesMakeStatesOnlyOfVariablesWithoutDefinition) {
  DerivedModel model(R"(
model M
  coordinate Real x;
  body ball(mass = 1, position = {x, 0});
  Real z(start = 1), w(start = 2), y, s, rate, lag;
equation
  der(z) = -z + der(y);
  y = x^2 + z*0 + sin(time);
  s = y*w;
  rate = der(s);
  der(w) = z - w;
  lag = der(der(y));
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(stateNames(model), (std::vector<std::string>{"z", "w"}));
  Point point(*model, 2);
  const double t = point(Time), x = point(Coordinate), v = point(Velocity), a = point(Acceleration), z = point(State, 0),
               w = point(State, 1);
  const double y = x * x + std::sin(t), rate = 2 * x * v + std::cos(t);
  EXPECT_NEAR(point.evaluate(model->graph, model->stateDerivatives[0]), -z + rate, 1e-14);
  EXPECT_NEAR(valueOf(model, point, "rate"), rate * w + y * (z - w), 1e-14);
  EXPECT_NEAR(valueOf(model, point, "lag"), 2 * v * v + 2 * x * a - std::sin(t), 1e-14);
}

TEST(Definitions, SecondOrderSystemOfStates) {
  DerivedModel model(R"(
model Oscillator
  parameter Real k = 4;
  Real x(start = 1, fixed = true), v(start = 0);
  Real a = der(v);
equation
  v = der(x);
  a + k*x = 0;
end Oscillator;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(stateNames(model), (std::vector<std::string>{"x", "v"}));
  Point point(*model, 3);
  EXPECT_EQ(point.evaluate(model->graph, model->stateDerivatives[0]), point(State, 1));
  EXPECT_NEAR(point.evaluate(model->graph, model->stateDerivatives[1]), -4 * point(State, 0), 1e-15);
}

TEST(Definitions, StateDerivativesThatAreCoupledLinearlyInOneUnknownEach) {
  DerivedModel model(R"(
model Circuit
  parameter Real R = 2, L = 0.5, C = 0.1;
  Real i(start = 1), u(start = 0), p = u*i;
equation
  L*der(i) + R*i + u = 0;
  C*der(u) = i;
end Circuit;
)");
  TF_ASSERT_DERIVED(model);
  Point point(*model, 4);
  const double i = point(State, 0), u = point(State, 1);
  EXPECT_NEAR(point.evaluate(model->graph, model->stateDerivatives[0]), -(2 * i + u) / 0.5, 1e-14);
  EXPECT_NEAR(point.evaluate(model->graph, model->stateDerivatives[1]), i / 0.1, 1e-14);
  EXPECT_NEAR(valueOf(model, point, "p"), u * i, 1e-15);
}

TEST(Definitions, ArrayOperations) {
  DerivedModel model(R"(
model M
  Real a[3] = {time, 2, 3*time};
  Real b[3] = {1, time^2, -1};
  Real A[2, 3] = {{1, time, 2}, {0, 3, time}};
  output Real dot = a*b;
  output Real c[3] = cross(a, b);
  output Real m[2] = A*a;
  output Real n[2, 2] = A*transpose(A);
  output Real w[3] = a .* b + 2*a ./ {1, 2, 3};
  Real ab[6] = cat(1, a, b);
  output Real d[2] = ab[{2, 6}];
  output Real e = sum(A[:, 2]) + product(b);
  output Real s[3, 3] = skew(a);
  output Real o[3, 3] = outerProduct(a, b);
  output Real r[3] = A[1, :].^2;
end M;
)");
  TF_ASSERT_DERIVED(model);
  const Point point(*model, 5);
  const double t = point.at({Time, 0}), a[3] = {t, 2, 3 * t}, b[3] = {1, t * t, -1}, A[2][3] = {{1, t, 2}, {0, 3, t}};
  const auto expect = [&](const std::string &name, double value) { EXPECT_NEAR(valueOf(model, point, name), value, 1e-14) << name; };
  expect("dot", a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  expect("c[1]", a[1] * b[2] - a[2] * b[1]);
  expect("c[2]", a[2] * b[0] - a[0] * b[2]);
  expect("c[3]", a[0] * b[1] - a[1] * b[0]);
  for (int i = 0; i < 2; ++i) {
    expect("m[" + std::to_string(i + 1) + "]", A[i][0] * a[0] + A[i][1] * a[1] + A[i][2] * a[2]);
    for (int j = 0; j < 2; ++j)
      expect("n[" + std::to_string(i + 1) + "," + std::to_string(j + 1) + "]", A[i][0] * A[j][0] + A[i][1] * A[j][1] + A[i][2] * A[j][2]);
  }
  expect("w[2]", a[1] * b[1] + a[1]);
  expect("w[3]", a[2] * b[2] + 2 * a[2] / 3);
  expect("d[1]", a[1]);
  expect("d[2]", b[2]);
  expect("e", t + 3 - t * t);
  expect("s[1,2]", -a[2]);
  expect("s[3,2]", a[0]);
  expect("o[2,3]", a[1] * b[2]);
  expect("r[2]", t * t);
}

TEST(Definitions, LongChainOfVariables) {
  DerivedModel model(R"(
model Chain
  parameter Integer n = 2000;
  Real x[n];
equation
  x[n] = time;
  for i in 1:n - 1 loop
    x[i] = x[i + 1] + 1;
  end for;
end Chain;
)");
  TF_ASSERT_DERIVED(model);
  const Point point(*model, 6);
  EXPECT_NEAR(valueOf(model, point, "x[1]"), point.at({Time, 0}) + 1999, 1e-9);
}

}  // namespace
}  // namespace tf::test
