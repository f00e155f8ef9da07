// Free flight with constant accelerations and rest that nothing can end are followed in closed form: exact over any time, and without
// evaluations of the model on the way.
#include "tests/accuracy/each_integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

long long evaluations(const CompiledModel &model) { return tf_get_statistics(model.simulation())->evaluations; }

// A body that is thrown in the plane, with couplings in M, and lands on a slope after a long time.
std::string thrownBody() {
  return sourceFile("thrown.tf", R"(
model Thrown
  coordinate Real s[3](start = {0, 100, 0}, der(start = {30, 200, 3}));
  body base(mass = 2, position = {s[1], s[2]});
  body load(mass = 1, position = {s[1] + s[2], s[2] + 2*s[3]}, angle = s[3], inertia = 0.3);
  gravity weight(acceleration = {0, -9.81});
  force wind(value = {0.5, 0}, at = {s[1], s[2]});
  contact slope(gap = s[2] + 0.1*s[1], restitution = 0.5);
end Thrown;
)");
}

TEST(UniformMotion, FlightIsExact) {
  CompiledModel model(thrownBody());
  ASSERT_EQ(model.model().uniform_flight, 1);
  model.tolerance(1e-4).run(0.5);
  // M a = f by hand, with J = [[1, 1, 0], [0, 1, 2]] of the load.
  const double a00 = 3, a01 = 1, a11 = 4, a12 = 2, a22 = 4.3, g = 9.81;
  const double f0 = 0.5, f1 = -3 * g, f2 = -2 * g;
  // Elimination of the first and the last row.
  const double d = a11 - a01 * a01 / a00 - a12 * a12 / a22, second = (f1 - a01 * f0 / a00 - a12 * f2 / a22) / d;
  const double first = (f0 - a01 * second) / a00, third = (f2 - a12 * second) / a22;
  const auto at = [](double start, double velocity, double acceleration, double t) {
    return start + t * (velocity + 0.5 * t * acceleration);
  };
  EXPECT_NEAR(model["s[1]"], at(0, 30, first, 0.5), 1e-12);
  EXPECT_NEAR(model["s[2]"], at(100, 200, second, 0.5), 1e-12 * 200);
  EXPECT_NEAR(model["s[3]"], at(0, 3, third, 0.5), 1e-12);
  const long long before = evaluations(model);
  model.advance(10);
  model.advance(20);
  EXPECT_EQ(evaluations(model), before);
  // The first impact: the positive zero of a parabola.
  const double p = 0.5 * (second + 0.1 * first), q = 200 + 3.0, r = 100;
  const double impact = (-q - std::sqrt(q * q - 4 * p * r)) / (2 * p);
  model.advance(impact + 1);
  ASSERT_GE(model.count(TF_EVENT_IMPACT), 1);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), impact, 1e-12 * impact);
}

// States beside the coordinates, forces that depend on anything that changes, and constraints: not uniform.
TEST(UniformMotion, FlightWithVaryingForcesIsIntegrated) {
  const std::string head = "model M\n  coordinate Real x(start = 1);\n  body b(mass = 1, position = x);\n";
  for (const char *more : {"  force f(value = -x, at = x);\n", "  force f(value = time, at = x);\n",
                           "  force f(value = -der(x), at = x);\n", "  input Real u;\n  force f(value = u, at = x);\n",
                           "  force f(value = if x > 0 then 1 else 2, at = x);\n", "  Real z(start = 1);\nequation\n  der(z) = -z;\n"}) {
    CompiledModel model(sourceFile("varying_flight.tf", head + more + "end M;\n"));
    EXPECT_EQ(model.model().uniform_flight, 0) << more;
  }
}

