// Impacts that several contacts take part in, or that leave slow slips behind: that they end, what they keep and what they cost.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/differentiated_models.h"
#include "tests/accuracy/each_integrator.h"
#include "tests/accuracy/pushed_table.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

namespace tf::test {
namespace {

// Impacts with slips of two components are followed to 1e-10 of velocities: slower ones than 1e-9 do not bounce, at any tolerance, which
// would go on for ever by what they are wrong by.
TEST(Impacts, WithTurningSlipsDoNotBounceByTheirErrors) {
  for (const double tolerance : {1e-6, 1e-9, 1e-11})
    for (const double speed : {2e-10, 8e-10, 1e-7, 1e-3}) {
      CompiledModel model(sourceFile("slow_impact.tf", R"(
model SlowImpact
  parameter Real speed = 1, e = 0.6;
  coordinate Real q[3](start = {0, 0, 0}, der(start = {0.7, 0.2, -speed}));
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = der(q[1:2]), friction = 0.5, restitution = e);
end SlowImpact;
)"),
                          {{"speed", speed}});
      model.tolerance(tolerance).initialise();
      const bool bounces = speed > std::max(1e-9, 0.05 * tolerance);
      EXPECT_NEAR(model["der(q[3])"], bounces ? 0.6 * speed : 0, 1e-10 + 1e-9 * speed) << tolerance << ' ' << speed;
    }
}

// Of two balls on a rod one rolls and the other bounces, ever more slowly, until its speed is no more than what slips are told from zero
// by: no bounce may be higher than the one before it.
TEST(Impacts, BesideARollingBallDecayToTheirEnd) {
  const std::string file = sourceFile("balls_on_a_rod.tf", R"(
model BallsOnARod
  parameter Real m = 0.5, r = 0.1, l = 0.3, spin = -6, mu = 0.3, e = 0.5;
  coordinate Real p[3](start = {0, 0, 0.5}, der(start = {1, 0.4, 0}));
  coordinate Real q[3](start = {l, 0, 0.5}, der(start = {1, -0.6, 0.3}, fixed = {false, true, true}));
  coordinate Rotation P(w(start = {4, spin, 12})), Q(w(start = {-2, 3, 1}));
  Real w[3] = P*P.w, z[3] = Q*Q.w;
  body ball(mass = m, position = p, orientation = P, inertia = 0.4*m*r^2*identity(3));
  body other(mass = 2*m, position = q, orientation = Q, inertia = 0.8*m*r^2*diagonal({1, 1.2, 0.9}));
  constraint rod(residual = ((p - q)*(p - q) - l^2)/(2*l));
  gravity weight(acceleration = {0, 0, -9.81});
  contact a(gap = p[3] - r, slip = {der(p[1]) - r*w[2], der(p[2]) + r*w[1]}, friction = mu, restitution = e);
  contact b(gap = q[3] - r, slip = {der(q[1]) - r*z[2], der(q[2]) + r*z[1]}, friction = mu, restitution = e);
end BallsOnARod;
)");
  struct Bounces {
    int count = 0, place = 0;
    double worst = 0;  // part of the speed before that is left behind it
  };
  for (const double tolerance : {1e-9, 1e-12, 1e-13})
    for (const double spin : {-6.0, -5.7, -5.5, -4.9}) {
      CompiledModel model(file, {{"spin", spin}});
      Bounces bounces;
      bounces.place = model.model().nq + 5;  // der(q[3])
      const auto note = [](void *data, const tf_event *event) {
        auto &all = *static_cast<Bounces *>(data);
        ++all.count;
        if (event->kind == TF_EVENT_IMPACT && event->element == 1)
          all.worst = std::max(all.worst, event->after[all.place] / -event->before[all.place]);
      };
      ASSERT_EQ(tf_set_event_callback(model.simulation(), note, &bounces), TF_OK);
      model.tolerance(tolerance).run(0.9);
      EXPECT_LT(bounces.count, 200) << tolerance << ' ' << spin;
      EXPECT_GT(bounces.worst, 0.49) << tolerance << ' ' << spin;
      EXPECT_LT(bounces.worst, 0.51) << tolerance << ' ' << spin;
      EXPECT_NEAR(model["q[3]"], 0.1, 1e-12) << tolerance << ' ' << spin;
    }
}

// What slides slowly, with or without friction, is not what an impact elsewhere has shaken, whatever the tolerance is.
TEST(Impacts, LeaveSlowSlipsAsTheyAre) {
  const std::string file = sourceFile("creepers.tf", R"(
model Creepers
  parameter Real v = 1e-6;
  coordinate Real x[2](each start = 0, each der(start = v));
  coordinate Real y[3](start = {0, 0, 1});
  body creeper[2](each mass = 1, position = {{x[1], y[1]}, {x[2], y[2]}});
  body ball(mass = 1, position = {-1, y[3]});
  gravity weight(acceleration = {0, -9.81});
  force pull(value = 0.4*9.81, at = x[2]);
  contact floor[2](gap = y[1:2], slip = der(x), friction = {0, 0.4});
  contact ground(gap = y[3]);
end Creepers;
)");
  for (const double tolerance : {1e-1, 1e-2, 1e-4})
    for (const tf_integrator integrator : {TF_STEP, TF_EXPLICIT, TF_CVODE}) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(1);
      EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1);
      EXPECT_NEAR(model["x[1]"], 1e-6, 1e-15) << tolerance;
      EXPECT_NEAR(model["x[2]"], 1e-6, 1e-15) << tolerance;
      EXPECT_NEAR(model["der(x[1])"], 1e-6, 1e-15) << tolerance;
      EXPECT_EQ(model.count(TF_EVENT_STICK), 0) << tolerance;
    }
}

