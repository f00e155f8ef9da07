// Relaxed friction of slips of two components, c3 = ‖slip‖ − slipRadius: against closed forms of its law (outside of the disk, inside and
// on its edge), and its convergence to Coulomb's exact law.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/tumbling_box.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace tf::test {
namespace {

using Vector = std::complex<double>;

std::string puck(const std::string &form = "Relaxed") {
  return sourceFile("relaxed_puck_" + form + ".tf", R"(
model Puck
  parameter Real mu = 0.3, radius = 1e-3, vx = 2, vy = 0, height = 0, fall = 0, e = 0, pull[2] = {0, 0};
  coordinate Real q[3](start = {0, 0, height}, der(start = {vx, vy, -fall}));
  body puck(mass = 2, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = pull, at = q[1:2]);
  contact table(gap = q[3], slip = der(q[1:2]), friction = mu, restitution = e, frictionForm = FrictionForm.)" +
                                                        form +
                                                        (form == "Relaxed" ? R"(, slipRadius = radius);
end Puck;
)"
                                                                           : R"();
end Puck;
)"));
}

Vector place(const CompiledModel &model) { return {model["q[1]"], model["q[2]"]}; }
Vector velocity(const CompiledModel &model) { return {model["der(q[1])"], model["der(q[2])"]}; }
Vector friction(const CompiledModel &model) { return {model["table.frictionForce[1]"], model["table.frictionForce[2]"]}; }

// Without load the puck slides as under Coulomb's law until it is as fast as the disk's radius, which it stays.
TEST(RelaxedFriction, SlidesToTheEdgeOfTheDisk) {
  const double deceleration = 0.3 * g;
  for (const double radius : {0.1, 1e-3, 1e-6})
    for (const tf_integrator integrator : integrators) {
      CompiledModel model(puck(), {{"vx", 1.2}, {"vy", 1.6}, {"radius", radius}});
      model.tolerance(1e-10).integrator(integrator).initialise();
      const Vector along = {0.6, 0.8};
      const double tolerance = integrator == TF_CVODE ? 1e-7 : 1e-9, slows = (2 - radius) / deceleration;
      model.advance(0.3);
      EXPECT_NEAR(std::abs(place(model) - (2 * 0.3 - 0.5 * deceleration * 0.09) * along), 0, tolerance);
      EXPECT_EQ(model["table.sticking"], 0);
      EXPECT_EQ(model["table.alpha[3]"], 1);
      EXPECT_NEAR(std::abs(friction(model) + 2 * deceleration * along), 0, tolerance);
      model.advance(2);
      const double way = (4 - radius * radius) / (2 * deceleration) + radius * (2 - slows);
      EXPECT_NEAR(std::abs(place(model) - way * along), 0, tolerance) << radius << " integrator " << integrator;
      EXPECT_NEAR(std::abs(velocity(model) - radius * along), 0, 1e-12);
      EXPECT_EQ(model["table.sticking"], 1);
      EXPECT_NEAR(std::abs(friction(model)), 0, 1e-9);
      EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), slows, tolerance);
      EXPECT_EQ(model.events().size(), 1U);
    }
}

// On the edge friction is radial: the slip turns into the direction of the load F with m ε θ' = −F sin θ.
TEST(RelaxedFriction, TurnsOnTheEdgeIntoTheLoad) {
  const double radius = 0.05, load = 1.5, rate = load / (2 * radius);
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(puck(), {{"vx", radius}, {"radius", radius}, {"pull[2]", load}});
    model.tolerance(1e-10).integrator(integrator).initialise();
    const double tolerance = integrator == TF_CVODE ? 1e-7 : 1e-9;
    for (const double time : {0.02, 0.1, 0.4}) {
      model.advance(time);
      const double angle = 2 * std::atan(std::tan(std::numbers::pi / 4) * std::exp(-rate * time));  // to the load
      EXPECT_NEAR(model["der(q[2])"], radius * std::cos(angle), tolerance) << time << " integrator " << integrator;
      EXPECT_NEAR(model["der(q[1])"], radius * std::sin(angle), tolerance);
      EXPECT_NEAR(std::abs(friction(model) + load * std::cos(angle) * std::polar(1.0, std::numbers::pi / 2 - angle)), 0, 1e-6);
      const double limit = 0.3 * 2 * g, share = load * std::cos(angle) / limit;
      EXPECT_NEAR(model["table.alpha[3]"], share, 2e-6);
    }
    EXPECT_EQ(model.count(TF_EVENT_STICK), 0);
  }
}

