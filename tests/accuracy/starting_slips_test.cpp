// Slips of two components that start from rest while the direction of their load turns: the slip grows from zero with the square of time,
// and the direction of its friction is that of 0/0 where it starts.
#include "tests/accuracy/each_integrator.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tf::test {
namespace {

using Complex = std::complex<double>;

// A block on a table that turns faster and faster about the origin, W = W0 + W1 t, with its coordinates' masses m. The applied force is the
// one that holds it still on the table until t = 1 and gives it the slip growth·s²/2 from then on, s = t − 1, in a direction that turns
// against the table at the given rate.
std::string pulledBlock(const std::string &name, const std::string &friction) {
  return sourceFile(name + ".tf", R"(
model PulledBlock
  parameter Real W0 = 0, W1 = 0, m[2] = {1, 1}, growth = 1, turning = 0, limit = 3;
  coordinate Real x(start = 0.4, der(start = 0.3*W0)), y(start = -0.3, der(start = 0.4*W0)), z;
  body first(mass = m[1], position = {x, 0});
  body second(mass = m[2], position = {0, y});
  body third(mass = 1, position = {0, z});
  Real W = W0 + W1*time, s = time - 1, angle = W0*time + W1*time^2/2 + turning*s;
  Real d[2] = {cos(angle), sin(angle)}, e[2] = {-d[2], d[1]}, slip[2] = {der(x) + W*y, der(y) - W*x};
  Real a[2] = growth*s*d + growth*s^2/2*(W + turning)*e + W1*{-y, x} + W*{-der(y), der(x)};
  force pull(value = {m[1]*a[1], m[2]*a[2]} + limit*d, at = {x, y});
  force weight(value = -10, at = z);
)" + friction + "end PulledBlock;\n");
}

const std::string onTable = "  contact table(gap = z, slip = slip, friction = limit/10);\n";
const std::string withElement = "  contact table(gap = z);\n  friction damper(slip = slip, bound = limit);\n";

// Its place in the plane at a time after 1: on the table ∫ growth s²/2 exp(i turning s) ds from its start.
Complex placeOfBlock(double time, double W0, double W1, double growth, double turning) {
  const double s = time - 1;
  const Complex a(0, turning), i(0, 1);
  const Complex way = turning == 0 ? Complex(growth * s * s * s / 6)
                                   : growth / 2 * (std::exp(a * s) * (s * s / a - 2 * s / (a * a) + 2.0 / (a * a * a)) - 2.0 / (a * a * a));
  return std::exp(i * (W0 * time + W1 * time * time / 2)) * (Complex(0.4, -0.3) + way);
}

constexpr double slipTolerances[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

// CVODE's local errors are not controlled below 1e-13 in each of its many steps.
double allowed(tf_integrator integrator, double tolerance) { return std::max(10 * tolerance, integrator == TF_CVODE ? 1e-9 : 1e-11); }

void expectOneSlip(const CompiledModel &model, double time, double error) {
  EXPECT_EQ(model.count(TF_EVENT_SLIP), 1);
  EXPECT_EQ(model.events().size(), 1U);
  EXPECT_NEAR(model.eventTime(TF_EVENT_SLIP), time, error);
}

void expectPlaces(const std::string &file, const Settings &settings, double W0, double W1, double growth, double turning) {
  for (const double tolerance : slipTolerances)
    for (const tf_integrator integrator : integrators) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", tolerance " + std::to_string(std::log10(tolerance)));
      CompiledModel model(file, settings);
      model.tolerance(tolerance).integrator(integrator).run(2);
      const Complex place = placeOfBlock(2, W0, W1, growth, turning);
      EXPECT_NEAR(model["x"], place.real(), allowed(integrator, tolerance));
      EXPECT_NEAR(model["y"], place.imag(), allowed(integrator, tolerance));
      expectOneSlip(model, 1, allowed(integrator, tolerance));
    }
}

TEST(StartingSlip, StaysStraight) { expectPlaces(pulledBlock("pulled_straight", onTable), {}, 0, 0, 1, 0); }

TEST(StartingSlip, TurnsOnAFixedTable) {
  for (const double turning : {-4.0, 1.0, 4.0})
    expectPlaces(pulledBlock("pulled_turning", onTable), {{"turning", turning}}, 0, 0, 1, turning);
}

