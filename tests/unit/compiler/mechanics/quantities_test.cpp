// The table of quantities: order, names, units, flags, starts, aliases.
#include "runtime/abi/tf_model.h"
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <cmath>

namespace tf::test {
namespace {

std::vector<std::string> namesOf(DerivedModel &model) {
  std::vector<std::string> names;
  for (const Quantity &quantity : model->quantities)
    names.push_back(quantity.name);
  return names;
}

constexpr const char *kModel = R"(
model M
  parameter Real m(unit = "kg", min = 0) = 2 "mass";
  final parameter Real two = 2;
  parameter Real twice = two*m;
  input Real u(start = 3);
  coordinate Real q[2](each unit = "m", start = {0, twice}, der(start = {1, 0}), each nominal = 5) "position";
  Real z(start = 0.5, fixed = true, unit = "K");
  Real v = der(q[1]);
  Real down = -q[2];
  output Real height = q[2] "how high";
  Boolean isUp = q[2] > 1;
  Real speed = sqrt(der(q)*der(q));
  body ball(mass = m, position = q);
  force push(value = u, at = q[1]);
  contact wall[2](gap = {q[1] + 9, q[2]}, slip = {der(q[2]), der(q[1])}, each friction = 0.1);
  friction dry(slip = der(q[1]) + der(q[2]), bound = 1);
protected
  Real hidden = z^2;
equation
  der(z) = -z;
end M;
)";

TEST(Quantities, OrderAndNames) {
  DerivedModel model(kModel);
  TF_ASSERT_DERIVED(model);
  std::vector<std::string> expected{
      "time", "tau",    "q[1]", "q[2]",  "der(q[1])", "der(q[2])",          "der(der(q[1]))",   "der(der(q[2]))",   "z",         "der(z)",
      "u",    "height", "isUp", "speed", "hidden",    "ball.kineticEnergy", "ball.velocity[1]", "ball.velocity[2]", "push.power"};
  for (const char *wall : {"wall[1]", "wall[2]"})
    for (const char *result : {"gap", "normalForce", "frictionForce", "slip", "closed", "sticking", "alpha[1]", "alpha[2]", "alpha[3]",
                               "theta[1]", "theta[2]", "impulse"})
      expected.push_back(std::string(wall) + "." + result);
  for (const char *name : {"dry.force", "dry.slip", "dry.alpha", "dry.sticking", "energy.kinetic", "energy.potential",
                           "energy.frictionLoss", "energy.impactLoss", "energy.work", "alpha[1]", "timeSpeed", "m", "two", "twice"})
    expected.emplace_back(name);
  EXPECT_EQ(namesOf(model), expected);
}

TEST(Quantities, EnergiesMakeWayForTheModelsOwnNames) {
  DerivedModel own("model M\n  coordinate Real x;\n  body b(mass = 1, position = x);\n  Real energy = x;\nend M;\n");
  TF_ASSERT_DERIVED(own);
  EXPECT_NE(own.quantity("energies.work"), nullptr);
  EXPECT_EQ(own.quantity("energy.work"), nullptr);
  DerivedModel none("model M\n  Real z(start = 1);\nequation\n  der(z) = -z;\nend M;\n");
  TF_ASSERT_DERIVED(none);
  EXPECT_EQ(none.quantity("energy.kinetic"), nullptr);
}

TEST(Quantities, MultipliersOfConstraints) {
  DerivedModel model(R"(
model M
  coordinate Real x, y;
  body b(mass = 1, position = {x, y});
  constraint wire(residual = y - x);
  constraint edge[2](velocityResidual = {der(x), der(y)});
  constraint joint(residual = {x, y});
  Real force = wire.multiplier;
end M;
)");
  TF_ASSERT_DERIVED(model);
  int index = 0;
  for (const char *name : {"wire.multiplier", "edge[1].multiplier", "edge[2].multiplier", "joint.multiplier[1]", "joint.multiplier[2]"}) {
    ASSERT_NE(model.quantity(name), nullptr) << name;
    EXPECT_EQ(model.quantity(name)->kind, TF_KIND_MULTIPLIER);
    EXPECT_EQ(model.quantity(name)->index, index++);
  }
  ASSERT_EQ(model->constraints.size(), 4U);
  EXPECT_TRUE(model->constraints[0].isHolonomic);
  EXPECT_FALSE(model->constraints[2].isHolonomic);
  EXPECT_EQ(model->constraints[2].name, "edge[2]");
  EXPECT_EQ(model->constraints[3].rowFirst, 3);
  ASSERT_EQ(model->aliases.size(), 1U);
  EXPECT_EQ(model->quantities[static_cast<std::size_t>(model->aliases[0].quantity)].name, "wire.multiplier");
}

TEST(Quantities, KindsIndicesUnitsAndFlags) {
  DerivedModel model(kModel);
  TF_ASSERT_DERIVED(model);
  const auto expect = [&](const std::string &name, int kind, int index, const std::string &unit, int flags) {
    const Quantity *quantity = model.quantity(name);
    ASSERT_NE(quantity, nullptr) << name;
    EXPECT_EQ(quantity->kind, kind) << name;
    EXPECT_EQ(quantity->index, index) << name;
    EXPECT_EQ(quantity->unit, unit) << name;
    EXPECT_EQ(quantity->flags, flags) << name;
  };
  expect("q[2]", TF_KIND_COORDINATE, 1, "m", TF_FIXED | TF_SETTABLE);
  expect("der(q[2])", TF_KIND_VELOCITY, 1, "m/s", TF_FIXED | TF_SETTABLE);
  expect("der(der(q[2]))", TF_KIND_ACCELERATION, 1, "m/s2", 0);
  expect("z", TF_KIND_STATE, 0, "K", TF_FIXED | TF_SETTABLE);
  expect("der(z)", TF_KIND_STATE_DERIVATIVE, 0, "K/s", 0);
  expect("u", TF_KIND_INPUT, 0, "", TF_SETTABLE);
  expect("height", TF_KIND_OUTPUT, 0, "", TF_OUTPUT);
  expect("isUp", TF_KIND_OUTPUT, 1, "", TF_BOOLEAN);
  expect("hidden", TF_KIND_OUTPUT, 3, "", TF_PROTECTED);
  expect("wall[2].normalForce", TF_KIND_NORMAL_FORCE, 1, "N", 0);
  expect("wall[2].frictionForce", TF_KIND_TANGENT_FORCE, 1, "N", 0);
  expect("dry.force", TF_KIND_TANGENT_FORCE, 2, "N", 0);
  expect("dry.sticking", TF_KIND_STICKING, 2, "", TF_BOOLEAN);
  expect("alpha[1]", TF_KIND_STEP_VARIABLE, 0, "", 0);
  expect("m", TF_KIND_PARAMETER, 0, "kg", TF_FIXED | TF_SETTABLE);
  expect("two", TF_KIND_PARAMETER, 1, "", TF_FIXED);
  expect("twice", TF_KIND_PARAMETER, 2, "", TF_FIXED | TF_SETTABLE | TF_BOUND);
  EXPECT_EQ(model.quantity("m")->min, 0);
  EXPECT_TRUE(std::isinf(model.quantity("m")->max));
  EXPECT_EQ(model.quantity("q[1]")->nominal, 5);
  EXPECT_EQ(model.quantity("m")->description, "mass");
  EXPECT_EQ(model->contacts[0].nominal, 5);
  EXPECT_EQ(model->parameterValues[0], 2);
  EXPECT_GE(model->parameterBindings[2], 0);
}

TEST(Quantities, SecondNames) {
  DerivedModel model(kModel);
  TF_ASSERT_DERIVED(model);
  ASSERT_EQ(model->aliases.size(), 2U);
  const auto &quantities = model->quantities;
  EXPECT_EQ(model->aliases[0].name, "v");
  EXPECT_EQ(quantities[static_cast<std::size_t>(model->aliases[0].quantity)].name, "der(q[1])");
  EXPECT_EQ(model->aliases[0].sign, 1);
  EXPECT_EQ(model->aliases[1].name, "down");
  EXPECT_EQ(quantities[static_cast<std::size_t>(model->aliases[1].quantity)].name, "q[2]");
  EXPECT_EQ(model->aliases[1].sign, -1);
}

TEST(Quantities, NamesOfTheModelComeFirst) {
  DerivedModel model(R"(
model M
  parameter Real alpha = 1, timeSpeed = 2;
  Real x(start = alpha), tau = 2*x + timeSpeed;
equation
  der(x) = sign(x);
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(namesOf(model), (std::vector<std::string>{"time", "numericalTime", "x", "der(x)", "tau", "stepVariable[1]", "stepVariable[2]",
                                                      "numericalTimeSpeed", "alpha", "timeSpeed"}));
}

TEST(Quantities, StartOfASecondNameIsThatOfTheVelocity) {
  DerivedModel model(R"(
model M
  parameter Real v0 = 4;
  coordinate Real x;
  Real v(start = v0) = der(x);
  body b(mass = 1, position = {x, 0});
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(Point(*model, 1).evaluate(model->graph, model->velocityStarts[0]), 4);
}

TEST(Quantities, VectorSlipsAreNumbered) {
  DerivedModel model(R"(
model M
  coordinate Real q[3];
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.2);
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_NE(model.quantity("floor.slip[2]"), nullptr);
  EXPECT_NE(model.quantity("floor.frictionForce[1]"), nullptr);
  EXPECT_NE(model.quantity("floor.sticking"), nullptr);
}

TEST(Contacts, LawsOfConstantsAndFinalParameters) {
  DerivedModel model(R"(
model M
  parameter ImpactLaw structural = ImpactLaw.Newton annotation(Evaluate = true);
  final parameter ImpactLaw settled = ImpactLaw.Stronge;
  coordinate Real y(start = 1);
  body b(mass = 1, position = {0, y});
  contact c0(gap = y);
  contact c1(gap = y + 1, law = structural);
  contact c2(gap = y + 2, law = settled);
  contact c3(gap = y + 3, law = ImpactLaw.Stronge);
end M;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(model->contacts[0].law, TF_LAW_POISSON);
  EXPECT_EQ(model->contacts[1].law, TF_LAW_NEWTON);
  EXPECT_EQ(model->contacts[2].law, TF_LAW_STRONGE);
  EXPECT_EQ(model->contacts[3].law, TF_LAW_STRONGE);
}

TEST(Quantities, ResultsOfElementsInExpressions) {
  DerivedModel model(R"(
model M
  coordinate Real x, y(start = 1);
  body b(mass = 3, position = {x, y});
  force damper(value = -2*der(damper.at), at = x + y);
  contact floor(gap = y, slip = der(x), friction = 0.2);
  output Real f = 2*floor.normalForce + floor.frictionForce + floor.gap + floor.slip;
  output Real e = b.kineticEnergy + b.velocity[2];
  output Real p = damper.power;
end M;
)");
  TF_ASSERT_DERIVED(model);
  using enum ir::SymbolKind;
  Point point(*model, 3);
  const double x = point(Velocity, 0), y = point(Velocity, 1);
  const auto value = [&](const char *name) {
    return point.evaluate(model->graph, model->outputs.at(static_cast<std::size_t>(model.quantity(name)->index)));
  };
  EXPECT_NEAR(value("f"), 2 * point(NormalForce) + point(TangentForce) + point(Coordinate, 1) + x, 1e-14);
  EXPECT_NEAR(value("e"), 1.5 * (x * x + y * y) + y, 1e-14);
  EXPECT_NEAR(value("p"), -2 * (x + y) * (x + y), 1e-14);
  EXPECT_NEAR(point.evaluate(model->graph, model->force[0]), -2 * (x + y), 1e-14);
}

// Rows of friction that are no results of their own have names where results depend on them.
TEST(Printing, NamesTheRowsOfOtherFormsOfFriction) {
  DerivedModel model(R"(
model M
  coordinate Real q[3];
  body ball(mass = 1, position = q);
  contact table(gap = q[3], slip = der(q[1:2]), friction = 0.3, frictionForm = FrictionForm.Polyhedral, directions = 2);
  friction dry(slip = der(q[1:2]), bound = 2, frictionForm = FrictionForm.Relaxed);
end M;
)");
  TF_ASSERT_DERIVED(model);
  const std::string text = print(*model);
  for (const char *name : {"table.lt[1]", "table.lt[2]", "dry.lt[3]", "dry.lt[4]"})
    EXPECT_NE(text.find(name), std::string::npos) << text;
  EXPECT_EQ(text.find('?'), std::string::npos) << text;
}

TEST(Verifier, FindsWhatBreaksTheContract) {
  DerivedModel model(kModel);
  TF_ASSERT_DERIVED(model);
  const auto broken = [&](auto change) {
    HybridSystem system = *model;
    change(system);
    return verify(system);
  };
  EXPECT_NE(broken([](HybridSystem &s) { s.force.pop_back(); }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.force[0] = s.graph.symbol(ir::SymbolKind::NormalForce, 0); }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.outputs[0] = s.graph.symbol(ir::SymbolKind::Unknown, 0); }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.switches[0].condition = s.graph.symbol(ir::SymbolKind::StepVariable, 0); }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.contacts[1].tangentFirst = 3; }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.quantities[3].name = "time"; }), "");
  EXPECT_NE(broken([](HybridSystem &s) { s.aliases[0].quantity = 1000; }), "");
}

}  // namespace
}  // namespace tf::test
