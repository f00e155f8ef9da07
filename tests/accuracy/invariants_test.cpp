// What holds in every run: no penetration, no pulling contact, friction inside its cone, no energy out of nothing.
#include "tests/accuracy/each_integrator.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>

namespace tf::test {
namespace {

struct InvariantsCase {
  const char *file;
  bool isFree;  // nothing does work on it: the energy may only fall
};

std::ostream &operator<<(std::ostream &out, const InvariantsCase &c) { return out << c.file; }

class Invariants : public testing::TestWithParam<InvariantsCase> {};

TEST_P(Invariants, HoldAtEveryOutput) {
  CompiledModel model(example(GetParam().file));
  for (const tf_integrator integrator : integrators) {
    model.tolerance(1e-8).integrator(integrator).initialise();
    double energy = model.energy();
    const double scale = std::max(1.0, std::abs(energy)), end = model.model().stop_time;
    for (int i = 1; i <= 997; ++i) {
      model.advance(end * i / 997);
      for (const double gap : model.valuesOf(TF_KIND_GAP)) {
        ASSERT_GE(gap, -1e-10) << "t = " << model.time() << ", integrator " << integrator;
      }
      for (const double force : model.valuesOf(TF_KIND_NORMAL_FORCE)) {
        ASSERT_GE(force, 0) << "t = " << model.time() << ", integrator " << integrator;
      }
      if (GetParam().isFree) {
        const double now = model.energy();
        ASSERT_LE(now, energy + 1e-7 * scale) << "t = " << model.time() << ", integrator " << integrator;
        energy = std::min(energy, now);
      }
    }
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_gap, -1e-10);
    EXPECT_GE(statistics.worst_normal_force, 0);
  }
}

// In long steps of loose tolerances, whose events are found on an interpolant that leaves the closed contacts a little.
TEST_P(Invariants, HoldWhereStepsAreLong) {
  for (const double tolerance : {1e-1, 1e-2, 1e-3})
    for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT}) {
      CompiledModel model(example(GetParam().file));
      tf_set_energy_balance(model.simulation(), 1);
      model.tolerance(tolerance).integrator(integrator).run(model.model().stop_time);
      EXPECT_GE(tf_get_statistics(model.simulation())->worst_gap, -1e-10) << "tolerance " << tolerance << ", integrator " << integrator;
    }
}

INSTANTIATE_TEST_SUITE_P(Examples, Invariants,
                         testing::Values(InvariantsCase{"particle.tf", true}, InvariantsCase{"incline.tf", true},
                                         InvariantsCase{"corner.tf", true}, InvariantsCase{"falling_rod.tf", true},
                                         InvariantsCase{"falling_box.tf", true}, InvariantsCase{"chain.tf", true},
                                         InvariantsCase{"slider_crank.tf", true}, InvariantsCase{"carts.tf", true},
                                         InvariantsCase{"pushed_block.tf", false}, InvariantsCase{"moving_ground.tf", false},
                                         InvariantsCase{"pendulum_wall.tf", false}),
                         [](const testing::TestParamInfo<InvariantsCase> &testCase) {
                           const std::string file = testCase.param.file;
                           return file.substr(0, file.find('.'));
                         });