// Zeros of gaps that are parabolas then are not looked for by samples; those of others are, though they look alike at both ends of a
// flight.
TEST(UniformMotion, GapsThatAreAffineAreKnown) {
  const auto flagOf = [](const std::string &gap) {
    const CompiledModel model(sourceFile("affine_gap.tf", R"(
model M
  parameter Real a = 0.1, b = 2;
  coordinate Real x(start = 1), y(start = 1);
  body m(mass = 1, position = {x, y});
  contact c(gap = )" + gap + ");\nend M;\n"));
    return model.model().contacts[0].gap_is_affine;
  };
  for (const char *gap : {"y", "y - a*x + b", "-(x - y)/(b + a) + a*b", "cos(a)*y + sin(a)*x + 1", "2*(y - 3*(x - y))"})
    EXPECT_EQ(flagOf(gap), 1) << gap;
  for (const char *gap : {"y - a*x^2", "y + 0.1*time", "y + smooth(2, abs(x))", "y + smooth(2, noEvent(floor(x)))", "y*x", "b/(y + 1)",
                          "y + smooth(2, if x > 0 then x else 0)", "sin(y)"})
    EXPECT_EQ(flagOf(gap), 0) << gap;
}

// The flight is symmetric, and so are the gap and its rate at both ends: the post in the middle is met all the same.
TEST(UniformMotion, PostInTheMiddleOfAFlightIsMet) {
  CompiledModel model(sourceFile("post.tf", R"(
model Post
  coordinate Real x(start = -1, der(start = 1)), y(start = 1, der(start = 10));
  body ball(mass = 1, position = {x, y});
  gravity weight(acceleration = {0, -10});
  contact post(gap = y + 1 - 8*exp(-50*x^2), restitution = 0);
end Post;
)"));
  ASSERT_EQ(model.model().uniform_flight, 1);
  model.tolerance(1e-8).run(2);
  ASSERT_GE(model.count(TF_EVENT_IMPACT), 1);
  const auto gap = [](double t) { return 2 + 10 * t - 5 * t * t - 8 * std::exp(-50 * (t - 1) * (t - 1)); };
  double open = 0.8, closed = 1;
  while (closed - open > 1e-15)
    (gap(0.5 * (open + closed)) > 0 ? open : closed) = 0.5 * (open + closed);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), closed, 1e-11);
}

