// Sensitivities across impacts, stick and slip: against closed forms, and where they are refused.
#include "tests/accuracy/differentiated_models.h"
#include "tests/accuracy/each_integrator.h"
#include "tests/accuracy/pushed_table.h"
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

// Falls from h with the speed v along a rough floor: impact at t1 = sqrt(2h/g), which takes mu·g·t1 of v, then sliding friction mu·g, rest
// at t2 = v/(mu g), x = v t1 + (v − mu g t1)²/(2 mu g).
TEST(Sensitivities, OfASlideAfterAnImpactAreThoseOfTheClosedForm) {
  const double h = 1, g = 9.81, mu = 0.3, v = 2, t1 = std::sqrt(2 * h / g), after = v - mu * g * t1;
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf", {{"mu", mu}, {"der(q[1])", v}});
  differentiateBy(model, {"mu", "q[2]", "der(q[1])", "g"});
  model.tolerance(1e-10).run(1.5);
  EXPECT_EQ(model["der(q[1])"], 0);
  EXPECT_NEAR(sensitivity(model, "q[1]", 0), -t1 * after / mu - after * after / (2 * mu * mu * g), 1e-8);
  const double byTime = v - after;  // dx/dt1
  EXPECT_NEAR(sensitivity(model, "q[1]", 1), byTime * t1 / (2 * h), 1e-8);
  EXPECT_NEAR(sensitivity(model, "q[1]", 2), t1 + after / (mu * g), 1e-8);
  EXPECT_NEAR(sensitivity(model, "q[1]", 3), -byTime * t1 / (2 * g) - t1 * after / g - after * after / (2 * mu * g * g), 1e-8);
  for (std::size_t column = 0; column < 4; ++column) {
    EXPECT_NEAR(sensitivity(model, "der(q[1])", column), 0, 1e-9);
    EXPECT_NEAR(sensitivity(model, "q[2]", column), 0, 1e-9);
  }
  EXPECT_NEAR(sensitivity(model, "floor.normalForce", 3), 1, 1e-9);
}

TEST(Sensitivities, AnInputIsAConstantAddedToIt) {
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf", {{"mu", 0}});
  differentiateBy(model, {"u[1]", "m"});
  model.tolerance(1e-10).run(0.4);
  EXPECT_NEAR(sensitivity(model, "q[1]", 0), 0.08, 1e-10);
  EXPECT_NEAR(sensitivity(model, "q[2]", 1), 0, 1e-10);
}

// Of what is small beside its nominal value 1: J dx/dJ = −x for quotients by J.
TEST(Sensitivities, ByParametersAndInputsOfAnyScale) {
  const std::string file = sourceFile("small_inertia.tf", R"(
model SmallInertia
  parameter Real J = 1, s = 1, w = s/J;
  input Real u(start = 1);
  coordinate Real x(der(start = w)), y(start = s/J), z, angle;
  body a(mass = 1, position = {x, 0});
  body b(mass = 1, position = {y, 0});
  body c(mass = 1, position = {z, 0});
  body d(mass = J, position = {angle, 0});
  force push(value = s/J, at = z);
  force turn(value = s^2/u, at = angle);
end SmallInertia;
)");
  for (const double J : {1.0, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 1e6}) {
    SCOPED_TRACE(J);
    CompiledModel model(file, {{"J", J}, {"s", J}, {"u", J}});
    differentiateBy(model, {"J", "u"});
    model.tolerance(1e-10).run(1);
    EXPECT_NEAR(J * sensitivity(model, "x", 0), -1, 1e-9);
    EXPECT_NEAR(J * sensitivity(model, "y", 0), -1, 1e-9);
    EXPECT_NEAR(J * sensitivity(model, "der(z)", 0), -1, 1e-9);
    EXPECT_NEAR(J * sensitivity(model, "der(angle)", 0), -1, 1e-9);
    EXPECT_NEAR(J * sensitivity(model, "der(angle)", 1), -1, 1e-9);
  }
}

