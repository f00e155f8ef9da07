// Sensitivities against differences of whole runs.
#include "tests/accuracy/differentiated_models.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <vector>

namespace tf::test {
namespace {

// A run of a model (its text or the name of an example) up to a time, by a parameter.
struct DifferenceCase {
  const char *file;
  double time;
  const char *name;
  double value;
  double tolerance = 2e-7;
};

std::ostream &operator<<(std::ostream &out, const DifferenceCase &c) {
  return out << std::string(c.file).substr(0, std::string(c.file).find('\n')) << " by " << c.name << " at " << c.time;
}

std::vector<double> states(CompiledModel &model) {
  std::vector<double> all = model.valuesOf(TF_KIND_COORDINATE);
  const std::vector<double> velocities = model.valuesOf(TF_KIND_VELOCITY);
  all.insert(all.end(), velocities.begin(), velocities.end());
  return all;
}

class RunDifferences : public testing::TestWithParam<DifferenceCase> {};

// Of coordinates and velocities at the end of the run.
TEST_P(RunDifferences, Agree) {
  const DifferenceCase &c = GetParam();
  // Of order 4: some of the runs are far from linear in their parameter.
  const double h = 1e-5 * std::max(1.0, std::abs(c.value));
  const auto run = [&](double value) {
    CompiledModel model(fileOf(c.file), {{c.name, value}});
    model.tolerance(1e-12).run(c.time);
    return states(model);
  };
  const std::vector<double> plus = run(c.value + h), minus = run(c.value - h), plus2 = run(c.value + 2 * h), minus2 = run(c.value - 2 * h);
  CompiledModel model(fileOf(c.file), {{c.name, c.value}});
  differentiateBy(model, {c.name});
  model.tolerance(1e-10).run(c.time);
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  ASSERT_EQ(tf_get_sensitivity(model.simulation(), 0, all.data()), TF_OK) << tf_error_text(model.simulation());
  for (std::int32_t k = 0; k < model.model().variable_count; ++k) {
    const tf_variable &variable = model.model().variables[k];
    const bool isVelocity = variable.kind == TF_KIND_VELOCITY;
    if (!isVelocity && variable.kind != TF_KIND_COORDINATE)
      continue;
    const auto place = static_cast<std::size_t>(variable.index) + (isVelocity ? model.model().nq : 0);
    const double expected = (8 * (plus[place] - minus[place]) - (plus2[place] - minus2[place])) / (12 * h);
    EXPECT_NEAR(all[static_cast<std::size_t>(k)], expected, c.tolerance * std::max(1.0, std::abs(expected))) << variable.name;
  }
}

constexpr const char *kBall = R"(model Ball "with backspin"
  parameter Real r = 0.1, m = 1, mu = 0.2, vx = 3, wy = -60, wz = 10, h = 0, e = 0;
  coordinate Real p[3](start = {0, 0, 0.1 + h}, der(start = {vx, 1, 0}));
  coordinate Rotation R(w(start = {5, wy, wz}));
  body ball(mass = m, position = p, orientation = R, inertia = 0.4*m*r^2*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  Real w[3] = R*R.w;
  contact floor(gap = p[3] - r, slip = {der(p[1]) - w[2]*r, der(p[2]) + w[1]*r}, friction = mu, restitution = e);
end Ball;
)";
constexpr const char *kPuck = R"(model Puck "on springs, drawn to and fro: slips, turns, sticks and slips again"
  parameter Real mu = 0.3, speed = 2, angle = 0.4, pull = 1, k = 1;
  coordinate Real q[3](start = {0, 0, 0}, der(start = {speed*cos(angle), speed*sin(angle), 0}));
  body puck(mass = 2, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = {pull*sin(3*time) - k*q[1], -k*q[2]}, at = q[1:2]);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = mu);
end Puck;
)";
constexpr const char *kTop = R"(model Top
  parameter Real a = 0.3, wx = 1, g = 9.81;
  coordinate Rotation R(start = {cos(a/2), sin(a/2), 0, 0}, w(start = {wx, 2, 8}));
  body top(mass = 1, position = R*{0, 0, 0.5}, orientation = R, inertia = {{0.1, 0, 0}, {0, 0.2, 0}, {0, 0, 0.15}});
  gravity weight(acceleration = {0, 0, -g});