// A box that slides on a rough floor comes to rest on two corners; a push begins at t = 50.
TEST(UniformMotion, RestLastsUntilSomethingPushes) {
  CompiledModel model(sourceFile("resting_box.tf", R"(
model Resting
  coordinate Real r[2](start = {0, 0.3}, der(start = {1, 0}));
  coordinate Real phi;
  body box(mass = 2, position = r, angle = phi, inertia = 0.2);
  gravity weight(acceleration = {0, -9.81});
  force push(value = if time > 50 then 20 else 0, at = r[1]);
  contact corner[2](gap = {r[2] - 0.5*sin(phi) - 0.3*cos(phi), r[2] + 0.5*sin(phi) - 0.3*cos(phi)},
    slip = {der(r[1] - 0.5*cos(phi) + 0.3*sin(phi)), der(r[1] + 0.5*cos(phi) + 0.3*sin(phi))}, each friction = 0.4);
end Resting;
)"));
  model.tolerance(1e-8).run(20);
  const double stop = 0.5 / (0.4 * 9.81);
  EXPECT_NEAR(model["r[1]"], stop, 1e-9);
  const double x = model["r[1]"], y = model["r[2]"];
  const long long before = evaluations(model);
  for (int k = 1; k <= 100; ++k)
    model.advance(20 + 0.29 * k);
  // No stages, and what it rests on is known.
  EXPECT_LE(evaluations(model) - before, 100);
  EXPECT_EQ(model["r[1]"], x);
  EXPECT_EQ(model["r[2]"], y);
  EXPECT_NEAR(model["corner[1].normalForce"] + model["corner[2].normalForce"], 2 * 9.81, 1e-12);
  model.advance(51);
  EXPECT_NEAR(model["r[1]"], x + 0.5 * (10 - 0.4 * 9.81), 1e-8);
}

// An input that does not change leaves rest to be held; where it changes, rest may end.
TEST(UniformMotion, ConstantInputsHoldRest) {
  CompiledModel model(sourceFile("pushed_block.tf", R"(
model Pushed
  input Real u;
  coordinate Real x, y;
  body block(mass = 1, position = {x, y});
  gravity weight(acceleration = {0, -10});
  force push(value = u, at = x);
  contact floor(gap = y, slip = der(x), friction = 0.5);
end Pushed;
)"));
  const double times[] = {0, 30}, forces[] = {4, 7};
  ASSERT_EQ(tf_set_input_table(model.simulation(), "u", times, forces, 2, 0), TF_OK);
  model.tolerance(1e-8).run(20);
  const long long before = evaluations(model);
  for (int k = 1; k <= 90; ++k)
    model.advance(20 + 0.1 * k);
  EXPECT_LE(evaluations(model) - before, 90);
  EXPECT_EQ(model["x"], 0);
  EXPECT_NEAR(model["floor.frictionForce"], -4, 1e-12);
  model.advance(31);
  EXPECT_NEAR(model["x"], 0.5 * (7 - 5), 1e-12);
}

// A velocity of zero is no rest where the motion is not held, or where what holds it moves.
TEST(UniformMotion, AnInstantWithoutVelocityIsNoRest) {
  CompiledModel pendulum(sourceFile("upright.tf", R"(
model Upright
  coordinate Real phi(start = 1e-6);
  body bob(mass = 1, position = {sin(phi), cos(phi)});
  gravity weight(acceleration = {0, -10});
end Upright;
)"));
  pendulum.tolerance(1e-10).run(2);
  EXPECT_NEAR(pendulum["phi"], 1e-6 * std::cosh(2 * std::sqrt(10.0)), 1e-9);
  CompiledModel lift(sourceFile("lift.tf", R"(
model Lift
  coordinate Real y;
  body load(mass = 1, position = {0, y});
  gravity weight(acceleration = {0, -10});
  contact floor(gap = y - 0.01*(1 - cos(10*time)));
end Lift;
)"));
  lift.tolerance(1e-10).run(3);
  EXPECT_NEAR(lift["y"], 0.01 * (1 - std::cos(30.0)), 1e-10);
  EXPECT_NEAR(lift["floor.normalForce"], 10 + std::cos(30.0), 1e-7);
}

// A sphere on a rough floor in space: rolling is free, so that only friction against turning could hold it; a box is held.
TEST(UniformMotion, InSpaceRestIsWhatIsHeld) {
  CompiledModel sphere(sourceFile("sphere_at_rest.tf", R"(
model Sphere
  coordinate Real r[3](start = {0, 0, 0.1});
  coordinate Rotation Q "orientation";
  Real w[3] = Q*Q.w;
  body ball(mass = 1, position = r, orientation = Q, inertia = 0.004*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  force push(value = if time > 10 then {1, 0, 0} else {0, 0, 0}, at = r);
  contact floor(gap = r[3] - 0.1, slip = {der(r[1]) - 0.1*w[2], der(r[2]) + 0.1*w[1]}, friction = 0.5);
end Sphere;
)"));
  sphere.tolerance(1e-9).run(9);
  EXPECT_EQ(sphere["r[1]"], 0);
  sphere.advance(11);
  EXPECT_NEAR(sphere["r[1]"], 0.5 / (1 + 0.4), 1e-8);
}

// What is met at a place only, of which nothing is to be seen where a long way begins and ends. A puck strikes a bump in its way: the bump
// has its height where h = H exp(−u²), and the puck is reflected by its normal.
TEST(UniformMotion, BumpsOnTheWayAreMet) {
  const std::string file = sourceFile("bump.tf", R"(
model Bump
  parameter Real H = 0.3, s = 0.5;
  coordinate Real x(der(start = 1)), y(start = 0.1);
  body puck(mass = 1, position = {x, y});
  contact wall(gap = y - H*exp(-((x - 5)/s)^2), restitution = 1);
end Bump;
)");
  for (const double s : {0.5, 0.2, 0.1, 0.05})
    withEachIntegrator(file, 1e-6, 10,
                       [&](CompiledModel &model) {
                         const double u = -std::sqrt(std::log(3.0)), place = 5 + s * u, slope = -2 * u / s * 0.1;
                         EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1) << s;
                         EXPECT_NEAR(model["x"], place + (1 - slope * slope) / (1 + slope * slope) * (10 - place), 1e-10) << s;
                       },
                       {{"s", s}});
}

// A force that acts at a place does work; a magnet that passes a block pulls it loose.
TEST(UniformMotion, ForcesOnTheWayAct) {
  const std::string gate = sourceFile("gate.tf", R"(
model Gate
  parameter Real F = 2, s = 0.05;
  coordinate Real x(der(start = 1));
  body cart(mass = 1, position = x);
  force f(value = F*exp(-((x - 5)/s)^2), at = x);
end Gate;
)");
  const std::string magnet = sourceFile("magnet.tf", R"(
model Magnet
  parameter Real s = 0.5;
  coordinate Real x(der(start = 1)), z;
  body passing(mass = 1000, position = x);
  body block(mass = 1, position = z);
  force pull(value = noEvent(if abs(x - 5) < s then 1.5 else 0), at = z);
  friction dry(slip = der(z), bound = 1);
end Magnet;
)");
  for (const double s : {0.5, 0.2, 0.05})
    withEachIntegrator(
        gate, 1e-7, 10,
        [&](CompiledModel &model) { EXPECT_NEAR(model["der(x)"], std::sqrt(1 + 4 * s * std::sqrt(std::acos(-1.0))), 1e-5) << s; },
        {{"s", s}});
  // It slides for 2 s, by 0.5 (2 s)²/2, and comes to rest by (2 s 0.5)²/2.
  for (const double s : {0.5, 0.2})
    withEachIntegrator(magnet, 1e-7, 10, [&](CompiledModel &model) { EXPECT_NEAR(model["z"], 1.5 * s * s, 1e-4) << s; }, {{"s", s}});
}

// A bead that coasts on a rail, towards a rise that is a fiftieth of what it passes in a second: it has not the energy for it.
TEST(UniformMotion, IsNotLongerThanTheLongestStep) {
  const std::string file = sourceFile("rising_rail.tf", R"(
model RisingRail
  coordinate Real x(der(start = 1.5)), y;
  body bead(mass = 1, position = {x, y});
  gravity weight(acceleration = {0, -50});
  constraint rail(residual = y - 0.05*(tanh(200*(x - 1)) - tanh(-200)));
end RisingRail;
)");
  for (const double tolerance : {1e-4, 1e-7})
    withEachIntegrator(
        file, tolerance, 3,
        [&](CompiledModel &model) {
          EXPECT_NEAR(model["der(x)"], -1.5, 1e3 * tolerance) << tolerance;
          EXPECT_GE(tf_get_statistics(model.simulation())->steps, 150) << tolerance;
        },
        {}, [](CompiledModel &model) { ASSERT_EQ(tf_set_longest_step(model.simulation(), 0.02), TF_OK); });
  CompiledModel shot(sourceFile("shot.tf", R"(
model Shot
  coordinate Real y(der(start = 20));
  body stone(mass = 1, position = y);
  force weight(value = -10, at = y);
end Shot;
)"));
  ASSERT_EQ(tf_set_longest_step(shot.simulation(), 0.25), TF_OK);
  shot.run(1);
  EXPECT_EQ(tf_get_statistics(shot.simulation())->steps, 4);
  EXPECT_NEAR(shot["y"], 15, 1e-13);
}

}  // namespace
}  // namespace tf::test
