// The time-freezing sum form against the formulas of theory.md section 2.
#include "compiler/filippov/filippov_system.h"
#include "tests/unit/compiler/mechanics/derived_model.h"

#include <Eigen/Dense>

#include <cmath>
#include <numbers>

namespace tf::filippov {
namespace {

using test::DerivedModel;
using test::Point;
using enum ir::SymbolKind;

// Σ θ_k f_k at a point with values of all step variables (in the order of `steps`): (q', v', t').
Eigen::VectorXd rightHandSide(const FilippovSystem &form, HybridSystem &system, Point point, const std::vector<double> &alphas) {
  for (std::size_t k = 0; k < alphas.size(); ++k)
    point(StepVariable, system.graph[form.steps[k].variable].symbol.index) = alphas[k];
  const int n = system.nv;
  const std::vector<double> values = point.evaluate(system.graph, system.mass);
  const Eigen::MatrixXd mass = Eigen::Map<const Eigen::MatrixXd>(values.data(), n, n);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(2 * n + 1);
  for (const Term &term : form.terms) {
    const Field &field = form.fields[static_cast<std::size_t>(term.field)];
    const std::vector<double> force = point.evaluate(system.graph, field.force);
    Eigen::VectorXd derivative = Eigen::VectorXd::Zero(2 * n + 1);
    for (int k = 0; k < n && field.timeRuns; ++k)
      derivative(k) = point(Velocity, k);
    derivative.segment(n, n) = mass.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(force.data(), n));
    derivative(2 * n) = field.timeRuns ? 1 : 0;
    sum += point.evaluate(system.graph, term.coefficient) * derivative;
  }
  return sum;
}

// A rod with one end on the ground, gravity and an input torque: J_nᵀ M⁻¹ J_t ≠ 0.
constexpr const char *kRod = R"(
model Rod
  parameter Real mu = 0.3, a = 4;
  coordinate Real x, y, th;
  body rod(mass = 1.5, position = {x, y}, angle = th, inertia = 0.2);
  gravity weight(acceleration = {0, -9.81});
  force push(value = 0.7, at = x);
  contact tip(gap = y - 0.6*sin(th), slip = der(x - 0.6*cos(th)), friction = mu, rate = a);
end Rod;
)";

struct ContactData {
  Eigen::MatrixXd inverseMass;
  Eigen::VectorXd force, normal, tangent;
  double normalBias = 0, tangentBias = 0;
};

ContactData dataAt(HybridSystem &system, const Point &point) {
  const int n = system.nv;
  const auto vector = [&](const std::vector<ir::NodeId> &nodes) {
    const std::vector<double> values = point.evaluate(system.graph, nodes);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  ContactData data;
  const Eigen::VectorXd mass = vector(system.mass);
  data.inverseMass = Eigen::Map<const Eigen::MatrixXd>(mass.data(), n, n).inverse();
  data.force = vector(system.force);
  data.normal = vector(system.contacts[0].normal);
  data.tangent = vector(system.tangents[0].jacobian);
  data.normalBias = point.evaluate(system.graph, system.contacts[0].bias);
  data.tangentBias = point.evaluate(system.graph, system.tangents[0].bias);
  return data;
}

// A point on c1 = c2 = 0 with the given slip.
Point closedPoint(HybridSystem &system, double slip) {
  Point point(system, 4);
  const double th = 0.8;
  point(Coordinate, 2) = th;
  point(Coordinate, 1) = 0.6 * std::sin(th);
  point(Velocity, 2) = 0.5;
  point(Velocity, 1) = 0.6 * std::cos(th) * 0.5;
  point(Velocity, 0) = slip - 0.6 * std::sin(th) * 0.5;
  return point;
}

TEST(TimeFreezing, LectureExampleHasThreeTermsAndEightRegions) {
  DerivedModel model(kRod);
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  ASSERT_EQ(form.steps.size(), 3U);
  ASSERT_EQ(form.terms.size(), 3U);
  std::vector<int> modes;
  for (const Region &region : regions(form, *model))
    modes.push_back(region.mode);
  EXPECT_EQ(modes, (std::vector<int>{0, 0, 0, 0, 0, 0, 1, 2}));
  const auto theta = [&](double a1, double a2, double a3) {
    std::vector<double> values;
    Point point;
    for (std::size_t k = 0; k < 3; ++k)
      point(StepVariable, model->graph[form.steps[k].variable].symbol.index) = std::array{a1, a2, a3}[k];
    for (const Term &term : form.terms)
      values.push_back(point.evaluate(model->graph, term.coefficient));
    return values;
  };
  const double a1 = 0.2, a2 = 0.7, a3 = 0.4;
  const std::vector<double> values = theta(a1, a2, a3);
  EXPECT_NEAR(values[0], a1 + (1 - a1) * a2, 1e-15);
  EXPECT_NEAR(values[1], (1 - a1) * (1 - a2) * a3, 1e-15);
  EXPECT_NEAR(values[2], (1 - a1) * (1 - a2) * (1 - a3), 1e-15);
}

// Slip: the sliding solution is β (f_Slip, 1) with β = a_n/(a_n + λ_n), λ_n = −φ/D_s, D_s = D_nn − μ s D_nt.
TEST(TimeFreezing, SlipOnTheContactSurface) {
  DerivedModel model(kRod);
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  for (const double slip : {0.9, -0.9}) {
    const Point point = closedPoint(*model, slip);
    const ContactData d = dataAt(*model, point);
    const double s = slip > 0 ? 1 : -1, mu = 0.3, rate = 4;
    const Eigen::VectorXd direction = d.normal - mu * s * d.tangent;
    const double phi = d.normal.dot(d.inverseMass * d.force) + d.normalBias;
    const double delassus = d.normal.dot(d.inverseMass * direction);
    ASSERT_LT(phi, 0);
    const double lambda = -phi / delassus, beta = rate / (rate + lambda);
    EXPECT_NEAR(beta, rate * delassus / (rate * delassus - phi), 1e-14);
    // On c1 = c2 = 0 only push = (1 − α1)(1 − α2) = λ β/a_n is unique.
    const double push = lambda * beta / rate;
    for (const double a1 : {0.0, 0.1}) {
      const Eigen::VectorXd y = rightHandSide(form, *model, point, {a1, 1 - push / (1 - a1), s > 0 ? 1.0 : 0.0});
      EXPECT_NEAR(y(6), beta, 1e-12);
      const Eigen::VectorXd acceleration = d.inverseMass * (d.force + direction * lambda);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(y(k), beta * point.at({Velocity, k}), 1e-12);
        EXPECT_NEAR(y(3 + k), beta * acceleration(k), 1e-12);
      }
      EXPECT_NEAR(d.normal.dot(y.segment(3, 3)) + beta * d.normalBias, 0, 1e-12);
    }
  }
}