end Top;
)";
constexpr const char *kHeld =
    R"(model Held "a body in space, held at a point of its own by a constraint; another point strikes a rough wall"
  parameter Real mu = 0.3, e = 0.4, wx = 1, side = 0.3, g = 9.81;
  coordinate Real p[3](start = {0, 0, -0.5}, der(each fixed = false));
  coordinate Rotation R(w(start = {wx, 0.5, 1}));
  body stone(mass = 1.5, position = p, orientation = R, inertia = {{0.1, 0.01, 0}, {0.01, 0.2, 0}, {0, 0, 0.15}});
  gravity weight(acceleration = {0, 0, -g});
  constraint pivot(residual = p + R*{0, 0, 0.5});
  Real tip[3] = p + R*{0.1, 0, -0.2};
  contact wall(gap = side - tip[2], slip = der(tip[1:2:3]), friction = mu, restitution = e);
end Held;
)";
constexpr const char *kElement = R"(model Damped "a friction element in the plane"
  parameter Real bound = 3, vx = 1.2, k = 20;
  coordinate Real q[2](start = {0.1, 0}, der(start = {vx, 0.6}));
  body puck(mass = 2, position = q);
  force spring(value = -k*{q[1], 2*q[2]}, at = q);
  friction dry(slip = der(q), bound = bound);
end Damped;
)";
constexpr const char *kPlate = R"(model Plate "slides and spins on four feet, which stop together"
  parameter Real mu = 0.3, vx = 1, w0 = 4, a = 0.2;
  parameter Real c[4, 2] = {{a, a}, {a, -a}, {-a, a}, {-a, -a}};
  coordinate Real q[2](der(start = {vx, 0.3}));
  coordinate Real phi(der(start = w0));
  body plate(mass = 1, position = q, angle = phi, inertia = 0.05);
  friction foot[4](slip = {der(q + {c[i, 1]*cos(phi) - c[i, 2]*sin(phi), c[i, 1]*sin(phi) + c[i, 2]*cos(phi)}) for i in 1:4},
                   each bound = mu*9.81/4);
end Plate;
)";
constexpr const char *kBouncing = R"(model Bouncing "a spinning ball that bounces, comes to rest on the floor and rolls on"
  parameter Real r = 0.1, mu = 0.2, e = 0.5, h = 0.3, vx = 3;
  coordinate Real p[3](start = {0, 0, 0.1 + h}, der(start = {vx, 1, 0}));
  coordinate Rotation R(w(start = {5, -60, 10}));
  body ball(mass = 1, position = p, orientation = R, inertia = 0.4*r^2*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  Real w[3] = R*R.w;
  contact floor(gap = p[3] - r, slip = {der(p[1]) - w[2]*r, der(p[2]) + w[1]*r}, friction = mu, restitution = e);
end Bouncing;
)";
constexpr const char *kSkipping = R"(model Skipping "a stone that bounces, comes to rest on the floor and slides on"
  parameter Real mu = 0.05, e = 0.6, h = 1, vx = 4, c = 0.3;
  coordinate Real x(der(start = vx)), y(start = h);
  body stone(mass = 2, position = {x, y});
  gravity weight(acceleration = {0, -9.81});
  force wind(value = {-c*der(x), -c*der(y)}, at = {x, y});
  contact floor(gap = y - 0.02*sin(x), slip = der(x), friction = mu, restitution = e);
end Skipping;
)";
constexpr const char *kPolygon = R"(model Puck "as above, on a polygon"
  parameter Real mu = 0.3, speed = 2, angle = 0.4, pull = 1, k = 1;
  coordinate Real q[3](start = {0, 0, 0}, der(start = {speed*cos(angle), speed*sin(angle), 0}));
  body puck(mass = 2, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = {pull*sin(3*time) - k*q[1], -k*q[2]}, at = q[1:2]);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = mu, frictionForm = FrictionForm.Polyhedral, directions = 6);
