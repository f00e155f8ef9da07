// Equations of motion against hand-derived formulas, at random points to 1e-12.
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <cmath>

namespace tf::test {
namespace {

using enum ir::SymbolKind;

constexpr double kTolerance = 1e-12;

void expectMotion(DerivedModel &model, const Point &point, const std::vector<double> &mass, const std::vector<double> &force) {
  const std::vector<double> actualMass = point.evaluate(model->graph, model->mass);
  const std::vector<double> actualForce = point.evaluate(model->graph, model->force);
  ASSERT_EQ(actualMass.size(), mass.size());
  for (std::size_t k = 0; k < mass.size(); ++k)
    EXPECT_NEAR(actualMass[k], mass[k], kTolerance) << "M " << k;
  for (std::size_t k = 0; k < force.size(); ++k)
    EXPECT_NEAR(actualForce[k], force[k], kTolerance) << "f " << k;
}

TEST(Lagrange, DoublePendulum) {
  DerivedModel model(R"(
model DoublePendulum
  parameter Real m1 = 1.3, m2 = 0.7, l1 = 0.9, l2 = 1.4, g = 9.81;
  coordinate Real a, b;
  Real p[2] = l1*{sin(a), -cos(a)};
  Real r[2] = p + l2*{sin(b), -cos(b)};
  body upper(mass = m1, position = p);
  body lower(mass = m2, position = r);
  gravity weight(acceleration = {0, -g});
end DoublePendulum;
)");
  TF_ASSERT_DERIVED(model);
  const double m1 = 1.3, m2 = 0.7, l1 = 0.9, l2 = 1.4, g = 9.81;
  for (unsigned seed = 1; seed < 6; ++seed) {
    Point point(*model, seed, -2, 2);
    const double a = point(Coordinate, 0), b = point(Coordinate, 1), w = point(Velocity, 0), u = point(Velocity, 1);
    const double coupling = m2 * l1 * l2 * std::cos(a - b), twist = m2 * l1 * l2 * std::sin(a - b);
    expectMotion(model, point, {(m1 + m2) * l1 * l1, coupling, coupling, m2 * l2 * l2},
                 {-twist * u * u - (m1 + m2) * g * l1 * std::sin(a), twist * w * w - m2 * g * l2 * std::sin(b)});
    const double kinetic = 0.5 * (m1 + m2) * l1 * l1 * w * w + 0.5 * m2 * l2 * l2 * u * u + coupling * w * u;
    EXPECT_NEAR(point.evaluate(model->graph, model->kineticEnergy), kinetic, 10 * kTolerance);
    EXPECT_NEAR(point.evaluate(model->graph, model->potentialEnergy), -(m1 + m2) * g * l1 * std::cos(a) - m2 * g * l2 * std::cos(b),
                10 * kTolerance);
  }
}

TEST(Lagrange, PendulumOnCart) {
  DerivedModel model(R"(
model CartPole
  parameter Real M = 2, m = 0.4, l = 0.6, g = 9.81, d = 0.3;
  input Real F;
  coordinate Real x, phi;
  body cart(mass = M, position = {x, 0});
  body bob(mass = m, position = {x + l*sin(phi), -l*cos(phi)});
  potential weight(energy = -m*g*l*cos(phi));
  force motor(value = F - d*der(x), at = x);
end CartPole;
)");
  TF_ASSERT_DERIVED(model);
  const double M = 2, m = 0.4, l = 0.6, g = 9.81, d = 0.3;
  for (unsigned seed = 1; seed < 6; ++seed) {
    Point point(*model, seed, -2, 2);
    const double phi = point(Coordinate, 1), v = point(Velocity, 0), w = point(Velocity, 1), F = point(Input, 0);
    const double coupling = m * l * std::cos(phi);
    expectMotion(model, point, {M + m, coupling, coupling, m * l * l},
                 {F - d * v + m * l * std::sin(phi) * w * w, -m * g * l * std::sin(phi)});
    EXPECT_NEAR(point.evaluate(model->graph, model->power), (F - d * v) * v, kTolerance);
  }
}

TEST(Lagrange, RodOnMovingGroundWithBelt) {
  DerivedModel model(R"(
model Rod
  parameter Real m = 1.5, J = 0.2, L = 1.2, mu = 0.3;
  coordinate Real x, y, th;
  body rod(mass = m, position = {x, y}, angle = th, inertia = J);
  gravity weight(acceleration = {0, -9.81});
  contact tip(gap = y - L/2*sin(th) - 0.1*sin(3*time), slip = der(x - L/2*cos(th)) - 2*time^2, friction = mu*(1 + x^2), rate = 4);
end Rod;
)");
  TF_ASSERT_DERIVED(model);
  const double m = 1.5, J = 0.2, h = 0.6;
  for (unsigned seed = 1; seed < 6; ++seed) {
    Point point(*model, seed, -2, 2);
    const double t = point(Time), x = point(Coordinate, 0), y = point(Coordinate, 1), th = point(Coordinate, 2);
    const double vx = point(Velocity, 0), vy = point(Velocity, 1), w = point(Velocity, 2);
    expectMotion(model, point, {m, 0, 0, 0, m, 0, 0, 0, J}, {0, -m * 9.81, 0});
    const Contact &tip = model->contacts.at(0);
    const TangentRow &row = model->tangents.at(0);
    const auto value = [&](ir::NodeId node) { return point.evaluate(model->graph, node); };
    EXPECT_NEAR(value(tip.gap), y - h * std::sin(th) - 0.1 * std::sin(3 * t), kTolerance);
    EXPECT_NEAR(value(tip.gapRate), vy - h * std::cos(th) * w - 0.3 * std::cos(3 * t), kTolerance);
    EXPECT_NEAR(value(tip.bias), h * std::sin(th) * w * w + 0.9 * std::sin(3 * t), kTolerance);
    EXPECT_NEAR(value(tip.normal[2]), -h * std::cos(th), kTolerance);
    EXPECT_NEAR(value(row.slip), vx + h * std::sin(th) * w - 2 * t * t, kTolerance);
    EXPECT_NEAR(value(row.bias), h * std::cos(th) * w * w - 4 * t, kTolerance);
    EXPECT_NEAR(value(row.jacobian[2]), h * std::sin(th), kTolerance);
    EXPECT_NEAR(value(tip.friction), 0.3 * (1 + x * x), kTolerance);
    EXPECT_NEAR(value(tip.rate), 4, 0);
  }
}

TEST(Lagrange, BoxWithFourCorners) {
  DerivedModel model(R"(
model Box
  parameter Real J = 1.36/12;
  parameter Real c[4, 2] = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}};
  coordinate Real x, y, th;
  body box(mass = 1, position = {x, y}, angle = th, inertia = J);
  gravity weight(acceleration = {0, -9.81});
  Real px[4] = {x + cos(th)*c[i, 1] - sin(th)*c[i, 2] for i in 1:4};
  Real py[4] = {y + sin(th)*c[i, 1] + cos(th)*c[i, 2] for i in 1:4};
  contact corner[4](gap = py, slip = der(px), each friction = 0.2);
end Box;
)");
  TF_ASSERT_DERIVED(model);
  ASSERT_EQ(model->contacts.size(), 4U);
  EXPECT_EQ(model->contacts[2].name, "corner[3]");
  const double corners[4][2] = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}};
  Point point(*model, 7, -2, 2);
  const double th = point(Coordinate, 2), w = point(Velocity, 2);
  expectMotion(model, point, {1, 0, 0, 0, 1, 0, 0, 0, 1.36 / 12}, {0, -9.81, 0});
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = corners[k][0], b = corners[k][1];
    const Contact &contact = model->contacts[k];
    const TangentRow &row = model->tangents[static_cast<std::size_t>(contact.tangentFirst)];
    EXPECT_NEAR(point.evaluate(model->graph, contact.normal[2]), std::cos(th) * a - std::sin(th) * b, kTolerance);
    EXPECT_NEAR(point.evaluate(model->graph, contact.bias), -(std::sin(th) * a + std::cos(th) * b) * w * w, kTolerance);
    EXPECT_NEAR(point.evaluate(model->graph, row.jacobian[2]), -std::sin(th) * a - std::cos(th) * b, kTolerance);
    EXPECT_NEAR(point.evaluate(model->graph, row.bias), (-std::cos(th) * a + std::sin(th) * b) * w * w, kTolerance);
  }
}

