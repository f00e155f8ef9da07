// Painlevé's paradox and the indeterminacy beside it against closed forms and independent references.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr std::array<tf_integrator, 3> kIntegrators = {TF_STEP, TF_EXPLICIT, TF_CVODE};

TEST(Painleve, RodLeavesTheFloor) {
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(example("painleve_rod.tf"));
    model.tolerance(1e-9).integrator(integrator).initialise();
    EXPECT_NEAR(model["der(r[1])"], -6.666666666667, 1e-11);
    EXPECT_NEAR(model["der(r[2])"], 3.849001794598, 1e-11);
    EXPECT_NEAR(model["der(phi)"], 15.396007178391, 1e-11);
    EXPECT_NEAR(model["floor[1].impulse"], 3.849001794598, 1e-11);
    EXPECT_EQ(model["floor[1].closed"], 0.0);
    ASSERT_EQ(model.events().size(), 1u);
    EXPECT_EQ(model.events()[0].kind, TF_EVENT_PAINLEVE);
    EXPECT_EQ(model.events()[0].element, 0);
    model.advance(0.05);
    EXPECT_NEAR(model["r[2]"], std::sqrt(3) / 4 + 3.849001794598 * 0.05 - 0.5 * g * 0.0025, 1e-9);
    EXPECT_GT(model["floor[1].gap"], 0);
  }
}

// A rod in space whose slip turns while the force grows without bound: it jams with a slip that is turned further by the force, so that the
// determinant that vanishes would soon come back from zero. The references are runs of another integrator at a tolerance far smaller.
TEST(Painleve, RodInSpaceJamsWithEachIntegrator) {
  const std::string file = sourceFile("painleve_in_space.tf", R"(
model Rod3
  parameter Real mu = 2, a = 0.5, v = 2, vz = 0;
  coordinate Real p[3](start = {0, 0, 0.5*cos(a)}, der(start = {v, vz, 0}));
  coordinate Rotation Q(start = {cos(a/2), 0, sin(a/2), 0});
  body b(mass = 1, position = p, orientation = Q, inertia = diagonal({1, 1, 0.01})/12);
  gravity g(acceleration = {0, 0, -9.81});
  Real c[3] = p + Q*{0, 0, -0.5};
  contact k(gap = c[3], slip = der(c[1:2]), friction = mu);
end Rod3;
)");
  constexpr double end = 0.2;
  const std::vector<Settings> cases = {{{"a", 0.76}, {"mu", 2}, {"vz", 1}, {"v", 0.3}},
                                       {{"a", -0.66}, {"mu", 2.8}, {"vz", 0.5}, {"v", 0.3}},
                                       {{"a", -0.27155830750654875}, {"mu", 2.0716747681810075}, {"vz", 1}, {"v", 0.3}},
                                       {{"a", -0.7}, {"mu", 2.2}, {"vz", 1}, {"v", 0.3}},
                                       {{"a", -0.7}, {"mu", 2.2}, {"vz", -1}, {"v", 0.3}},
                                       {{"a", 0.44}, {"mu", 2.93}, {"vz", 1}, {"v", 0.3}}};
  for (const Settings &settings : cases) {
    CompiledModel reference(file, settings);
    reference.tolerance(1e-11).integrator(TF_EXPLICIT).run(end);
    ASSERT_EQ(reference.count(TF_EVENT_PAINLEVE), 1);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
        SCOPED_TRACE(std::to_string(settings[0].second) + ", " + std::to_string(tolerance) + ", integrator " + std::to_string(integrator));
        CompiledModel model(file, settings);
        ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(end));
        // The slip that jams may be found to end within the tolerance first.
        EXPECT_LE(model.count(TF_EVENT_PAINLEVE), 1);
        EXPECT_TRUE(model.count(TF_EVENT_PAINLEVE) == 1 || tolerance > 1e-5);
        const std::vector<double> expected = reference.valuesOf(TF_KIND_VELOCITY), velocities = model.valuesOf(TF_KIND_VELOCITY);
        for (std::size_t i = 0; i < expected.size(); ++i)
          EXPECT_NEAR(velocities[i], expected[i], 50 * tolerance) << i;
      }
  }
}