end Puck;
)";

constexpr const char *kWorn = R"(model Worn "a puck whose friction depends on where it slides"
  parameter Real mu = 0.3, c = 0.1, vx = 2;
  coordinate Real q[3](der(start = {vx, 0.3, 0}));
  body puck(mass = 1, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = {0, -3*q[1]}, at = q[1:2]);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = mu + c*q[1]);
end Worn;
)";
constexpr const char *kFeet =
    R"(model Feet "a plate falls on four feet of different friction, which changes along the floor, slides, spins and stops"
  parameter Real mu[4] = {0.25, 0.4, 0.15, 0.3}, c = 0.05, m = 3, J = 0.07, g = 10, h = 0.02, vx = 2, wz = 6;
  parameter Real a = 0.2, e = 0.01;
  coordinate Real p[3](start = {0, 0, 0.1 + h}, der(start = {vx, 0.3, 0}));
  coordinate Rotation Q(w(start = {0, 0, wz}));
  input Real pull(start = 0);
  Real corner[4, 3] = {Q*{a, 0.15, -0.1}, Q*{-0.2, 0.15, -0.1}, Q*{-0.2, -0.15, -0.1}, Q*{0.2, -0.15, -0.1}};
  Real w[3] = Q*Q.w;
  body plate(mass = m, position = p + Q*{e, 0.02, 0}, orientation = Q, inertia = diagonal({0.03, 0.05, J}));
  gravity weight(acceleration = {0, 0, -g});
  force f(value = {pull, 0, 0}, at = p);
  contact foot[4](gap = {p[3] + corner[k, 3] for k in 1:4}, friction = {mu[k] + c*(0.5*p[1] + corner[k, 1]) for k in 1:4},
    slip = {{der(p[1]) + w[2]*corner[k, 3] - w[3]*corner[k, 2], der(p[2]) + w[3]*corner[k, 1] - w[1]*corner[k, 3]} for k in 1:4});
end Feet;
)";
constexpr const char *kGroove = R"(model Groove "a block on six feet slides along a groove of two inclined planes"
  parameter Real mu[6] = {0.1, 0.3, 0.2, 0.15, 0.35, 0.05}, m = 2, s = 0.5, a = 0.3, x2 = 0.02, vx = 3, k = 4;
  constant Real r = sqrt(0.5);
  coordinate Real p[3](der(start = {vx, 0, 0}));
  coordinate Rotation Q;
  parameter Real foot[6, 3] = {{a, 0.1, 0.1}, {-0.2, 0.1, 0.1}, {x2, 0.25, 0.25}, {0.25, -0.1, 0.1}, {-a, -0.1, 0.1}, {0, -0.2, 0.2}};
  parameter Real n[6, 2] = {{-r, r}, {-r, r}, {-r, r}, {r, r}, {r, r}, {r, r}};
  Real w[3] = Q*Q.w;
  Real arm[6, 3] = {Q*{foot[i, 1], foot[i, 2], foot[i, 3]} for i in 1:6};
  Real v[6, 3] = {{der(p[1]) + w[2]*arm[i, 3] - w[3]*arm[i, 2], der(p[2]) + w[3]*arm[i, 1] - w[1]*arm[i, 3],
                   der(p[3]) + w[1]*arm[i, 2] - w[2]*arm[i, 1]} for i in 1:6};
  body block(mass = m, position = p + Q*{0.05, 0.01, s}, orientation = Q, inertia = diagonal({0.03, 0.05, 0.07}));
  gravity weight(acceleration = {-0.5, 0, -10});
  force pull(value = {-k*p[1], 0.5*k*p[1], 0}, at = p + Q*{0, 0, 0.3});
  contact side[6](gap = {n[i, 1]*(p[2] + arm[i, 2]) + n[i, 2]*(p[3] + arm[i, 3]) for i in 1:6}, friction = mu,
    slip = {{v[i, 1], n[i, 2]*v[i, 2] - n[i, 1]*v[i, 3]} for i in 1:6});