// After many periods a small change of a frequency is a large one of the phase.
TEST(Sensitivities, ByAFrequencyAfterManyPeriods) {
  const double w = 1000, end = 3;
  CompiledModel model(sourceFile("shaken.tf", R"(
model Shaken
  parameter Real w = 1000;
  coordinate Real x;
  body b(mass = 1, position = {x, 0});
  force f(value = w*cos(w*time), at = x);
end Shaken;
)"));
  differentiateBy(model, {"w"});
  model.tolerance(1e-10).run(end);
  EXPECT_NEAR(sensitivity(model, "der(x)", 0), end * std::cos(w * end), 1e-6);
}

// Both ends of a level rod hit the floor at once: by its height they go on doing so, by its angle one comes before the other.
TEST(Sensitivities, OfImpactsAtOneTimeExistWhereTheyStayTogether) {
  const std::string file = sourceFile("level_rod", R"(
model LevelRod
  coordinate Real y(start = 1), phi;
  body rod(mass = 1, position = {0, y}, angle = phi, inertia = 0.1);
  gravity weight(acceleration = {0, -9.81});
  contact tip[2](gap = {y - 0.5*sin(phi), y + 0.5*sin(phi)}, each restitution = 0.5);
end LevelRod;
)");
  const double impact = std::sqrt(2 / 9.81), speed = 9.81 * impact;
  CompiledModel byHeight(file);
  differentiateBy(byHeight, {"y"});
  byHeight.tolerance(1e-9).run(0.6);
  // y = 0.5 v (t − t1) − g (t − t1)²/2 with v = g t1 and dt1/dh = 1/v
  const double later = 0.6 - impact;
  EXPECT_NEAR(sensitivity(byHeight, "y", 0), (0.5 * 9.81 * later - 0.5 * speed + 9.81 * later) / speed, 1e-7);
  CompiledModel byAngle(file);
  differentiateBy(byAngle, {"phi"});
  byAngle.tolerance(1e-9).initialise();
  try {
    byAngle.advance(0.6);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    const std::string text = error.what();
    for (const char *part : {"'tip[1]' (", "'tip[2]' (", "), which come one after the other nearby, at t = 0.45"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

// A disk that rests on the floor and is pushed, started a little too fast: friction makes it roll at once, m a = −Λ, I ω̇ = −r Λ.
TEST(Sensitivities, OfAStartThatTheContactsDoNotAllowAreThoseOfTheMotionTheyLeave) {
  const std::string file = sourceFile("rolling_start.tf", R"(
model RollingStart
  parameter Real v0 = 0, fall = 0, y0 = 0.5, r = 0.5;
  coordinate Real x(der(start = v0)), y(start = y0, der(start = fall)), p;
  body b(mass = 1, position = {x, y}, angle = p, inertia = 0.5*r^2);
  gravity weight(acceleration = {0, -9.81});
  contact c(gap = y - r, slip = der(x) + r*der(p), friction = 0.5, restitution = 0.5);
end RollingStart;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    differentiateBy(model, {"v0", "fall"});
    model.tolerance(1e-9).integrator(integrator).run(1);
    EXPECT_NEAR(sensitivity(model, "x", 0), 2.0 / 3, 1e-9);
    EXPECT_NEAR(sensitivity(model, "p", 0), -4.0 / 3, 1e-9);
    for (const char *still : {"x", "y", "p", "der(y)"})
      EXPECT_NEAR(sensitivity(model, still, 1), 0, 1e-9) << still;
  }
  CompiledModel opened(file);
  differentiateBy(opened, {"y0"});
  try {
    opened.run(1);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find("the start: 'y0' opens contact 'c'"), std::string::npos) << error.what();
  }
}

// Thrown across a belt of speed u: the slip s0 = (−u, v) keeps its direction and ends at t = |s0|/(mu g), so that
// x = u t + s0 (t/2) there and x grows by u from then on.
TEST(Sensitivities, OfASlipThatContainsTheParameterAreThoseOfTheClosedForm) {
  const std::string file = sourceFile("crossed_belt.tf", R"(
model CrossedBelt
  parameter Real u = 1, mu = 0.3;
  coordinate Real x[2](der(start = {0, 1.5})), z;
  body b(mass = 1, position = {x[1], x[2], z});
  gravity weight(acceleration = {0, 0, -10});
  contact belt(gap = z, slip = {der(x[1]) - u, der(x[2])}, friction = mu);
end CrossedBelt;
)");
  const double u = 1, v = 1.5, end = 2, speed = std::hypot(u, v), stop = speed / 3, byBelt = u / speed / 3;
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-6, 1e-10}) {
      CompiledModel model(file);
      differentiateBy(model, {"u"});
      model.tolerance(tolerance).integrator(integrator).run(end);
      EXPECT_NEAR(sensitivity(model, "x[1]", 0), end - 0.5 * stop - 0.5 * u * byBelt, 1e-9) << integrator << ", " << tolerance;
      EXPECT_NEAR(sensitivity(model, "x[2]", 0), 0.5 * v * byBelt, 1e-9) << integrator << ", " << tolerance;
    }
}

// A force with a bend, which is no event: its derivative jumps inside a step, at a time that is as wrong as the state. x = cos(2ωt) until
// π/(4ω), then −2 sin(ω(t − π/(4ω))), ω² = k/m.
TEST(Sensitivities, OfAForceWithABendAreThoseOfTheClosedForm) {
  const std::string file = sourceFile("bent_spring.tf", R"(
model BentSpring
  parameter Real k = 1;
  coordinate Real x(start = 1);
  body b(mass = 1, position = {x, 0});
  force f(value = -k*noEvent(if x > 0 then 4*x else x), at = x);
end BentSpring;
)");
  // At k = 1: phase = ω t − π/4 grows with ω by t.
  const double end = 3, phase = end - std::acos(-1.0) / 4, byFrequency = -2 * end * std::cos(phase);
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    withEachIntegrator(
        file, tolerance, end, [&](CompiledModel &model) { EXPECT_NEAR(sensitivity(model, "x", 0), byFrequency / 2, 100 * tolerance); }, {},
        [](CompiledModel &model) { differentiateBy(model, {"k"}); });
}

TEST(Sensitivities, NamesOfResultsAreRefused) {
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf");
  for (const char *name : {"floor.normalForce", "no such thing"})
    EXPECT_EQ(tf_set_sensitivities(model.simulation(), &name, 1), TF_BAD_ARGUMENT);
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  model.initialise();
  EXPECT_EQ(tf_get_sensitivity(model.simulation(), 0, all.data()), TF_BAD_ARGUMENT);
}

void expectRefusal(CompiledModel &model, const char *name, double end, const char *reason) {
  differentiateBy(model, {name});
  try {
    model.run(end);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

constexpr const char *kBoard =
    R"(model Board "a table stands or slides with two feet on the ground and with two on a board that slides under it"
  parameter Real mu[4] = {0.6, 0.2, 0.25, 0.4}, push = -6, m = 3, h = 0.5, center = 0.03, vx = 1, wb = 2, tx = 0, tw = 0;
  coordinate Real p[3](start = {0, 0, h}, der(start = {tx, 0, 0})), P[2](der(start = {vx, 0.2})), phi(der(start = wb));
  coordinate Rotation Q(w(start = {0, 0, tw}));
  parameter Real c[4, 2] = {{-0.2, 0.15}, {-0.2, -0.15}, {0.2, 0.15}, {0.2, -0.15}};
  Real w[3] = Q*Q.w;
  Real arm[4, 3] = {Q*{c[i, 1], c[i, 2], -h} for i in 1:4};
  Real foot[4, 3] = {p + arm[i, :] for i in 1:4};
  Real v[4, 2] = {{der(p[1]) + w[2]*arm[i, 3] - w[3]*arm[i, 2], der(p[2]) + w[3]*arm[i, 1] - w[1]*arm[i, 3]} for i in 1:4};
  body table(mass = m, position = p + Q*{center, 0.02, 0}, orientation = Q, inertia = diagonal({0.1, 0.12, 0.2}));
  body board(mass = 2, position = P, angle = phi, inertia = 0.1);
  force weight(value = {0, 0, -10*m}, at = p + Q*{center, 0.02, 0});
  force pull(value = {push*(1 + 0.3*sin(3*time)), 0, 0}, at = p + Q*{0, 0.1, 0.2*h});
  contact ground[2](gap = foot[1:2, 3], slip = v[1:2, :], friction = mu[1:2]);
  contact top[2](gap = foot[3:4, 3], friction = mu[3:4],
    slip = {{v[i, 1] - der(P[1]) + der(phi)*(foot[i, 2] - P[2]), v[i, 2] - der(P[2]) - der(phi)*(foot[i, 1] - P[1])} for i in 3:4});
end Board;
)";

// Between the feet that stick forces are redundant as well; where the least of them lie on a friction limit they have no derivative.
TEST(Sensitivities, OfForcesOnTheFrictionLimitsOfRedundantContactsThatStickAreRefused) {
  const auto speedOfTheBoard = [&](double m) {
    CompiledModel model(fileOf(kBoard), {{"m", m}});
    model.tolerance(1e-12).run(0.15);
    return model["der(phi)"];
  };
  CompiledModel within(fileOf(kBoard));
  differentiateBy(within, {"m"});
  within.tolerance(1e-10).run(0.15);
  EXPECT_NEAR(sensitivity(within, "der(phi)", 0), (speedOfTheBoard(3 + 1e-4) - speedOfTheBoard(3 - 1e-4)) / 2e-4, 1e-7);
  CompiledModel onALimit(fileOf(kBoard), {{"push", -5}});
  expectRefusal(onALimit, "m", 0.15, "share their load within the friction of those that stick");
}

// One foot comes to rest before the others. Those nearby end the last of their slip while loads are still shared as before.
TEST(Sensitivities, OfRestWhileLoadsDecideOnWhatSlidesOnAreRefused) {
  const Settings low = {{"mu[1]", 0.3}, {"h", 0.05}, {"center", -0.1}, {"vx", 2}, {"wb", 1}, {"tx", 0.3}, {"tw", 0.5}};
  CompiledModel sliding(fileOf(kBoard), low);
  differentiateBy(sliding, {"tx"});
  sliding.tolerance(1e-9).run(0.1);
  CompiledModel resting(fileOf(kBoard), low);
  expectRefusal(resting, "tx", 0.3, "contacts that come to rest while others slide");
}

// With their friction two of the legs have equal moments: no share of theirs carries what remains when the others have lost their load.
TEST(Sensitivities, OfLoadsThatEndWithAContradictionAreRefused) {
  CompiledModel model(fileOf(kBounds), {{"x4", 0.5}});
  model.tolerance(1e-10);
  expectRefusal(model, "v2", 0.3, "the end of a load that redundant contacts share");
}

// A block on a plane that tilts slides from where tan(rate t) = μ on. Its accelerations are nearly zero there, those by gravity and by
// friction are not, and neither are their rounding errors. Its mass does not matter.
TEST(Sensitivities, OfASlipThatBeginsAtRest) {
  CompiledModel model(sourceFile("tilting_plane.tf", R"(
model TiltingPlane
  parameter Real m = 1, mu = 0.35, g = 9.81, rate = 0.3;
  coordinate Real p[2];
  body block(mass = m, position = p);
  gravity weight(acceleration = g*{sin(rate*time), -cos(rate*time)});
  contact plane(gap = p[2], slip = der(p[1]), friction = mu);
end TiltingPlane;
)"));
  constexpr double mu = 0.35, rate = 0.3, end = 1.6;
  const double angle = std::atan(mu);
  const double byGravity = (std::cos(angle) - std::cos(rate * end) - mu * (std::sin(rate * end) - std::sin(angle))) / rate;
  const double byFriction = -9.81 * (std::sin(rate * end) - std::sin(angle)) / rate;
  for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
    SCOPED_TRACE(tolerance);
    differentiateBy(model, {"m", "g", "mu"});
    model.tolerance(tolerance).run(end);
    EXPECT_NEAR(sensitivity(model, "der(p[1])", 0), 0, 1e-10);
    EXPECT_NEAR(sensitivity(model, "der(p[1])", 1), byGravity, 10 * tolerance);
    EXPECT_NEAR(sensitivity(model, "der(p[1])", 2), byFriction, 10 * tolerance);
  }
}

// From t = 0.7 on the least forces of its feet lie on the edges of friction cones, where they are known to the accuracy of an iteration
// only. The motion is none. When it begins, the direction of the slips decides on the loads and these on the slips.
TEST(Sensitivities, OfATableThatStandsStillAreZero) {
  CompiledModel model(sourceFile("pushed_table.tf", pushedTable("Exact")));
  differentiateBy(model, {"mu", "F"});
  model.tolerance(1e-8).run(1);
  for (const std::size_t column : {0U, 1U})
    for (const char *name : {"p[1]", "der(p[1])", "der(p[2])", "Q.w[3]"})
      EXPECT_EQ(sensitivity(model, name, column), 0) << name;
}

TEST(Sensitivities, OfSlipsThatStartOnRedundantContactsAreRefused) {
  CompiledModel model(sourceFile("pushed_table.tf", pushedTable("Exact")));
  model.tolerance(1e-8);
  expectRefusal(model, "mu", 1.2, "slips that start where redundant contacts share their load");
}

// A plate on four feet slides and stops. Which foot carries how much does not matter while it does not spin.
TEST(Sensitivities, OfASlideOnRedundantContactsAreThoseOfTheClosedForm) {
  const std::string file = sourceFile("plate_on_four_feet.tf", R"(
model Plate
  coordinate Real p[3](start = {0, 0, 0.1}, der(start = {2, 0.3, 0}));
  coordinate Rotation Q;
  parameter Real mu = 0.25;
  Real corner[4, 3] = {Q*{0.2, 0.15, -0.1}, Q*{-0.2, 0.15, -0.1}, Q*{-0.2, -0.15, -0.1}, Q*{0.2, -0.15, -0.1}};
  Real w[3] = Q*Q.w;
  body plate(mass = 3, position = p, orientation = Q, inertia = diagonal({0.03, 0.05, 0.07}));
  gravity g(acceleration = {0, 0, -10});
  contact foot[4](gap = {p[3] + corner[k, 3] for k in 1:4}, each friction = mu,
    slip = {{der(p[1]) + w[2]*corner[k, 3] - w[3]*corner[k, 2], der(p[2]) + w[3]*corner[k, 1] - w[1]*corner[k, 3]} for k in 1:4});
end Plate;
)");
  CompiledModel straight(file);
  differentiateBy(straight, {"mu"});
  straight.tolerance(1e-8).run(0.5);
  const double speed = std::hypot(2, 0.3);
  EXPECT_NEAR(sensitivity(straight, "p[1]", 0), -0.5 * 10 * 0.5 * 0.5 * 2 / speed, 1e-7);
  EXPECT_NEAR(sensitivity(straight, "der(p[2])", 0), -10 * 0.5 * 0.3 / speed, 1e-7);
  straight.advance(2);
  EXPECT_NEAR(sensitivity(straight, "p[1]", 0), -speed * 2 / (2 * 10 * 0.25 * 0.25), 1e-6);
}

// A slip of two components starts from zero, and its acceleration as well: for as long as it is slower than what the interpolant may be
// wrong by, that has no direction.
TEST(Sensitivities, OverTheFirstInstantsOfASlip) {
  const std::string file = sourceFile("turntable_puck.tf", R"(model TurntablePuck
  parameter Real mu = 0.3, spin = 0.8;
  coordinate Real q[3](start = {0.4, 0.1, 0});
  body puck(mass = 1, position = q);
  gravity g(acceleration = {0, 0, -9.81});
  contact table(gap = q[3], slip = {der(q[1]) + spin*time*q[2], der(q[2]) - spin*time*q[1]}, friction = mu);
end TurntablePuck;
)");
  constexpr double h = 1e-5;
  for (const auto &[name, value] : {std::pair{"mu", 0.3}, std::pair{"spin", 0.8}}) {
    const auto speeds = [&](double changed) {
      CompiledModel model(file, {{name, changed}});
      model.tolerance(1e-12).run(3.4);
      return std::array{model["der(q[1])"], model["der(q[2])"]};
    };
    const auto plus = speeds(value + h), minus = speeds(value - h);
    const double first = (plus[0] - minus[0]) / (2 * h), second = (plus[1] - minus[1]) / (2 * h), size = std::hypot(first, second);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
        CompiledModel model(file);
        differentiateBy(model, {name});
        model.tolerance(tolerance).integrator(integrator).run(3.4);
        const double error = std::hypot(sensitivity(model, "der(q[1])", 0) - first, sensitivity(model, "der(q[2])", 0) - second);
        EXPECT_LE(error, std::max(1e-7, 100 * tolerance * size)) << name << " by " << integrator << " to " << tolerance;
      }
  }
}

// The speed with which it starts is lost by 3 N if it is against the pull, and by none of it if it is along.
TEST(Sensitivities, BySpeedsOfSlipsThatStartFromRestAreRefused) {
  const std::string file = sourceFile("pulled_block.tf", R"(model PulledBlock
  parameter Real pull = 2;
  coordinate Real x, y;
  body block(mass = 1, position = {x, y});
  force f(value = {pull, 0}, at = {x, y});
  gravity g(acceleration = {0, -10});
  contact floor(gap = y, slip = der(x), friction = 0.1);
end PulledBlock;
)");
  CompiledModel refused(file);
  expectRefusal(refused, "der(x)", 1, "the start: 'der(x)' moves contact 'floor'");
  CompiledModel pulled(file), sticking(file, {{"pull", 0.5}}), moving(file, {{"der(x)", 1}});
  differentiateBy(pulled, {"pull", "x"});
  pulled.tolerance(1e-9).run(1);
  EXPECT_NEAR(sensitivity(pulled, "x", 0), 0.5, 1e-8);
  EXPECT_NEAR(sensitivity(pulled, "x", 1), 1, 1e-8);
  for (CompiledModel *model : {&sticking, &moving})
    differentiateBy(*model, {"der(x)"});
  sticking.tolerance(1e-9).run(1);
  EXPECT_NEAR(sensitivity(sticking, "x", 0), 0, 1e-8);
  moving.tolerance(1e-9).run(1);
  EXPECT_NEAR(sensitivity(moving, "x", 0), 1, 1e-8);
}

// With restitution the box does not stay: with more friction it leaves the floor with another velocity than with less.
TEST(Sensitivities, OfAnImpactWithAKinkAreRefused) {
  CompiledModel model(fileOf(kLanding), {{"e", 0.2}});
  differentiateBy(model, {"mu"});
  try {
    model.tolerance(1e-10).run(0.08);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_NE(std::string(error.what()).find("for larger and for smaller values of a parameter differ at t = 0.0700911"), std::string::npos)
        << error.what();
  }
  // They are not known afterwards: the run does not go on without them.
  const std::string text = tf_error_text(model.simulation());
  EXPECT_EQ(tf_step(model.simulation(), 0.1), TF_FAILED);
  EXPECT_EQ(tf_error_text(model.simulation()), text);
  CompiledModel other(fileOf(kLanding), {{"e", 0.2}});
  differentiateBy(other, {"J"});
  other.tolerance(1e-10).run(0.08);
}

// Bounces of a foot that accumulate, in a mechanism whose gaps are no coordinates: the slower an impact, the more its time moves with a
// given error of a derivative of the gap.
TEST(Sensitivities, OfSlowImpactsAreAsExactAsThoseOfFastOnes) {
  const std::string file = sourceFile("compass.tf", R"(model Compass
  parameter Real l = 1, b = 0.5, slope = 0.05, g = 9.81, w = -1;
  coordinate Real r[2](start = {0, l*cos(0.2)}, der(start = {-l*w*cos(0.2), 0}));
  coordinate Real phi[2](start = {0.2, -0.3}, der(start = {w, 0}));
  Real foot[2, 2] = {r + l*{sin(phi[i]), -cos(phi[i])} for i in 1:2};
  body hip(mass = 10, position = r);
  body leg[2](each mass = 5, position = {r + b*{sin(phi[i]), -cos(phi[i])} for i in 1:2});
  gravity weight(acceleration = {g*sin(slope), -g*cos(slope)});
  contact ground[2](gap = foot[:, 2], slip = der(foot[:, 1]), each friction = 1, each restitution = 0.1);
end Compass;
)");
  constexpr double end = 0.2, step = 1e-4;
  const auto angle = [&](double w) {
    CompiledModel model(file, {{"w", w}});
    model.tolerance(1e-12).run(end);
    EXPECT_GE(model.count(TF_EVENT_REST), 2);
    return model["phi[1]"];
  };
  const double difference = differenceQuotient(angle, -1, step);
  for (const double tolerance : {1e-8, 1e-9, 1e-10}) {
    CompiledModel model(file);
    differentiateBy(model, {"w"});
    model.tolerance(tolerance).run(end);
    EXPECT_NEAR(sensitivity(model, "phi[1]", 0), difference, 2e-8) << tolerance;
  }
}

// The same where the gap itself contains the parameter, whose differences have rounding errors: a ball bounces on one side of a groove
// while it rolls along the other.
TEST(Sensitivities, OfSlowImpactsOnWhatTheParameterMovesAreAsExact) {
  const std::string file = sourceFile("groove.tf", R"(model Groove
  parameter Real m = 0.5, r = 0.1, al = 0.7, A = 0.03, om = 14;
  coordinate Real p[3](start = {0.01, 0, 0.3}, der(start = {0.1, 1, 0}));
  coordinate Rotation Q(w(start = {4, -6, 12}));
  Real w[3] = Q*Q.w;
  parameter Real n1[3] = {sin(al), 0, cos(al)}, n2[3] = {-sin(al), 0, cos(al)};
  parameter Real t1[3] = {cos(al), 0, -sin(al)}, t2[3] = {cos(al), 0, sin(al)}, along[3] = {0, 1, 0};
  Real u[3] = der(p) - {0, A*om*cos(om*time), 0};
  Real c1[3] = u - r*cross(w, n1), c2[3] = u - r*cross(w, n2);
  body ball(mass = m, position = p, orientation = Q, inertia = 0.4*m*r^2*identity(3));
  gravity weight(acceleration = {0.3, 0, -9.81});
  contact one(gap = n1*p - r, slip = {c1*t1, c1*along}, friction = 0.25, restitution = 0.4);
  contact other(gap = n2*p - r, slip = {c2*t2, c2*along}, friction = 0.25, restitution = 0.4);
end Groove;
)");
  constexpr double end = 0.5, step = 1e-5;
  const auto spin = [&](double angle) {
    CompiledModel model(file, {{"al", angle}});
    model.tolerance(1e-12).run(end);
    EXPECT_GE(model.count(TF_EVENT_IMPACT), 20);
    return model["Q.w[3]"];
  };
  const double difference = differenceQuotient(spin, 0.7, step);
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP})
    for (const double tolerance : {1e-7, 1e-8, 1e-9, 1e-10, 1e-11}) {
      CompiledModel model(file);
      differentiateBy(model, {"al"});
      model.tolerance(tolerance).integrator(integrator).run(end);
      EXPECT_NEAR(sensitivity(model, "Q.w[3]", 0), difference, 1e-7 + 50 * tolerance) << integrator << ' ' << tolerance;
    }
}