std::string longChain() {
  return sourceFile("long_chain.tf", R"(
model LongChain
  parameter Integer n = 50;
  parameter Real l = 1/n;
  coordinate Real r[2](start = {0, 0.3}, der(start = {0.5, 0}));
  coordinate Real phi[n](start = {0.9 - 0.25*(i - 1) for i in 1:n});
  Real node[n + 1, 2];
  body rod[n](each mass = 1/n, position = (node[1:n, :] + node[2:n + 1, :])/2, angle = phi, each inertia = l^2/n/12);
  gravity weight(acceleration = {0, -9.81});
  force damper[n - 1](value = -0.002*(der(phi[2:n]) - der(phi[1:n - 1])), at = phi[2:n] - phi[1:n - 1]);
  contact floor[n + 1](gap = node[:, 2], slip = der(node[:, 1]), each friction = 0.5);
equation
  node[1, :] = r;
  for i in 1:n loop
    node[i + 1, :] = node[i, :] + l*{cos(phi[i]), sin(phi[i])};
  end for;
end LongChain;
)");
}

// A chain with stiff joint dampers, rods of which creep while others fall onto the floor: no fewer impacts with a smaller tolerance.
// And no contact pulls, at any tolerance.
TEST(Impacts, OfAChainAreNotMoreAtLargerTolerances) {
  const std::string file = longChain();
  const auto impacts = [&](double tolerance) {
    CompiledModel model(file);
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).integrator(TF_AUTO).run(0.45);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_normal_force, -1e-8 * statistics.largest_normal_force) << tolerance;
    return model.count(TF_EVENT_IMPACT);
  };
  const int fine = impacts(1e-3);
  for (const double tolerance : {1e-1, 1e-2})
    EXPECT_LE(impacts(tolerance), fine) << tolerance;
}

