// Every example against its closed form or an independent reference solution.
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/support/dry_friction_reference.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

const double kPi = std::acos(-1.0);

std::vector<double> uniformGrid(double end, int count) {
  std::vector<double> grid;
  for (int i = 1; i <= count; ++i) {
    grid.push_back(end * i / count);
  }
  return grid;
}

// The zero of a function in an interval where it changes its sign.
double zero(const std::function<double(double)> &function, double low, double high) {
  const bool negative = function(low) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((function(middle) < 0) == negative ? low : high) = middle;
  }
  return high;
}

void expectFollows(CompiledModel &model, const DryFriction &problem, double end, const char *x, const char *v, double bound) {
  const std::vector<double> grid = uniformGrid(end, 200);
  const FrictionSolution solution = solve(problem, grid);
  model.tolerance(1e-9).initialise();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    model.advance(grid[i]);
    ASSERT_NEAR(model[x], static_cast<double>(solution.samples[i][0]), bound) << "t = " << grid[i];
    ASSERT_NEAR(model[v], static_cast<double>(solution.samples[i][1]), bound) << "t = " << grid[i];
  }
  std::vector<double> times;
  for (const Event &event : model.events()) {
    if (event.kind == TF_EVENT_STICK || event.kind == TF_EVENT_SLIP || event.kind == TF_EVENT_SLIP_REVERSAL) {
      times.push_back(event.time);
    }
  }
  ASSERT_EQ(times.size(), solution.switches.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(times[i], static_cast<double>(solution.switches[i].time), bound) << "switch " << i;
  }
}

// From the impact on, the wind W pulls along x against friction R = 2W: with the speed w at the angle ψ to x, w = C tan²(ψ/2)/sin ψ and
// rest after C/(2W) (u + u³/3), u = tan(ψ₀/2).
TEST(Examples, ParticleInSpaceComesToRestOnACurve) {
  const double fall = std::sqrt(2 * 0.05 / 10), speed = std::hypot(2 + fall, 2), slip = speed - 0.2 * 10 * fall;
  const double angle = std::atan2(2, 2 + fall), u = std::tan(angle / 2), C = slip * std::sin(angle) / (u * u);
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_CVODE}) {
    CompiledModel model(example("particle3d.tf"));
    model.tolerance(1e-9).integrator(integrator).run(4);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), fall, 1e-9);
    EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), fall + C / 2 * (u + u * u * u / 3), 1e-8);
    EXPECT_NEAR(model["der(q[1])"], 0, 1e-13);
    EXPECT_NEAR(model["floor.frictionForce[1]"], -1, 1e-10);
  }
}

// All feet leave at once, each in its own direction: independent integrators agree.
TEST(Examples, TableTurnsAsSoonAsNoForceHoldsIt) {
  CompiledModel reference(example("dragged_table.tf"));
  reference.tolerance(1e-11).integrator(TF_STEP).run(3);
  for (const tf_integrator integrator : {TF_AUTO, TF_CVODE}) {
    CompiledModel model(example("dragged_table.tf"));
    model.tolerance(1e-8).integrator(integrator).run(1.9);
    EXPECT_EQ(model["foot[1].sticking"], 1);
    EXPECT_NEAR(model["psi"], 0, 1e-13);
    model.advance(3);
    EXPECT_NEAR(model.eventTime(TF_EVENT_SLIP), reference.eventTime(TF_EVENT_SLIP), 1e-9);
    for (const char *name : {"q[1]", "q[2]", "psi", "der(q[1])", "der(psi)"})
      EXPECT_NEAR(model[name], reference[name], 1e-6) << name;
  }
}

