// Holonomic and velocity constraints against closed forms and against the same mechanisms in minimal coordinates.
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdexcept>

namespace tf::test {
namespace {

constexpr double gravity = 9.81;

class Constraints : public testing::TestWithParam<tf_integrator> {};

// m (x'', y'') = (0, −m g) + 2 (x, y) ν: the rod's tension is −2 ν l = m (v²/l + g (−y)/l).
TEST_P(Constraints, PendulumInPositionsMovesAsInItsAngle) {
  CompiledModel positions(sourceFile("pendulum_in_positions.tf", R"(model Pendulum
  coordinate Real x(start = 1), y;
  body bob(mass = 2, position = {x, y});
  gravity weight(acceleration = {0, -9.81});
  constraint rod(residual = x^2 + y^2 - 1);
end Pendulum;
)"));
  CompiledModel angle(sourceFile("pendulum_in_angle.tf", R"(model Pendulum
  coordinate Real phi(start = 0);
  body bob(mass = 2, position = {cos(phi), sin(phi)});
  gravity weight(acceleration = {0, -9.81});
end Pendulum;
)"));
  positions.tolerance(1e-10).integrator(GetParam()).initialise();
  angle.tolerance(1e-12).initialise();
  for (int k = 1; k <= 50; ++k) {
    positions.advance(0.1 * k);
    angle.advance(0.1 * k);
    const double x = positions["x"], y = positions["y"], vx = positions["der(x)"], vy = positions["der(y)"];
    EXPECT_NEAR(x, std::cos(angle["phi"]), 1e-7);
    EXPECT_NEAR(y, std::sin(angle["phi"]), 1e-7);
    EXPECT_NEAR(vx * vx + vy * vy, -2 * gravity * y, 1e-7);
    EXPECT_NEAR(-2 * positions["rod.multiplier"], 2 * (vx * vx + vy * vy - gravity * y), 1e-6);
    EXPECT_LE(std::abs(x * x + y * y - 1), 1e-13);
    EXPECT_LE(std::abs(x * vx + y * vy), 1e-13);
  }
}

// Long steps at a loose tolerance end far from the constraint: one correction does not do.
TEST_P(Constraints, ResidualsAreOfTheSizeOfRoundingAtALooseTolerance) {
  const std::string file = sourceFile("driven_crank.tf", R"(model Crank
  parameter Real r = 0.3, l = 1, speed = 5;
  coordinate Real a(start = 0, der(start = speed)), x(start = r + l);
  body crank(angle = a, inertia = 0.1);
  body slider(mass = 2, position = {x, 0});
  constraint rod(residual = (x - r*cos(a))^2 + (r*sin(a))^2 - l^2);
  constraint drive(residual = a - speed*time);
end Crank;
)");
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    CompiledModel model(file);
    ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
    model.tolerance(tolerance).integrator(GetParam()).run(3);
    EXPECT_LE(tf_get_statistics(model.simulation())->worst_constraint, 2e-14) << tolerance;
  }
}

// A slider-crank with the rod's angle and the slider as further coordinates, and with the crank's angle alone.
TEST_P(Constraints, SliderCrankInMixedCoordinatesMovesAsInMinimalOnes) {
  CompiledModel mixed(sourceFile("slider_crank_mixed.tf", R"(model SliderCrank
  parameter Real r = 0.3, l = 1;
  coordinate Real a(start = 0.5, der(start = 2)), b(start = 0, fixed = false, der(start = 0, fixed = false));
  coordinate Real x(start = 1, fixed = false, der(start = 0, fixed = false));
  Real pin[2] = r*{cos(a), sin(a)};
  body crank(mass = 1, position = pin/2, angle = a, inertia = 0.01);
  body rod(mass = 0.5, position = pin + l/2*{cos(b), -sin(b)}, angle = -b, inertia = 0.04);
  body slider(mass = 0.7, position = {x, 0});
  gravity weight(acceleration = {0, -9.81});
  constraint closure(residual = pin + l*{cos(b), -sin(b)} - {x, 0});
end SliderCrank;
)"));
  CompiledModel minimal(sourceFile("slider_crank_minimal.tf", R"(model SliderCrank
  parameter Real r = 0.3, l = 1;
  coordinate Real a(start = 0.5, der(start = 2));
  Real b = asin(r*sin(a)/l);
  Real x = r*cos(a) + l*cos(b);
  Real pin[2] = r*{cos(a), sin(a)};
  body crank(mass = 1, position = pin/2, angle = a, inertia = 0.01);
  body rod(mass = 0.5, position = pin + l/2*{cos(b), -sin(b)}, angle = -b, inertia = 0.04);
  body slider(mass = 0.7, position = {x, 0});
  gravity weight(acceleration = {0, -9.81});
end SliderCrank;
)"));
  mixed.tolerance(1e-10).integrator(GetParam()).initialise();
  minimal.tolerance(1e-12).initialise();
  EXPECT_EQ(tf_get_statistics(mixed.simulation())->redundant_constraints, 0);
  for (int k = 0; k <= 30; ++k) {
    mixed.advance(0.1 * k);
    minimal.advance(0.1 * k);
    EXPECT_NEAR(mixed["a"], minimal["a"], 2e-7) << "t = " << mixed.time();
    EXPECT_NEAR(mixed["x"], minimal["x"], 2e-7);
    EXPECT_NEAR(mixed["der(a)"], minimal["der(a)"], 1e-6);
  }
  EXPECT_LE(tf_get_statistics(mixed.simulation())->worst_constraint, 1e-13);
}

// A skate on a slope that turns at the rate w: x = c (1 − cos 2wt)/(4 w²), y = c (wt − sin(2wt)/2)/(2 w²) with the acceleration c down x.
TEST_P(Constraints, ASkateOnASlopeMovesOnACycloid) {
  CompiledModel skate(sourceFile("skate.tf", R"(model Skate
  coordinate Real x, y, phi(der(start = 2));
  body blade(mass = 1.5, position = {x, y}, angle = phi, inertia = 0.2);
  gravity slope(acceleration = {3, 0});
  constraint edge(velocityResidual = der(x)*sin(phi) - der(y)*cos(phi));
end Skate;
)"));
  skate.tolerance(1e-10).integrator(GetParam()).initialise();
  const double w = 2, c = 3;
  for (int k = 1; k <= 40; ++k) {
    const double t = 0.1 * k;
    skate.advance(t);
    EXPECT_NEAR(skate["x"], c * (1 - std::cos(2 * w * t)) / (4 * w * w), 1e-7);
    EXPECT_NEAR(skate["y"], c * (w * t - std::sin(2 * w * t) / 2) / (2 * w * w), 1e-7);
  }
  EXPECT_LE(tf_get_statistics(skate.simulation())->worst_constraint, 1e-13);
}

// Two masses on a massless rod fall on the floor: the impulse on one of them is passed on to the other.
TEST_P(Constraints, TransmitImpulses) {
  const std::string contacts = R"(  contact floor[2](gap = {p[1, 2], p[2, 2]}, slip = {der(p[1, 1]), der(p[2, 1])}, each friction = 0.3);
  gravity weight(acceleration = {0, -9.81});
)";
  CompiledModel masses(sourceFile("dumbbell_of_masses.tf", R"(model Dumbbell
  coordinate Real p[2, 2](start = {{0.5*cos(0.6), 1 + 0.5*sin(0.6)}, {-0.5*cos(0.6), 1 - 0.5*sin(0.6)}}, der(start = {{1, 0}, {1, 0}}));
  body mass[2](each mass = 0.8, position = p);
  constraint rod(residual = (p[1, :] - p[2, :])*(p[1, :] - p[2, :]) - 1);
)" + contacts + "end Dumbbell;\n"));
  CompiledModel rigid(sourceFile("rigid_dumbbell.tf", R"(model Dumbbell
  coordinate Real r[2](start = {0, 1}, der(start = {1, 0})), phi(start = 0.6);
  Real p[2, 2] = {r + 0.5*{cos(phi), sin(phi)}, r - 0.5*{cos(phi), sin(phi)}};
  body rod(mass = 1.6, position = r, angle = phi, inertia = 0.4);
)" + contacts + "end Dumbbell;\n"));
  masses.tolerance(1e-10).integrator(GetParam()).initialise();
  rigid.tolerance(1e-12).initialise();
  for (int k = 1; k <= 40; ++k) {
    masses.advance(0.05 * k);
    rigid.advance(0.05 * k);
    EXPECT_NEAR((masses["p[1,1]"] + masses["p[2,1]"]) / 2, rigid["r[1]"], 1e-7) << "t = " << masses.time();
    EXPECT_NEAR((masses["p[1,2]"] + masses["p[2,2]"]) / 2, rigid["r[2]"], 1e-7) << "t = " << masses.time();
  }
  EXPECT_NEAR(masses.eventTime(TF_EVENT_IMPACT), rigid.eventTime(TF_EVENT_IMPACT), 1e-9);
  EXPECT_NEAR(masses.eventTime(TF_EVENT_IMPACT, 1), rigid.eventTime(TF_EVENT_IMPACT, 1), 1e-8);
}

std::string nameOf(const testing::TestParamInfo<tf_integrator> &integrator) {
  const char *const names[] = {"auto", "step", "cvode", "explicit"};
  return names[integrator.param];
}

// A beam on cranks of one length, of which all but two are redundant, everywhere but in the flat position.
std::string parallelCranks(int cranks) {
  return sourceFile(fmt::format("parallelogram_{}.tf", cranks), fmt::format(R"(model Parallelogram
  constant Integer n = {};
  parameter Real l = 0.4, d = 0.5, start = 0.3;
  parameter Real s[n] = {{(i - 1)/(n - 1) for i in 1:n}};
  coordinate Real a[n](each start = start, der(each start = -1));
  coordinate Real th(fixed = false, der(fixed = false));
  body crank[n](each mass = 1, position = {{{{l/2*cos(a[i]), l/2*sin(a[i])}} for i in 1:n}}, angle = a, each inertia = 0.01);
  body beam(mass = 3, position = {{l*cos(a[1]) + d/2*cos(th), l*sin(a[1]) + d/2*sin(th)}}, angle = th, inertia = 0.3);
  gravity weight(acceleration = {{0, -9.81}});
  constraint joint[n - 1](residual =
    {{{{l*cos(a[1]) + s[i]*d*cos(th) - s[i]*d - l*cos(a[i]), l*sin(a[1]) + s[i]*d*sin(th) - l*sin(a[i])}} for i in 2:n}});
end Parallelogram;
)",
                                                                            cranks));
}

// True: it passes its flat position, as the crank does. False: the run stops there.
bool passesFlatPosition(CompiledModel &linkage, const CompiledModel &crank, double tolerance, tf_integrator integrator) {
  linkage.tolerance(tolerance).integrator(integrator);
  try {
    linkage.run(0.6);
  } catch (const std::exception &error) {
    const std::string text = error.what();
    EXPECT_LT(tolerance, 1e-6) << text;
    // CVODE's steps come to rounding before.
    if (integrator != TF_CVODE) {
      EXPECT_NE(text.find("at a singular position of constraint 'joint["), std::string::npos) << text;
    }
    return false;
  }
  for (const char *angle : {"a[1]", "a[2]"})
    EXPECT_NEAR(linkage[angle], crank["a"], 100 * tolerance + 1e-9);
  EXPECT_NEAR(linkage["th"], 0, 1e-9);
  return true;
}

// Flat, it could go on as a parallelogram or as an antiparallelogram. Where steps end so near that rounding would choose, the run ends.
TEST_P(Constraints, AParallelogramPassesItsFlatPositionOrStopsThere) {
  CompiledModel crank(sourceFile("parallel_crank.tf", R"(model Crank
  parameter Real l = 0.4, start = 0.3, n = 2;
  coordinate Real a(start = start, der(start = -1));
  body cranks(mass = n, position = {l/2*cos(a), l/2*sin(a)}, angle = a, inertia = n*0.01);
  body beam(mass = 3, position = {l*cos(a), l*sin(a)});
  gravity weight(acceleration = {0, -9.81});
end Crank;
)"));
  for (const int cranks : {2, 3}) {
    CompiledModel linkage(parallelCranks(cranks));
    ASSERT_EQ(tf_set(crank.simulation(), "n", cranks), TF_OK);
    int passed = 0, stopped = 0;
    for (const double start : {0.2, 0.3, 0.41}) {
      for (CompiledModel *model : {&crank, &linkage})
        ASSERT_EQ(tf_set(model->simulation(), "start", start), TF_OK);
      crank.tolerance(1e-12).run(0.6);
      for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12}) {
        SCOPED_TRACE(testing::Message() << cranks << " cranks, " << start << ", " << tolerance);
        ++(passesFlatPosition(linkage, crank, tolerance, GetParam()) ? passed : stopped);
      }
    }
    EXPECT_GE(passed, 9) << cranks;
    EXPECT_GE(stopped, 3) << cranks;
  }
}

// Four bars of Bennett's: the axes of their hinges are neither parallel nor do they meet, so that all but three of the seven rows follow
// from others wherever the loop is closed, and nowhere else. tan(t₁/2) tan(t₂/2) = sin((β + α)/2)/sin((β − α)/2), t₃ = −t₁. At t₁ = 0,
// which it passes, the first row vanishes.
TEST_P(Constraints, BennettsLinkageMovesAsInItsOneAngle) {
  const std::string parameters = R"(
  parameter Real al = 0.6, be = 1.1, a = 1, b = a*sin(be)/sin(al), t0 = 1;
  parameter Real k = sin((be + al)/2)/sin((be - al)/2), s0 = 2*atan2(k*cos(t0/2), sin(t0/2));
)",
                    bars = R"(
  Rotation R1 = rotation({0, 0, 1}, t1), F1 = R1*rotation({1, 0, 0}, al);
  Rotation R2 = F1*rotation({0, 0, 1}, t2), F2 = R2*rotation({1, 0, 0}, be);
  Rotation R3 = F2*rotation({0, 0, 1}, t3);
  Real p1[3] = R1*{a, 0, 0}, p2[3] = p1 + R2*{b, 0, 0}, p3[3] = p2 + R3*{a, 0, 0};
  body l1(mass = 1, position = p1/2, orientation = R1, inertia = diagonal({0.01, 0.1, 0.1}));
  body l2(mass = 1.5, position = (p1 + p2)/2, orientation = R2, inertia = diagonal({0.01, 0.2, 0.2}));
  body l3(mass = 1, position = (p2 + p3)/2, orientation = R3, inertia = {{0.02, 0.01, 0}, {0.01, 0.1, 0}, {0, 0, 0.1}});
  gravity g(acceleration = {1, 2, -9.81});
)";
  const std::string oneAngle = sourceFile("bennett_in_one_angle.tf", "model Bennett" + parameters + R"(
  coordinate Real t1(start = t0, der(start = 1.5));
  Real t2 = 2*atan2(k*cos(t1/2), sin(t1/2)), t3 = -t1;)" + bars + "end Bennett;\n");
  const std::string fourAngles = sourceFile("bennett_in_four_angles.tf", "model Bennett" + parameters + R"(
  coordinate Real t1(start = t0, der(start = 1.5));
  coordinate Real t2(start = s0, fixed = false, der(fixed = false));
  coordinate Real t3(start = -t0, fixed = false, der(fixed = false)), t4(start = -s0, fixed = false, der(fixed = false));)" +
                                                                             bars +
                                                                             R"(
  Rotation F3 = R3*rotation({1, 0, 0}, al), R4 = F3*rotation({0, 0, 1}, t4), F4 = R4*rotation({1, 0, 0}, be);
  Real ex[3] = F4*{1, 0, 0}, ez[3] = F4*{0, 0, 1};
  body l4(mass = 1, position = p3 + R4*{b, 0, 0}/2, orientation = R4, inertia = identity(3));
  constraint closed(residual = p3 + R4*{b, 0, 0});
  constraint turned(residual = {ex[2], ex[3], ez[1], ez[2]});
end Bennett;
)");
  constexpr double amplification = 10, end = 3;
  for (const double start : {1.0, 1e-9, 0.0}) {
    CompiledModel reference(oneAngle, {{"t0", start}});
    reference.tolerance(1e-12).run(end);
    for (const double tolerance : {1e-4, 1e-7, 1e-9}) {
      CompiledModel model(fourAngles, {{"t0", start}});
      ASSERT_NO_THROW(model.tolerance(tolerance).integrator(GetParam()).run(end)) << start << ", tolerance " << tolerance;
      EXPECT_EQ(tf_get_statistics(model.simulation())->redundant_constraints, 4) << start << ", tolerance " << tolerance;
      for (const char *variable : {"t1", "der(t1)"})
        EXPECT_NEAR(model[variable], reference[variable], amplification * 10 * tolerance) << variable << ", start " << start;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, Constraints, testing::Values(TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE), nameOf);

// A pin without friction in a bushing that is a little wider: the direction of the gap is a difference of positions, known to rounding over
// the clearance, which is more than CVODE's share of a tight tolerance. Its steps shrink without end for that, and no derivative jumps.
TEST(TightClearances, HinderNoIntegratorByRounding) {
  const std::string file = sourceFile("clearance_joint.tf", R"(
model ClearanceJoint "slider-crank whose crank pin has a clearance"
  parameter Real l[2] = {0.15, 0.5}, m[3] = {0.3, 0.4, 0.5}, c = 0.001, e = 0.2;
  coordinate Real a(start = 0.3, der(start = 20));
  coordinate Real q[2](start = {0.15*cos(0.3) + 0.0002, 0.15*sin(0.3)}, der(start = {-3*sin(0.3), 3*cos(0.3)}));
  coordinate Real phi(start = -0.0888, fixed = false, der(start = -5.7, fixed = false));
  coordinate Real x(start = 0.64, fixed = false, der(start = -1, fixed = false));
  Real pin[2] = q - l[1]*{cos(a), sin(a)};
  body crank(mass = m[1], position = l[1]/2*{cos(a), sin(a)}, angle = a, inertia = m[1]*l[1]^2/12);
  body rod(mass = m[2], position = q + l[2]/2*{cos(phi), sin(phi)}, angle = phi, inertia = m[2]*l[2]^2/12);
  body slider(mass = m[3], position = {x, 0});
  constraint joint(residual = q + l[2]*{cos(phi), sin(phi)} - {x, 0});
  gravity weight(acceleration = {0, -9.81});
  contact ring(gap = c - sqrt(pin[1]^2 + pin[2]^2), restitution = e);
end ClearanceJoint;
)");
  constexpr double amplification = 10, end = 0.5;
  CompiledModel reference(file);
  reference.tolerance(1e-12).integrator(TF_STEP).run(end);
  for (const double tolerance : {1e-8, 3e-10, 1e-10}) {
    CompiledModel model(file);
    ASSERT_NO_THROW(model.tolerance(tolerance).integrator(TF_CVODE).run(end)) << tolerance;
    for (const char *variable : {"a", "phi", "x"})
      EXPECT_NEAR(model[variable], reference[variable], amplification * 10 * tolerance) << tolerance << ' ' << variable;
  }
  CompiledModel tight(file);
  try {
    tight.tolerance(1e-13).integrator(TF_CVODE).run(end);
    FAIL() << "no error";
  } catch (const std::runtime_error &error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the integrator cannot meet tolerance 1e-13"));
  }
}

TEST(RedundantConstraints, AreCountedAndChangeNothing) {
  CompiledModel model(sourceFile("pendulum_held_twice.tf", R"(model Pendulum
  coordinate Real x(start = 1), y;
  body bob(mass = 2, position = {x, y});
  gravity weight(acceleration = {0, -9.81});
  constraint rod(residual = x^2 + y^2 - 1);
  constraint again(residual = sqrt(x^2 + y^2) - 1);
end Pendulum;
)"));
  model.tolerance(1e-10).initialise();
  EXPECT_EQ(tf_get_statistics(model.simulation())->redundant_constraints, 1);
  model.advance(1);
  const double x = model["x"], y = model["y"], speed = model["der(x)"] * model["der(x)"] + model["der(y)"] * model["der(y)"];
  EXPECT_NEAR(speed, -2 * gravity * y, 1e-8);
  EXPECT_NEAR(x * x + y * y, 1, 1e-13);
  // Together they pull as one rod does.
  EXPECT_NEAR(-2 * model["rod.multiplier"] - model["again.multiplier"], 2 * (speed - gravity * y), 1e-7);
}

// Which rows stand for all is no part of a saved state: both continuations begin anew.
TEST(RedundantConstraints, ContinueBitIdentically) {
  const std::string file = sourceFile("pendulum_held_in_three_ways.tf", R"(model Pendulum
  coordinate Real x(start = 1), y, z;
  body bob(mass = 2, position = {x, y, z});
  gravity weight(acceleration = {0, -9.81, 1});
  constraint plane(residual = z - 0.3*x*y);
  constraint rod(residual = x^2 + y^2 + z^2 - 1);
  constraint again(residual = sqrt(x^2 + y^2 + z^2) - 1 + z - 0.3*x*y);
end Pendulum;
)");
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE}) {
    CompiledModel run(file), fresh(file);
    for (CompiledModel *model : {&run, &fresh})
      model->tolerance(1e-7).integrator(integrator).initialise();
    run.advance(0.7);
    std::vector<char> saved(tf_state_size(run.simulation()));
    ASSERT_EQ(tf_save_state(run.simulation(), saved.data(), saved.size()), TF_OK);
    run.advance(1.5);
    ASSERT_EQ(tf_restore_state(fresh.simulation(), saved.data(), saved.size()), TF_OK);
    fresh.advance(1.5);
    EXPECT_EQ(run.valuesOf(TF_KIND_COORDINATE), fresh.valuesOf(TF_KIND_COORDINATE)) << integrator;
  }
}

struct Note {
  double time;
  int kind;
  std::string text;
};

std::vector<Note> &collectNotes(CompiledModel &model, std::vector<Note> &notes) {
  const auto append = [](void *data, const tf_note *note) {
    static_cast<std::vector<Note> *>(data)->push_back({note->time, note->kind, note->text});
  };
  EXPECT_EQ(tf_set_note_callback(model.simulation(), append, &notes), TF_OK);
  return notes;
}

// y − z = 0 twice, x + y − z = 1 beside x = 1: two of the four rows follow from those declared before them.
TEST(RedundantConstraints, AreNamedWithWhatTheyFollowFrom) {
  CompiledModel model(sourceFile("redundant.tf", R"(model Redundant
  coordinate Real x(start = 1), y, z, w;
  body ball(mass = 1, position = {x, y, z});
  body other(mass = 3, position = w);
  constraint first(residual = y - z);
  constraint second(residual = {w, 2*z - 2*y});
  constraint third(residual = x - 1);
  constraint fourth(residual = x + y - z - 1);
end Redundant;
)"));
  std::vector<Note> notes;
  collectNotes(model, notes);
  model.tolerance(1e-9).run(1);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].kind, TF_NOTE_REDUNDANT);
  EXPECT_EQ(notes[0].text.find("constraint 'second[2]' follows from 'first' ("), 0U) << notes[0].text;
  EXPECT_NE(notes[0].text.find("redundant.tf:6)"), std::string::npos) << notes[0].text;
  EXPECT_EQ(notes[1].text.find("constraint 'fourth' follows from 'first' and 'third' ("), 0U) << notes[1].text;
  EXPECT_EQ(tf_get_statistics(model.simulation())->redundant_constraints, 2);
}

// Each is named once, whatever happens to the rank afterwards.
TEST(RedundantConstraints, AreNamedOnce) {
  CompiledModel model(sourceFile("named_once.tf", R"(model Once
  coordinate Real x(start = -1, der(start = 1)), y;
  body ball(mass = 1, position = {x, y});
  constraint line(residual = y);
  constraint scaled(residual = y*(1 + x^2));
  contact wall(gap = 0.5 - x, restitution = 1);
end Once;
)"));
  std::vector<Note> notes;
  collectNotes(model, notes);
  model.tolerance(1e-9).run(2);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].time, 0);
  EXPECT_NEAR(model["x"], 0, 1e-9);
}

TEST(RedundantConstraints, ThatContradictEachOtherEndTheRun) {
  CompiledModel model(sourceFile("contradiction.tf", R"(model Contradiction
  coordinate Real x, y;
  body ball(mass = 1, position = {x, y});
  constraint still(residual = x);
  constraint moving(residual = 2*x - time^3);
end Contradiction;
)"));
  model.tolerance(1e-9).initialise();
  try {
    model.advance(1);
    FAIL() << "the run goes on";
  } catch (const std::exception &error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'still' ("), std::string::npos) << text;
    EXPECT_NE(text.find("'moving' ("), std::string::npos) << text;
    EXPECT_NE(text.find("contradict"), std::string::npos) << text;
  }
}

TEST(RedundantConstraints, StepsThatEndInAContradictionHaveNoSamples) {
  CompiledModel model(sourceFile("late_contradiction.tf", R"(model Late
  coordinate Real x, y;
  body ball(mass = 1, position = {x, y});
  constraint together(residual = x - y);
  constraint apart(velocityResidual = der(x) - der(y) - max(0, time - 0.5));
end Late;
)"));
  model.tolerance(1e-9).initialise();
  struct Worst {
    CompiledModel &model;
    double value = 0;
  } worst{model};
  const auto sample = [](void *data, double time) {
    Worst &own = *static_cast<Worst *>(data);
    own.value = std::max(own.value, std::abs(own.model["x"] - own.model["y"]));
    return time + 0.01;
  };
  EXPECT_EQ(tf_run(model.simulation(), 1, 0.01, sample, &worst), TF_FAILED);
  EXPECT_NE(std::string(tf_error_text(model.simulation())).find("contradict"), std::string::npos);
  EXPECT_NEAR(model.time(), 0.5, 0.01);
  EXPECT_LE(worst.value, 1e-6);
}

// Two bars that turn in a tilted plane have parallel axes anyway: the residual is made of rounding errors.
TEST(RedundantConstraints, ThatVanishButForRoundingHoldNothing) {
  CompiledModel model(sourceFile("parallel_axes.tf", R"(model TwoBars
  coordinate Real phi(start = 0.5, der(start = 6)), psi(start = 1.4, der(start = 1));
  Rotation W = rotation({1, 0, 0}, 0.3), R = W*rotation({0, 0, 1}, phi), S = W*rotation({0, 0, 1}, psi);
  body b(orientation = R, inertia = identity(3));
  body c(orientation = S, inertia = identity(3));
  constraint axis(residual = {(R*{0, 0, 1})*(S*{1, 0, 0}), (R*{0, 0, 1})*(S*{0, 1, 0})});
end TwoBars;
)"));
  model.tolerance(1e-8).run(1);
  EXPECT_EQ(tf_get_statistics(model.simulation())->redundant_constraints, 2);
  EXPECT_NEAR(model["phi"], 6.5, 1e-8);
  EXPECT_NEAR(model["psi"], 2.4, 1e-8);
}

TEST(ConstrainedStarts, ThatAreFarAwayAreFound) {
  for (const double nominal : {1e-6, 1.0, 1e3}) {
    CompiledModel model(sourceFile("far_start.tf", R"(model Far
  constant Real N = )" + std::to_string(nominal) + R"(;
  parameter Real L = 30000;
  coordinate Real p[2](start = {1, 2}, each fixed = false, each nominal = N, der(each fixed = false)), phi(start = 0.1, fixed = false);
  body b(mass = 1, position = p, angle = phi, inertia = 1);
  constraint rod(residual = p - L*{cos(phi), sin(phi)});
  constraint height(residual = p[2] - L/2);
end Far;
)"));
    ASSERT_NO_THROW(model.initialise()) << nominal;
    EXPECT_NEAR(model["p[2]"], 15000, 1e-6) << nominal;
    EXPECT_NEAR(std::abs(model["p[1]"]), 15000 * std::sqrt(3.0), 1e-6) << nominal;
  }
}

// Nor do they hold a body that rests.
TEST(RedundantConstraints, ThatVanishButForRoundingLockNothing) {
  CompiledModel model(sourceFile("axis_at_rest.tf", R"(model Rest
  coordinate Real u(start = 0.4), v(start = 0.8);
  Rotation W = rotation({1, 2, 0.5}, 0.7), R = W*rotation({0, 0, 1}, v);
  body first(angle = u, inertia = 1);
  body second(angle = v, inertia = 1);
  force push(value = 1, at = u);
  constraint gear(residual = v - 2*u);
  constraint axis(residual = (R*{0, 0, 1})*(W*{1, 0, 0}));
end Rest;
)"));
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE}) {
    model.tolerance(1e-8).integrator(integrator).run(1);
    EXPECT_NEAR(model["u"], 0.5, 1e-7) << integrator;
    EXPECT_NEAR(model["der(v)"], 0.4, 1e-7) << integrator;
  }
}

// The last row holds z, but at x = 1, where it starts and its derivatives vanish too.
TEST(RedundantConstraints, ThatHoldAgainTooLateEndTheRun) {
  CompiledModel model(sourceFile("held_again.tf", R"(model HeldAgain
  coordinate Real x(start = 1, der(start = 1)), y, z;
  body b(mass = 1, position = {x, y, z});
  force f(value = {0, -1, 1}, at = {x, y, z});
  constraint c(residual = y);
  constraint d(residual = y + (x - 1)^3*z);
end HeldAgain;
)"));
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE})
    for (const double tolerance : {1e-4, 1e-7})
      try {
        model.tolerance(tolerance).integrator(integrator).run(3);
        ADD_FAILURE() << "the run goes on: " << integrator << ", tolerance " << tolerance;
      } catch (const std::exception &error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("at a singular position of constraint 'd' ("));
      }
}

// exp(x) is 1e43 times larger where the search begins than where it ends.
TEST(ConstrainedStarts, AreExactWhereResidualsAreSmallerThanAtTheirValues) {
  CompiledModel model(sourceFile("exponential_start.tf", R"(model Start
  coordinate Real x(start = 100, fixed = false, der(fixed = false)), y(start = 1);
  body b(mass = 1, position = {x, y});
  constraint c(residual = exp(x) - 2*y);
end Start;
)"));
  ASSERT_NO_THROW(model.initialise());
  EXPECT_NEAR(model["x"], std::log(2.0), 1e-12);
}

TEST(ConstrainedStarts, ThatContradictEachOtherAreNamed) {
  CompiledModel model(sourceFile("contradicting_start.tf", R"(model Start
  coordinate Real x(fixed = false), y;
  body ball(mass = 1, position = {x, y});
  constraint one(residual = x);
  constraint two(residual = x - 1);
end Start;
)"));
  try {
    model.initialise();
    FAIL() << "the start is accepted";
  } catch (const std::exception &error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("violates constraint 'one' by 0.5"), std::string::npos) << text;
    EXPECT_NE(text.find("violates constraint 'two' by 0.5"), std::string::npos) << text;
    EXPECT_NE(text.find("contradict each other"), std::string::npos) << text;
  }
}

// A stiff spring beside a soft one: the explicit pair starts, CVODE takes over, and the times of both add up.
TEST(Integrators, SayWhoRanAndWhy) {
  CompiledModel model(sourceFile("stiff.tf", R"(model Stiff
  coordinate Real x(start = 1), y(start = 1);
  body a(mass = 1, position = x);
  body b(mass = 1, position = y);
  force soft(value = -x, at = x);
  force stiff(value = -1e4*der(y) - 1e4*(y - x), at = y);
end Stiff;
)"));
  std::vector<Note> notes;
  collectNotes(model, notes);
  model.tolerance(1e-6).run(10);
  ASSERT_FALSE(notes.empty());
  EXPECT_EQ(notes[0].kind, TF_NOTE_INTEGRATOR);
  EXPECT_EQ(notes[0].text, "cvode: stiff");
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_EQ(statistics.stiff_changes, 1);
  EXPECT_NEAR(statistics.explicit_time, notes[0].time, 1e-12);
  EXPECT_NEAR(statistics.explicit_time + statistics.cvode_time, 10, 1e-9);
  EXPECT_EQ(statistics.step_time, 0);
}

TEST(ConstrainedStarts, ThatViolateAConstraintNameIt) {
  CompiledModel model(sourceFile("pendulum_off_its_circle.tf", R"(model Pendulum
  coordinate Real x(start = 1.1), y;
  body bob(mass = 2, position = {x, y});
  constraint rod(residual = x^2 + y^2 - 1);
end Pendulum;
)"));
  try {
    model.initialise();
    FAIL() << "the start is accepted";
  } catch (const std::exception &error) {
    EXPECT_NE(std::string(error.what()).find("violates constraint 'rod' by 0.21"), std::string::npos) << error.what();
  }
}

TEST(ConstrainedStarts, FreeOnesAreTheNearest) {
  CompiledModel model(sourceFile("free_pendulum.tf", R"(model Pendulum
  coordinate Real x(start = 3, fixed = false, der(start = 1, fixed = false)), y(start = 4, fixed = false, der(start = 0, fixed = false));
  body bob(mass = 2, position = {x, y});
  constraint rod(residual = x^2 + y^2 - 1);
end Pendulum;
)"));
  model.initialise();
  EXPECT_NEAR(model["x"] * model["x"] + model["y"] * model["y"], 1, 1e-12);
  EXPECT_NEAR(model["y"] / model["x"], 4.0 / 3, 1e-9);
  // (1, 0) less its part along (0.6, 0.8).
  EXPECT_NEAR(model["der(x)"], 0.64, 1e-9);
  EXPECT_NEAR(model["der(y)"], -0.48, 1e-9);
}

}  // namespace
}  // namespace tf::test