TEST(StartingSlip, TurnsWithATurntable) {
  const std::string file = pulledBlock("pulled_on_turntable", onTable);
  expectPlaces(file, {{"W0", 2}}, 2, 0, 1, 0);
  expectPlaces(file, {{"W0", 1}, {"W1", 1.5}, {"turning", -2}}, 1, 1.5, 1, -2);
}

TEST(StartingSlip, GrowsSlowly) {
  expectPlaces(pulledBlock("pulled_slowly", onTable), {{"W1", 1}, {"growth", 0.1}, {"turning", 2}}, 0, 1, 0.1, 2);
}

TEST(StartingSlip, GrowsFast) {
  expectPlaces(pulledBlock("pulled_fast", onTable), {{"W1", 1}, {"growth", 2.5}, {"turning", 2}}, 0, 1, 2.5, 2);
}

// On a fixed table slips are functions of the velocities, and the turn of friction is all that is stiff.
TEST(StartingSlip, NeedsNoWholeJacobian) {
  for (const std::string &friction : {onTable, withElement}) {
    CompiledModel model(pulledBlock("pulled_without_jacobian", friction), {{"turning", -2}});
    model.tolerance(1e-8).initialise();
    model.advance(1.5);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GT(statistics.step_steps, 0);
    EXPECT_EQ(statistics.jacobians, 0);
  }
}

TEST(StartingSlip, TurnsWithMassesThatDiffer) {
  expectPlaces(pulledBlock("pulled_masses", onTable), {{"W0", 1}, {"m[2]", 3}, {"turning", 2}}, 1, 0, 1, 2);
}

TEST(StartingSlip, TurnsOfFrictionElements) {
  expectPlaces(pulledBlock("pulled_damper", withElement), {{"W0", 1}, {"W1", 1}, {"turning", 2}}, 1, 1, 1, 2);
}

// The place is the start turned with the table and what is proportional to the growth.
TEST(StartingSlip, HasSensitivities) {
  const std::string file = pulledBlock("pulled_sensitively", onTable);
  const Complex change = placeOfBlock(2, 1, 1.5, 2, -2) - placeOfBlock(2, 1, 1.5, 1, -2);
  for (const double tolerance : {1e-6, 1e-8, 1e-10})
    for (const tf_integrator integrator : integrators) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", tolerance " + std::to_string(std::log10(tolerance)));
      CompiledModel model(file, {{"W0", 1}, {"W1", 1.5}, {"turning", -2}});
      differentiateBy(model, {"growth"});
      model.tolerance(tolerance).integrator(integrator).run(2);
      EXPECT_NEAR(sensitivity(model, "x", 0), change.real(), 10 * tolerance);
      EXPECT_NEAR(sensitivity(model, "y", 0), change.imag(), 10 * tolerance);
    }
}

// Not pulled by anything, with places and velocities by collocation with 18 stages in the slip itself, whose zero is exact then: to 1e-14.
struct Recorded {
  double start = 0, end = 0, x = 0, y = 0, xRate = 0, yRate = 0;
};

void expectRecorded(const std::string &file, const Recorded &recorded) {
  for (const double tolerance : slipTolerances)
    for (const tf_integrator integrator : integrators) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", tolerance " + std::to_string(std::log10(tolerance)));
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(recorded.end);
      const double error = 10 * allowed(integrator, tolerance);
      EXPECT_NEAR(model["p[1]"], recorded.x, error);
      EXPECT_NEAR(model["p[2]"], recorded.y, error);
      EXPECT_NEAR(model["der(p[1])"], recorded.xRate, error);
      EXPECT_NEAR(model["der(p[2])"], recorded.yRate, error);
      expectOneSlip(model, recorded.start, error);
    }
}

// Until the acceleration towards the axis and along the way together exceed what friction can give.
TEST(StartingSlip, OfABlockOnATurntable) {
  expectRecorded(sourceFile("block_on_turntable.tf", R"(
model BlockOnTurntable
  Real W = 0.8*time;
  coordinate Real p[3](start = {0.5, 0.2, 0});
  body block(mass = 1, position = p);
  gravity weight(acceleration = {0, 0, -10});
  contact table(gap = p[3], slip = {der(p[1]) + W*p[2], der(p[2]) - W*p[1]}, friction = 0.3);
end BlockOnTurntable;
)"),
                 {2.9350040326007085, 4, 0.9280987086330315, 0.07176184078687566, 0.8626328495376019, 1.8142236846909638});
}