// Stick: both accelerations vanish; λ of the stick problem, α3 = (1 − λ_t/(μ λ_n))/2.
TEST(TimeFreezing, StickOnTheContactSurface) {
  DerivedModel model(kRod);
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  const Point base = closedPoint(*model, 0);
  Point point = base;
  const double mu = 2, rate = 4;
  point(Parameter, 0) = mu;
  const ContactData d = dataAt(*model, point);
  Eigen::MatrixXd jacobian(2, 3);
  jacobian << d.normal.transpose(), d.tangent.transpose();
  const Eigen::VectorXd free = jacobian * d.inverseMass * d.force + Eigen::Vector2d(d.normalBias, d.tangentBias);
  const Eigen::VectorXd lambda = (jacobian * d.inverseMass * jacobian.transpose()).ldlt().solve(-free);
  ASSERT_GT(lambda(0), 0);
  ASSERT_LT(std::abs(lambda(1)), mu * lambda(0));
  const double beta = rate / (rate + lambda(0));
  const double alpha3 = (1 - lambda(1) / (mu * lambda(0))) / 2;
  const Eigen::VectorXd y = rightHandSide(form, *model, point, {0, 1 - lambda(0) * beta / rate, alpha3});
  EXPECT_NEAR(y(6), beta, 1e-12);
  const Eigen::VectorXd acceleration = d.inverseMass * (d.force + jacobian.transpose() * lambda);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(y(3 + k), beta * acceleration(k), 1e-12);
  EXPECT_NEAR(d.normal.dot(y.segment(3, 3)) + beta * d.normalBias, 0, 1e-12);
  EXPECT_NEAR(d.tangent.dot(y.segment(3, 3)) + beta * d.tangentBias, 0, 1e-12);
}

