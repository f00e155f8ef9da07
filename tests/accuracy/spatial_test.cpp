// Rotations and constraints in whole runs: closed forms, and the same mechanism in other coordinates.
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

// Steady precession: the axis R e3 goes round the vertical with the given rate.
TEST(SpinningTop, PrecessesSteadily) {
  CompiledModel model(example("spinning_top.tf"));
  model.tolerance(1e-9).initialise();
  const double tilt = 0.5, rate = 8, l = 0.06, start = model.energy();
  for (int i = 1; i <= 20; ++i) {
    const double t = 0.25 * i;
    model.advance(t);
    EXPECT_NEAR(model["centre[1]"], l * std::sin(tilt) * std::sin(rate * t), 1e-8) << t;
    EXPECT_NEAR(model["centre[2]"], -l * std::sin(tilt) * std::cos(rate * t), 1e-8) << t;
    EXPECT_NEAR(model["centre[3]"], l * std::cos(tilt), 1e-8) << t;
  }
  EXPECT_NEAR(model.energy(), start, 1e-8);
}

// Without torque ω1 + i ω2 turns with (J3 − J1)/J1·ω3 in the body's frame, and R J ω stays.
TEST(FreeTop, KeepsItsAngularMomentum) {
  CompiledModel model(sourceFile("free_top", R"(
model FreeTop
  coordinate Rotation R(start = {1, 2, -1, 0.5}, w(start = {0.3, 0, 2}));
  body top(orientation = R, inertia = diagonal({2, 2, 1}));
  Real momentum[3] = R*{2*R.w[1], 2*R.w[2], R.w[3]};
end FreeTop;
)"));
  model.tolerance(1e-10).initialise();
  const double start[3] = {model["momentum[1]"], model["momentum[2]"], model["momentum[3]"]};
  for (int i = 1; i <= 10; ++i) {
    model.advance(i);
    EXPECT_NEAR(model["R.w[1]"], 0.3 * std::cos(i), 1e-8);
    EXPECT_NEAR(model["R.w[2]"], -0.3 * std::sin(i), 1e-8);
    EXPECT_NEAR(model["momentum[1]"], start[0], 1e-8);
    EXPECT_NEAR(model["momentum[2]"], start[1], 1e-8);
    EXPECT_NEAR(model["momentum[3]"], start[2], 1e-8);
    double square = 0;
    for (int k = 1; k <= 4; ++k)
      square += std::pow(model["R.q[" + std::to_string(k) + "]"], 2);
    EXPECT_NEAR(square, 1, 1e-14);
  }
}

// Set parts of a quaternion are normalised with the rest.
TEST(FreeTop, NormalisesItsStart) {
  CompiledModel model(sourceFile("set_top", R"(
model SetTop
  coordinate Rotation R;
  body top(orientation = R, inertia = identity(3));
end SetTop;
)"),
                      {{"R.q[1]", 3}, {"R.q[3]", 4}});
  model.initialise();
  EXPECT_DOUBLE_EQ(model["R.q[1]"], 0.6);
  EXPECT_EQ(model["R.q[2]"], 0);
  EXPECT_DOUBLE_EQ(model["R.q[3]"], 0.8);
}

// After the impacts, which accumulate where the box falls flat on its face: it slides until all four corners stick at once.
TEST(TumblingBox, ComesToRestOnItsFace) {
  for (const tf_integrator integrator : integrators) {
    SCOPED_TRACE(integrator);
    CompiledModel model(example("tumbling_box.tf"));
    model.tolerance(1e-8).integrator(integrator).run(4);
    EXPECT_NEAR(model["p[3]"], 0.15, 1e-10);
    double force = 0;
    for (int i = 1; i <= 4; ++i) {
      const std::string contact = "floor[" + std::to_string(i) + "].";
      EXPECT_NEAR(model[contact + "gap"], 0, 1e-10);
      EXPECT_EQ(model[contact + "sticking"], 1);
      force += model[contact + "normalForce"];
    }
    EXPECT_NEAR(force, 9.81, 1e-8);
    for (const char *name : {"der(p[1])", "der(p[2])", "der(p[3])", "Q.w[1]", "Q.w[2]", "Q.w[3]"})
      EXPECT_NEAR(model[name], 0, 1e-10) << name;
  }
}

// The linkage with angles and a constraint against the one with the crank's angle alone, whose other angles follow from the law of cosines.
TEST(FourBar, AgreesWithMinimalCoordinates) {
  CompiledModel mixed(example("four_bar.tf"));
  CompiledModel minimal(sourceFile("four_bar_minimal", R"(
model Minimal
  parameter Real l[3] = {0.3, 0.8, 0.5}, d = 0.7, rho = 2;
  coordinate Real phi(start = 0.5);
  Real A[2] = l[1]*{cos(phi), sin(phi)};
  Real r[2] = {d, 0} - A;
  Real s = sqrt(r*r);
  Real psi = atan2(r[2], r[1]) + acos((l[2]^2 + s^2 - l[3]^2)/(2*l[2]*s));
  Real B[2] = A + l[2]*{cos(psi), sin(psi)};
  Real chi = atan2(B[2], B[1] - d);
  body crank(mass = rho*l[1], position = A/2, angle = phi, inertia = rho*l[1]^3/12);
  body coupler(mass = rho*l[2], position = (A + B)/2, angle = psi, inertia = rho*l[2]^3/12);
  body rocker(mass = rho*l[3], position = ({d, 0} + B)/2, angle = chi, inertia = rho*l[3]^3/12);
  gravity weight(acceleration = {0, -9.81});
end Minimal;
)"));
  mixed.tolerance(1e-10).initialise();
  minimal.tolerance(1e-10).initialise();
  for (int i = 1; i <= 10; ++i) {
    const double t = 0.1 * i;
    mixed.advance(t);
    minimal.advance(t);
    ASSERT_NEAR(mixed["phi[1]"], minimal["phi"], 1e-7) << t;
    EXPECT_NEAR(mixed["phi[2]"], minimal["psi"], 1e-7) << t;
    EXPECT_NEAR(mixed["B[1]"], mixed["C[1]"], 1e-12) << t;
    EXPECT_NEAR(mixed["B[2]"], mixed["C[2]"], 1e-12) << t;
    EXPECT_NEAR(mixed["energy.kinetic"], minimal["energy.kinetic"], 1e-6) << t;
  }
}

}  // namespace
}  // namespace tf::test