// Corners of a coin that rolls around its edge are near one another: closed gaps that differ by the accuracy of events tilt it by far more.
TEST(Impacts, OfACoinOfTwelveCornersHaveAContinuation) {
  CompiledModel model(sourceFile("coin.tf", R"(
model Coin
  parameter Integer n = 12;
  parameter Real R = 0.1, h = 0.02, mu = 0.5, e = 0.5, pi = 3.14159265358979;
  parameter Real rim[n, 2] = {{R*cos(2*pi*i/n), R*sin(2*pi*i/n)} for i in 1:n};
  parameter Real corner[2*n, 3] = {if i <= n then {rim[i, 1], rim[i, 2], h/2} else {rim[i - n, 1], rim[i - n, 2], -h/2} for i in 1:2*n};
  coordinate Real p[3](start = {0, 0, 0.3}, der(start = {0.5, 0, 0}));
  coordinate Rotation Q(start = {1, 0.3, 0.2, 0.1});
  body coin(mass = 0.5, position = p, orientation = Q, inertia = diagonal({0.00127, 0.00127, 0.0025}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real c[2*n, 3] = {p + Q*corner[i, :] for i in 1:2*n};
  contact leg[2*n](gap = c[:, 3], slip = der(c[:, 1:2]), each friction = mu, each restitution = e);
end Coin;
)"));
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  for (const double mu : {0.5, 1.0})
    for (const double start : {1.0, 0.7}) {
      ASSERT_EQ(tf_set(model.simulation(), "mu", mu), TF_OK);
      ASSERT_EQ(tf_set(model.simulation(), "Q.q[1]", start), TF_OK);
      ASSERT_EQ(tf_set(model.simulation(), "Q.w[3]", 5), TF_OK);
      model.tolerance(1e-6).run(1);
      const tf_statistics &statistics = *tf_get_statistics(model.simulation());
      EXPECT_GE(statistics.worst_gap, -1e-9);
      EXPECT_LT(statistics.worst_energy_error, 1e-7);
    }
}

// Which foot of a table that slides bears how much is open, and with it the friction: no paradox of a contact.
TEST(Impacts, LoadsThatAreOpenAreNoParadox) {
  CompiledModel model(sourceFile("table_with_polyhedral_friction.tf", pushedTable("Polyhedral")));
  model.tolerance(1e-6).run(1.3);
  EXPECT_GE(model.count(TF_EVENT_SLIP), 4);
  EXPECT_EQ(model.count(TF_EVENT_PAINLEVE), 0);
}

// Damping makes forces of the chain stiff: at a step's end they are quite other ones than on the closed contacts nearby, where the mode
// ends. How the steps fall depends on the tolerance.
TEST(Impacts, OfAChainLeaveForcesThatPressAtLooseTolerances) {
  const std::string file = longChain();
  for (const double tolerance : {0.3, 0.2, 0.15, 0.05, 0.02}) {
    CompiledModel model(file);
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).integrator(TF_AUTO).run(0.45);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_normal_force, -1e-8 * statistics.largest_normal_force) << tolerance;
  }
}

// What its motion would be behind an event has an error that is none of a step up to the event: one attempt shows that.
TEST(Impacts, OfAChainTakeFewAttemptsOfSteps) {
  CompiledModel model(longChain());
  model.tolerance(1e-1).integrator(TF_AUTO).run(0.45);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_LT(statistics.rejected_steps, statistics.steps / 5);
}

// A corner of a cube, turned somehow, hits the top of another one that rests on four feet, whose shares of the impact are not unique.
std::string cubeOntoCube() {
  return sourceFile("cube_onto_cube.tf", R"(
model CubeOntoCube
  parameter Real a = 0.5, b = 0.3, m = 2, M = 4, mu = 0.4, mf = 0.5, e = 0.5, shift = 0;
  coordinate Real p[3](start = {0, 0, a/2});
  coordinate Rotation Q;
  coordinate Rotation R(start = {0.9820881872783486, 0.06357317401828835, 0.011066235248301522, 0.1770276317160605},
    w(start = {1.0001431719304463, 0.04779145392832871, 0.5536829853836617}));
  coordinate Real q[3](start = {0.125 + shift, 0.062, 0.6681847016461915},
    der(start = {0.083399896385126, 0.0250199689155378, -1.2669712521212646}));
  body lower(mass = M, position = p, orientation = Q, inertia = M*a^2/6*identity(3));
  body upper(mass = m, position = q, orientation = R, inertia = m*b^2/6*identity(3));
  parameter Real s[4, 2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  Real foot[4, 3] = {p + Q*{s[i, 1]*a/2, s[i, 2]*a/2, -a/2} for i in 1:4};
  contact floor[4](gap = foot[:, 3], slip = der(foot[:, 1:2]), each friction = mf, each restitution = 0.3);
  Real corner[3] = inverse(Q)*(q + R*{-b/2, -b/2, -b/2} - p);
  contact top(gap = corner[3] - a/2, slip = der(corner[1:2]), friction = mu, restitution = e);
end CubeOntoCube;
)");
}

double impulseOntoCube(double mu, double mf, double e, double shift) {
  CompiledModel model(cubeOntoCube(), {{"mu", mu}, {"mf", mf}, {"e", e}, {"shift", shift}});
  model.tolerance(1e-8).run(1e-6);
  EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1);
  return model["top.impulse"];
}

// By Poisson's law that is e times the impulse of the compression, in whatever way the feet share the load.
TEST(Impacts, OntoABodyOnManyFeetHaveTheirRestitution) {
  const double compression = impulseOntoCube(0.4, 0.5, 0, 0);
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR(impulseOntoCube(0.4, 0.5, 0.5, 1e-13 * k), 1.5 * compression, 1e-7) << k;
}

// While the upper cube slips, friction is as large as all feet together can bear: they neither slip nor have anything left.
TEST(Impacts, OntoFeetThatAreAtTheLimitOfTheirFriction) {
  for (const double mu : {0.3, 0.5}) {
    const double rough = impulseOntoCube(mu, 1.05 * mu, 0.5, 0);
    EXPECT_NEAR(impulseOntoCube(mu, mu, 0.5, 0), rough, 1e-6) << mu;
    EXPECT_NEAR(impulseOntoCube(mu, mu, 0, 0), rough / 1.5, 1e-6) << mu;
  }
}

// The wall's friction ends what lifts the particle, and holds it then without any help of the floor, which it has left: where forces are
// not unique, contacts stay open.
TEST(Impacts, OfAContactThatOthersHoldLeaveItOpen) {
  const std::string file = sourceFile("corner_that_sticks.tf", R"(
model CornerThatSticks
  parameter Real vz = 0.1;
  coordinate Real q[3](der(start = {2, 0, vz}));
  body b(mass = 0.5, position = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.25);
  contact wall(gap = -q[1], slip = {der(q[2]), der(q[3])}, friction = 0.3, restitution = 0.6);
end CornerThatSticks;
)");
  for (const double lift : {0.0, 1e-8, 0.01, 0.1, 0.5})
    withEachIntegrator(file, 1e-6, 0.001,
                       [lift](CompiledModel &model) {
                         EXPECT_NEAR(model["der(q[1])"], -1.2, 1e-12) << lift;
                         EXPECT_NEAR(model["der(q[3])"], 0, 1e-12) << lift;
                         EXPECT_EQ(model["floor.impulse"], 0) << lift;
                         EXPECT_NEAR(model["wall.impulse"], 1.6, 1e-12) << lift;
                       },
                       {{"vz", lift}});
}

// A ball that spins on the floor, between a paddle and a wall: these lift it, stop its spin and hold it then. What the slips are at the
// start moves the times of all that by little.
TEST(Impacts, OfABallThatIsCaughtDoNotDependOnTrifles) {
  const std::string file = sourceFile("caught_ball.tf", R"(
model CaughtBall
  parameter Real r = 0.1, m = 0.5, gap = 1e-3, across = 0.1;
  coordinate Real p[3](start = {-gap, 0, r}, der(start = {2, across, 0}));
  coordinate Rotation Q(w(start = {-1, 20, 3}));
  Real w[3] = Q*Q.w;
  body ball(mass = m, position = p, orientation = Q, inertia = 0.4*m*r^2*identity(3));
  coordinate Real x(start = -r - gap, der(start = 2));
  body pad(mass = 2, position = x);
  contact paddle(gap = p[1] - r - x, slip = {der(p[2]) - r*w[3], der(p[3]) + r*w[2]}, friction = 0.3, restitution = 0.4);
  contact floor(gap = p[3] - r, slip = {der(p[1]) - r*w[2], der(p[2]) + r*w[1]}, friction = 0.25);
  contact wall(gap = -p[1], slip = {der(p[2]) + r*w[3], der(p[3]) - r*w[2]}, friction = 0.3, restitution = 0.6);
end CaughtBall;
)");
  for (const double trifle : {0.0, 1e-12, 1e-7, 1e-6, 1e-4}) {
    CompiledModel model(file, {{"across", 0.1 + trifle}});
    model.tolerance(1e-10).run(0.001);
    EXPECT_NEAR(model["der(p[1])"], -1.2, 1e-12) << trifle;
    EXPECT_EQ(model["floor.impulse"], 0) << trifle;
    EXPECT_NEAR(model["Q.w[1]"], -0.999948875436691, 10 * trifle + 1e-9) << trifle;
  }
}

// A mass slides obliquely under a ceiling that comes down, and is caught: friction holds it while the ceiling has work left to give back,
// or has not reached its target. Impulses of Stronge's law against an integration with friction that is smooth at zero, which is right to
// 1e-5.
TEST(Impacts, WhatCannotPartAWedgeIsLost) {
  const auto wedge = [](const std::string &law) {
    return sourceFile("caught_in_a_wedge_" + law + ".tf", fmt::format(R"(
model Wedge
  parameter Real mu = 0.6, under = 0.4, e = 0.5, below = 0.5, slope = 0.3, side = 2;
  coordinate Real x(der(start = 5)), y(der(start = side)), z;
  body b(mass = 1, position = {{x, y, z}});
  gravity g(acceleration = {{0, 0, -9.81}});
  contact floor(gap = z, slip = {{der(x), der(y)}}, friction = under, restitution = below, law = ImpactLaw.{0});
  contact ceiling(gap = (1 - x)*sin(slope) - z*cos(slope), slip = {{der(x)*cos(slope) - der(z)*sin(slope), der(y)}}, friction = mu,
    restitution = e, law = ImpactLaw.{0});
end Wedge;
)",
                                                                      law));
  };
  const auto expectRest = [](CompiledModel &model) {
    for (const char *velocity : {"der(x)", "der(y)", "der(z)"})
      EXPECT_NEAR(model[velocity], 0, 1e-9) << velocity;
  };
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-8})
      for (const double side : {2.0, -3.0}) {
        CompiledModel model(wedge("Stronge"), {{"side", side}});
        model.tolerance(tolerance).integrator(integrator).run(2);
        const double scale = 10 * tolerance;
        expectRest(model);
        EXPECT_NEAR(model["floor.impulse"], side > 0 ? 3.131527 : 3.60633, 2e-5 + scale);
        EXPECT_NEAR(model["ceiling.impulse"], side > 0 ? 3.910427 : 4.38592, 2e-5 + scale);
      }
  const Settings cases[] = {{{"mu", 1.122}, {"under", 0.268}, {"e", 0.35}, {"below", 0.81}, {"slope", 0.668}, {"side", -0.81}},
                            {{"mu", 0.363}, {"under", 0.503}, {"e", 0.87}, {"below", 0.19}, {"slope", 0.582}, {"side", 2.11}}};
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-8})
      for (const Settings &settings : cases) {
        CompiledModel model(wedge("Poisson"), settings);
        model.tolerance(tolerance).integrator(integrator).run(2);
        expectRest(model);
        EXPECT_LT(model["ceiling.impulse"], 10);
      }
  const std::string planar = sourceFile("caught_in_a_planar_wedge.tf", R"(
model PlanarWedge
  parameter Real mu = 0.6, e = 0.5, slope = 0.4;
  coordinate Real x(der(start = 5)), y;
  body b(mass = 1, position = {x, y});
  gravity g(acceleration = {0, -9.81});
  contact floor(gap = y, slip = der(x), friction = mu);
  contact ceiling(gap = (1 - x)*sin(slope) - y*cos(slope), slip = der(x)*cos(slope) - der(y)*sin(slope), friction = mu, restitution = e,
    law = ImpactLaw.Newton);
end PlanarWedge;
)");
  for (const double friction : {0.3, 0.6, 1.0})
    for (const double restitution : {0.01, 0.5, 1.0}) {
      CompiledModel model(planar, {{"mu", friction}, {"e", restitution}});
      model.tolerance(1e-8).run(1);
      EXPECT_NEAR(model["der(x)"], 0, 1e-12);
      EXPECT_NEAR(model["der(y)"], 0, 1e-12);
      EXPECT_LT(model["ceiling.impulse"], 20);
    }
}

