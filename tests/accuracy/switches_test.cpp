// Switches of conditions: none is missed, branches that end at their switch are left in time, and what switches without end says so.
#include "tests/accuracy/each_integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace tf::test {
namespace {

// Torricelli's law: the root h = (1 − t/2)² has no derivative that is continuous beyond its end.
TEST(BranchesThatEnd, TankThatEmptiesStaysEmpty) {
  const std::string file = sourceFile("tank.tf", R"(
model Tank
  Real h(start = 1);
equation
  der(h) = -sqrt(max(0, h));
end Tank;
)");
  withEachIntegrator(file, 1e-8, 1, [](CompiledModel &model) {
    EXPECT_NEAR(model["h"], 0.25, 1e-7);
    model.advance(3);
    EXPECT_NEAR(model["h"], 0, 1e-8);
  });
}

// The flow goes on at the speed 1 where the level crosses zero: 2 (y − ln(1 + y)) with y = sqrt|x| is the time from or to there.
TEST(BranchesThatEnd, AreCrossedAtASpeed) {
  const std::string file = sourceFile("turbulent.tf", R"(
model Turbulent
  Real x(start = 1);
equation
  der(x) = -1 - sqrt(abs(x));
end Turbulent;
)");
  const double crossing = 2 * (1 - std::log(2.0));
  const auto time = [](double x) { return 2 * (std::sqrt(-x) - std::log1p(std::sqrt(-x))); };
  // Error estimates are for smooth equations: of a root from its zero on that of the pair of order 5 shows a fortieth.
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    withEachIntegrator(file, tolerance, 2,
                       [&](const CompiledModel &model) { EXPECT_NEAR(crossing + time(model["x"]), 2, 10 * tolerance); });
}

// Hertz' force stores and returns the energy: the ball leaves as fast as it came.
TEST(BranchesThatEnd, HertzContactReturnsTheSpeed) {
  for (const char *force : {"max(0, x)^1.5", "(if x > 0 then x^1.5 else 0)"}) {
    const std::string file = sourceFile("hertz.tf", std::string("model Hertz\n  coordinate Real x(start = -0.5, der(start = 1));\n"
                                                                "  body b(mass = 1, position = x);\n  force f(value = -100*") +
                                                        force + ", at = x);\nend Hertz;\n");
    withEachIntegrator(file, 1e-8, 2, [](const CompiledModel &model) { EXPECT_NEAR(model["der(x)"], -1, 5e-8); });
  }
}

// x'' = −2 sgn x − sgn x': from x' = v on x = 0 the speed falls to zero with −3, rises to v/√3 with 1 and so on.
const char *const twisting = R"(
model Twisting
  coordinate Real x(der(start = 0.01));
  body b(mass = 1, position = x);
  force f(value = -2*sign(x) - sign(der(x)), at = x);
end Twisting;
)";

std::vector<double> twistingTimes(double v, int count) {
  std::vector<double> times;
  for (double time = 0; static_cast<int>(times.size()) < count; v /= std::sqrt(3.0)) {
    times.push_back(time += v / 3);
    times.push_back(time += v / std::sqrt(3.0));
  }
  return times;
}

// A ball falls against a constant drag, comes to rest, and is slowly lifted: relations of its velocity while that is zero.
TEST(Switches, RelationsAtRestAreThoseThatAreWritten) {
  const std::string file = sourceFile("relations_at_rest.tf", R"(
model AtRest
  coordinate Real y(start = 0.8);
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -10});
  force drag(value = -2*sign(der(y)), at = y);
  force lift(value = if time < 4 then 0 else 5*(time - 4), at = y);
  contact floor(gap = y);
  Real up(start = 0), notDown(start = 0), down(start = 0), notUp(start = 0), sum(start = 0);
equation
  der(up) = if der(y) > 0 then 1 else 0;
  der(notDown) = if der(y) >= 0 then 1 else 0;
  der(down) = if der(y) < 0 then 1 else 0;
  der(notUp) = if der(y) <= 0 then 1 else 0;
  der(sum) = sign(der(y));