// From rest a load that friction could hold takes the puck to the edge of the disk, where it creeps along the load.
TEST(RelaxedFriction, CreepsAlongTheLoad) {
  for (const double radius : {0.02, 1e-4, 1e-7})
    for (const tf_integrator integrator : integrators) {
      CompiledModel model(puck(), {{"vx", 0}, {"radius", radius}, {"pull[1]", 3}, {"pull[2]", -4}});
      model.tolerance(1e-9).integrator(integrator).run(1);
      // Up to the edge with 2.5 m/s², less a push of 1e-6 of the limit.
      const double start = radius / 2.5;
      EXPECT_NEAR(std::abs(place(model) - radius * (1 - start / 2) * Vector(0.6, -0.8)), 0, 1e-6 * radius + 1e-11);
      EXPECT_NEAR(std::abs(velocity(model) - radius * Vector(0.6, -0.8)), 0, 1e-9 * radius + 1e-15);
      EXPECT_NEAR(std::abs(friction(model) + Vector(3, -4)), 0, 1e-6);
      EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), start, 1e-6 * start + 1e-12);
    }
}

// Thrown up a slope, the puck comes to the edge of the disk with its slip against the load: it goes through the disk, and creeps down.
TEST(RelaxedFriction, TurnsRoundInTheDisk) {
  const double radius = 1e-3, load = 2, down = load / 2, up = 0.3 * g + down;
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(puck(), {{"radius", radius}, {"pull[1]", -load}});
    model.tolerance(1e-10).integrator(integrator).run(2);
    const double enters = (2 - radius) / up, leaves = enters + 2 * radius / down;
    const double tolerance = integrator == TF_CVODE ? 1e-7 : 1e-9;
    EXPECT_NEAR(model.eventTime(TF_EVENT_SLIP_REVERSAL), enters, tolerance);
    EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), leaves, 10 * tolerance);
    EXPECT_NEAR(model["q[1]"], (4 - radius * radius) / (2 * up) - radius * (2 - leaves), tolerance);
    EXPECT_NEAR(model["der(q[1])"], -radius, 1e-12);
    EXPECT_NEAR(model["table.frictionForce[1]"], load, 1e-8);
  }
}

TEST(RelaxedFriction, BreaksAwayBeyondCoulombsLimit) {
  CompiledModel model(puck(), {{"vx", 0}, {"pull[2]", 1.01 * 0.3 * 2 * g}});
  model.tolerance(1e-10).run(1);
  EXPECT_EQ(model["table.sticking"], 0);
  EXPECT_NEAR(model["der(q[2])"], 0.01 * 0.3 * g + 0.99e-3, 1e-5);
}

// Errors in proportion to the radius.
TEST(RelaxedFriction, ConvergesToCoulombsLaw) {
  const Settings load = {{"vy", -0.7}, {"pull[1]", 0.5}, {"pull[2]", 1.5}};
  CompiledModel exact(puck("Exact"), load);
  exact.tolerance(1e-11).run(1.5);
  double before = 0;
  for (const double radius : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    Settings settings = load;
    settings.emplace_back("radius", radius);
    CompiledModel model(puck(), settings);
    model.tolerance(1e-11).run(1.5);
    const double error = std::abs(place(model) - place(exact));
    EXPECT_LT(error, 1.5 * radius);
    if (before > 0) {
      EXPECT_NEAR(error / before, 0.1, 0.02) << radius;
    }
    before = error;
  }
}

// While time is frozen the components of the slip have the exact law.
TEST(RelaxedFriction, ImpulsesAreThoseOfTheExactForm) {
  for (const double fall : {0.5, 3.0, 8.0})
    for (const double e : {0.0, 0.6}) {
      const Settings settings = {{"vy", 1}, {"fall", fall}, {"e", e}};
      CompiledModel exact(puck("Exact"), settings), model(puck(), settings);
      exact.tolerance(1e-9).initialise();
      model.tolerance(1e-9).initialise();
      EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1);
      EXPECT_NEAR(std::abs(velocity(model) - velocity(exact)), 0, 1e-13);
      EXPECT_NEAR(model["der(q[3])"], exact["der(q[3])"], 1e-13);
      EXPECT_NEAR(model["table.impulse"], exact["table.impulse"], 1e-13);
    }
}