// The directions in which the feet begin to slip amplify rounding errors, but not beyond the accuracy that is asked for.
TEST(Examples, TableTurnsAtTheTightestTolerances) {
  CompiledModel reference(example("dragged_table.tf"));
  reference.tolerance(1e-10).integrator(TF_STEP).run(3);
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT})
    for (const double tolerance : {1e-11, 1e-12}) {
      CompiledModel model(example("dragged_table.tf"));
      model.tolerance(tolerance).integrator(integrator).run(3);
      for (const char *name : {"q[1]", "q[2]", "psi", "der(q[1])", "der(psi)"})
        EXPECT_NEAR(model[name], reference[name], 2e-9) << name << ", " << tolerance;
    }
}

TEST(Examples, ParticleRestsAtHalfTheSpeedOfTime) {
  CompiledModel model(example("particle.tf"));
  model.tolerance(1e-9).run(1);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), std::sqrt(2 / 9.81), 1e-10);
  EXPECT_NEAR(model["tau"], 2, 1e-9);
  EXPECT_NEAR(model["q[2]"], 0, 1e-10);
  EXPECT_NEAR(model["floor.normalForce"], 9.81, 1e-9);
}

TEST(Examples, ParticleLiftsOffWhereTheForceBeatsGravity) {
  // u[2] as a table that is linear from 1 s on, as 2 g (t - 1).
  const double g = 9.81, mu = 0.6;
  CompiledModel model(example("particle.tf"), {{"mu", mu}, {"u[1]", 7}});
  const double times[] = {0, 1, 3}, forces[] = {0, 0, 4 * g};
  ASSERT_EQ(tf_set_input_table(model.simulation(), "u[2]", times, forces, 3, 1), TF_OK);
  model.tolerance(1e-9).run(3);
  const double t1 = std::sqrt(2 / g), v1 = 7 * t1 - mu * g * t1;
  // Sliding with 7 - mu (g - u2) to 1.5 s, then free.
  const double vLift = v1 + (7 - mu * g) * (1.5 - t1) + mu * g * 0.25;
  EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), 1.5, 1e-8);
  EXPECT_NEAR(model["der(q[1])"], vLift + 7 * 1.5, 1e-8);
  EXPECT_NEAR(model["q[2]"], g * std::pow(1.5, 3) / 3, 1e-8);
  EXPECT_NEAR(model["der(q[2])"], g * 1.5 * 1.5, 1e-8);
}

TEST(Examples, InclineStaysOrSlidesBack) {
  for (const double mu : {0.3, 0.7}) {
    CompiledModel model(example("incline.tf"), {{"mu", mu}});
    model.tolerance(1e-9).run(2);
    const double g = 9.81, a = kPi / 6, up = g * (std::sin(a) + mu * std::cos(a)),
                 down = std::max(0.0, g * (std::sin(a) - mu * std::cos(a)));
    const double stop = 2 / up, back = 2 - stop;
    EXPECT_NEAR(model["s"], 2 * stop - up * stop * stop / 2 - down * back * back / 2, 1e-8) << mu;
    EXPECT_NEAR(model["der(s)"], -down * back, 1e-8) << mu;
    EXPECT_NEAR(model.eventTime(down > 0 ? TF_EVENT_SLIP_REVERSAL : TF_EVENT_STICK), stop, 1e-9) << mu;
    EXPECT_NEAR(model["plane.normalForce"], 2 * g * std::cos(a), 1e-9) << mu;
  }
}

TEST(Examples, StickSlipFollowsTheReference) {
  CompiledModel model(example("stickslip.tf"));
  DryFriction problem{.mass = 1, .bound = 1, .force = [](Number, Number x, Number) { return -4 * x; }};
  problem.belt = [](Number) { return 0.3; };
  problem.v = 0.3;
  expectFollows(model, problem, 5, "x", "der(x)", 1e-8);
}

TEST(Examples, PushedBlockSticksAndSlips) {
  CompiledModel model(example("pushed_block.tf"));
  const Number g = 9.81, mu = 0.4;
  const DryFriction problem{.mass = 1, .bound = mu * g, .force = [](Number t, Number, Number) { return 6 * std::sin(2 * t); }};
  expectFollows(model, problem, 5, "q[1]", "der(q[1])", 1e-8);
}