// Two contacts: push_i = λ_i β/a_i with β the root of β = Π (1 − λ_i β/a_i).
TEST(TimeFreezing, TwoContactsAddUp) {
  DerivedModel model(R"(
model Corner
  parameter Real a1 = 2, a2 = 5;
  coordinate Real x, y;
  body ball(mass = 1.5, position = {x, y});
  force push(value = {-3, -7}, at = {x, y});
  contact wall[2](gap = {x, y}, rate = {a1, a2});
end Corner;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  EXPECT_EQ(form.terms.size(), 3U);
  Point point(*model, 1);
  for (int k = 0; k < 2; ++k)
    point(Coordinate, k) = point(Velocity, k) = 0;
  const double l1 = 3, l2 = 7, a1 = 2, a2 = 5;
  double beta = 0, upper = std::min(a1 / l1, a2 / l2);
  for (int round = 0; round < 80; ++round) {
    const double middle = (beta + upper) / 2;
    (middle < (1 - l1 * middle / a1) * (1 - l2 * middle / a2) ? beta : upper) = middle;
  }
  const Eigen::VectorXd y = rightHandSide(form, *model, point, {0, 1 - l1 * beta / a1, 0, 1 - l2 * beta / a2});
  EXPECT_NEAR(y(4), beta, 1e-12);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(y(k), 0, 1e-12);
}

// A friction element takes part with a step variable of its own; while time is frozen it gives no impulse.
TEST(TimeFreezing, FrictionElementsActInsideOde) {
  DerivedModel model(R"(
model StickSlip
  coordinate Real x, y(start = 1);
  body mass(mass = 2, position = {x, y});
  friction dry(slip = der(x) - 0.3, bound = 3);
  contact floor(gap = y);
end StickSlip;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  ASSERT_EQ(form.steps.size(), 3U);
  EXPECT_EQ(form.steps[2].role, StepRole::Friction);
  const Point point(*model, 1);
  EXPECT_NEAR(rightHandSide(form, *model, point, {1, 1, 1})(2), -1.5, 1e-15);
  EXPECT_NEAR(rightHandSide(form, *model, point, {1, 1, 0})(2), 1.5, 1e-15);
  EXPECT_NEAR(rightHandSide(form, *model, point, {1, 1, 0.5})(2), 0, 1e-15);
  EXPECT_NEAR(rightHandSide(form, *model, point, {0, 0, 1})(2), 0, 1e-15);
}

// Two slip components: outside of the small disk the auxiliary field works against the slip with μ, inside it pushes outward.
TEST(TimeFreezing, RelaxedFrictionInSpace) {
  DerivedModel model(R"(
model Particle
  coordinate Real q[3](start = {0, 0, 1});
  body ball(mass = 2, position = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.5, rate = 4,
                frictionForm = FrictionForm.Relaxed, slipRadius = 1e-3);
end Particle;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  Point point(*model, 1);
  point(Velocity, 0) = 3;
  point(Velocity, 1) = -4;
  const Eigen::VectorXd outside = rightHandSide(form, *model, point, {0, 0, 1}), inside = rightHandSide(form, *model, point, {0, 0, 0});
  EXPECT_NEAR(outside(3), -0.5 * 4 * 0.6 / 2, 1e-15);
  EXPECT_NEAR(outside(4), 0.5 * 4 * 0.8 / 2, 1e-15);
  EXPECT_NEAR(outside(5), 2, 1e-15);
  EXPECT_GT(inside(3), 0);
  EXPECT_LT(inside(4), 0);
  EXPECT_NEAR(point.evaluate(model->graph, form.steps[2].condition), 5 - 1e-3, 1e-14);
}

// One step variable for each direction; at their vertices the forces are those of the polygon, inscribed in Coulomb's circle.
TEST(TimeFreezing, PolyhedralFrictionInSpace) {
  constexpr int directions = 6;
  DerivedModel model(R"(
model Particle
  coordinate Real q[3](start = {0, 0, 1});
  body ball(mass = 2, position = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.5, rate = 4,
                frictionForm = FrictionForm.Polyhedral, directions = 6);
end Particle;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  ASSERT_EQ(form.steps.size(), 2U + directions);
  ASSERT_EQ(form.terms.size(), 2U + 2 * directions);
  const double side = std::numbers::pi / directions, limit = 0.5 * 4 / 2.0;
  for (int corner = 0; corner < 2 * directions; ++corner) {
    // Corners are between the normals of sides, which are across the directions.
    const double angle = std::numbers::pi / 2 + (corner + 0.5) * side;
    Point point(*model, 1);
    point(Velocity, 0) = 3 * std::cos(angle);
    point(Velocity, 1) = 3 * std::sin(angle);
    std::vector<double> alpha = {0, 0};
    for (int k = 0; k < directions; ++k) {
      const double slip = point.evaluate(model->graph, form.steps[2 + static_cast<std::size_t>(k)].condition);
      EXPECT_NEAR(slip, 3 * std::sin(side / 2) * std::cos(angle - k * side), 1e-14);
      alpha.push_back(slip > 0 ? 1 : 0);
    }
    const Eigen::VectorXd y = rightHandSide(form, *model, point, alpha);
    EXPECT_NEAR(y(3), -limit * std::cos(angle), 1e-14);
    EXPECT_NEAR(y(4), -limit * std::sin(angle), 1e-14);
    EXPECT_NEAR(y(5), 2, 1e-14);
  }
}

TEST(TimeFreezing, GeneralSwitchesMultiplyTheModes) {
  DerivedModel model(R"(
model Relay
  Real x(start = 1), z(start = 0);
equation
  der(x) = -2*sign(x) + cos(time);
  der(z) = if x > 0 then 1 else -1;
end Relay;
)");
  TF_ASSERT_DERIVED(model);
  const FilippovSystem form = timeFreezing(*model);
  EXPECT_EQ(verify(form, *model), "");
  const std::vector<Region> all = regions(form, *model);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_NE(all[0].mode, all[1].mode);
}

TEST(TimeFreezing, VerifierFindsAWrongCoefficient) {
  DerivedModel model(kRod);
  TF_ASSERT_DERIVED(model);
  FilippovSystem form = timeFreezing(*model);
  std::swap(form.terms[1].coefficient, form.terms[2].coefficient);
  EXPECT_NE(verify(form, *model), "");
  form = timeFreezing(*model);
  form.terms[0].coefficient = model->graph.constant(1);
  EXPECT_NE(verify(form, *model), "");
}

}  // namespace
}  // namespace tf::filippov