// A bead on a line that turns with constant speed: the time dependence of the position makes the centrifugal force m r w².
TEST(Lagrange, TimeDependentPosition) {
  DerivedModel model(R"(
model Bead
  parameter Real w = 3, m = 0.5;
  coordinate Real r;
  body bead(mass = m, position = r*{cos(w*time), sin(w*time)});
end Bead;
)");
  TF_ASSERT_DERIVED(model);
  Point point(*model, 3);
  expectMotion(model, point, {0.5}, {0.5 * point(Coordinate) * 9});
}

// Gravity acts on the bodies of its own instance and below only.
TEST(Lagrange, ScopeOfGravity) {
  DerivedModel model(R"(
model Two
  model Ball
    coordinate Real y;
    body ball(mass = 2, position = {0, y});
  end Ball;
  model Falling
    Ball below;
    gravity weight(acceleration = {0, -5});
  end Falling;
  Ball free;
  Falling falling;
end Two;
)");
  TF_ASSERT_DERIVED(model);
  const std::vector<double> force = Point(*model, 1).evaluate(model->graph, model->force);
  ASSERT_EQ(force.size(), 2U);
  EXPECT_EQ(force[0], 0);
  EXPECT_EQ(force[1], -10);
}

TEST(Lagrange, ResidualIsMassTimesAccelerationLessForces) {
  DerivedModel model(R"(
model Chain
  parameter Integer n = 3;
  coordinate Real x, y, th[n];
  Real c[n] = {x + sum(cos(th[j])/3 for j in 1:i) - cos(th[i])/6 for i in 1:n};
  Real s[n] = {y + sum(sin(th[j])/3 for j in 1:i) - sin(th[i])/6 for i in 1:n};
  body rod[n](each mass = 1/3, position = {{c[i], s[i]} for i in 1:n}, angle = th, each inertia = 1/324);
  gravity weight(acceleration = {0, -9.81});
  force joint[n - 1](value = {0.002*(der(th[i]) - der(th[i + 1])) for i in 1:n - 1}, at = {th[i + 1] - th[i] for i in 1:n - 1});
  contact node(gap = y, slip = der(x), friction = 0.5);
  friction drag(slip = der(c[2]), bound = 0.1);
end Chain;
)");
  TF_ASSERT_DERIVED(model);
  const auto n = static_cast<std::size_t>(model->nv);
  for (unsigned seed = 1; seed < 4; ++seed) {
    Point point(*model, seed);
    const std::vector<double> mass = point.evaluate(model->graph, model->mass), force = point.evaluate(model->graph, model->force);
    const std::vector<double> residual = point.evaluate(model->graph, model->residual);
    for (std::size_t k = 0; k < n; ++k) {
      double expected = -force[k];
      for (std::size_t j = 0; j < n; ++j)
        expected += mass[k * n + j] * point(Acceleration, static_cast<int>(j));
      for (std::size_t i = 0; i < model->contacts.size(); ++i)
        expected -= point.evaluate(model->graph, model->contacts[i].normal[k]) * point(NormalForce, static_cast<int>(i));
      for (std::size_t i = 0; i < model->tangents.size(); ++i)
        expected -= point.evaluate(model->graph, model->tangents[i].jacobian[k]) * point(TangentForce, static_cast<int>(i));
      EXPECT_NEAR(residual[k], expected, kTolerance);
    }
  }
}

}  // namespace
}  // namespace tf::test