TEST(Examples, DenHartogFollowsTheReference) {
  for (const double w : {0.5, 0.25}) {
    CompiledModel model(example("den_hartog.tf"), {{"w", w}});
    const Number d = 0.1, bound = 0.6;
    const DryFriction problem{
        .mass = 1, .bound = bound, .force = [=](Number t, Number x, Number v) { return std::cos(Number(w) * t) - x - d * v; }};
    expectFollows(model, problem, 30, "x", "der(x)", 1e-7);
  }
}

TEST(Examples, DuffingFollowsTheReference) {
  CompiledModel model(example("duffing.tf"));
  const Number speed = 0.6, part = 0.7;
  DryFriction problem{.mass = 1, .bound = 1, .force = [](Number, Number x, Number) { return -x - x * x * x; }};
  problem.belt = [=](Number t) { return speed * (1 + part * std::sin(2 * t)); };
  problem.beltAcceleration = [=](Number t) { return speed * part * 2 * std::cos(2 * t); };
  problem.x = -0.2;
  expectFollows(model, problem, 6.5, "x", "der(x)", 1e-8);
}

TEST(Examples, RelaySlides) {
  CompiledModel model(example("relay.tf"));
  model.tolerance(1e-9).initialise();
  const double hit = zero([](double t) { return 1 - 2 * t + std::sin(t); }, 0.5, 1.5);
  model.advance(3);
  EXPECT_NEAR(model.eventTime(TF_EVENT_SLIDING), hit, 1e-9);
  EXPECT_NEAR(model["x"], 0, 1e-9);
  EXPECT_NEAR(model["z"], hit + (std::sin(3) - std::sin(hit)) / 2, 1e-8);
}

TEST(Examples, CornerCatchesTheParticle) {
  CompiledModel model(example("corner.tf"));
  model.tolerance(1e-9).run(0.3);
  EXPECT_NEAR(model["r[1]"], 0.35, 1e-9);
  EXPECT_NEAR(model["r[2]"], 0, 1e-10);
  model.advance(1.5);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, 0), (std::sqrt(11.0) - 1) / 10, 1e-9);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, 1), 0.8 / 1.5, 1e-9);
  EXPECT_NEAR(model["r[1]"], 0, 1e-10);
  EXPECT_NEAR(model["wall[2].normalForce"], 10, 1e-9);
}

TEST(Examples, CartsGoTogetherUntilTheBufferThrowsThemBack) {
  CompiledModel model(example("carts.tf"));
  model.tolerance(1e-9).initialise();
  const double hit = 0.25, together = kPi / std::sqrt(3.0), end = 3 - hit - together;
  model.advance(1);
  EXPECT_NEAR(model["x[2]"], 1 + 0.5 / std::sqrt(3.0) * std::sin(std::sqrt(3.0) * 0.75), 1e-9);
  EXPECT_NEAR(model["bumper.normalForce"], 3 * (model["x[2]"] - 1), 1e-8);
  model.advance(3);
  EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), hit, 1e-9);
  EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), hit + together, 1e-7);
  EXPECT_NEAR(model["x[1]"], 0.5 - 0.5 * end, 1e-8);
  EXPECT_NEAR(model["x[2]"], 1 - 0.25 * std::sin(2 * end), 1e-8);
}