end Groove;
)";
constexpr const char *kLegs = R"(model Legs "a planar table on three legs of different heights carries a drawer and a pendulum"
  parameter Real mu[3] = {0.2, 0.45, 0.1}, m = 3, h2 = 0.3, x1 = 0.4, k = 10, vx = 2, c = 0.2;
  coordinate Real x(der(start = vx)), y, phi, d(der(start = 0.5)), th(start = 0.7);
  Real leg[3, 2] = {{x - x1*cos(phi) + 0.5*sin(phi), y - x1*sin(phi) - 0.5*cos(phi) + 0.5},
                    {x + 0.1*cos(phi) + h2*sin(phi), y + 0.1*sin(phi) - h2*cos(phi) + h2},
                    {x + 0.5*cos(phi) + 0.6*sin(phi), y + 0.5*sin(phi) - 0.6*cos(phi) + 0.6}};
  body table(mass = m, position = {x, y}, angle = phi, inertia = 0.2);
  body drawer(mass = 1, position = {x + d*cos(phi) - 0.1*sin(phi), y + d*sin(phi) + 0.1*cos(phi)}, angle = phi, inertia = 0.01);
  body pendulum(mass = 0.5, position = {x + 0.3*sin(th), y - 0.3*cos(th)}, angle = th, inertia = 0.002);
  gravity weight(acceleration = {0, -9.81});
  force spring(value = -k*d, at = d);
  contact floor[3](gap = leg[:, 2], slip = {der(leg[i, 1]) for i in 1:3}, friction = {mu[i]*(1 + c*sin(x)) for i in 1:3});
end Legs;
)";
constexpr const char *kRelay = R"(model Relay "thrown across a belt, beside a state that slides on its switch"
  parameter Real u = 1, mu = 0.3;
  coordinate Real x[2](der(start = {0, 1.5})), z;
  Real s(start = 0);
  body b(mass = 1, position = {x[1], x[2], z});
  gravity weight(acceleration = {0, 0, -10});
  contact belt(gap = z, slip = {der(x[1]) - u, der(x[2])}, friction = mu);
equation
  der(s) = if s > 0 then -2 else 2;
end Relay;
)";
constexpr const char *kPendulum = R"(model Pendulum "in Cartesian coordinates, all of which have a start"
  parameter Real L = 1, angle = 1.2;
  coordinate Real q[2](start = {L*sin(angle), -L*cos(angle)});
  body bob(mass = 1, position = q);
  gravity weight(acceleration = {0, -9.81});
  constraint rod(residual = q[1]^2 + q[2]^2 - L^2);
end Pendulum;
)";

constexpr const char *kSlot = R"(model Slot "a slider rattles in a slot: bounces accumulate at its corners"
  parameter Real h = 0.04, c = 0.0005, mu = 0.25, e = 0.3, k = 400;
  coordinate Real x, y, th(start = 0.002);
  body slider(mass = 0.5, position = {x, y}, angle = th, inertia = 0.002);
  gravity weight(acceleration = {0, -9.81});
  potential spring(energy = k/2*((x + h*sin(th) - 0.08*sin(9*time))^2 + (y - 0.3*h)^2/10));
  constant Real corner[2] = {-0.1, 0.1};
  contact low[2](gap = {c + y + s*sin(th) + h*(1 - cos(th)) for s in corner},
                 slip = {der(x) - s*sin(th)*der(th) + h*cos(th)*der(th) for s in corner}, each friction = mu, each restitution = e);
  contact high[2](gap = {c - y - s*sin(th) + h*(1 - cos(th)) for s in corner},
                  slip = {der(x) - s*sin(th)*der(th) - h*cos(th)*der(th) for s in corner}, each friction = mu, each restitution = e);