// Three balls on a rail that nothing presses together: the impacts of the middle one with the others, on either side in turn, bring them to
// one velocity in finite time, and each contact comes to rest there although it bears nothing from then on.
TEST(AccumulatingImpacts, OfBallsWithoutLoadEndAtRestWithOneAnother) {
  const std::string file = sourceFile("three_balls.tf", R"(
model ThreeBalls
  parameter Real e[2] = {0.05, 0.06};
  coordinate Real x[3](start = {0, 1.1, 2.3}, der(start = {1, 0, -0.8}));
  body ball[3](each mass = 1, position = x);
  contact pair[2](gap = x[2:3] - x[1:2] - fill(1, 2), restitution = e);
end ThreeBalls;
)");
  for (const auto &[first, second] : {std::pair{0.05, 0.06}, std::pair{0.06, 0.06}, std::pair{0.065, 0.055}}) {
    double time = 0, gap[2] = {0.1, 0.2}, v[3] = {1, 0, -0.8};
    for (int impact = 0; impact < 200; ++impact) {
      double next[2];
      for (int k = 0; k < 2; ++k)
        next[k] = v[k] > v[k + 1] ? std::max(gap[k], 0.0) / (v[k] - v[k + 1]) : std::numeric_limits<double>::infinity();
      const int k = next[0] < next[1] ? 0 : 1;
      if (!(next[k] < 1))
        break;
      time += next[k];
      for (int i = 0; i < 2; ++i)
        gap[i] = i == k ? 0 : gap[i] + next[k] * (v[i + 1] - v[i]);
      const double push = 0.5 * (1 + (k == 0 ? first : second)) * (v[k] - v[k + 1]);
      v[k] -= push;
      v[k + 1] += push;
    }
    withEachIntegrator(file, 1e-9, 3,
                       [&](CompiledModel &model) {
                         EXPECT_EQ(model.count(TF_EVENT_REST), 2);
                         EXPECT_NEAR(model.eventTime(TF_EVENT_REST), time, 1e-8);
                         for (const char *velocity : {"der(x[1])", "der(x[2])", "der(x[3])"})
                           EXPECT_NEAR(model[velocity], 0.2 / 3, 1e-9);
                       },
                       {{"e[1]", first}, {"e[2]", second}});
  }
}