end AtRest;
)");
  // It falls with an acceleration of 8, and leaves the floor when the lift is its weight.
  const double fall = std::sqrt(0.2), leave = 4 + 10 / 5.0;
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", " + std::to_string(tolerance));
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(5);
      EXPECT_NEAR(model["floor.normalForce"], 10 - 5, 1e-9);
      EXPECT_NEAR(model["down"], fall, tolerance);
      EXPECT_EQ(model["up"], 0);
      EXPECT_NEAR(model["notDown"], 5 - fall, 10 * tolerance);
      EXPECT_NEAR(model["notUp"], 5, 10 * tolerance);
      EXPECT_NEAR(model["sum"], -fall, tolerance);
      // The drag, in the sense of Filippov, holds it in the air until the lift is larger by its limit.
      model.advance(8);
      EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), leave, 1e-9);
      EXPECT_NEAR(model["y"], 5.0 / 6 * std::pow(8 - leave - 0.4, 3), 10 * tolerance);
    }
}

// Conditions that a contact or friction keeps at zero while they depend on time: what steps are off by inside is no switch.
TEST(Switches, ConditionsThatContactsHoldStayZero) {
  const std::string rest = sourceFile("held_by_contact.tf", R"(
model Held
  coordinate Real y(start = 0, der(start = 0.3));
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -9.81});
  contact c(gap = y - 0.1*sin(3*time));
  Real above(start = 0), higher(start = 0), distance(start = 0);
equation
  der(above) = if der(y) > 0.3*cos(3*time) then 1 else 0;
  der(higher) = if y > 0.1*sin(3*time) then 1 else 0;
  der(distance) = abs(der(y) - 0.3*cos(3*time));
end Held;
)");
  const std::string stick = sourceFile("held_by_friction.tf", R"(
model Stuck
  coordinate Real x(start = 0, der(start = 0.3));
  body b(mass = 1, position = x);
  friction c(slip = der(x) - 0.3*cos(3*time), bound = if time < 2.5 then 5 else 0);
  Real above(start = 0), higher(start = 0), distance(start = 0);
equation
  der(above) = if der(x) > 0.3*cos(3*time) then 1 else 0;
  der(higher) = if der(x) >= 0.3*cos(3*time) then 0 else 1;
  der(distance) = abs(der(x) - 0.3*cos(3*time));
end Stuck;
)");
  for (const std::string &file : {rest, stick})
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-3, 1e-6, 1e-9})
        for (const double interval : {0.01, 2.5}) {
          SCOPED_TRACE(file + ", integrator " + std::to_string(integrator) + ", " + std::to_string(tolerance));
          CompiledModel model(file);
          model.tolerance(tolerance).integrator(integrator).initialise();
          for (int k = 1; k * interval <= 2.5; ++k)
            model.advance(k * interval);
          EXPECT_EQ(model["above"], 0);
          EXPECT_EQ(model["higher"], 0);
          EXPECT_NEAR(model["distance"], 0, tolerance);
          EXPECT_EQ(model.events().size(), 0U);
        }
  // Friction ends, and with it the hold.
  CompiledModel model(stick);
  model.tolerance(1e-9).run(2.5 + 0.1);
  EXPECT_NEAR(model["above"], 0.1, 1e-9);
  EXPECT_EQ(model["higher"], 0);
}

TEST(Switches, ThatFollowOneThatJustWasAreFound) {
  constexpr int count = 20;
  const std::vector<double> expected = twistingTimes(0.01, count);
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT}) {
    CompiledModel model(sourceFile("twisting.tf", twisting));
    model.tolerance(1e-8).integrator(integrator).run(0.5 * (expected[count - 1] + expected[count - 2]));
    ASSERT_EQ(model.events().size(), static_cast<std::size_t>(count - 1)) << integrator;
    for (int k = 0; k < count - 1; ++k)
      EXPECT_NEAR(model.events()[k].time, expected[k], 1e-12) << integrator << ", event " << k;
  }
}

TEST(Switches, WithoutEndEndTheRun) {
  const double end = 0.01 * (1.0 / 3 + 1 / std::sqrt(3.0)) / (1 - 1 / std::sqrt(3.0));
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(sourceFile("twisting.tf", twisting));
    model.tolerance(1e-8).integrator(integrator);
    try {
      model.run(1);
      ADD_FAILURE() << integrator;
    } catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find("no consistent continuation: 'sign(x)' ("), std::string::npos) << error.what();
    }
    EXPECT_NEAR(model.time(), end, 1e-3);
    EXPECT_NEAR(model["x"], 0, 1e-9);
  }
}