// y = 1: the ball rests at t = sqrt(2/g) (1 + e)/(1 − e).
TEST(Sensitivities, OfTheTimeOfRestAreThoseOfTheClosedForm) {
  const double g = 9.81, e = 0.8, first = std::sqrt(2 / g), rest = first * (1 + e) / (1 - e);
  CompiledModel model(sourceFile("drifting_ball.tf", R"(model Drift
  parameter Real e = 0.8, h = 1, g = 9.81, c = 0.5;
  coordinate Real x, y(start = h);
  body ball(mass = 2, position = {x, y});
  gravity weight(acceleration = {0, -g});
  contact floor(gap = y, restitution = e);
  force wind(value = 2*c, at = x);
end Drift;
)"));
  differentiateBy(model, {"e", "h", "c"});
  model.tolerance(1e-10).run(8);
  EXPECT_NEAR(model.eventTime(TF_EVENT_REST), rest, 1e-8);
  for (std::size_t column = 0; column < 3; ++column) {
    EXPECT_NEAR(sensitivity(model, "y", column), 0, 1e-9);
    EXPECT_NEAR(sensitivity(model, "der(y)", column), 0, 1e-9);
  }
  EXPECT_NEAR(sensitivity(model, "x", 0), 0, 1e-8);
  EXPECT_NEAR(sensitivity(model, "x", 1), 0, 1e-8);
  EXPECT_NEAR(sensitivity(model, "x", 2), 32, 1e-7);
}

// What a contact holds has rates that are differences of forces: with a small inertia these are large, and so are their rounding errors.
// Differences of such rates by a parameter need no shorter steps for it.
TEST(Sensitivities, OfWhatContactsHoldStayZero) {
  const double start = 0.00680634;
  const std::vector<std::pair<std::string, double>> woodpecker = {
      {"mu", 0.3}, {"e", 0.935635}, {"der(y)", -0.603069}, {"der(phiS)", -2.8941}, {"mS", 0.0142243}};
  const auto place = [&](double stiffness) {
    std::vector<std::pair<std::string, double>> settings = woodpecker;
    settings.emplace_back("c", stiffness);
    CompiledModel model(example("woodpecker.tf"), settings);
    model.tolerance(1e-11);
    model.run(0.3);
    return model["y"];
  };
  const double expected = differenceQuotient(place, start, 1e-3 * start);
  for (const double tolerance : {1e-6, 1e-8, 1e-9, 1e-10}) {
    std::vector<std::pair<std::string, double>> settings = woodpecker;
    settings.emplace_back("c", start);
    CompiledModel model(example("woodpecker.tf"), settings);
    model.tolerance(tolerance);
    differentiateBy(model, {"c"});
    model.run(0.3);
    EXPECT_NEAR(sensitivity(model, "y", 0), expected, 1e-4 * std::abs(expected)) << tolerance;
    // `lower` is closed, and sticks.
    EXPECT_NEAR(sensitivity(model, "der(phiM)", 0), 0, 1e-5) << tolerance;
  }
  // A box at rest on its face, free to slide.
  for (const double tolerance : {1e-6, 1e-9, 1e-10}) {
    CompiledModel box(
        example("falling_box.tf"),
        {{"a", 0.164433}, {"b", 0.273402}, {"mu", 0}, {"der(r[1])", 0}, {"phi", -0.250039}, {"der(phi)", 0}, {"r[2]", 0.474136}});
    box.tolerance(tolerance);
    differentiateBy(box, {"a"});
    box.run(2);
    EXPECT_NEAR(sensitivity(box, "phi", 0), 0, 1e-8) << tolerance;
    EXPECT_NEAR(sensitivity(box, "der(phi)", 0), 0, 1e-8) << tolerance;
  }
}

// The time of a jump that no event shows moves with the parameter: derivatives that leave that out would be wrong.
// Rates that begin as rounding errors, which are no jumps and are resolved from where they can be seen on. All are linear in k, so that
// d(x)/d(k) is x/k.
TEST(Sensitivities, OfRatesThatCancelAtFirstAreKnown) {
  int number = 0;
  for (const char *rate : {"1 - cos(time)", "log(1 + time^2)", "sin(time) - time", "exp(time) - 1 - time", "(1 + time)^2 - 1 - 2*time",
                           "1e4*(sqrt(1 + 1e-8*sin(time)) - 1)", "(1e8 + time) - 1e8", "max(0, time - 0.5)^1.5"}) {
    SCOPED_TRACE(rate);
    const std::string text = std::string("model Cancelling\n  parameter Real k = 4;\n  Real x;\n  coordinate Real y;\n") +
                             "  body b(mass = 1, position = y);\n  force f(value = k*(" + rate + "), at = y);\nequation\n  der(x) = k*(" +
                             rate + ") - x;\nend Cancelling;\n";
    const std::string file = sourceFile("cancelling" + std::to_string(++number) + ".tf", text);
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12})
      withEachIntegrator(
          file, tolerance, 6,
          [&](CompiledModel &model) {
            for (const char *variable : {"x", "y", "der(y)"}) {
              const double expected = model[variable] / 4;
              EXPECT_NEAR(sensitivity(model, variable, 0), expected, 1e3 * std::max(tolerance, 1e-11) * std::max(1.0, std::abs(expected)))
                  << variable << ", " << tolerance;
            }
          },
          {}, [](CompiledModel &model) { differentiateBy(model, {"k"}); });
  }
}