// A bump that is far narrower than what steps look for is passed over: a result on it shows that, although no step ends there.
TEST(InvariantsAtSamples, ShowWhatStepsHavePassedOver) {
  CompiledModel model(sourceFile("needle.tf", R"(
model Needle
  coordinate Real x(der(start = 1)), y(start = 0.5);
  body b(mass = 1, position = {x, y});
  contact needle(gap = y - exp(-((x - 3)/1e-7)^2));
end Needle;
)"));
  model.tolerance(1e-8).initialise();
  const auto read = [](void *data, double time) {
    (void)(*static_cast<const CompiledModel *>(data))["y"];
    return time + 1;
  };
  ASSERT_EQ(tf_run(model.simulation(), 5.5, 1, read, &model), TF_OK) << tf_error_text(model.simulation());
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_NEAR(statistics.worst_gap, -0.5, 1e-6);
  EXPECT_EQ(statistics.worst_gap_time, 3);
  EXPECT_EQ(statistics.worst_gap_contact, 0);
}

TEST(Friction, StaysInItsCone) {
  for (const char *file : {"falling_rod.tf", "falling_box.tf", "chain.tf", "pushed_block.tf"}) {
    CompiledModel model(example(file));
    model.tolerance(1e-8).initialise();
    const double mu = model["mu"];
    for (int i = 1; i <= 500; ++i) {
      model.advance(model.model().stop_time * i / 500);
      const auto normal = model.valuesOf(TF_KIND_NORMAL_FORCE), tangent = model.valuesOf(TF_KIND_TANGENT_FORCE),
                 slip = model.valuesOf(TF_KIND_SLIP);
      for (std::size_t c = 0; c < normal.size(); ++c) {
        ASSERT_LE(std::abs(tangent[c]), mu * normal[c] + 1e-9) << file << ", t = " << model.time();
        if (normal[c] > 1e-6 && std::abs(slip[c]) > 1e-6) {
          ASSERT_NEAR(tangent[c], -std::copysign(mu * normal[c], slip[c]), 1e-9) << file << ", t = " << model.time();
        }
      }
    }
  }
}

// A force that has no value for an instant between the stages of steps, where the quadrature of the balance has a point.
TEST(EnergyBalance, SaysWhereItIsEstimated) {
  CompiledModel model(sourceFile("hole.tf", R"(
model Hole
  parameter Real hole = 0.1069431844;
  coordinate Real x(start = 1);
  body m(mass = 1, position = x);
  force f(value = if noEvent(abs(time - hole) < 1e-4) then sqrt(-1 - x^2) else -x, at = x);
end Hole;
)"));
  model.stepOptions(3, 0.1).integrator(TF_STEP);
  tf_set_energy_balance(model.simulation(), 1);
  model.run(1);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_NEAR(statistics.estimated_energy_time, 0.1, 1e-12);
  EXPECT_LT(statistics.worst_energy_error, 5e-3);
  EXPECT_GT(statistics.worst_energy_error, 1e-7);
}

// A ball bounces on a floor a sin(ωt) until it rests there: what the bounces take, bounce by bounce until they take 1e-7 s, then by their
// geometric sum.
struct PaddleReference {
  static constexpr double g = 9.81, a = 0.03, omega = 15, e = 0.6, height = 0.2;
  double impulse = 0, impactLoss = 0, restTime = 0;

  static double floor(double t) { return a * std::sin(omega * t); }
  static double floorSpeed(double t) { return a * omega * std::cos(omega * t); }
  PaddleReference() {
    double time = 0, y = height, v = 0, flight = std::sqrt(2 * height / g);
    for (int k = 0; k < 80; ++k) {
      const double begin = time;
      for (int pass = 0; pass < 60; ++pass) {
        const double gap = y + v * flight - 0.5 * g * flight * flight - floor(begin + flight);
        flight -= gap / (v - g * flight - floorSpeed(begin + flight));
      }
      time = begin + flight;
      const double speed = v - g * flight, w = floorSpeed(time), relative = speed - w;
      y = floor(time);
      v = w - e * relative;
      impulse += v - speed;
      impactLoss += w * (v - speed) - 0.5 * (v * v - speed * speed);
      // The next bounce, as if the floor kept its acceleration.
      flight = 2 * (v - w) / (g - omega * omega * a * std::sin(omega * time));
      if (flight < 1e-7) {
        impulse += (1 + e) / (1 - e) * (v - w);
        restTime = time + flight / (1 - e);
        break;
      }
    }
  }
};

TEST(EnergyBalance, OfInfinitelyManyImpactsOnAMovingFloorIsKnownToTheTolerance) {
  const PaddleReference reference;
  const std::string file = sourceFile("paddle.tf", R"(model Paddle
  coordinate Real y(start = 0.2);
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -9.81});
  contact c(gap = y - 0.03*sin(15*time), restitution = 0.6, law = ImpactLaw.Newton);
end Paddle;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", tolerance " + std::to_string(tolerance));
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator);
      tf_set_energy_balance(model.simulation(), 1);
      model.run(1.5);
      ASSERT_EQ(model.count(TF_EVENT_REST), 1);
      EXPECT_NEAR(model.eventTime(TF_EVENT_REST), reference.restTime, 10 * tolerance);
      EXPECT_NEAR(model["c.impulse"], reference.impulse, 10 * tolerance * reference.impulse);
      EXPECT_NEAR(model["energy.impactLoss"], reference.impactLoss, 10 * tolerance);
      EXPECT_NEAR(model["energy.work"], model.energy() - reference.g * reference.height + reference.impactLoss, 10 * tolerance);
    }
}