// s' = −1.5 sqrt|s| sgn s + u + sin t, u' = −1.1 sgn s: s and s' come to zero together, through infinitely many switches.
TEST(Switches, WithoutEndInASuperTwistingControllerAreNamed) {
  for (const char *sign : {"sign(s)", "(if s > 0 then 1 else -1)"})
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
        CompiledModel model(
            sourceFile(std::string("super_twisting_") + (sign[0] == 's' ? "a.tf" : "b.tf"),
                       std::string("model SuperTwisting\n  Real s(start = 1), u;\nequation\n  der(s) = -1.5*sqrt(abs(s))*") + sign +
                           " + u + sin(time);\n  der(u) = -1.1*" + sign + ";\nend SuperTwisting;\n"));
        model.tolerance(tolerance).integrator(integrator);
        try {
          model.run(10);
          ADD_FAILURE() << integrator;
        } catch (const std::runtime_error &error) {
          EXPECT_NE(std::string(error.what()).find("no consistent continuation: '"), std::string::npos) << error.what();
          EXPECT_NE(std::string(error.what()).find("switches without end: "), std::string::npos) << error.what();
        }
      }
}

// Where times are so coarse that within the least of them a slip changes by more than what counts as zero, it stops all the same.
TEST(LateStops, AreOneEvent) {
  struct Case {
    double mass, bound, speed, begin;
  };
  const std::string file = sourceFile("late_stop.tf", R"(
model LateStop
  parameter Real m = 1, b = 3, v = 10;
  coordinate Real x(der(start = v));
  body slider(mass = m, position = x);
  friction f(slip = der(x), bound = b);
end LateStop;
)");
  for (const auto &[mass, bound, speed, begin] : {Case{1, 3, 10, 1e5}, Case{1e-6, 0.01, 1, 99}, Case{1, 1e3, 1, 1e3}, Case{1, 1e6, 1, 10}})
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-4, 1e-9}) {
        const double duration = speed * mass / bound;
        CompiledModel model(file, {{"m", mass}, {"b", bound}, {"v", speed}});
        model.tolerance(tolerance).integrator(integrator).initialise(begin);
        model.advance(begin + 2 * duration);
        EXPECT_EQ(model.events().size(), 1) << integrator << ' ' << begin;
        EXPECT_EQ(model.count(TF_EVENT_STICK), 1) << integrator << ' ' << begin;
        EXPECT_EQ(model["der(x)"], 0) << integrator << ' ' << begin;
        EXPECT_NEAR(model["x"], 0.5 * speed * duration, 10 * tolerance + 4e-16 * begin * speed) << integrator << ' ' << begin;
      }
}

// A relation of the velocity switches where the slip stops: there it has the value at rest, which friction can hold. x'' = 12 + x.
TEST(SwitchesOfVelocity, AreThoseAtRestWhereASlipStops) {
  const std::string file = sourceFile("drive_by_sign.tf", R"(
model DriveBySign
  parameter Real v0, k = 0.1, forwards = 30, backwards = -3;
  coordinate Real x(der(start = v0)), y;
  body b(mass = 0.5, position = {x, y});
  gravity g(acceleration = {0, -10});
  contact floor(gap = y, slip = der(x), friction = 1.8 + k*x);
  force drive(value = if der(x) > 0 then forwards else backwards, at = x);
end DriveBySign;
)");
  for (const double speed : {0.313, 0.77, 1.3, 2.0})
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10})
      withEachIntegrator(file, tolerance, 1,
                         [&](CompiledModel &model) {
                           EXPECT_NEAR(model["x"], std::sqrt(144 - speed * speed) - 12, 10 * tolerance)
                               << speed << ", tolerance " << tolerance;
                           EXPECT_EQ(model["der(x)"], 0) << speed << ", tolerance " << tolerance;
                         },
                         {{"v0", -speed}});
}

