// Boundaries whose motion switches with time: gaps, slips and constraints have the side that time goes to, from the start on.
#include "tests/accuracy/each_integrator.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

namespace tf::test {
namespace {

double worstEnergyError(const CompiledModel &model) { return tf_get_statistics(model.simulation())->worst_energy_error; }

void run(CompiledModel &model, double time) {
  tf_set_energy_balance(model.simulation(), 1);
  model.run(time);
}

TEST(MovingBoundaries, BeltThatStartsAtOnceDragsTheBody) {
  const std::string file = sourceFile("starting_belt.tf", R"(
model StartingBelt
  coordinate Real x;
  body b(mass = 1, position = x);
  friction f(slip = der(x) - (if time < 1 then 0 else 1), bound = 2);
end StartingBelt;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator);
    run(model, 1.2);
    EXPECT_NEAR(model["der(x)"], 0.4, 1e-9);
    model.advance(3);
    EXPECT_NEAR(model["x"], 0.25 + 1.5, 1e-8);
    EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), 1.5, 1e-8);
    EXPECT_LT(worstEnergyError(model), 1e-7);
  }
}

// A jump of the floor's velocity is an impact on the body that rests on it.
TEST(MovingBoundaries, FloorThatStartsAtOnceHitsTheBody) {
  const std::string file = sourceFile("starting_floor.tf", R"(
model StartingFloor
  coordinate Real y;
  body b(mass = 1, position = y);
  force weight(value = -9.81, at = y);
  contact floor(gap = y - (if time <= 1 then 0 else 0.1*(time - 1)), restitution = 0.5);
end StartingFloor;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator);
    run(model, 0.99);
    EXPECT_TRUE(model.events().empty());
    model.advance(1.005);
    EXPECT_NEAR(model["der(y)"], 0.15 - 9.81 * 0.005, 1e-8);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), 1, 1e-12);
    EXPECT_LT(worstEnergyError(model), 1e-7);
  }
}