// Errors add up with the energy that passes through a system which never holds much.
TEST(EnergyBalance, IsRelativeToTheEnergyThatHasPassed) {
  CompiledModel model(sourceFile("rub.tf", R"(
model Rub "drawn to and fro over a rough table"
  coordinate Real x;
  body b(mass = 1, position = x);
  friction table(slip = der(x), bound = 0.1);
  force drive(value = sin(time) - x, at = x);
end Rub;
)"));
  model.tolerance(1e-4);
  tf_set_energy_balance(model.simulation(), 1);
  model.run(1e4);
  EXPECT_LT(tf_get_statistics(model.simulation())->worst_energy_error, 1e-4);
}

// The same lift, in its own coordinates, in those of the ground, and as a body that a constraint drives: a ball loses m g h in its impacts,
// and the lift works against its weight.
TEST(Energies, OfImpactsInALiftDoNotDependOnTheCoordinates) {
  const std::string common = R"(
  parameter Real V = 3, e = 0;
  gravity g(acceleration = {0, -10});
)";
  const std::string models[] = {
      "coordinate Real y(start = 0.2);\n  body b(mass = 1, position = {0, y + V*time});\n  contact f(gap = y, restitution = e);",
      "coordinate Real y(start = 0.2, der(start = V));\n  body b(mass = 1, position = {0, y});\n"
      "  contact f(gap = y - V*time, restitution = e);",
      "coordinate Real y(start = 0.2, der(start = V)), s(der(start = V));\n  body b(mass = 1, position = {0, y});\n"
      "  body lift(mass = 5, position = {s, 0});\n  constraint drive(residual = s - V*time);\n"
      "  contact f(gap = y - s, restitution = e);"};
  int number = 0;
  for (const std::string &own : models) {
    const std::string name = "Lift" + std::to_string(++number);
    const std::string file =
        sourceFile("lift" + std::to_string(number) + ".tf", "model " + name + common + "  " + own + "\nend " + name + ";\n");
    for (const double e : {0.0, 0.6})
      for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
        CompiledModel model(file, {{"e", e}});
        ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
        model.tolerance(tolerance).run(2);
        EXPECT_NEAR(model["energy.impactLoss"], 2, 1e-9) << number << ", " << e << ", " << tolerance;
        EXPECT_NEAR(model["energy.work"], 60, 1e-8) << number << ", " << e << ", " << tolerance;
      }
  }
}

// Infinitely many impacts lose m g h while a constraint does other work.
TEST(Energies, OfInfinitelyManyImpactsBesideADrive) {
  const std::string file = sourceFile("driven_beside.tf", R"(
model Beside
  coordinate Real y(start = 0.5), x(start = 0, der(start = 3)), s(start = 0, der(start = 2));
  body b(mass = 1, position = {s, y});
  body d(mass = 1, position = {x, 0});
  gravity g(acceleration = {0, -10});
  constraint drive(residual = x - sin(3*time));
  contact f(gap = y, slip = der(s), friction = 0.1, restitution = 0.8);
end Beside;
)");
  for (const double tolerance : {1e-4, 1e-6, 1e-9, 1e-11}) {
    CompiledModel model(file);
    ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
    model.tolerance(tolerance).run(4);
    EXPECT_GE(model.count(TF_EVENT_REST), 1);
    EXPECT_NEAR(model["energy.work"], 4.5 * (std::pow(std::cos(12), 2) - 1), 10 * tolerance) << tolerance;
    // Of friction that part which is in the impacts belongs to them.
    EXPECT_NEAR(model["energy.impactLoss"] + model["energy.frictionLoss"], 5 + 2, 10 * tolerance) << tolerance;
  }
}

double withBalance(CompiledModel &model, double end, tf_integrator integrator) {
  EXPECT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.tolerance(1e-9).integrator(integrator).run(end);
  EXPECT_LE(tf_get_statistics(model.simulation())->worst_energy_error, 1e-7) << integrator;
  return model["energy.work"];
}

// x'' = -k x with x(0) = 1 at rest: k is 1 up to 1, then 3.
TEST(Energies, OfAStiffnessThatSwitchesInTime) {
  const std::string file = sourceFile("switched_stiffness.tf", R"(
model SwitchedStiffness
  coordinate Real x(start = 1);
  body b(mass = 1, position = x);
  potential spring(energy = 0.5*(if time < 1 then 1 else 3)*x^2);
end SwitchedStiffness;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    EXPECT_NEAR(withBalance(model, 2, integrator), std::pow(std::cos(1), 2), 1e-7) << integrator;
  }
}