std::string ball(const std::string &form) {
  return sourceFile("relaxed_ball_" + form + ".tf", R"(
model Ball "with backspin"
  parameter Real r = 0.1, m = 1, mu = 0.2, height = 0.1, e = 0.5;
  coordinate Real p[3](start = {0, 0, height}, der(start = {3, 1, 0}));
  coordinate Rotation R(w(start = {5, -60, 10}));
  body ball(mass = m, position = p, orientation = R, inertia = 0.4*m*r^2*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  Real w[3] = R*R.w;
  contact floor(gap = p[3] - r, slip = {der(p[1]) - w[2]*r, der(p[2]) + w[1]*r}, friction = mu, restitution = e,
                frictionForm = FrictionForm.)" + form + (form == "Relaxed" ? ", slipRadius = 1e-5" : "") +
                                                        R"();
end Ball;
)");
}

// Bounces to rest, slides, turns and rolls.
TEST(RelaxedFriction, BallWithBackspinIsNearTheExactOne) {
  for (const double height : {0.1, 0.5}) {
    CompiledModel exact(ball("Exact"), {{"height", height}}), model(ball("Relaxed"), {{"height", height}});
    for (CompiledModel *one : {&exact, &model}) {
      one->tolerance(1e-10).initialise();
      one->advance(3);
    }
    for (const char *name : {"p[1]", "p[2]", "der(p[1])", "der(p[2])"})
      EXPECT_NEAR(model[name], exact[name], 2e-5) << name << " from " << height;
    EXPECT_NEAR(std::hypot(model["floor.slip[1]"], model["floor.slip[2]"]), 1e-5, 1e-12);
    EXPECT_EQ(model.count(TF_EVENT_STICK), 1);
  }
}

TEST(RelaxedFriction, FrictionElementsHaveItToo) {
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(sourceFile("relaxed_element.tf", R"(
model Damped "with a belt that starts to move"
  parameter Real radius = 1e-3;
  coordinate Real q[2](der(start = {1, 0.6}));
  body puck(mass = 2, position = q);
  friction dry(slip = der(q) - {if time < 1 then 0 else time - 1, 0}, bound = 3, frictionForm = FrictionForm.Relaxed, slipRadius = radius);
end Damped;
)"));
    model.tolerance(1e-9).integrator(integrator).initialise();
    const double speed = std::hypot(1, 0.6);
    model.advance(0.5);
    EXPECT_NEAR(model["der(q[1])"], (1 - 1.5 * 0.5 / speed), 1e-8);
    EXPECT_NEAR(model["dry.force[2]"], -3 * 0.6 / speed, 1e-8);
    // Carried along, a little slower than the belt.
    model.advance(2);
    EXPECT_NEAR(model["der(q[1])"], 1 - 1e-3, 1e-6);
    EXPECT_NEAR(model["dry.force[1]"], 2, 1e-4);
    EXPECT_EQ(model["dry.sticking"], 1);
  }
}

std::string box() {
  return tumblingBox("relaxed_box.tf", ", radius = 1e-4", "each frictionForm = FrictionForm.Relaxed, each slipRadius = radius");
}

// Faces that slide and turn on their four corners. Energy does not rise: the push inside of the disk does as little work as its edge
// allows.
TEST(RelaxedFriction, TumblingBoxesKeepTheirInvariants) {
  std::mt19937 random(7);
  const auto between = [&random](double low, double high) { return low + (high - low) * (static_cast<double>(random()) / 4294967296.0); };
  for (int run = 0; run < 12; ++run) {
    Settings settings = {{"mu", between(0, 1.5)}, {"e", run % 2 == 0 ? 0 : between(0, 1)}, {"radius", std::pow(10, -2 - run % 4)}};
    for (const char *name : {"v[1]", "v[2]", "w[1]", "w[2]", "w[3]"})
      settings.emplace_back(name, between(-5, 5));
    CompiledModel model(box(), settings);
    model.tolerance(1e-8);
    tf_set_energy_balance(model.simulation(), 1);
    model.initialise();
    double energy = model.energy();
    for (double time = 0.1; time < 3; time += 0.1) {
      model.advance(time);
      EXPECT_LT(model.energy(), energy + 1e-5) << run << " at " << time;
      energy = model.energy();
    }
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GT(statistics.worst_gap, -1e-9) << run;
    EXPECT_GT(statistics.worst_normal_force, -1e-12) << run;
    EXPECT_LT(statistics.worst_energy_error, 1e-6) << run;
  }
}

std::string errorOf(const Settings &settings, bool withSensitivity) {
  CompiledModel model(puck(), settings);
  const char *name = "mu";
  if (withSensitivity)
    tf_set_sensitivities(model.simulation(), &name, 1);
  return tf_initialise(model.simulation(), 0) == TF_FAILED ? tf_error_text(model.simulation()) : "";
}

TEST(RelaxedFriction, RefusesWhatItCannotDo) {
  const std::string radius = errorOf({{"radius", 1e-12}}, false);
  EXPECT_NE(radius.find("contact 'table' has slipRadius 1e-12; a run needs 1e-09 or more"), std::string::npos) << radius;
  const std::string sensitivity = errorOf({}, true);
  EXPECT_NE(sensitivity.find("but contact 'table' has .Relaxed"), std::string::npos) << sensitivity;
}

// The default radius is as small as the default tolerance: the slip is held in its disk all the same.
TEST(RelaxedFriction, SmallDisksAreFollowedAtAnyTolerance) {
  const std::string file = sourceFile("relaxed_brief_slip.tf", R"(
model BriefSlip
  coordinate Real p[3];
  body b(mass = 1, position = p);
  force f(value = {2.899, 2.5*sin(time), -9.372}, at = p);
  contact k(gap = p[3], slip = der(p[1:2]), friction = 0.4, frictionForm = FrictionForm.Relaxed);
end BriefSlip;
)");
  CompiledModel reference(file);
  reference.tolerance(1e-10).run(3);
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    CompiledModel model(file);
    model.tolerance(tolerance).run(3);
    EXPECT_NEAR(model["p[1]"], reference["p[1]"], 1e-6) << tolerance;
    EXPECT_NEAR(model["p[2]"], reference["p[2]"], 1e-6) << tolerance;
  }
}

}  // namespace
}  // namespace tf::test