TEST(Examples, ParticleLeavesTheSwingingTableAndLandsOnIt) {
  CompiledModel model(example("moving_ground.tf"));
  model.tolerance(1e-9).initialise();
  const double g = 9.81, A = 0.1, w = 12, angle = std::asin(g / (A * w * w));
  const auto table = [&](double t) { return A * std::sin(w * t); };
  double time = 0;
  for (int hop = 0; hop < 2; ++hop) {
    // Lift-off where the table's downward acceleration exceeds gravity: at once, or at the next time.
    const double phase = std::fmod(w * time, 2 * kPi), next = time + (phase <= angle ? angle - phase : angle - phase + 2 * kPi) / w;
    const double lift = phase > angle && phase < kPi - angle ? time : next;
    const double y = table(lift), v = A * w * std::cos(w * lift);
    const auto gap = [&](double t) { return y + v * (t - lift) - g * (t - lift) * (t - lift) / 2 - table(t); };
    double after = lift + 0.02;
    while (gap(after) > 0) {
      after += 1e-3;
    }
    const double land = zero(gap, after - 1e-3, after), middle = (lift + land) / 2;
    model.advance(middle);
    EXPECT_NEAR(model["y"], table(middle) + gap(middle), 1e-8) << "hop " << hop;
    model.advance(land + 1e-3);
    EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING, hop), lift, 1e-8) << "hop " << hop;
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, hop), land, 1e-8) << "hop " << hop;
    time = land;
  }
}

TEST(Examples, ThermostatHoldsTheSetPointWhileItCan) {
  CompiledModel model(example("thermostat.tf"));
  model.tolerance(1e-9).initialise();
  const auto warming = [](double t) { return 41 - t - 29 * std::exp(-0.2 * t); };
  const double hit = zero([&](double t) { return warming(t) - 20; }, 1, 3);
  model.advance(1);
  EXPECT_NEAR(model["T"], warming(1), 1e-8);
  model.advance(10);
  EXPECT_NEAR(model["T"], 20, 1e-9);
  EXPECT_NEAR(model["used"], 6 * hit + 2.8 * (10 - hit) + 0.1 * (100 - hit * hit), 1e-7);
  model.advance(24);
  EXPECT_NEAR(model["T"], 41 - 24 - 5 * std::exp(-0.2 * 8), 1e-8);
  EXPECT_NEAR(model.eventTime(TF_EVENT_SLIDING), hit, 1e-9);
}

TEST(Examples, PendulumRestsAtTheWallUntilTheWindTakesIt) {
  CompiledModel model(example("pendulum_wall.tf"));
  model.tolerance(1e-9).initialise();
  const Number g = 9.81, d = 0.05, wall = -0.3;
  const auto torque = [&](Number t, Number phi, Number w) { return -g * std::sin(phi) - d * w + 4 * std::sin(2 * t) * std::cos(phi); };
  const auto flight = [&](Number t, const State<2> &y) { return State<2>{y[1], torque(t, y[0], y[1])}; };
  const auto gap = [&](Number, const State<2> &y) { return wall - std::sin(y[0]); };
  const Number angle = std::asin(wall);
  Number t = 0;
  State<2> y{-1.2L, 0};
  int impacts = 0;
  while (gaussUntil<2>(flight, gap, t, y, 5, Number(0.01))) {
    model.advance(static_cast<double>(t) + 1e-6);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, impacts), static_cast<double>(t), 1e-8);
    EXPECT_NEAR(model["der(phi)"], 0, 1e-4);
    ++impacts;
    // Held while the torque presses it to the wall.
    while (t < 5 && torque(t, angle, 0) > 0) {
      t += Number(1e-4);
    }
    y = {angle, -1e-18L};
    if (t >= 5) {
      break;
    }
    t = static_cast<Number>(zero([&](double at) { return static_cast<double>(torque(at, angle, 0)); },
                                 static_cast<double>(t - Number(2e-4)), static_cast<double>(t)));
    y = {angle, -1e-18L};
    model.advance(std::min(5.0, static_cast<double>(t) + 0.1));
    EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING, impacts - 1), static_cast<double>(t), 1e-8);
  }
  EXPECT_GE(impacts, 2);
  model.advance(5);
  EXPECT_NEAR(model["phi"], static_cast<double>(y[0]), 1e-7);
}

}  // namespace
}  // namespace tf::test