TEST(Painleve, RodReboundsWithRestitution) {
  CompiledModel model(example("painleve_rod.tf"), {{"e", 0.5}});
  model.tolerance(1e-9).initialise();
  EXPECT_NEAR(model["floor[1].impulse"], 1.5 * 3.849001794598, 1e-11);
  // The tip rises with D_stick times half the impulse.
  const double c = 0.5 * std::cos(std::acos(-1.0) / 3), s = 0.5 * std::sin(std::acos(-1.0) / 3);
  const double Dnn = 1 + 32 * c * c, Dnt = -32 * c * s, Dtt = 1 + 32 * s * s;
  const double rise = model["der(r[2])"] - c * model["der(phi)"];
  EXPECT_NEAR(rise, (Dnn - Dnt * Dnt / Dtt) * 0.5 * 3.849001794598, 1e-10);
}

// D_s < 0 but the tip rises: sliding on would be as consistent as opening, which is taken.
TEST(Painleve, IndeterminateRodOpensAndSaysSo) {
  const double spin = 6, rise = spin * 0.25;
  CompiledModel model(example("painleve_rod.tf"), {{"der(phi)", spin}, {"der(r[2])", rise}});
  model.tolerance(1e-9).initialise();
  ASSERT_GE(model.events().size(), 1u);
  EXPECT_EQ(model.events()[0].kind, TF_EVENT_PAINLEVE);
  EXPECT_EQ(model.events()[0].element, 0);
  EXPECT_EQ(model["floor[1].impulse"], 0.0);
  EXPECT_EQ(model["der(r[1])"], -10.0);
  model.advance(0.01);
  EXPECT_GT(model["floor[1].gap"], 0);
}

// D_s reaches zero while the rod slides: its force grows without bound, and a frictional impulse ends the slip.
TEST(Painleve, SlidingRodJams) {
  std::vector<double> after;
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(example("painleve_rod.tf"),
                        {{"psi", 0.5}, {"mu", 1.2}, {"der(phi)", 3}, {"der(r[2])", 1.5 * std::cos(0.5)}, {"der(r[1])", -5}});
    model.tolerance(1e-9).integrator(integrator).run(0.12);
    ASSERT_EQ(model.count(TF_EVENT_PAINLEVE), 1);
    // D_s = D_nn − μ |D_nt| = 5 + 4 cos 2φ − 4.8 sin 2φ.
    const double angle = 0.5 * (std::acos(-5 / std::hypot(4, 4.8)) - std::atan2(4.8, 4.0));
    const double time = model.eventTime(TF_EVENT_PAINLEVE);
    EXPECT_NEAR(model["phi"] - model["der(phi)"] * (0.12 - time), angle, 1e-8);
    after.push_back(model["der(phi)"]);
  }
  EXPECT_NEAR(after[0], after[1], 1e-7);
  EXPECT_NEAR(after[0], after[2], 1e-6);
}

// D_s and the free acceleration reach zero together: the force stays finite, and beyond that point sliding on would be as consistent as
// opening, which is taken. Without it the rod slides on in a balance that any error decides about.
TEST(Painleve, SlidingRodOpensWhereItsForceBecomesIndeterminate) {
  const double mu = 0.99 * std::sqrt(3) / 2;
  std::vector<double> after;
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(example("painleve_rod.tf"), {{"mu", mu}});
    model.tolerance(1e-9).integrator(integrator).run(0.0035);
    EXPECT_NEAR(model["floor[1].normalForce"], 309.505, 1e-3);
    model.advance(0.05);
    ASSERT_EQ(model.count(TF_EVENT_OPENING), 1);
    EXPECT_LE(model.count(TF_EVENT_PAINLEVE), 1);
    EXPECT_EQ(model["floor[1].impulse"], 0.0);
    // It flies from where D_s = 5 + 4 cos 2φ − 4 μ sin 2φ is zero.
    const double angle = 0.5 * (std::acos(-5 / std::hypot(4, 4 * mu)) - std::atan(mu));
    EXPECT_NEAR(model["phi"] - model["der(phi)"] * (0.05 - model.eventTime(TF_EVENT_OPENING)), angle, 1e-7);
    after.push_back(model["der(phi)"]);
  }
  EXPECT_NEAR(after[0], after[1], 1e-6);
  EXPECT_NEAR(after[0], after[2], 2e-6);
}

