// Gaps, slips, friction and masses that are no numbers end the run with their name and place: nothing goes on through them.
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace tf::test {
namespace {

struct Undefined {
  const char *name, *contact, *message;
  double earliest, latest;
};

std::ostream &operator<<(std::ostream &out, const Undefined &u) { return out << u.name; }

class UndefinedValues : public testing::TestWithParam<Undefined> {};

TEST_P(UndefinedValues, EndTheRun) {
  const Undefined &u = GetParam();
  const std::string body = "model A\n  coordinate Real x(der(start = 1)), y;\n  body b(mass = 1, position = {x, y});\n"
                           "  gravity g(acceleration = {0, -9.81});\n  ";
  const std::string file = sourceFile(std::string("undefined_") + u.name + ".tf", body + u.contact + ";\nend A;\n");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    model.tolerance(1e-8).integrator(integrator);
    std::string text;
    try {
      model.initialise();
      for (int k = 1; k <= 50; ++k)
        model.advance(0.02 * k);
    } catch (const std::runtime_error &error) {
      text = error.what();
    }
    EXPECT_NE(text.find(u.message), std::string::npos) << text;
    if (u.latest > 0) {
      EXPECT_GE(model.time(), u.earliest);
      EXPECT_LE(model.time(), u.latest);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Contacts, UndefinedValues,
    testing::Values(Undefined{"gap", "contact c(gap = y + 10 - sqrt(0.5 - time))", "NaN in the gap of contact 'c' (", 0.47, 0.53},
                    Undefined{"gap_by_state", "contact c(gap = sqrt(0.5 - x) + y + 10)", "NaN in the gap of contact 'c' (", 0.47, 0.53},
                    Undefined{"gap_beside_an_open_contact",
                              "contact a(gap = y + 20, slip = der(x) - sqrt(-1 - time), friction = 0.1);\n  "
                              "contact c(gap = y + 10 - sqrt(0.5 - time))",
                              "NaN in the gap of contact 'c' (", 0.47, 0.53},
                    Undefined{"slip", "contact c(gap = y, slip = der(x) - sqrt(0.5 - time), friction = 0.01)",
                              "NaN in the slip of contact 'c' (", 0.47, 0.53},
                    Undefined{"slip_at_the_start", "contact c(gap = y, slip = der(x) - sqrt(-1 - time), friction = 0.01)",
                              "NaN in the slip of contact 'c' (", 0, 0},
                    Undefined{"friction", "contact c(gap = y, slip = der(x), friction = 0.01*sqrt(0.5 - time))",
                              "NaN in the friction coefficient of contact 'c' (", 0.47, 0.53},
                    Undefined{"bound", "friction c(slip = der(x), bound = 0.01*sqrt(0.5 - time))",
                              "NaN in the bound of friction element 'c' (", 0.47, 0.53}),
    [](const auto &tested) { return std::string(tested.param.name); });

// Forces on what friction or the floor holds: no choice of a mode is possible with them.
class UndefinedForces : public testing::TestWithParam<std::pair<const char *, const char *>> {};

TEST_P(UndefinedForces, EndTheRunWhereTheyBegin) {
  const auto &[name, elements] = GetParam();
  for (const auto &[value, text] :
       {std::pair("sqrt(-1 - time)", "NaN"), std::pair("10*1e308", "infinity"),
        std::pair("if time < 0.5 then 0 else sqrt(0.4 - time)", "NaN"), std::pair("if time < 0.5 then 0 else 10*1e308", "infinity")}) {
    const bool isLate = std::string(value).starts_with("if");
    const std::string file = sourceFile(std::string("undefined_force_") + name + text + (isLate ? "_late" : "") + ".tf",
                                        "model A\n  coordinate Real x, y, z;\n  body b(mass = 1, position = {x, y, z});\n"
                                        "  gravity g(acceleration = {0, 0, -9.81});\n  force f(value = {" +
                                            std::string(value) + ", 0, 0}, at = {x, y, z});\n  " + elements + ";\nend A;\n");
    for (const tf_integrator integrator : integrators) {
      CompiledModel model(file);
      model.tolerance(1e-6).integrator(integrator);
      const std::string error = errorOfRun(model, 1);
      EXPECT_NE(error.find(std::string(text) + " in 'der(der(x))'"), std::string::npos) << name << ", " << value << ": " << error;
      if (isLate) {
        EXPECT_NEAR(model.time(), 0.5, 1e-12) << name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, UndefinedForces,
                         testing::Values(std::pair("friction", "friction c(slip = der(x), bound = 1)"),
                                         std::pair("friction_of_two", "friction c(slip = {der(x), der(y)}, bound = 1)"),
                                         std::pair("floor", "contact c(gap = z)"),
                                         std::pair("rough_floor", "contact c(gap = z, slip = der(x), friction = 1)"),
                                         std::pair("rough_floor_in_space", "contact c(gap = z, slip = {der(x), der(y)}, friction = 1)")),
                         [](const auto &tested) { return std::string(tested.param.first); });

// A block at rest, pulled by time/2, whose friction √(1 − time) can no longer hold it from 2√2 − 2 on.
class UndefinedLimits : public testing::TestWithParam<std::pair<const char *, const char *>> {};

TEST_P(UndefinedLimits, AreFoundAfterTheSlipBeforeThem) {
  const auto &[name, elements] = GetParam();
  const std::string file = sourceFile(std::string("undefined_limit_of_") + name + ".tf",
                                      "model A\n  coordinate Real x, y;\n  body b(mass = 1, position = {x, y});\n"
                                      "  force f(value = {time/2, -1}, at = {x, y});\n  " +
                                          std::string(elements) + ";\nend A;\n");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-3, 1e-9}) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator);
      const std::string text = errorOfRun(model, 3);
      EXPECT_NE(text.find("NaN in the "), std::string::npos) << text;
      EXPECT_NEAR(model.time(), 1, 1e-9);
      EXPECT_EQ(model.count(TF_EVENT_SLIP), 1);
      EXPECT_NEAR(model.eventTime(TF_EVENT_SLIP), 2 * std::sqrt(2.0) - 2, 1e-11);
    }
}

INSTANTIATE_TEST_SUITE_P(Elements, UndefinedLimits,
                         testing::Values(std::pair("contact", "contact floor(gap = y, slip = der(x), friction = sqrt(1 - time))"),
                                         std::pair("friction",
                                                   "contact floor(gap = y);\n  friction c(slip = der(x), bound = sqrt(1 - time))")),
                         [](const auto &tested) { return std::string(tested.param.first); });

// A limit jumps to what is none, with other ones around it, at rest and in motion; the run goes on with another input.
TEST(UndefinedLimit, OfAnInputIsNamedAndTheRunGoesOnWithAnotherOne) {
  const std::string file = sourceFile("jumping_limits.tf", R"(
model A
  input Real mu(start = 0.2), bound(start = 1), root(start = 1);
  coordinate Real x(der(start = 1)), y, z(der(start = 1));
  body b(mass = 1, position = {x, y});
  body c(mass = 1, position = {z, 0});
  gravity g(acceleration = {0, -10});
  contact floor(gap = y, slip = der(x), friction = mu);
  friction rail(slip = der(z), bound = bound*sqrt(root));
end A;
)");
  const struct {
    const char *input, *message;
    double bad, good;
  } cases[] = {{"mu", "the friction coefficient of contact 'floor' is -0.5, it cannot be negative", -0.5, 0.2},
               {"bound", "the bound of friction element 'rail' is -1, it cannot be negative", -1, 1},
               {"root", "NaN in the bound of friction element 'rail'", -1, 1}};
  for (const auto &one : cases)
    for (const double at : {0.1, 2.0}) {
      SCOPED_TRACE(std::string(one.input) + " at " + std::to_string(at));
      CompiledModel model(file);
      model.initialise();
      model.advance(at);
      const double x = model["x"];
      ASSERT_EQ(tf_set(model.simulation(), one.input, one.bad), TF_OK);
      try {
        model.advance(3);
        ADD_FAILURE() << "no error";
      } catch (const std::runtime_error &error) {
        EXPECT_NE(std::string(error.what()).find(one.message), std::string::npos) << error.what();
      }
      EXPECT_EQ(model["x"], x);
      ASSERT_EQ(tf_set(model.simulation(), one.input, one.good), TF_OK);
      model.advance(3);
      // Both stop by v²/2a, as if nothing had happened.
      EXPECT_NEAR(model["x"], 0.25, 1e-8);
      EXPECT_NEAR(model["z"], 0.5, 1e-8);
    }
}

// The spring's energy jumps with its stiffness from 2 to 3, not from what the failed event has tried.
TEST(UndefinedLimit, OfAnInputLeavesTheEnergyBalanceOfWhatFollows) {
  const std::string file = sourceFile("spring_and_rail.tf", R"(
model SpringAndRail
  input Real k(start = 2), bound(start = 0.1);
  coordinate Real x(start = 1);
  body b(mass = 1, position = {x, 0});
  potential spring(energy = k*x^2/2);
  friction rail(slip = der(x), bound = bound);
end SpringAndRail;
)");
  CompiledModel model(file);
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.tolerance(1e-9).initialise();
  model.advance(0.5);
  const double x = model["x"], before = model["energy.work"];
  ASSERT_EQ(tf_set(model.simulation(), "bound", -1), TF_OK);
  ASSERT_EQ(tf_set(model.simulation(), "k", 50), TF_OK);
  EXPECT_THROW(model.advance(1), std::runtime_error);
  ASSERT_EQ(tf_set(model.simulation(), "bound", 0.1), TF_OK);
  ASSERT_EQ(tf_set(model.simulation(), "k", 3), TF_OK);
  model.advance(1);
  EXPECT_NEAR(model["energy.work"] - before, x * x / 2, 1e-9);
}

TEST(UndefinedMass, IsNamed) {
  const std::string file = sourceFile("undefined_mass.tf", R"(
model A
  parameter Real m = 1;
  coordinate Real x(der(start = 1));
  body b(mass = if m > 2 then sqrt(2 - m) else m, position = x);
end A;
)");
  const auto message = [&](double mass) {
    CompiledModel model(file, {{"m", mass}});
    try {
      model.initialise();
    } catch (const std::runtime_error &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(1), "");
  EXPECT_NE(message(0).find("the mass matrix is singular: no inertia acts on 'x'"), std::string::npos) << message(0);
  EXPECT_NE(message(-1).find("the inertia that acts on 'x' is -1, it cannot be negative"), std::string::npos) << message(-1);
  EXPECT_NE(message(3).find("NaN in the inertia that acts on 'x'"), std::string::npos) << message(3);
}

// A rod falls about its lower end until it lies flat, where the other end is the lower one; energy is m g a sin φ at first.
TEST(KinkOfAClosedGap, EndsTheRun) {
  const std::string file = sourceFile("flat_rod.tf", R"(
model FlatRod
  parameter Real a = 0.5, J = 0.1, start = 0.3;
  coordinate Real y(start = a*sin(start)), phi(start = start);
  body b(mass = 1, position = {0, y}, angle = phi, inertia = J);
  gravity g(acceleration = {0, -9.81});
  contact c(gap = y - a*sqrt(sin(phi)^2));
end FlatRod;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator);
      const std::string text = errorOfRun(model, 1);
      EXPECT_NE(text.find("the derivative of the gap of contact 'c' ("), std::string::npos) << text;
      // The run goes up to the last step before it.
      EXPECT_NEAR(model["phi"], 0, 0.1);
      EXPECT_NEAR(model.energy(), 0.5 * 9.81 * std::sin(0.3), std::max(1e-8, 10 * tolerance));
    }
}

// A ground or a rail that jumps at a place, which smooth() hides: no body follows it.
TEST(JumpOfAHeldGap, EndsTheRun) {
  for (const auto &[jump, element, text] :
       {std::tuple("0.1", "contact c(gap = y - h, slip = der(x), friction = 0.1)", "the gap of contact 'c' ("),
        std::tuple("-0.1", "contact c(gap = y - h, slip = der(x), friction = 0.1)", "the gap of contact 'c' ("),
        std::tuple("0.1", "constraint c(residual = y - h)", "constraint 'c' ("),
        std::tuple("2e-3", "constraint c(residual = y - h)", "constraint 'c' (")}) {
    const std::string file = sourceFile(std::string("jumping_ground") + jump + element[1] + ".tf",
                                        "model A\n  coordinate Real x(start = -1, der(start = 2)), y;\n"
                                        "  Real h = smooth(2, if x < 0 then 0 else " +
                                            std::string(jump) +
                                            ");\n  body b(mass = 1, position = {x, y});\n"
                                            "  gravity g(acceleration = {0, -9.81});\n  " +
                                            element + ";\nend A;\n");
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-5, 1e-8}) {
        CompiledModel model(file);
        model.tolerance(tolerance).integrator(integrator);
        const std::string error = errorOfRun(model, 1);
        EXPECT_NE(error.find(text), std::string::npos) << error;
        EXPECT_NE(error.find("jumps at t = 0.5"), std::string::npos) << error;
        EXPECT_NEAR(model["y"], 0, 1e-9);
        EXPECT_LT(model["x"], 1e-6);
      }
  }
}

}  // namespace
}  // namespace tf::test