TEST(MovingBoundaries, TheStartHasTheSideOfItsTime) {
  CompiledModel wall(sourceFile("later_wall.tf", R"(
model LaterWall
  coordinate Real x(start = 0.5);
  body b(mass = 1, position = x);
  contact wall(gap = x - (if time < 1 then 0 else (time - 1)^2), restitution = 0);
end LaterWall;
)"));
  wall.tolerance(1e-9);
  run(wall, 3);
  EXPECT_NEAR(wall["x"], 4, 1e-7);
  EXPECT_NEAR(wall.eventTime(TF_EVENT_IMPACT), 1 + std::sqrt(0.5), 1e-9);

  CompiledModel rail(sourceFile("later_rail.tf", R"(
model LaterRail
  coordinate Real x(start = 0.3), y(start = 1);
  body b(mass = 1, position = {x, y});
  constraint rail(residual = y - 1 - (if time < 1 then 0 else 0.5*(time - 1)^2));
end LaterRail;
)"));
  rail.tolerance(1e-9);
  run(rail, 2);
  EXPECT_NEAR(rail["y"], 1.5, 1e-9);
  EXPECT_NEAR(rail["der(y)"], 1, 1e-9);

  CompiledModel spring(sourceFile("switched_spring.tf", R"(
model SwitchedSpring
  coordinate Real x(start = 0.5);
  body b(mass = 1, position = x);
  potential p(energy = if x < 0 then 5*x^2 else 50*x^2);
end SwitchedSpring;
)"));
  spring.tolerance(1e-9);
  run(spring, 2);
  EXPECT_LT(worstEnergyError(spring), 1e-7);
}

std::string errorOf(const std::string &name, const std::string &elements) {
  CompiledModel model(sourceFile(
      name + ".tf", "model " + name + "\n  coordinate Real x(start = 0.3, der(start = 1)), y;\n" + elements +
                        "\n  body b(mass = 1, position = {x, y});\n  gravity w(acceleration = {0, -9.81});\nend " + name + ";\n"));
  model.tolerance(1e-8);
  try {
    run(model, 2);
  } catch (const std::runtime_error &error) {
    return error.what();
  }
  return "";
}

// What no impact can follow is an error, not a wrong motion.
TEST(MovingBoundaries, JumpsThatNothingFollowsAreErrors) {
  const auto expect = [](const std::string &text, const std::string &part) { EXPECT_NE(text.find(part), std::string::npos) << text; };
  expect(errorOf("JumpingFloor", "  contact floor(gap = y - (if time < 1 then 0 else 0.2));"),
         "the gap of contact 'floor' jumps to -0.2 (");
  expect(errorOf("JumpingRail", "  constraint rail(residual = y - (if time < 1 then 0 else 0.2));"),
         "the residual of constraint 'rail' jumps to -0.2 (");
  expect(errorOf("StartingRail", "  constraint rail(residual = y - (if time < 1 then 0 else 0.2*(time - 1)));"),
         "the velocity of constraint 'rail' jumps by 0.2, which only contacts may (");
  expect(errorOf("Negative", "  contact floor(gap = y, slip = der(x), friction = if x < 0.5 then 0.01 else -1);"),
         "the friction coefficient of contact 'floor' is -1, it cannot be negative (");
}

// The gap opens with the third power of time, more slowly than a long step at a loose tolerance is wrong.
TEST(MovingBoundaries, AWheelLeavesTheRoadOnce) {
  const std::string file = sourceFile("quarter_car.tf", R"(
model QuarterCar
  parameter Real M = 75, m = 20, k = 20000, A = 0.1, w = 15, g = 9.81;
  Real road = A*sin(w*time)*(if time < 0.1 then 0 else 1 - exp(-5*(time - 0.1)));
  coordinate Real zb(start = -M*g/k), zw;
  body chassis(mass = M, position = {0, zb});
  body wheel(mass = m, position = {0, zw});
  gravity weight(acceleration = {0, -g});
  potential spring(energy = k/2*(zb - zw)^2);
  contact ground(gap = zw - road);
end QuarterCar;
)");
  const auto run = [&](tf_integrator integrator, double tolerance, double amplitude) {
    CompiledModel model(file, {{"A", amplitude}});
    model.tolerance(tolerance).integrator(integrator).run(0.5);
    EXPECT_GE(model.count(TF_EVENT_OPENING), 1);
    EXPECT_LE(model.count(TF_EVENT_OPENING), 2);
    return model["zb"];
  };
  for (const double amplitude : {0.1, 0.15}) {
    const double exact = run(TF_STEP, 1e-11, amplitude);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6})
        EXPECT_NEAR(run(integrator, tolerance, amplitude), exact, 10 * tolerance) << tolerance;
  }
}

// A box falls on a plane that turns, with two corners: gaps that depend on time. In the frame of the plane they do not, and the box has the
// forces of that frame.
TEST(MovingBoundaries, ABoxFallsOnATurningPlane) {
  const std::string corners = R"(
  Real c[2, 2] = {r + {-0.2*cos(p) - s*0.1*sin(p), -0.2*sin(p) + s*0.1*cos(p)} for s in {-1, 1}};
)";
  const std::string moving = sourceFile("box_on_turning_plane.tf", R"(
model TurningPlane
  parameter Real O, e, mu, p0, a0 = 2*3.141592653589793/3;
  coordinate Real r[2], p(start = p0);
  body b(mass = 1, position = r, angle = p, inertia = 0.05/3);
  gravity g(acceleration = {0, -9.81});)" + corners + R"(
  Real a = O*time + a0;
  contact w[2](gap = {0.6 + c[i, 1]*sin(a) - c[i, 2]*cos(a) for i in 1:2},
    slip = {der(c[i, 1])*cos(a) + der(c[i, 2])*sin(a) + O*(c[i, 2]*cos(a) - c[i, 1]*sin(a)) for i in 1:2},
    each friction = mu, each restitution = e);
end TurningPlane;
)");
  const std::string fixed = sourceFile("box_in_turning_frame.tf", R"(
model TurningFrame
  parameter Real O, e, mu, p0, a0 = 2*3.141592653589793/3;
  coordinate Real r[2], p(start = p0 - a0, der(start = -O));
  body b(mass = 1, position = r, angle = p, inertia = 0.05/3);
  Real a = O*time + a0;
  force along(value = -9.81*sin(a) + 2*O*der(r[2]) + O^2*r[1], at = r[1]);
  force across(value = -9.81*cos(a) - 2*O*der(r[1]) + O^2*r[2], at = r[2]);)" +
                                                                      corners + R"(
  contact w[2](gap = {0.6 - c[i, 2] for i in 1:2}, slip = {der(c[i, 1]) for i in 1:2}, each friction = mu, each restitution = e);
end TurningFrame;
)");
  const Settings all[] = {{{"mu", 0.2}, {"p0", 0.3}, {"O", 1}, {"e", 0.2}},
                          {{"mu", 0.072}, {"p0", -0.204}, {"O", 1.474}, {"e", 0.059}},
                          {{"mu", 0.234}, {"p0", 0.096}, {"O", 0.868}, {"e", 0.513}},
                          {{"mu", 0.313}, {"p0", 0.06}, {"O", 0.618}, {"e", 0.241}},
                          {{"mu", 0.491}, {"p0", 0.268}, {"O", 1.091}, {"e", 0.259}}};
  for (const Settings &settings : all) {
    CompiledModel inFrame(fixed, settings);
    inFrame.tolerance(1e-11).run(1.5);
    const double a = settings[2].second * 1.5 + inFrame["a0"], x = inFrame["r[1]"], y = inFrame["r[2]"];
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-3, 1e-5, 1e-6, 1e-9}) {
        SCOPED_TRACE("integrator " + std::to_string(integrator) + ", " + std::to_string(tolerance) + ", mu " +
                     std::to_string(settings[0].second));
        CompiledModel model(moving, settings);
        model.tolerance(tolerance).integrator(integrator);
        run(model, 1.5);
        const double accepted = 10 * tolerance;
        EXPECT_NEAR(model["r[1]"], x * std::cos(a) - y * std::sin(a), accepted);
        EXPECT_NEAR(model["r[2]"], x * std::sin(a) + y * std::cos(a), accepted);
        EXPECT_NEAR(model["p"], inFrame["p"] + a, accepted);
        EXPECT_LT(model.events().size(), 1000U);
        EXPECT_GE(tf_get_statistics(model.simulation())->worst_gap, -1e-10);
      }
  }
}