// A rod falls on two supports inside its radius of gyration, where an impact of one lifts the other end: within each hop of one end the
// other one bounces and comes to rest, infinitely often. Small angles: all impacts down to 1e-28 m/s followed with 60 digits.
TEST(AccumulatingImpacts, OfAccumulationsAreSummed) {
  const std::string file = sourceFile("two_supports.tf", R"(
model TwoSupports
  parameter Real d = 0.2, tilt = 0.05;
  coordinate Real y(start = 0.5), q(start = tilt);
  body rod(mass = 1, position = {0, y}, angle = q, inertia = 1/12);
  gravity g(acceleration = {0, -9.81});
  contact support[2](gap = {y - d*q, y + d*q}, restitution = {0.644, 0.248});
end TwoSupports;
)");
  struct Rod {
    double distance, tilt, rest;
  };
  for (const auto &[distance, tilt, rest] : {Rod{0.2, 0.05, 1.7457585442706273758}, Rod{0.2, 0.5, 1.4938597146020134334},
                                             Rod{0.28, 0.05, 1.5351560528686501025}, Rod{0.28, 0.5, 1.3006552134800441317}})
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
        CompiledModel model(file, {{"d", distance}, {"tilt", tilt}});
        ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
        ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(3));
        const double error = integrator == TF_CVODE ? 1e3 * tolerance : 1e-12;
        EXPECT_NEAR(model.eventTime(TF_EVENT_CLOSING, model.count(TF_EVENT_CLOSING) - 1), rest, error)
            << distance << ", tilt " << tilt << ", integrator " << integrator << ", tolerance " << tolerance;
        EXPECT_LT(tf_get_statistics(model.simulation())->worst_energy_error, std::max(1e-12, error));
      }
}