end Slot;
)";
constexpr const char *kRamp = R"(model Ramp "a block slides off a wedge whose face bends away, without an event"
  parameter Real a = 0.5, mu = 0.2, L = 0.6;
  coordinate Real X, s, n;
  Real x = X + s*cos(a) + n*sin(a), y = L*sin(a) - s*sin(a) + n*cos(a);
  body wedge(mass = 3, position = {X, 0});
  body block(mass = 1, position = {x, y});
  gravity weight(acceleration = {0, -9.81});
  contact incline(gap = n + smooth(2, if s > L then 10*(s - L)^3 else 0), slip = der(s), friction = mu);
  contact floor(gap = y + 0.05, slip = der(x), friction = 0.4, restitution = 0.3);
end Ramp;
)";

constexpr const char *kTether =
    R"(model Tether "a body on a pivot, the tip of which lands on a turning table, slides there and is carried along"
  parameter Real m = 0.4, d = 0.5, W = 4, gx = 3, mu = 0.4, e = 0.3;
  coordinate Rotation Q(start = {0, 1, 0.3, 0.5}, w(start = {0.5, -0.2, 3}));
  Real p[3] = Q*{0.05, -0.1, d}, tip[3] = 2*p;
  Real w = W*sin(2*time);
  body b(mass = m, position = p, orientation = Q, inertia = [0.02, 0.001, 0; 0.001, 0.03, -0.002; 0, -0.002, 0.015]);
  gravity g(acceleration = {gx, 0, -9.81});
  contact table(gap = tip[3] + 0.9, slip = {der(tip[1]) + w*tip[2], der(tip[2]) - w*tip[1]}, friction = mu, restitution = e);
end Tether;
)";

// The slip turns up to its very end, as a small power of what is left of it; there the contact opens, which has pressed until then.
constexpr const char *kPushedBall = R"(model PushedBall "a cart pushes a sliding ball and falls behind as it begins to roll"
  parameter Real m = 1, bound = 4, vx = 1, vy = 0.3;
  coordinate Real x[2](start = {0, 0}, der(start = {vx, vy}));
  coordinate Real turn[2] "radius times angle", y(start = 0, der(start = vx));
  body ball(mass = m, position = x);
  body spin(mass = 0.4*m, position = turn);
  body cart(mass = 1, position = y);
  friction floor(slip = der(x) - der(turn), bound = bound);
  friction axle(slip = der(y), bound = 1);
  contact push(gap = x[1] - y);
end PushedBall;
)";

// The slips of two feet of a rigid body have three components of their own.
constexpr const char *kTwoFeet = R"(model TwoFeet "a body on two feet on a belt tips about the line through them"
  parameter Real vb = -0.2, mu = 0.4;
  constant Real P[2, 3] = {{-0.24, 0, -0.2}, {0.3, 0, -0.2}};
  coordinate Real p[3](start = {0, 0, 0.2}, der(start = {-0.9, 0.9, 0}));
  coordinate Rotation Q(w(start = {0, 0, -1.4}));
  Real r[2, 3] = {p + Q*P[i, :] for i in 1:2};
  body b(mass = 1.7, position = p, orientation = Q, inertia = diagonal({0.08, 0.096, 0.09}));
  gravity g(acceleration = {0, 0, -9.81});
  contact floor[2](gap = r[:, 3], slip = {{der(r[i, 1]) - vb, der(r[i, 2])} for i in 1:2}, each friction = mu);
end TwoFeet;
)";

INSTANTIATE_TEST_SUITE_P(Examples, RunDifferences,
                         testing::Values(DifferenceCase{"falling_rod.tf", 0.6, "mu", 0.3},
                                         DifferenceCase{"falling_rod.tf", 1.4, "phi", 0.785},
                                         DifferenceCase{"falling_box.tf", 0.9, "der(r[1])", 3},
                                         DifferenceCase{"stickslip.tf", 3, "mu", 0.5}, DifferenceCase{"stickslip.tf", 3, "k", 4},
                                         DifferenceCase{"chain.tf", 0.4, "mu", 0.5}, DifferenceCase{"chain.tf", 0.4, "r[2]", 0.3}));