TEST(StartingSlip, OfABlockOnAnOrbitalShaker) {
  expectRecorded(sourceFile("block_on_shaker.tf", R"(
model BlockOnShaker
  Real A = 0.05*time, u[2] = {0.05*cos(10*time) - 10*A*sin(10*time), 0.05*sin(10*time) + 10*A*cos(10*time)};
  coordinate Real p[3](start = {0, 0, 0}, der(start = {0.05, 0, 0}));
  body block(mass = 1, position = p);
  gravity weight(acceleration = {0, 0, -10});
  contact table(gap = p[3], slip = {der(p[1]) - u[1], der(p[2]) - u[2]}, friction = 0.3);
end BlockOnShaker;
)"),
                 {0.5656854249492381, 2, 0.0098813176027128, -0.024315388137156644, 0.052690302655779564, 0.29535204583798785});
}

// The tips of rods slide along the next ones; where these are parallel the slip is zero, and so is its gradient: no friction can hold it,
// and its sign changes. Forces and velocities are continuous there: against the motion without any event, friction in closed form of the
// state.
TEST(StartingSlips, ASlipWhoseGradientVanishesGoesOnReversed) {
  const std::string file = sourceFile("parallel_rods.tf", R"(
model ParallelRods
  parameter Real w0 = 4, mu = 0.2, H = 0.1, d = 0.04, t = 0.008, M = 0.02;
  parameter Real a2 = 1.1761343964033404, a3 = 1.0605039332605757, r2 = 1.5879576302231901, r3 = 1.5417518033353463;
  coordinate Real a[3](start = {1.25, a2, a3}, der(start = {w0, w0*r2, w0*r2*r3}));
  body b[3](each inertia = 1.7e-4, angle = a);
  force f(value = M, at = a[1]);
  contact hit[2](gap = {H*sin(a[i + 1] - a[i]) + d*cos(a[i + 1]) - t for i in 1:2},
                 slip = {H*sin(a[i + 1] - a[i])*der(a[i]) for i in 1:2}, each friction = mu);
end ParallelRods;
)");
  // Both contacts bear all the way, so that they are constraints, with the forces and their friction as multipliers.
  const std::string smooth = sourceFile("parallel_rods_held.tf", R"(
model ParallelRodsHeld
  parameter Real w0 = 4, mu = 0.2, H = 0.1, d = 0.04, t = 0.008, M = 0.02, J = 1.7e-4;
  parameter Real a2 = 1.1761343964033404, a3 = 1.0605039332605757, r2 = 1.5879576302231901, r3 = 1.5417518033353463;
  Real a[3](start = {1.25, a2, a3}), w[3](start = {w0, w0*r2, w0*r2*r3});
  Real D[2] = {a[i + 1] - a[i] for i in 1:2}, c[2] = {H*cos(D[i]) for i in 1:2}, s[2] = {H*sin(D[i]) for i in 1:2};
  Real e[2] = {c[i] - d*sin(a[i + 1]) for i in 1:2};
  // gap' = e w[i + 1] - c w[i]; gap'' = e w'[i + 1] - c w'[i] - b. The friction on a[i] is -mu N |s| sign(w[i]).
  Real b[2] = {s[i]*(w[i + 1] - w[i])^2 + d*cos(a[i + 1])*w[i + 1]^2 for i in 1:2};
  Real p[2] = {c[i] + mu*abs(s[i]) for i in 1:2};
  // J w'[1] = M - p[1] N[1], J w'[2] = e[1] N[1] - p[2] N[2], J w'[3] = e[2] N[2]
  Real A11 = e[1]^2 + c[1]*p[1], A12 = -e[1]*p[2], A21 = -c[2]*e[1], A22 = e[2]^2 + c[2]*p[2], B1 = J*b[1] + c[1]*M, B2 = J*b[2];
  Real N[2] = {A22*B1 - A12*B2, A11*B2 - A21*B1}/(A11*A22 - A12*A21);
equation
  der(a) = w;
  der(w) = {M - p[1]*N[1], e[1]*N[1] - p[2]*N[2], e[2]*N[2]}/J;
end ParallelRodsHeld;
)");
  for (const double mu : {0.05, 0.2, 0.5})
    for (const double speed : {1.3, 1.6666666666666667, 2.0, 3.0}) {
      CompiledModel reference(smooth, {{"mu", mu}, {"w0", speed}});
      reference.tolerance(1e-11).run(0.1);
      ASSERT_GT(std::min(reference["N[1]"], reference["N[2]"]), 0);
      for (const tf_integrator integrator : integrators)
        for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
          CompiledModel model(file, {{"mu", mu}, {"w0", speed}});
          model.tolerance(tolerance).integrator(integrator).run(0.1);
          EXPECT_EQ(model.events().size(), 2U) << mu << " " << speed << " " << tolerance;
          for (int i = 1; i <= 3; ++i)
            EXPECT_NEAR(model["der(a[" + std::to_string(i) + "])"], reference["w[" + std::to_string(i) + "]"], 100 * tolerance);
        }
    }
}