// The same rod at large angles: the impacts change as it turns, and the point of rest is found by extrapolation. Without friction all
// impacts down to 1e-20 m/s, and the motions between them, have been followed with 60 digits.
TEST(AccumulatingImpacts, OfAccumulationsAreExtrapolated) {
  const std::string file = sourceFile("two_rough_supports.tf", R"(
model TwoRoughSupports
  parameter Real d = 0.28, tilt = 0.3, mu = 0;
  coordinate Real r[2](start = {0, 0.5}), phi(start = tilt);
  Real tip[2, 2] = {r - d*{cos(phi), sin(phi)}, r + d*{cos(phi), sin(phi)}};
  body rod(mass = 1, position = r, angle = phi, inertia = 1/12);
  gravity g(acceleration = {0, -9.81});
  contact support[2](gap = tip[:, 2], slip = der(tip[:, 1]), each friction = mu, restitution = {0.644, 0.248});
end TwoRoughSupports;
)");
  constexpr double rest = 1.48307347205555;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    CompiledModel model(file);
    model.tolerance(tolerance).run(3);
    EXPECT_NEAR(model.eventTime(TF_EVENT_CLOSING, model.count(TF_EVENT_CLOSING) - 1), rest, tolerance);
  }
  const auto placeOfRough = [&file](double tilt) {
    CompiledModel model(file, {{"mu", 0.3}, {"tilt", tilt}});
    model.tolerance(1e-12).run(3);
    return model["r[1]"];
  };
  CompiledModel model(file, {{"mu", 0.3}});
  differentiateBy(model, {"tilt"});
  model.tolerance(1e-10).run(3);
  EXPECT_NEAR(model["r[1]"], placeOfRough(0.3), 1e-9);
  EXPECT_NEAR(sensitivity(model, "r[1]", 0), differenceQuotient(placeOfRough, 0.3, 1e-3), 1e-7);
}