// What friction cannot hold turns back: by 58 m/s² until then, by 32 m/s² afterwards.
TEST(SwitchesOfVelocity, TurnWithASlipThatCannotStop) {
  const std::string file = sourceFile("drive_that_turns.tf", R"(
model DriveThatTurns
  coordinate Real x(der(start = -2)), y;
  body b(mass = 0.5, position = {x, y});
  gravity g(acceleration = {0, -10});
  contact floor(gap = y, slip = der(x), friction = 1.8);
  force drive(value = if der(x) > 0 then 25 else 20, at = x);
end DriveThatTurns;
)");
  const double stop = 2.0 / 58;
  for (const double tolerance : {1e-4, 1e-7, 1e-10})
    withEachIntegrator(file, tolerance, 1, [&](CompiledModel &model) {
      EXPECT_NEAR(model["x"], 16 * (1 - stop) * (1 - stop) - stop, 100 * tolerance) << tolerance;
      EXPECT_NEAR(model["der(x)"], 32 * (1 - stop), 100 * tolerance) << tolerance;
    });
}

// x' = −2 sgn x − k sin t slides on x = 0 and leaves it where |k sin t| = 2: there the rate begins at zero, as a difference of large terms
// that rounding gives a sign.
TEST(SlidingModes, AreLeftAgainAndAgain) {
  const std::string ofState = sourceFile("sliding_of_a_state.tf", R"(
model A
  parameter Real k = 2.5;
  Real x(start = 0, fixed = true);
equation
  der(x) = -2*sign(x) - k*sin(time);
end A;
)"),
                    ofVelocity = sourceFile("sliding_of_a_velocity.tf", R"(
model A
  parameter Real k = 2.5, m = 0.7;
  coordinate Real s;
  Real x = der(s);
  body b(mass = m, position = s);
  force f(value = -m*(2*sign(der(s)) + k*sin(time)), at = s);
end A;
)");
  constexpr double pi = 3.14159265358979323846;
  for (const std::string &file : {ofState, ofVelocity})
    for (const double k : {2.1, 2.5, 2.92126, 3.3})
      for (const double tolerance : {1e-6, 1e-9, 1e-11})
        for (const tf_integrator integrator : integrators) {
          CompiledModel model(file, {{"k", k}});
          model.tolerance(tolerance).integrator(integrator);
          model.initialise();
          const double leaves = std::asin(2 / k);
          int slides = 0;
          for (int period = 0; period < 16; ++period) {
            const double t = leaves + period * pi + 0.7, sign = period % 2 == 0 ? -1 : 1;
            ASSERT_NO_THROW(model.advance(t)) << k << ' ' << tolerance << ' ' << integrator;
            EXPECT_NEAR(model["x"], sign * (k * (std::cos(leaves) - std::cos(leaves + 0.7)) - 2 * 0.7), 20 * tolerance);
            ++slides;
          }
          EXPECT_EQ(model.count(TF_EVENT_SLIDING), slides - 1);
        }
}

// Friction that doubles at a speed, under a drive that grows as 1 + t/2: the speed reaches 0.5 at √2 and stays there until the drive is 2.
TEST(SlidingModes, HoldASpeedAtWhichFrictionGrows) {
  for (const char *friction : {"friction c(slip = der(x), bound = if der(x) > 0.5 then 2 else 1)",
                               "friction c(slip = der(x) + 10, bound = if der(x) > 0.5 then 2 else 1)",
                               "friction c(slip = {der(x), der(z)}, bound = if der(x) > 0.5 then 2 else 1)"}) {
    const std::string file =
        sourceFile("friction_that_grows.tf", "model A\n  coordinate Real x, y, z;\n  body b(mass = 1, position = {x, y, z});\n"
                                             "  force f(value = {1 + time/2, 0, 0}, at = {x, y, z});\n  " +
                                                 std::string(friction) + ";\nend A;\n");
    for (const double tolerance : {1e-6, 1e-10})
      withEachIntegrator(file, tolerance, 1, [&](CompiledModel &model) {
        SCOPED_TRACE(std::string(friction) + " at " + std::to_string(tolerance));
        const double allowed = 20 * tolerance;
        EXPECT_NEAR(model["der(x)"], 0.25, allowed);
        model.advance(1.9);
        EXPECT_NEAR(model["der(x)"], 0.5, allowed);
        EXPECT_NEAR(model["x"], std::pow(2, 1.5) / 12 + 0.5 * (1.9 - std::sqrt(2.0)), allowed);
        model.advance(3);
        EXPECT_NEAR(model["der(x)"], 0.75, allowed);
        EXPECT_EQ(model.count(TF_EVENT_SLIDING), 1);
        EXPECT_NEAR(model.eventTime(TF_EVENT_SLIDING), std::sqrt(2.0), allowed);
      });
  }
}

}  // namespace
}  // namespace tf::test