// Quaternions are differentiated as they are, four components each, whose changes keep them at unit length.
INSTANTIATE_TEST_SUITE_P(
    InSpace, RunDifferences,
    testing::Values(DifferenceCase{kTop, 1.5, "a", 0.3}, DifferenceCase{kTop, 1.5, "wx", 1}, DifferenceCase{kTop, 1.5, "g", 9.81},
                    DifferenceCase{kBall, 1, "mu", 0.2}, DifferenceCase{kBall, 2, "mu", 0.2}, DifferenceCase{kBall, 2, "wy", -60},
                    DifferenceCase{kBall, 2, "wz", 10}, DifferenceCase{kPuck, 0.3, "k", 1}, DifferenceCase{kPuck, 4, "mu", 0.3},
                    DifferenceCase{kPuck, 4, "angle", 0.4}, DifferenceCase{kPuck, 3, "pull", 12}, DifferenceCase{kPuck, 4, "k", 1},
                    DifferenceCase{kHeld, 1, "mu", 0.3}, DifferenceCase{kHeld, 1, "e", 0.4}, DifferenceCase{kHeld, 1, "side", 0.3},
                    DifferenceCase{kRelay, 0.5, "u", 1}, DifferenceCase{kRelay, 0.5, "mu", 0.3}, DifferenceCase{kElement, 3, "bound", 3},
                    DifferenceCase{kElement, 3, "vx", 1.2}, DifferenceCase{kElement, 3, "k", 20}, DifferenceCase{kPlate, 0.2, "mu", 0.3},
                    DifferenceCase{kPlate, 1, "mu", 0.3}, DifferenceCase{kPlate, 1, "vx", 1}, DifferenceCase{kPlate, 1, "w0", 4},
                    DifferenceCase{kPolygon, 4, "mu", 0.3}, DifferenceCase{kPolygon, 4, "angle", 0.4},
                    DifferenceCase{kPolygon, 4, "k", 1}));

// The slips of both corners end in the impact or, with less friction, right after it.
INSTANTIATE_TEST_SUITE_P(Landing, RunDifferences,
                         testing::Values(DifferenceCase{kLanding, 0.08, "mu", 0.4, 1e-6}, DifferenceCase{kLanding, 0.08, "v", 0.3, 1e-6},
                                         DifferenceCase{kLanding, 0.08, "J", 0.1, 1e-6}));

INSTANTIATE_TEST_SUITE_P(Bend, RunDifferences, testing::Values(DifferenceCase{kRamp, 1, "mu", 0.2}, DifferenceCase{kRamp, 1, "a", 0.5}));

INSTANTIATE_TEST_SUITE_P(Constrained, RunDifferences,
                         testing::Values(DifferenceCase{kPendulum, 2, "angle", 1.2}, DifferenceCase{kPendulum, 2, "L", 1}));

INSTANTIATE_TEST_SUITE_P(Worn, RunDifferences,
                         testing::Values(DifferenceCase{kWorn, 0.3, "mu", 0.3}, DifferenceCase{kWorn, 0.3, "c", 0.1},
                                         DifferenceCase{kWorn, 0.3, "vx", 2}));