// A foot whose ankle's stop, heel and head shake one another, in accumulations of accumulations whose hops become lower than what gaps are
// rounded to. Without restitution what the contacts that close stop is what keeps another one parting; with restitution, the impacts have
// no order there.
TEST(AccumulatingImpacts, OfThreeContactsEndAtEachTolerance) {
  const std::string file = sourceFile("foot.tf", R"(
model Foot
  parameter Real mu = 0.643, L = 0.3, h = 0.1, l = 0.8, e = 0, vx = -2.393, spin = -1.378, T = 16.962;
  coordinate Real r[2](start = {0, h}, der(start = {vx, 0}));
  coordinate Real f;
  coordinate Real b(start = 0.487, der(start = spin));
  Real heel[2] = r + {-0.3*L*cos(f) + h*sin(f), -0.3*L*sin(f) - h*cos(f)};
  Real toe[2] = r + {0.7*L*cos(f) + h*sin(f), 0.7*L*sin(f) - h*cos(f)};
  body foot(mass = 1, position = (heel + toe + r)/3, angle = f, inertia = 0.01);
  body shin(mass = 4, position = r + l*{-sin(b), cos(b)}, angle = b, inertia = 0.1);
  gravity weight(acceleration = {0, -9.81});
  force ankle(value = T, at = b - f);
  contact floor[2](gap = {heel[2], toe[2]}, slip = {der(heel[1]), der(toe[1])}, each friction = mu, each restitution = e);
  contact head(gap = r[2] + 2*l*cos(b), slip = der(r[1] - 2*l*sin(b)), friction = mu, restitution = e);
  contact stop[2](gap = {0.6 - (b - f), b - f + 0.6}, each restitution = e);
end Foot;
)");
  const std::vector<Settings> cases = {
      {},
      {{"mu", 0.9661421522786328}, {"vx", -2.859093053888766}, {"spin", -1.1319219096251532}, {"T", 14.529987872731684}, {"e", 0.3}},
      {{"mu", 0.5608059663733073}, {"vx", -2.3355330437390682}, {"spin", -1.4941115167652652}, {"T", 12.552912262686192}, {"e", 0.3}}};
  for (const Settings &settings : cases) {
    CompiledModel reference(file, settings);
    reference.tolerance(1e-9).run(0.8);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-11, 1e-12, 1e-13}) {
        CompiledModel model(file, settings);
        // Worst values are those of all steps then.
        ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
        ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(0.8)) << integrator << ", tolerance " << tolerance;
        EXPECT_LT(model.events().size(), 10'000u) << integrator << ", tolerance " << tolerance;
        EXPECT_NEAR(model["r[1]"], reference["r[1]"], 1e-7) << integrator << ", tolerance " << tolerance;
        EXPECT_GT(tf_get_statistics(model.simulation())->worst_gap, -1e-9);
      }
  }
}

}  // namespace
}  // namespace tf::test