// A box tumbles in a drum of six walls: where it sticks to two of them a corner hits the one, and positions are corrected at the event's
// time.
TEST(MovingBoundaries, ABoxTumblesInADrum) {
  const std::string file = sourceFile("box_in_drum.tf", R"(
model Drum
  coordinate Real r[2], p(start = 0.3);
  parameter Real c[4, 2] = {{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}};
  body b(mass = 1, position = r, angle = p, inertia = 0.05/3);
  gravity g(acceleration = {0, -9.81});
  Real k[4, 2] = {r + {c[i, 1]*cos(p) - c[i, 2]*sin(p), c[i, 1]*sin(p) + c[i, 2]*cos(p)} for i in 1:4};
  Real a[6] = {time + j*3.14159265358979/3 for j in 1:6};
  contact w[6, 4](gap = {{0.6 + k[i, 1]*sin(a[j]) - k[i, 2]*cos(a[j]) for i in 1:4} for j in 1:6},
    slip = {{der(k[i, 1])*cos(a[j]) + der(k[i, 2])*sin(a[j]) + k[i, 2]*cos(a[j]) - k[i, 1]*sin(a[j]) for i in 1:4} for j in 1:6},
    each friction = 0.4, each restitution = 0.2);
end Drum;
)");
  CompiledModel best(file);
  best.tolerance(1e-11).run(4);
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT})
    for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", " + std::to_string(tolerance));
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator);
      run(model, 4);
      for (const char *name : {"r[1]", "r[2]", "p"})
        EXPECT_NEAR(model[name], best[name], 10 * tolerance) << name;
      EXPECT_GE(tf_get_statistics(model.simulation())->worst_gap, -1e-10);
    }
}

// A cylinder slides in a half pipe on a cart: what keeps it on the curve after a step moves its slip as well, whose zero is one event at
// any tolerance, with no reversal before the stick.
TEST(MovingBoundaries, SlipsOnACurveStopOnce) {
  const std::string file = sourceFile("half_pipe.tf", R"(
model HalfPipe
  parameter Real m = 0.5, r = 0.1, R = 0.6, mu = 0.2, M = 2, L = 1;
  coordinate Real x(start = 0.35), y(start = -sqrt((R - r)^2 - 0.35^2), fixed = true, der(fixed = true)), f(der(start = 10));
  coordinate Real s(start = 0), th(start = 0.3);
  Real d[2] = {x - s, y};
  Real l = sqrt(d*d);
  Real n[2] = -d/l, t[2] = {-n[2], n[1]};
  body cylinder(mass = m, position = {x, y}, angle = f, inertia = m*r^2/2);
  body cart(mass = M, position = {s, 0});
  body bob(mass = 0.7, position = {s + L*sin(th), -L*cos(th)});
  gravity weight(acceleration = {0, -9.81});
  friction rail(slip = der(s), bound = 0.5);
  contact wall(gap = R - r - l, slip = (der(x) - der(s))*t[1] + der(y)*t[2] - r*der(f), friction = mu);
end HalfPipe;
)");
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-7, 1e-9})
    withEachIntegrator(file, tolerance, 3, [](CompiledModel &model) {
      EXPECT_EQ(model.events().size(), 11);
      EXPECT_EQ(model.count(TF_EVENT_SLIP_REVERSAL), 4);
    });
}