// How redundant contacts share their load decides on the motion.
INSTANTIATE_TEST_SUITE_P(Shared, RunDifferences,
                         testing::Values(DifferenceCase{kFeet, 0.3, "mu[1]", 0.25, 1e-8}, DifferenceCase{kFeet, 0.3, "c", 0.05, 1e-8},
                                         DifferenceCase{kFeet, 0.3, "h", 0.02, 1e-8}, DifferenceCase{kFeet, 0.3, "m", 3, 1e-8},
                                         DifferenceCase{kFeet, 0.3, "J", 0.07, 1e-8}, DifferenceCase{kFeet, 0.3, "a", 0.2, 1e-8},
                                         DifferenceCase{kFeet, 0.3, "e", 0.01, 1e-8}, DifferenceCase{kFeet, 0.3, "wz", 6, 1e-8},
                                         DifferenceCase{kFeet, 0.3, "pull", 0, 1e-8}, DifferenceCase{kFeet, 2, "mu[1]", 0.25},
                                         DifferenceCase{kFeet, 2, "a", 0.2}, DifferenceCase{kFeet, 2, "wz", 6},
                                         DifferenceCase{kFeet, 2, "g", 10}, DifferenceCase{kGroove, 0.3, "mu[1]", 0.1, 1e-8},
                                         DifferenceCase{kGroove, 0.3, "m", 2, 1e-8}, DifferenceCase{kGroove, 0.3, "s", 0.5, 1e-8},
                                         DifferenceCase{kGroove, 0.3, "a", 0.3, 1e-8}, DifferenceCase{kGroove, 0.3, "x2", 0.02, 1e-8},
                                         DifferenceCase{kGroove, 0.3, "k", 4, 1e-8}, DifferenceCase{kLegs, 0.3, "h2", 0.3, 1e-8},
                                         DifferenceCase{kLegs, 2, "mu[1]", 0.2, 1e-8}, DifferenceCase{kLegs, 2, "m", 3, 1e-8},
                                         DifferenceCase{kLegs, 2, "x1", 0.4, 1e-8}, DifferenceCase{kLegs, 2, "vx", 2, 1e-8},
                                         DifferenceCase{kLegs, 2, "c", 0.2, 1e-8}, DifferenceCase{kBounds, 0.2, "mu[1]", 0.2, 1e-8},
                                         DifferenceCase{kBounds, 0.24, "mu[3]", 0.1, 1e-8}, DifferenceCase{kBounds, 0.24, "x1", 0.5, 1e-8},
                                         DifferenceCase{kBounds, 0.246, "mu[3]", 0.1, 1e-8}, DifferenceCase{kBounds, 0.246, "m", 1, 1e-8},
                                         DifferenceCase{kBounds, 0.246, "x4", 0.6, 1e-8}, DifferenceCase{kBounds, 0.246, "v2", 0.8, 1e-8}));

// Of a tip on a sphere three rows are redundant, and contradict one another where the table has another speed than the tip. What
// derivatives are off by at the stop of the slip must not grow until the end.
INSTANTIATE_TEST_SUITE_P(Redundant, RunDifferences,
                         testing::Values(DifferenceCase{kTether, 1.6, "W", 4}, DifferenceCase{kTether, 1.9, "W", 4},
                                         DifferenceCase{kTether, 1.9, "gx", 3}, DifferenceCase{kTether, 1.9, "mu", 0.4, 1e-6},
                                         DifferenceCase{kTether, 1.9, "d", 0.5, 1e-6}));

// Through the point where infinitely many impacts accumulate.
INSTANTIATE_TEST_SUITE_P(Rest, RunDifferences,
                         testing::Values(DifferenceCase{"bouncing_ball.tf", 6, "e", 0.8},
                                         DifferenceCase{"rocking_block.tf", 3, "tilt", -0.2},
                                         DifferenceCase{"rocking_block.tf", 3, "b", 0.2}, DifferenceCase{kSkipping, 3, "e", 0.6},
                                         DifferenceCase{kSkipping, 3, "mu", 0.05}, DifferenceCase{kSkipping, 3, "h", 1},
                                         DifferenceCase{kBouncing, 2, "e", 0.5}, DifferenceCase{kBouncing, 2, "h", 0.3},
                                         DifferenceCase{kSlot, 1, "mu", 0.25}, DifferenceCase{kSlot, 1, "e", 0.3}));

INSTANTIATE_TEST_SUITE_P(Stops, RunDifferences,
                         testing::Values(DifferenceCase{kPushedBall, 0.4, "vx", 1}, DifferenceCase{kPushedBall, 0.4, "bound", 4},
                                         DifferenceCase{kPushedBall, 0.4, "m", 1}, DifferenceCase{kPushedBall, 0.4, "vy", 0.3}));
INSTANTIATE_TEST_SUITE_P(Feet, RunDifferences,
                         testing::Values(DifferenceCase{kTwoFeet, 0.2, "vb", -0.2, 1e-8}, DifferenceCase{kTwoFeet, 0.2, "mu", 0.4, 1e-8}));

}  // namespace
}  // namespace tf::test
