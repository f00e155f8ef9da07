// Switches whose conditions vary much faster than the state: between two of them the state hardly changes, so that a step may be long.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/each_integrator.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

namespace tf::test {
namespace {

double bisect(const std::function<double(double)> &function, double low, double high) {
  const bool rises = function(low) < 0;
  for (int k = 0; k < 80; ++k)
    ((function(0.5 * (low + high)) < 0) == rises ? low : high) = 0.5 * (low + high);
  return low;
}

void expectTimes(CompiledModel &model, const std::vector<double> &expected, double allowed) {
  ASSERT_EQ(model.events().size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(model.events()[k].time, expected[k], allowed) << k;
}

// Zeros of v − V cos(ω t) where friction cannot hold the belt's acceleration: v changes at the constant rate ∓F/m between them.
std::vector<double> reversals(double speed, double frequency, double deceleration, double end) {
  std::vector<double> times;
  double time = 0, v = 0;
  for (double side = -1;; side = -side) {
    const auto relative = [&](double t) { return side * (v - side * deceleration * (t - time) - speed * std::cos(frequency * t)); };
    double high = time + 1e-3 / frequency;
    while (relative(high) > 0)
      high += 0.01 / frequency;
    const double zero = bisect(relative, high - 0.01 / frequency, high);
    if (zero > end)
      return times;
    v -= side * deceleration * (zero - time);
    time = zero;
    times.push_back(time);
  }
}

TEST(FastGuards, BeltThatShakesUnderAFreeBody) {
  for (const double frequency : {300.0, 100 * pi, 2000.0}) {
    const std::vector<double> expected = reversals(0.2, frequency, 3, 1);
    EXPECT_GT(expected.size(), 90U);
    SCOPED_TRACE(frequency);
    const std::string file = sourceFile("shaken_belt.tf", R"(
model Shaken
  parameter Real om = 300;
  coordinate Real x;
  body b(mass = 1, position = x);
  friction f(slip = der(x) - 0.2*cos(om*time), bound = 3);
end Shaken;
)");
    withEachIntegrator(file, 1e-9, 1, [&](CompiledModel &model) { expectTimes(model, expected, 1e-8); }, {{"om", frequency}});
  }
}

TEST(FastGuards, NarrowPulsesOfTime) {
  // 400 t in (π/2 ∓ acos 0.99) + 2πk.
  const double half = std::acos(0.99);
  std::vector<double> expected;
  for (int k = 0; 2 * pi * k + pi / 2 + half < 400; ++k)
    for (const double side : {-1.0, 1.0})
      expected.push_back((pi / 2 + 2 * pi * k + side * half) / 400);
  const double duration = 0.5 * static_cast<double>(expected.size()) * 2 * half / 400;
  const std::string file = sourceFile("pulses.tf", R"(
model Pulses
  coordinate Real x;
  body b(mass = 1, position = x);
  force f(value = if sin(400*time) > 0.99 then 1 else 0, at = x);
end Pulses;
)");
  withEachIntegrator(file, 1e-9, 1, [&](CompiledModel &model) {
    expectTimes(model, expected, 1e-9);
    EXPECT_NEAR(model["der(x)"], duration, 1e-9);
  });
}

// Frequencies, phases and levels at random: no coincidence of samples hides a switch.
TEST(FastGuards, SignalsAtRandomAreAllSeen) {
  CompiledModel model(sourceFile("signal_at_random.tf", R"(
model Random
  parameter Real om = 1, phase = 0, level = 0;
  coordinate Real x;
  body b(mass = 1, position = x);
  force f(value = if sin(om*time + phase) > level then 1 else -1, at = x);
end Random;
)"));
  std::mt19937_64 generator(1);
  const auto random = [&generator] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  for (int run = 0; run < 300; ++run) {
    const double frequency = 5 * std::pow(1000, random()), phase = 2 * pi * random(), level = 1.98 * random() - 0.99;
    SCOPED_TRACE(std::to_string(frequency) + " " + std::to_string(phase) + " " + std::to_string(level));
    tf_set(model.simulation(), "om", frequency);
    tf_set(model.simulation(), "phase", phase);
    tf_set(model.simulation(), "level", level);
    model.tolerance(1e-8).integrator(integrators[run % 4]).run(1);
    // sin rises through the level at asin(level) + 2πk and falls through it at π − asin(level) + 2πk.
    const auto passed = [&](double angle) {
      return std::floor((frequency + phase - angle) / (2 * pi)) - std::floor((phase - angle) / (2 * pi));
    };
    EXPECT_EQ(static_cast<double>(model.events().size()), passed(std::asin(level)) + passed(pi - std::asin(level)));
  }
}

// The switch depends on the state too, which creeps behind a signal that oscillates: x = 0.1 t + a little.
TEST(FastGuards, ConditionOfTimeAndState) {
  const std::string file = sourceFile("behind.tf", R"(
model Behind
  coordinate Real x(der(start = 0.1));
  body b(mass = 1, position = x);
  force f(value = if x < sin(100*time) - 0.5 then 0.01 else 0, at = x);
end Behind;
)");
  withEachIntegrator(file, 1e-9, 3, [&](CompiledModel &model) {
    std::vector<double> expected;
    double time = 0, x = 0, v = 0.1, force = 0;
    const auto moved = [&](double t) { return x + v * (t - time) + 0.5 * force * (t - time) * (t - time); };
    for (double t = 1e-4; t < 3; t += 1e-4) {
      const auto condition = [&](double s) { return std::sin(100 * s) - 0.5 - moved(s); };
      if ((condition(t) > 0) == (force > 0))
        continue;
      const double zero = bisect(condition, t - 1e-4, t);
      x = moved(zero);
      v += force * (zero - time);
      time = zero;
      force = force > 0 ? 0 : 0.01;
      expected.push_back(zero);
    }
    EXPECT_GT(expected.size(), 80U);
    expectTimes(model, expected, 1e-8);
  });
}

// While a body sticks its state does not change at all; each pull that exceeds the friction moves it.
TEST(FastGuards, PullsThatExceedFrictionForInstants) {
  // m v' = F0 sin(ω t) − F while it slides: it starts at sin(ω t) = F/F0 and stops where its velocity is zero again.
  const double frequency = 300, bound = 0.9, start = std::asin(bound) / frequency;
  const auto velocity = [&](double t) { return (std::cos(frequency * start) - std::cos(frequency * t)) / frequency - bound * (t - start); };
  const double stop = bisect(velocity, pi / 2 / frequency + 1e-4, pi / frequency);
  const double way = (std::cos(frequency * start) + bound * frequency * start) / frequency * (stop - start) -
                     (std::sin(frequency * stop) - std::sin(frequency * start)) / (frequency * frequency) -
                     0.5 * bound * (stop * stop - start * start);
  const std::string file = sourceFile("pulled.tf", R"(
model Pulled
  coordinate Real x;
  body b(mass = 1, position = x);
  force pull(value = max(0, sin(300*time)), at = x);
  friction f(slip = der(x), bound = 0.9);
end Pulled;
)");
  withEachIntegrator(file, 1e-10, 1, [&](CompiledModel &model) {
    // 300 t passes π/2 + 2πk for the last time in the period that begins at 47 · 2π.
    EXPECT_EQ(model.count(TF_EVENT_SLIP), 48);
    EXPECT_EQ(model.count(TF_EVENT_STICK), 48);
    EXPECT_NEAR(model["x"], 48 * way, 1e-8);
  });
}

// A body that a force F sin(ω t) moves once in every half period and that friction of 1 holds in between: steps over the rest of the time
// begin and end anywhere in a period.
TEST(FastGuards, NoSlipUnderAPeriodicForceIsPassedOver) {
  const std::string file = sourceFile("pushed_now_and_then.tf", R"(
model Push
  parameter Real F = 1.2, om = 7;
  coordinate Real x;
  body b(mass = 1, position = x);
  force push(value = F*sin(om*time), at = x);
  friction dry(slip = der(x), bound = 1);
end Push;
)");
  std::mt19937 random(20);
  const auto between = [&random](double low, double high) { return low + (high - low) * (static_cast<double>(random()) / 4294967296.0); };
  for (int draw = 0; draw < 100; ++draw) {
    const double force = between(1.02, 1.4), frequency = between(3, 60), tolerance = std::pow(10.0, between(-10, -3));
    const double halfPeriods = std::floor(between(10, 100)) + 0.75, end = halfPeriods * pi / frequency;
    for (const tf_integrator integrator : integrators) {
      CompiledModel model(file, {{"F", force}, {"om", frequency}});
      model.tolerance(tolerance).integrator(integrator);
      model.run(end);
      const auto slips = static_cast<int>(std::floor((frequency * end - std::asin(1 / force)) / pi)) + 1;
      EXPECT_EQ(model.count(TF_EVENT_SLIP), slips) << force << ' ' << frequency << ' ' << end << ' ' << tolerance << ' ' << integrator;
    }
  }
}

// A smooth pulse that exceeds friction for a small part of the time for which a body would rest.
TEST(FastGuards, APulseOnABodyAtRestIsNotPassedOver) {
  // What it has come to when it stops.
  const auto way = [](double center, double width) {
    const double step = 1e-4 * width;
    double time = center - width * std::sqrt(std::log(5.0)), velocity = 0, place = 0;
    const auto acceleration = [&](double t) { return 5 * std::exp(-std::pow((t - center) / width, 2)) - 1; };
    while (true) {
      const double next = velocity + step / 6 * (acceleration(time) + 4 * acceleration(time + 0.5 * step) + acceleration(time + step));
      if (next < 0)
        return place;
      place += 0.5 * step * (velocity + next);
      velocity = next;
      time += step;
    }
  };
  for (const char *element : {"friction c(slip = der(x), bound = 1)", "contact c(gap = y, slip = der(x), friction = 0.5)"}) {
    const std::string file = sourceFile(std::string("pulse_on_") + element[0] + ".tf",
                                        std::string("model A\n  parameter Real center = 5, width = 0.1;\n  coordinate Real x, y;\n"
                                                    "  body b(mass = 1, position = {x, y});\n"
                                                    "  force f(value = {5*exp(-((time - center)/width)^2), -2}, at = {x, y});\n  ") +
                                            (element[0] == 'f' ? "contact floor(gap = y);\n  " : "") + element + ";\nend A;\n");
    for (const double width : {1.0, 0.3, 0.15, 0.1})
      for (const double center : {1.7, 3.1, 5.632})
        for (const double tolerance : {1e-4, 1e-10})
          withEachIntegrator(file, tolerance, center + 10 * width + 1,
                             [&](const CompiledModel &model) {
                               EXPECT_NEAR(model["x"], way(center, width), 20 * tolerance * (1 + way(center, width)) + 1e-6)
                                   << element << ' ' << width << ' ' << center << ' ' << tolerance;
                             },
                             {{"center", center}, {"width", width}});
  }
}

// A floor that shakes under a body which flies by: it is hit where the floor is high.
TEST(FastGuards, FloorThatShakes) {
  // y = 1 − g t²/2 over 0.01 sin(1000 t).
  const auto gap = [](double t) { return 1 - 0.5 * 9.81 * t * t - 0.01 * std::sin(1000 * t); };
  double first = 0.4;
  while (gap(first) > 0)
    first += 1e-5;
  first = bisect(gap, first - 1e-5, first);
  const std::string file = sourceFile("shaking_floor.tf", R"(
model ShakingFloor
  coordinate Real y(start = 1);
  body b(mass = 1, position = y);
  force weight(value = -9.81, at = y);
  contact c(gap = y - 0.01*sin(1000*time), restitution = 1);
end ShakingFloor;
)");
  withEachIntegrator(file, 1e-9, 0.46, [&](CompiledModel &model) {
    ASSERT_FALSE(model.events().empty());
    EXPECT_NEAR(model.events()[0].time, first, 1e-9);
  });
}

// A parabola over many thousand periods of the table, of which one step would take more samples than are taken of a step.
TEST(FastGuards, TableThatVibratesThroughALongFlight) {
  const std::string file = sourceFile("vibrating_table.tf", R"(
model VibratingTable
  parameter Real om = 1e5;
  coordinate Real y(start = 1);
  body b(mass = 1, position = y);
  force weight(value = -0.1, at = y);
  contact table(gap = y - 0.01*sin(om*time), restitution = 0.5);
end VibratingTable;
)");
  for (const double frequency : {5e4, 6e4, 1e5, 2e5}) {
    const auto gap = [&](double t) { return 1 - 0.05 * t * t - 0.01 * std::sin(frequency * t); };
    double first = 4.44;  // the parabola is above 0.01 before
    while (gap(first) > 0)
      first += 0.001 / frequency;
    first = bisect(gap, first - 0.001 / frequency, first);
    for (const double end : {6.0, 4.6}) {
      CompiledModel model(file, {{"om", frequency}});
      model.tolerance(1e-9).run(end);
      EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), first, 1e-10) << frequency << ", " << end;
    }
  }
}

// Low bounces and long ones on a plate that vibrates many times in each: none is missed, however near a crest the ball comes.
TEST(FastGuards, PlatesThatVibrateUnderBounces) {
  CompiledModel model(sourceFile("vibrating_plate.tf", R"(
model VibratingPlate
  parameter Real amplitude = 0.1, om = 30, phase = 0, e(min = 0) = 0.7;
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  force weight(value = -9.81, at = y);
  contact plate(gap = y - amplitude*sin(om*time + phase), restitution = e);
end VibratingPlate;
)"));
  std::mt19937_64 generator(1);
  const auto random = [&generator] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  for (int run = 0; run < 200; ++run) {
    const double om = 10 * std::pow(100, random()), phase = 2 * pi * random();
    const double amplitude = std::min(0.3, 200 * random() / (om * om));
    tf_set(model.simulation(), "om", om);
    tf_set(model.simulation(), "phase", phase);
    tf_set(model.simulation(), "amplitude", amplitude);
    tf_set(model.simulation(), "e", 0.3 + 0.7 * random());
    struct Deepest {
      const CompiledModel &model;
      double om, phase, amplitude, gap = 0, time = 0;
    } deepest{model, om, phase, amplitude};
    const auto observe = [](void *data, double time) {
      auto &own = *static_cast<Deepest *>(data);
      if (const double gap = own.model["y"] - own.amplitude * std::sin(own.om * time + own.phase); gap < own.gap) {
        own.gap = gap;
        own.time = time;
      }
      return time + 1e-3;
    };
    model.tolerance(1e-6).integrator(integrators[run % 4]).initialise();
    ASSERT_EQ(tf_run(model.simulation(), 3, 1e-3, observe, &deepest), TF_OK) << tf_error_text(model.simulation());
    EXPECT_GE(deepest.gap, -1e-7) << run << ": t = " << deepest.time;
  }
}

// Teeth of a wheel that turns uniformly pass a carriage which comes nearer: however many of them pass in a step.
TEST(FastGuards, NoToothOfAWheelIsPassedOver) {
  CompiledModel model(sourceFile("wheel_with_teeth.tf", R"(
model WheelWithTeeth
  parameter Real teeth = 20, depth = 0.1, phase = 0;
  coordinate Real s(start = 1, der(start = -1)), w(der(start = 10));
  body carriage(mass = 1, position = s);
  body wheel(angle = w, inertia = 1);
  contact tooth(gap = s - depth*sin(teeth*w + phase), restitution = 0.5);
end WheelWithTeeth;
)"));
  std::mt19937_64 generator(1);
  const auto random = [&generator] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
  for (int run = 0; run < 1000; ++run) {
    const double teeth = 1 + std::floor(60 * random()), depth = 0.9 * random(), phase = 2 * pi * random(), speed = 60 * random();
    SCOPED_TRACE(std::to_string(run) + ": " + std::to_string(teeth) + " teeth, speed " + std::to_string(speed) + ", depth " +
                 std::to_string(depth));
    const auto gap = [&](double t) { return 1 - t - depth * std::sin(teeth * speed * t + phase); };
    double first = 0;
    const double step = 0.01 / std::max(1.0, teeth * speed);
    while (gap(first) > 0)
      first += step;
    first = bisect(gap, first - step, first);
    tf_set(model.simulation(), "teeth", teeth);
    tf_set(model.simulation(), "depth", depth);
    tf_set(model.simulation(), "phase", phase);
    tf_set(model.simulation(), "der(w)", speed);
    model.tolerance(run % 8 < 4 ? 1e-6 : 1e-9).integrator(integrators[run % 4]).run(first + 0.2 * random());
    ASSERT_FALSE(model.events().empty());
    EXPECT_NEAR(model.events()[0].time, first, 1e-7);
  }
}

// A rotor whose centre drifts to a wall, L − V t − r cos ω t, and one that is thrown over a floor: all is uniform, and one step would turn
// by up to a million radians.
TEST(FastGuards, RotorsThatTurnThousandsOfTimesInAFlight) {
  const std::string file = sourceFile("drifting_rotor.tf", R"(
model DriftingRotor
  parameter Real om = 1e4, v = 0.01, r = 0.01, l = 1, g = 0;
  coordinate Real x(der(start = v)), phi(der(start = om));
  body carrier(mass = 1, position = x);
  body rotor(angle = phi, inertia = 1);
  force weight(value = g, at = x);
  contact wall(gap = l - x - r*cos(phi), restitution = 0.5);
end DriftingRotor;
)");
  struct Case {
    double om, v, r, l, g, end;
  };
  for (const Case &one : {Case{1e4, 0.01, 0.01, 1, 0, 99.5}, Case{1e4, 0.01, 0.01, 1, 0, 100},
                          Case{6780.974563486473, 0.677503364550399, 0.015021407073201733, 2.0874891672151312, 0, 3.5571682835394},
                          Case{1440.9213892623914, 0, 0.01915189901984154, 1.8624727607452185, 0.1, 8.7494},
                          Case{1440.9213892623914, 0, 0.01915189901984154, 1.8624727607452185, 0.1, 8.8}}) {
    const auto gap = [&](double t) { return one.l - one.v * t - 0.5 * one.g * t * t - one.r * std::cos(one.om * t); };
    // When the centre is within r of the wall.
    const double path = one.l - one.r;
    double first = one.g > 0 ? std::sqrt(2 * path / one.g) : path / one.v;
    while (gap(first) > 0)
      first += 0.001 / one.om;
    first = bisect(gap, first - 0.001 / one.om, first);
    for (const tf_integrator integrator : {TF_AUTO, TF_EXPLICIT}) {
      CompiledModel model(file, {{"om", one.om}, {"v", one.v}, {"r", one.r}, {"l", one.l}, {"g", one.g}});
      model.tolerance(1e-9).integrator(integrator).run(one.end);
      EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), first, 1e-9) << one.om << ", " << one.end;
    }
  }
}

// An input that is a fast function of time reaches a condition.
TEST(FastGuards, ConditionOfAnInput) {
  const std::string file = sourceFile("signal.tf", R"(
model Signal
  input Real u;
  coordinate Real x;
  body b(mass = 1, position = x);
  force f(value = if u > x + 0.9 then 1 else 0, at = x);
end Signal;
)");
  const auto prepare = [](const CompiledModel &model) {
    const auto signal = [](void * /*data*/, double time, double /*segment*/) { return std::sin(500 * time); };
    tf_set_input_callback(model.simulation(), "u", signal, nullptr, nullptr);
  };
  withEachIntegrator(file, 1e-9, 0.2, [&](CompiledModel &model) { EXPECT_EQ(model.events().size(), 32U); }, {}, prepare);
}

// The push beats friction at t = 2; a step that begins less than rounding before that finds the same zero, without a search for others.
TEST(VaryingForces, EndAtTheirZeroHoweverNearItAStepBegins) {
  const std::string file = sourceFile("pushed.tf", R"(
model Pushed
  coordinate Real x, y;
  body block(mass = 1, position = {x, y});
  gravity weight(acceleration = {0, -10});
  force push(value = 5*time + sin(20*(time - 2))/100, at = x);
  contact floor(gap = y, slip = der(x), friction = 1);
end Pushed;
)");
  for (const tf_integrator integrator : integrators)
    for (const double before : {1e-9, 3e-10, 1e-10}) {
      CompiledModel model(file);
      model.tolerance(1e-9).integrator(integrator).initialise();
      model.advance(2 - before);
      model.advance(2.5);
      EXPECT_NEAR(model.eventTime(TF_EVENT_SLIP), 2, 1e-12) << integrator << ", " << before;
      EXPECT_LT(tf_get_statistics(model.simulation())->evaluations, 5000) << integrator << ", " << before;
    }
}

// A bar that turns through up to 100 rad in a step strikes a post of radius 0.1 at its tip's radius 1 and turns back, 2π − 4 asin(0.05)
// each time.
TEST(NarrowPosts, AreNotPassedByInLongSteps) {
  const std::string file = sourceFile("narrow_post.tf", R"(
model NarrowPost
  parameter Real place = 3.6;
  coordinate Real phi(der(start = 50));
  body bar(angle = phi, inertia = 1);
  contact post(gap = sqrt((cos(phi) - cos(place))^2 + (sin(phi) - sin(place))^2) - 0.1, restitution = 1);
end NarrowPost;
)");
  const double half = 2 * std::asin(0.05), turn = 2 * pi - 2 * half, first = 3.6 - half;
  for (const tf_integrator integrator : integrators)
    for (const double interval : {1.0, 0.37, 0.1})
      for (double speed = 31; speed < 110; speed += 7.3) {
        CompiledModel model(file, {{"der(phi)", speed}});
        model.tolerance(1e-6).integrator(integrator).initialise();
        for (double time = interval; time < 1; time += interval)
          model.advance(time);
        model.advance(1);
        const int expected = 1 + static_cast<int>(std::floor((speed - first) / turn));
        EXPECT_EQ(model.count(TF_EVENT_IMPACT), expected) << integrator << ", " << interval << ", " << speed;
      }
}

}  // namespace
}  // namespace tf::test