TEST(Energies, OfAStiffnessThatAStateSwitches) {
  const std::string file = sourceFile("worn_stiffness.tf", R"(
model WornStiffness
  coordinate Real x(start = 1);
  Real z(start = 1);
  body b(mass = 1, position = x);
  potential spring(energy = 0.5*(if z > 0.5 then 4 else 1)*x^2);
equation
  der(z) = -z;
end WornStiffness;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    EXPECT_NEAR(withBalance(model, 2, integrator), -1.5 * std::pow(std::cos(2 * std::log(2)), 2), 1e-7) << integrator;
  }
}

// An input that changes as a function of time does the work that time itself would do.
TEST(Energies, OfPotentialsThatInputsChange) {
  const auto spring = [](const std::string &declaration, const std::string &name) {
    return sourceFile(name + ".tf", R"(
model Spring
  )" + declaration + R"(
  coordinate Real x[2](start = {1, 0});
  body b(mass = 1, position = x);
  potential p(energy = 0.5*u*x[1]^2 + sin(u)*x[2] + exp(0.2*u)*x[2]^2);
end Spring;
)");
  };
  const std::string driven = spring("input Real u;", "driven_spring"), timed = spring("Real u = 1 + 2*time;", "timed_spring");
  for (const tf_integrator integrator : integrators) {
    CompiledModel byInput(driven), byTime(timed);
    const std::array<double, 3> times = {0, 1, 2}, values = {1, 3, 5};
    ASSERT_EQ(tf_set_input_table(byInput.simulation(), "u", times.data(), values.data(), times.size(), 1), TF_OK);
    EXPECT_NEAR(withBalance(byInput, 1.9, integrator), withBalance(byTime, 1.9, integrator), 1e-7) << integrator;
    EXPECT_NEAR(byInput["x[1]"], byTime["x[1]"], 1e-7) << integrator;
  }
}

// Steps of the stabilised method do not resolve the stretch of the spring inside them, nor its rate, which the damper takes to a power.
TEST(Energies, OfAStiffDamperAtLooseTolerances) {
  const std::string file = sourceFile("stiff_damper.tf", R"(
model StiffDamper
  coordinate Real x(der(start = 3)), y(start = 0.01), z;
  body a(mass = 1, position = {x, y});
  body b(mass = 0.01, position = {z, 0});
  gravity weight(acceleration = {0, -9.81});
  force coupling(value = -1e6*(x - z) - 2e3*(der(x) - der(z)), at = x - z);
  potential soft(energy = 20*x^2);
  contact floor(gap = y, slip = der(x), friction = 0.3, restitution = 0.4);
end StiffDamper;
)");
  const auto workAt = [&](double tolerance, tf_integrator integrator) {
    CompiledModel model(file);
    EXPECT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
    model.tolerance(tolerance).integrator(integrator).run(1.7);
    EXPECT_LE(tf_get_statistics(model.simulation())->worst_energy_error, 10 * tolerance) << integrator;
    return model["energy.work"];
  };
  const double reference = workAt(1e-11, TF_STEP);
  for (const tf_integrator integrator : {TF_AUTO, TF_EXPLICIT, TF_CVODE})
    for (const double tolerance : {1e-3, 3e-4, 1e-4, 1e-5, 1e-6})
      EXPECT_NEAR(workAt(tolerance, integrator), reference, 10 * tolerance) << integrator << ", " << tolerance;
}

// Errors of the velocity that the tolerance allows are a multiple of the way that the damper lets it lag behind the belt.
TEST(Energies, OfAStiffDamperOnAMovingBelt) {
  const std::string file = sourceFile("damped_belt.tf", R"(
model DampedBelt
  coordinate Real z(der(start = 2));
  body load(mass = 1, position = z);
  force belt(value = -1e5*(der(z) - cos(3*time)), at = z);
end DampedBelt;
)");
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6, 1e-8})
    withEachIntegrator(
        file, tolerance, 1,
        [tolerance](CompiledModel &model) {
          EXPECT_LE(tf_get_statistics(model.simulation())->worst_energy_error, 10 * tolerance) << tolerance;
          // m v² / 2 is 2 at the start; the belt's lag is a 1e-5th of its rate.
          const double speed = std::cos(3.0) + 3e-5 * std::sin(3.0);
          EXPECT_NEAR(model["energy.work"], 0.5 * speed * speed - 2, 10 * tolerance + 1e-9) << tolerance;
        },
        {}, [](CompiledModel &model) { EXPECT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK); });
}

