// Rotations and constraints: against hand-derived formulas, and the balance of energy and momentum, at random points.
#include "tests/unit/compiler/mechanics/derived_model.h"

#include "compiler/mechanics/derivation.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <array>

namespace tf::test {
namespace {

using enum ir::SymbolKind;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTolerance = 1e-12;

struct Numbers {
  DerivedModel &model;
  const Point &point;

  [[nodiscard]] VectorXd vector(const std::vector<ir::NodeId> &nodes) const {
    const std::vector<double> values = point.evaluate(model->graph, nodes);
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  [[nodiscard]] double number(ir::NodeId node) const { return point.evaluate(model->graph, node); }
  [[nodiscard]] MatrixXd mass() const {
    const VectorXd values = vector(model->mass);
    return Eigen::Map<const MatrixXd>(values.data(), model->nv, model->nv);
  }
  [[nodiscard]] VectorXd symbols(ir::SymbolKind kind, int count) const {
    VectorXd values(count);
    for (int k = 0; k < count; ++k)
      values(k) = point.at({kind, k});
    return values;
  }
  [[nodiscard]] Matrix3d rotation(int first) const {
    return Eigen::Quaterniond(point.at({Coordinate, first}), point.at({Coordinate, first + 1}), point.at({Coordinate, first + 2}),
                              point.at({Coordinate, first + 3}))
        .toRotationMatrix();
  }
  // Jnᵀ λn + Jtᵀ λt + Hᵀ ν.
  [[nodiscard]] VectorXd contactForce() const {
    VectorXd force = VectorXd::Zero(model->nv);
    for (std::size_t k = 0; k < model->contacts.size(); ++k)
      force += vector(model->contacts[k].normal) * point.at({NormalForce, static_cast<int>(k)});
    for (std::size_t k = 0; k < model->tangents.size(); ++k)
      force += vector(model->tangents[k].jacobian) * point.at({TangentForce, static_cast<int>(k)});
    for (std::size_t k = 0; k < model->constraintRows.size(); ++k)
      force += vector(model->constraintRows[k].jacobian) * point.at({Multiplier, static_cast<int>(k)});
    return force;
  }
};

void expectEqual(const MatrixXd &actual, const MatrixXd &expected, const char *what, double tolerance = kTolerance) {
  ASSERT_EQ(actual.rows(), expected.rows()) << what;
  ASSERT_EQ(actual.cols(), expected.cols()) << what;
  EXPECT_LE((actual - expected).cwiseAbs().maxCoeff(), tolerance * (1 + expected.cwiseAbs().maxCoeff())) << what << "\n"
                                                                                                         << actual << "\ninstead of\n"
                                                                                                         << expected;
}

TEST(Spatial, EulersEquationsWithTorqueInTheWorldsFrame) {
  DerivedModel model(R"(
model Top
  parameter Real I[3, 3] = {{2, 0.1, -0.2}, {0.1, 1.5, 0.3}, {-0.2, 0.3, 1}};
  input Real tau[3];
  coordinate Rotation R(start = {2, 0, 0, 0}, w(start = {0.3, 0, 2}));
  body top(orientation = R, inertia = I);
  force motor(value = tau, at = R);
end Top;
)");
  TF_ASSERT_DERIVED(model);
  EXPECT_EQ(model->nq, 4);
  EXPECT_EQ(model->nv, 3);
  Matrix3d inertia;
  inertia << 2, 0.1, -0.2, 0.1, 1.5, 0.3, -0.2, 0.3, 1;
  for (unsigned seed = 1; seed < 5; ++seed) {
    const Point point(*model, seed);
    const Numbers at{model, point};
    const Vector3d w = at.symbols(Velocity, 3), tau = at.symbols(Input, 3);
    expectEqual(at.mass(), inertia, "M");
    expectEqual(at.vector(model->force), at.rotation(0).transpose() * tau - w.cross(Vector3d(inertia * w)), "f");
    EXPECT_NEAR(at.number(model->kineticEnergy), 0.5 * w.dot(inertia * w), kTolerance);
    EXPECT_NEAR(at.number(model->power), tau.dot(at.rotation(0) * w), kTolerance);
  }
  EXPECT_EQ(model->graph[model->coordinateStarts[0]].value, 1);  // normalised
  ASSERT_NE(model.quantity("R.w[3]"), nullptr);
  EXPECT_EQ(model.quantity("R.w[3]")->unit, "rad/s");
  ASSERT_NE(model.quantity("der(R.w[3])"), nullptr);
  ASSERT_NE(model.quantity("R.q[4]"), nullptr);
}

TEST(Spatial, KinematicsOfTheUnitQuaternion) {
  DerivedModel model("model M\n  coordinate Real x;\n  coordinate Rotation R;\n  coordinate Real y;\n"
                     "  body a(mass = 1, position = {x, y, 0});\n  body b(orientation = R, inertia = identity(3));\nend M;\n");
  TF_ASSERT_DERIVED(model);
  ASSERT_EQ(model->motion.rotations().size(), 1U);
  EXPECT_EQ(model->motion.rotations()[0].coordinate, 1);
  EXPECT_EQ(model->motion.rotations()[0].velocity, 1);
  const Point point(*model, 3);
  const Numbers at{model, point};
  const std::vector<ir::Function> functions = modelFunctions(*model);
  std::vector<double> rate(6);
  for (const ir::Store &store : functions[2].stores)
    rate[static_cast<std::size_t>(store.position)] = at.number(store.node);
  const Eigen::Quaterniond q(point.at({Coordinate, 1}), point.at({Coordinate, 2}), point.at({Coordinate, 3}), point.at({Coordinate, 4}));
  const Vector3d w = at.symbols(Velocity, 5).segment(1, 3);
  const Eigen::Quaterniond expected = q * Eigen::Quaterniond(0, w.x() / 2, w.y() / 2, w.z() / 2);
  EXPECT_EQ(rate[0], point.at({Velocity, 0}));
  EXPECT_EQ(rate[5], point.at({Velocity, 4}));
  for (const auto &[k, value] :
       {std::pair{1, expected.w()}, std::pair{2, expected.x()}, std::pair{3, expected.y()}, std::pair{4, expected.z()}})
    EXPECT_NEAR(rate[static_cast<std::size_t>(k)], value, kTolerance);
}

// A corner r of a box: gap' = e·(v + R(ω × r)), gap'' likewise, slips in the plane.
TEST(Spatial, ContactAtACornerOfABox) {
  DerivedModel model(R"(
model Box
  parameter Real r[3] = {0.3, -0.2, 0.1};
  coordinate Real p[3];
  coordinate Rotation R;
  body box(mass = 2, position = p, orientation = R, inertia = diagonal({0.5, 0.7, 0.9}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real corner[3] = p + R*r;
  contact floor(gap = corner[3] - 0.1*sin(time), slip = der(corner[1:2]), friction = 0.4);
end Box;
)");
  TF_ASSERT_DERIVED(model);
  const Vector3d r(0.3, -0.2, 0.1);
  for (unsigned seed = 1; seed < 5; ++seed) {
    const Point point(*model, seed);
    const Numbers at{model, point};
    const Matrix3d R = at.rotation(3);
    const Vector3d v = at.symbols(Velocity, 6).head(3), w = at.symbols(Velocity, 6).tail(3);
    const Vector3d rate = v + R * w.cross(r), bias = R * w.cross(w.cross(r));
    const double t = point.at({Time, 0});
    const Contact &floor = model->contacts[0];
    EXPECT_NEAR(at.number(floor.gapRate), rate.z() - 0.1 * std::cos(t), kTolerance);
    EXPECT_NEAR(at.number(floor.bias), bias.z() + 0.1 * std::sin(t), kTolerance);
    const auto jacobian = [&](const Vector3d &direction) {
      VectorXd row(6);
      row << direction, r.cross(R.transpose() * direction);
      return row;
    };
    expectEqual(at.vector(floor.normal), jacobian(Vector3d::UnitZ()), "Jn");
    ASSERT_EQ(floor.tangentCount, 2);
    for (int k = 0; k < 2; ++k) {
      const TangentRow &row = model->tangents[static_cast<std::size_t>(k)];
      EXPECT_NEAR(at.number(row.slip), rate(k), kTolerance);
      EXPECT_NEAR(at.number(row.bias), bias(k), kTolerance);
      expectEqual(at.vector(row.jacobian), jacobian(Vector3d::Unit(k)), "Jt");
    }
  }
}

// One model with everything: rotations as coordinates, of hinges and composed, moving bases, constraints of both kinds.
std::unique_ptr<DerivedModel> everything() { return DerivedModel::ofFile("tests/cli/libtf/spatial.tf"); }

TEST(Spatial, ResidualIsMassTimesAccelerationLessForces) {
  const std::unique_ptr<DerivedModel> derived = everything();
  DerivedModel &model = *derived;
  TF_ASSERT_DERIVED(model);
  for (unsigned seed = 1; seed < 4; ++seed) {
    const Point point(*model, seed);
    const Numbers at{model, point};
    expectEqual(at.vector(model->residual), at.mass() * at.symbols(Acceleration, model->nv) - at.vector(model->force) - at.contactForce(),
                "residual", 1e-11);
    EXPECT_GT(Eigen::LLT<MatrixXd>(at.mass()).info() == Eigen::Success, 0);
  }
}

// d(T + V)/dt = power + what contacts, frictions and constraints do, for accelerations that satisfy the equations of motion.
TEST(Spatial, EnergyChangesByThePowerOfForces) {
  const std::unique_ptr<DerivedModel> derived = everything();
  DerivedModel &model = *derived;
  TF_ASSERT_DERIVED(model);
  ir::Graph &graph = model->graph;
  const ir::NodeId energy = graph.add(model->kineticEnergy, model->potentialEnergy);
  const ir::NodeId rate = ir::forwardDerivative(graph, std::array{energy}, [&](ir::Symbol symbol) {
    switch (symbol.kind) {
    case Coordinate:
      return model->motion.rate(graph, symbol.index);
    case Velocity:
      return graph.symbol(Acceleration, symbol.index);
    case State:
      return model->stateDerivatives[static_cast<std::size_t>(symbol.index)];
    default:
      return graph.constant(symbol.kind == Time ? 1 : 0);
    }
  })[0];
  for (unsigned seed = 1; seed < 6; ++seed) {
    Point point(*model, seed);
    const Numbers at{model, point};
    const VectorXd acceleration = at.mass().llt().solve(at.vector(model->force) + at.contactForce());
    for (int k = 0; k < model->nv; ++k)
      point(Acceleration, k) = acceleration(k);
    const double expected = at.number(model->power) + at.symbols(Velocity, model->nv).dot(at.contactForce());
    EXPECT_NEAR(at.number(rate), expected, 1e-10 * (1 + std::abs(expected)));
  }
}

// Along q' = N v, v' = A, t' = 1: rates and accelerations of gaps, slips, residuals are those of differences.
TEST(Spatial, RatesAlongTheMotion) {
  const std::unique_ptr<DerivedModel> derived = everything();
  DerivedModel &model = *derived;
  TF_ASSERT_DERIVED(model);
  const Point point(*model, 11);
  const Numbers at{model, point};
  const double h = 1e-3;
  std::vector<ir::NodeId> rates;
  for (int k = 0; k < model->nq; ++k)
    rates.push_back(model->motion.rate(model->graph, k));
  const VectorXd slopes = at.vector(rates);
  const auto moved = [&](double t) {
    Point p = point;
    for (int k = 0; k < model->nq; ++k)
      p(Coordinate, k) += t * slopes(k);
    for (int k = 0; k < model->nv; ++k)
      p(Velocity, k) += t * point.at({Acceleration, k});
    p(Time) += t;
    return p;
  };
  const std::array around{moved(-2 * h), moved(-h), moved(h), moved(2 * h)};
  const auto difference = [&](ir::NodeId node) {
    std::array<double, 4> f{};
    for (std::size_t k = 0; k < 4; ++k)
      f[k] = around[k].evaluate(model->graph, node);
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h);
  };
  const auto accelerated = [&](const std::vector<ir::NodeId> &row, ir::NodeId bias) {
    return at.number(bias) + at.vector(row).dot(at.symbols(Acceleration, model->nv));
  };
  const Contact &floor = model->contacts[0];
  EXPECT_NEAR(at.number(floor.gapRate), difference(floor.gap), 1e-8);
  EXPECT_NEAR(accelerated(floor.normal, floor.bias), difference(floor.gapRate), 1e-6);
  for (const TangentRow &row : model->tangents)
    EXPECT_NEAR(accelerated(row.jacobian, row.bias), difference(row.slip), 1e-6);
  for (std::size_t k = 0; k < model->constraintRows.size(); ++k) {
    const ConstraintRow &row = model->constraintRows[k];
    if (k < 2) {
      EXPECT_NEAR(at.number(row.rate), difference(row.residual), 1e-8) << k;
    } else {
      EXPECT_EQ(row.rate, row.residual);
    }
    EXPECT_NEAR(accelerated(row.jacobian, row.bias), difference(row.rate), 1e-6) << k;
  }
}

// Free of torques: the angular momentum R I ω keeps its value while the quaternion moves by the compiled equations.
TEST(Spatial, SymmetricTopPrecesses) {
  DerivedModel model(R"(
model Top
  coordinate Rotation R(w(start = {0.3, 0, 2}));
  body top(orientation = R, inertia = diagonal({2, 2, 1}));
  Real momentum[3] = R*{2*R.w[1], 2*R.w[2], R.w[3]};
end Top;
)");
  TF_ASSERT_DERIVED(model);
  // Body frame: ω1 + i ω2 turns with (I3 − I1)/I1·ω3.
  Point point(*model, 1);
  const Numbers at{model, point};
  std::vector<ir::NodeId> slopes;
  for (int k = 0; k < 4; ++k)
    slopes.push_back(model->motion.rate(model->graph, k));
  const std::array<double, 7> start{1, 0, 0, 0, 0.3, 0, 2};
  const auto set = [&](const VectorXd &y) {
    for (int k = 0; k < 4; ++k)
      point(Coordinate, k) = y(k);
    for (int k = 0; k < 3; ++k)
      point(Velocity, k) = y(4 + k);
  };
  const auto slope = [&](const VectorXd &y) {
    set(y);
    VectorXd d(7);
    d << at.vector(slopes), at.mass().llt().solve(at.vector(model->force));
    return d;
  };
  VectorXd y = Eigen::Map<const VectorXd>(start.data(), 7);
  constexpr int kSteps = 3000;
  const double h = 3.0 / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const VectorXd a = slope(y), b = slope(y + h / 2 * a), c = slope(y + h / 2 * b), d = slope(y + h * c);
    y += h / 6 * (a + 2 * b + 2 * c + d);
  }
  const double angle = -0.5 * 2 * 3.0;
  EXPECT_NEAR(y(4), 0.3 * std::cos(angle), 1e-11);
  EXPECT_NEAR(y(5), 0.3 * std::sin(angle), 1e-11);
  EXPECT_NEAR(y(6), 2, 1e-12);
  set(y);
  const Matrix3d R = at.rotation(0);
  expectEqual(R * Vector3d(2 * y(4), 2 * y(5), y(6)), Vector3d(0.6, 0, 2), "angular momentum", 1e-11);
}

}  // namespace
}  // namespace tf::test