// The ground lifts a body that is pressed on it, smoothly, and in a small part of the time for which nothing moves before and after; a mass
// hangs on a spring from the body. What holds the body gives no error that shows the rise.
TEST(MovingBoundaries, AShortRiseOfTheGroundLiftsTheBody) {
  const std::string file = sourceFile("short_rise.tf", R"(
model ShortRise
  parameter Real H = 0.12, duration = 0.1, begin = 0.25, k = 50;
  Real s = (time - begin)/duration;
  coordinate Real w, z;
  body follower(mass = 1, position = w);
  body hanging(mass = 1, position = z);
  force spring(value = -k*(z - w), at = z - w);
  force press(value = -1e5, at = w);
  contact ground(gap = w - H*smooth(2, noEvent(if s <= 0 then 0 elseif s >= 1 then 1 else s^3*(10 - 15*s + 6*s^2))));
end ShortRise;
)");
  for (const double duration : {0.1, 0.004}) {
    CompiledModel exact(file, {{"duration", duration}});
    exact.tolerance(1e-12).integrator(TF_STEP).run(2);
    for (const double tolerance : {1e-4, 1e-6, 1e-9})
      withEachIntegrator(
          file, tolerance, 2,
          [&](CompiledModel &model) {
            EXPECT_NEAR(model["w"], 0.12, 1e-13) << tolerance;
            EXPECT_NEAR(model["z"], exact["z"], 10 * tolerance) << tolerance;
            EXPECT_NEAR(model["der(z)"], exact["der(z)"], 10 * tolerance * std::sqrt(50.0)) << tolerance;
            EXPECT_NEAR(sensitivity(model, "w", 0), 1, 1e-9) << tolerance;
            EXPECT_NEAR(sensitivity(model, "w", 1), 0, 1e-9) << tolerance;
            // Motions at rest begin with the rise: z is one function of time less its begin.
            // On the way derivatives are as large as the accelerations of the rise.
            EXPECT_NEAR(sensitivity(model, "z", 1), -exact["der(z)"], 1000 * tolerance) << tolerance;
          },
          {{"duration", duration}}, [](CompiledModel &model) { differentiateBy(model, {"H", "begin"}); });
  }
}

// Attempts of a step that are rejected, as they leap over the lobe's begin, say nothing of the step that is accepted before it.
TEST(MovingBoundaries, TheLobesOfACamAreMetInFewSteps) {
  const std::string file = sourceFile("lobed_cam.tf", R"(
model LobedCam
  parameter Real e = 0.01;
  coordinate Real y(start = 0.05), phi(start = -1, der(start = 12));
  body follower(mass = 0.5, position = y);
  body shaft(angle = phi, inertia = 0.005);
  force motor(value = 0.4*(12 - der(phi)), at = phi);
  force spring(value = -300*(y - 0.05) - 2, at = y);
  contact cam(gap = y - 0.05 - smooth(2, if sin(phi) > 0 then e*sin(phi)^4 else 0), restitution = 0.3);
end LobedCam;
)");
  CompiledModel exact(file);
  exact.tolerance(1e-12).integrator(TF_STEP).run(2);
  for (const double tolerance : {1e-4, 1e-5, 1e-6})
    withEachIntegrator(file, tolerance, 2, [&](CompiledModel &model) {
      EXPECT_NEAR(model["phi"], exact["phi"], 23 * 10 * tolerance) << tolerance;
      EXPECT_NEAR(model["der(phi)"], exact["der(phi)"], 12 * 10 * tolerance) << tolerance;
      EXPECT_LT(tf_get_statistics(model.simulation())->steps, 1500) << tolerance;
    });
}

}  // namespace
}  // namespace tf::test