// A block on a belt that shakes, with a bound that does so as well: each slip starts from zero in a direction that is far smaller than the
// tolerance of loose steps.
TEST(StartingSlips, OnAShakingBeltAreFollowedAtLooseTolerances) {
  const std::string file = sourceFile("shaking_belt.tf", R"(
model ShakingBelt
  parameter Real w = 150, V = 0.037, k = 0.2, F = 0;
  coordinate Real x(start = 0);
  body b(mass = 1, position = x);
  force f(value = F, at = x);
  friction c(slip = der(x) - V*cos(w*time), bound = 4*(1 - k*sin(w*time)));
end ShakingBelt;
)");
  for (const Settings &settings : {Settings{}, Settings{{"k", 0.38}, {"F", -1}}}) {
    CompiledModel reference(file, settings);
    reference.tolerance(1e-11).integrator(TF_EXPLICIT).run(1);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6}) {
        SCOPED_TRACE(std::to_string(tolerance) + ", integrator " + std::to_string(integrator));
        CompiledModel model(file, settings);
        model.tolerance(tolerance).integrator(integrator).run(1);
        EXPECT_NEAR(model["x"], reference["x"], 10 * tolerance);
        EXPECT_EQ(model.events().size(), reference.events().size());
        EXPECT_LT(tf_get_statistics(model.simulation())->steps, 6000);
      }
  }
}

// Of a table on four feet whose loads are not unique the slips start in directions that are far from those of the forces that held it. At a
// loose tolerance velocities that are small beside it solve the equations of the first step as well as they need, at rest.
TEST(StartingSlips, OfATableOnFourFeetAreFollowedFromTheirStart) {
  const Settings table = {{"mu", 0.24}, {"x[1]", 0.5}, {"y[1]", 0.22}, {"x[2]", -0.91}, {"y[2]", 0.45}, {"x[3]", -0.7}, {"y[3]", -0.92}};
  // At tolerances from 1e-8 to 1e-11 all integrators agree on it to the digits given.
  constexpr double speed = 0.00672942386;
  for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8})
    for (const double sample : {0.94, 0.97, 1.0})
      withEachIntegrator(
          example("dragged_table.tf"), tolerance, sample,
          [&](CompiledModel &model) {
            model.advance(1);
            EXPECT_NEAR(model["der(q[2])"], speed, std::min(tolerance, 1e-7)) << tolerance << ' ' << sample;
          },
          table);
}

// The particle of an impact damper turns round where its host hardly accelerates: it slips by less than the tolerance until it sticks or
// goes on, and which of both depends on the tolerance.
TEST(StartingSlips, ThatHardlyAccelerateDoNotTurnAgainAndAgain) {
  const std::string file = sourceFile("impact_damper.tf", R"(
model ImpactDamper
  coordinate Real x, r(start = 0.1);
  body host(mass = 1, position = x);
  body particle(mass = 0.1, position = x + r);
  force f(value = -x - 0.02*der(x) + 0.1*cos(time), at = x);
  friction seat(slip = der(r), bound = 0.003);
  contact stop[2](gap = {r + 0.25, 0.25 - r}, each restitution = 0.6);
end ImpactDamper;
)");
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6})
    withEachIntegrator(file, tolerance, 100, [tolerance](CompiledModel &model) {
      const int turns = model.count(TF_EVENT_SLIP_REVERSAL), stops = model.count(TF_EVENT_STICK);
      EXPECT_NEAR(turns, 129, 8) << tolerance;
      EXPECT_LE(stops, 1) << tolerance;
    });
}

}  // namespace
}  // namespace tf::test