// The forces there are quotients of two numbers near zero: whatever rounding makes of them, the rod opens.
TEST(Painleve, SlidingRodOpensAtIndeterminateForcesOfAnyCoefficient) {
  for (int k = 0; k < 24; ++k) {
    const double mu = (0.975 + 0.001 * k) * std::sqrt(3) / 2, angle = 0.5 * (std::acos(-5 / std::hypot(4, 4 * mu)) - std::atan(mu));
    for (const tf_integrator integrator : kIntegrators) {
      CompiledModel model(example("painleve_rod.tf"), {{"mu", mu}});
      model.tolerance(1e-9).integrator(integrator).run(0.05);
      ASSERT_EQ(model.count(TF_EVENT_OPENING), 1) << k << ", integrator " << integrator;
      EXPECT_EQ(model["floor[1].impulse"], 0.0) << k << ", integrator " << integrator;
      EXPECT_NEAR(model["phi"] - model["der(phi)"] * (0.05 - model.eventTime(TF_EVENT_OPENING)), angle, 1e-6)
          << k << ", integrator " << integrator;
    }
  }
}

// Nearby, the force vanishes a little before D_s does: a common opening, not a jam.
TEST(Painleve, SlidingRodOpensShortlyBeforeItsForceBecomesIndeterminate) {
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(example("painleve_rod.tf"), {{"mu", 0.97 * std::sqrt(3) / 2}});
    model.tolerance(1e-9).integrator(integrator).run(0.05);
    EXPECT_EQ(model["floor[1].impulse"], 0.0);
    // The centre falls from where l/2 sin φ der(φ)² = g.
    const double time = model.eventTime(TF_EVENT_OPENING), spin = model["der(phi)"], angle = model["phi"] - spin * (0.05 - time);
    EXPECT_NEAR(0.5 * std::sin(angle) * spin * spin, g, 1e-6);
  }
}

// A box on a belt, and a driven rod that sticks to its side: the determinant of the forces of both contacts goes to zero while the
// velocities change by as much in each part of the time that is left. No integrator but the first follows them, and no power is refined,
// into rounding.
TEST(Painleve, TwoContactsThatBlowUpTogether) {
  const std::string file = sourceFile("conveyor.tf", R"(
model Conveyor
  parameter Real b = 0.1, h = 0.15, l = 0.6, H = 0.5, belt = -1.859;
  coordinate Real r[2](start = {0.561, h}, der(start = {0.92, 0}));
  coordinate Real f;
  coordinate Real p(start = 0.9, der(start = -1.648));
  Real u[2] = {cos(f), sin(f)}, n[2] = {-sin(f), cos(f)};
  Real c[2, 2] = {r - b*u - h*n, r + b*u - h*n};
  Real tip[2] = {l*cos(p), H - l*sin(p)}, d[2] = tip - r;
  body box(mass = 2, position = r, angle = f, inertia = 0.03);
  body rod(mass = 0.5, position = {l/2*cos(p), H - l/2*sin(p)}, angle = -p, inertia = 0.01);
  gravity weight(acceleration = {0, -9.81});
  force drive(value = -6.138, at = p);
  contact floor[2](gap = c[:, 2], slip = {der(c[1, 1]) - belt, der(c[2, 1]) - belt}, each friction = 1.25, each restitution = 0.3);
  contact side(gap = -(d*u) - b, slip = (der(tip[1]) - der(r[1]))*n[1] + (der(tip[2]) - der(r[2]))*n[2] - der(f)*(d*u), friction = 2.934,
               restitution = 0.3);
end Conveyor;
)");
  std::vector<double> spins;
  for (const double tolerance : {1e-8, 1e-9, 1e-10}) {
    CompiledModel model(file);
    ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
    model.tolerance(tolerance).run(0.12);
    EXPECT_EQ(model.count(TF_EVENT_PAINLEVE), 1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_PAINLEVE), 0.0985413073, 1e-10);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_LT(statistics.worst_energy_error, 10 * std::max(tolerance, 1e-8));
    EXPECT_LT(statistics.evaluations, 2'000'000);
    spins.push_back(model["der(f)"]);
  }
  EXPECT_NEAR(spins[0], spins[1], 1e-6);
  EXPECT_NEAR(spins[0], spins[2], 1e-6);
}

}  // namespace
}  // namespace tf::test