TEST(Sensitivities, OverJumpsThatNoEventShowsAreRefused) {
  const std::pair<const char *, const char *> cases[] = {
      {"force f(value = noEvent(if x > L then -1 else 0), at = x);\n  contact floor(gap = y)", "'der(der(x))'"},
      {"force f(value = smooth(2, if x > L then -2 else 1), at = x);\n  contact floor(gap = y)", "'der(der(x))'"},
      {"contact c(gap = y - smooth(2, if x < L then 0 else 0.1*(x - L)^2), slip = der(x), friction = 0.1)", "'der(der("}};
  int number = 0;
  for (const auto &[element, name] : cases) {
    ++number;
    const std::string file = sourceFile("hidden_jump" + std::to_string(number) + ".tf",
                                        "model A\n  parameter Real L = 0.5;\n  coordinate Real x(der(start = 2)), y;\n"
                                        "  body b(mass = 1, position = {x, y});\n  gravity g(acceleration = {0, -9.81});\n  " +
                                            std::string(element) + ";\nend A;\n");
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-5, 1e-9}) {
        CompiledModel model(file);
        model.tolerance(tolerance).integrator(integrator);
        differentiateBy(model, {"L"});
        const std::string text = errorOfRun(model, 1);
        EXPECT_NE(text.find("a jump of " + std::string(name)), std::string::npos) << text;
        EXPECT_NEAR(model["x"], 0.5, 0.1);
      }
  }
}

}  // namespace
}  // namespace tf::test