// Friction that turns near a stop is as stiff as a damper; nothing else acts on the ball.
TEST(Energies, OfASlidingBallHaveNoWork) {
  withEachIntegrator(
      example("backspin_ball.tf"), 1e-6, 1, [](CompiledModel &model) { EXPECT_NEAR(model["energy.work"], 0, 1e-14); }, {},
      [](CompiledModel &model) { EXPECT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK); });
}

// Each rod is stretched twice a turn, where its share of the load, which is the least one, grows beyond all bounds.
TEST(Energies, OfRedundantConstraintsThatAreStretched) {
  const std::string file = sourceFile("coupled_wheels.tf", R"(
model CoupledWheels "two wheels with a rod on each side, cranks at right angles"
  parameter Real r = 0.2, d = 1;
  coordinate Real a[2](each start = 0.5, der(each start = 10));
  body w[2](angle = a, each inertia = 0.5);
  constraint left(residual = ((d + r*cos(a[2]) - r*cos(a[1]))^2 + (r*sin(a[2]) - r*sin(a[1]))^2 - d^2)/(2*d));
  constraint right(residual = ((d - r*sin(a[2]) + r*sin(a[1]))^2 + (r*cos(a[2]) - r*cos(a[1]))^2 - d^2)/(2*d));
  force engine(value = 1, at = a[1]);
end CoupledWheels;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
      CompiledModel model(file);
      ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
      model.tolerance(tolerance).integrator(integrator).run(2);
      EXPECT_NEAR(model["energy.work"], 22, std::max(1e-7, 100 * tolerance)) << integrator << ", " << tolerance;
    }
}

void expectJumpAt(const std::string &file, double time, const std::string &text) {
  CompiledModel model(file);
  try {
    model.run(1);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
  EXPECT_NEAR(model.time(), time, 1e-6);
}

TEST(Energies, ThatNoForceChangesAreErrors) {
  const auto body = [](const std::string &position, const std::string &energy, const std::string &name) {
    return sourceFile(name + ".tf", "model Jumps\n  coordinate Real x(start = 1, der(start = -2));\n  body b(mass = 1, position = " +
                                        position + ");\n  potential p(energy = " + energy + ");\nend Jumps;\n");
  };
  const std::string velocity = "the velocity of a body jumps where ";
  expectJumpAt(body("x + max(0, time - 0.25)", "0", "bent_position"), 0.25, velocity + "'max(0, time - 0.25)'");
  expectJumpAt(body("x + abs(time - 0.25)", "0", "turned_position"), 0.25, velocity);
  expectJumpAt(body("x", "if x > 0 then 0 else 1", "stepped_energy"), 0.5, "the potential energy jumps by 1 where 'x > 0'");
  // A position and an energy that are smooth enough.
  CompiledModel smooth(body("x + (if time < 0.25 then 0 else (time - 0.25)^2)", "if x > 0 then 0 else x^2", "smooth"));
  withBalance(smooth, 1, TF_AUTO);
}

// Bodies whose positions are functions of time move where nothing else does, in steps as long as the output lets them.
TEST(Energies, OfWhatMovesBesideARest) {
  const std::string file = sourceFile("moves_beside.tf", R"(
model MovesBeside
  coordinate Real x, y;
  body b(mass = 1, position = {x + 0.2*sin(3*time), y + 0.1*sin(5*time)});
  gravity g(acceleration = {0, -10});
  contact f(gap = y, slip = der(x), friction = 0.5);
end MovesBeside;
)");
  const auto energy = [](double t) {
    return 0.5 * (std::pow(0.6 * std::cos(3 * t), 2) + std::pow(0.5 * std::cos(5 * t), 2)) + std::sin(5 * t);
  };
  for (const tf_integrator integrator : integrators)
    for (const double interval : {0.1, 1.0, 20.0}) {
      CompiledModel model(file);
      ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
      model.tolerance(1e-8).integrator(integrator).initialise();
      for (int k = 1; k * interval <= 20; ++k)
        model.advance(k * interval);
      EXPECT_NEAR(model["energy.work"], energy(20) - energy(0), 1e-7) << integrator << ", " << interval;
    }
}

}  // namespace
}  // namespace tf::test
