#include "runtime/contact/spatial_frozen_phase.h"

#include "tests/unit/runtime/contact/spatial_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace tf::runtime {
namespace {

using test::spatialBody;
using test::SpatialBody;

// One contact, rows (normal, two slips).
FrozenProblem oneContact(const Eigen::Matrix3d &D, double friction, double approach, const Eigen::Vector2d &slip) {
  FrozenProblem problem;
  problem.resize(1, 2);
  problem.delassus.map() = D;
  problem.owner = {0, 0};
  problem.friction = {friction, friction};
  problem.partner = {1, 0};
  problem.normalVelocity = {approach};
  problem.slipVelocity = {slip.x(), slip.y()};
  return problem;
}

// All points of the body, at rate 1 and without restitution.
FrozenProblem problemOf(const SpatialBody &body, const Eigen::VectorXd &velocity, double friction) {
  const int contacts = static_cast<int>(body.rows.rows()) / 3;
  FrozenProblem problem;
  problem.resize(contacts, 2 * contacts);
  problem.delassus.map() = body.rows * body.mass.inverse() * body.rows.transpose();
  const Eigen::VectorXd rowVelocity = body.rows * velocity;
  std::copy_n(rowVelocity.begin(), contacts, problem.normalVelocity.begin());
  std::copy_n(rowVelocity.begin() + contacts, 2 * contacts, problem.slipVelocity.begin());
  for (int j = 0; j < 2 * contacts; ++j) {
    problem.owner[j] = j / 2;
    problem.partner[j] = j ^ 1;
    problem.friction[j] = friction;
  }
  return problem;
}

// A sphere of mass 1; rows times (v, R ω).
FrozenProblem sphereAtTwoPoints(const Eigen::Matrix<double, 6, 6> &rows, double friction) {
  Eigen::Vector<double, 6> response;
  response << 1, 1, 1, 2.5, 2.5, 2.5;
  FrozenProblem problem;
  problem.resize(2, 4);
  problem.delassus.map() = rows * response.asDiagonal() * rows.transpose();
  problem.owner = {0, 0, 1, 1};
  problem.partner = {1, 0, 3, 2};
  problem.friction.assign(4, friction);
  return problem;
}

// A sphere with contacts at its lowest point and at a wall (normal y), that falls and slides along x; rows are (floor, wall),
// then (x, y) on the floor and (x, z) at the wall.
FrozenProblem sphereInCorner() {
  Eigen::Matrix<double, 6, 6> rows;
  rows << 0, 0, 1, 0, 0, 0,  //
      0, 1, 0, 0, 0, 0,      //
      1, 0, 0, 0, -1, 0,     //
      0, 1, 0, 1, 0, 0,      //
      1, 0, 0, 0, 0, 1,      //
      0, 0, 1, -1, 0, 0;
  FrozenProblem problem = sphereAtTwoPoints(rows, 0.4);
  problem.restitution.assign(2, 0.3);
  problem.normalVelocity = {-1, 0};
  problem.slipVelocity = {3, 0, 3, 0};
  problem.resolution = 1e-13;
  return problem;
}

// A sphere that slides along y between two walls that it just fits (normals x and −x); rows are (left, right), then (y, z) of
// each.
FrozenProblem sphereBetweenWalls(double friction, double approach) {
  Eigen::Matrix<double, 6, 6> rows;
  rows << 1, 0, 0, 0, 0, 0,  //
      -1, 0, 0, 0, 0, 0,     //
      0, 1, 0, 0, 0, -1,     //
      0, 0, 1, 0, 1, 0,      //
      0, 1, 0, 0, 0, 1,      //
      0, 0, 1, 0, -1, 0;
  FrozenProblem problem = sphereAtTwoPoints(rows, friction);
  problem.normalVelocity = {-approach, 0};
  problem.slipVelocity = {1, 0, 1, 0};
  return problem;
}

// No impulse ends an approach that redundant rows have by rounding only: it ends where it changes nothing, and is no impact that stops the
// slip.
TEST(SpatialFrozenPhase, AnApproachOfRoundingBetweenWallsStopsNothing) {
  constexpr double rounding = 1e-11;
  SpatialFrozenPhase phase;
  const FrozenResult &smooth = phase.run(sphereBetweenWalls(0, rounding), -1);
  EXPECT_EQ(smooth.status, FrozenStatus::Finished);
  EXPECT_NEAR(smooth.velocity[0], 0, rounding);
  EXPECT_EQ(smooth.velocity[2], 1);
  EXPECT_EQ(smooth.velocity[4], 1);
  EXPECT_EQ(phase.run(sphereBetweenWalls(0.3, rounding), -1).status, FrozenStatus::Unbounded);
  EXPECT_EQ(phase.run(sphereBetweenWalls(0, 0.1), -1).status, FrozenStatus::Unbounded);
}

// Friction on the floor is along the wall, but for a rounding error of its response, which must not press the sphere against the wall.
TEST(SpatialFrozenPhase, RoundingErrorsPressNoContactIn) {
  for (const double coupling : {0.0, 1e-17, -1e-17}) {
    FrozenProblem problem = sphereInCorner();
    problem.delassus(1, 2) += coupling;
    problem.delassus(2, 1) += coupling;
    SpatialFrozenPhase phase;
    const FrozenResult &result = phase.run(problem);
    ASSERT_EQ(result.status, FrozenStatus::Finished);
    EXPECT_EQ(result.breakpointCount, 2);
    EXPECT_NEAR(result.impulse[0], 1.3, 1e-14);
    EXPECT_EQ(result.impulse[1], 0);
    EXPECT_EQ(result.velocity[1], 0);
    EXPECT_NEAR(result.velocity[0], 0.3, 1e-14);
  }
}

// Another contact at rest that a curved slip moves within rounding only stores nothing, however long the impact pushes.
TEST(SpatialFrozenPhase, ContactsAtRestStoreNothingOfARoundingError) {
  for (const double coupling : {1e-17, -1e-17}) {
    FrozenProblem problem;
    problem.resize(2, 2);
    problem.delassus.map().setIdentity();
    problem.delassus.map()(3, 3) = 4;
    for (const int row : {2, 3})
      problem.delassus(1, row) = problem.delassus(row, 1) = coupling;
    problem.owner = {0, 0};
    problem.partner = {1, 0};
    problem.friction.assign(2, 0.3);
    problem.restitution.assign(2, 0.5);
    problem.normalVelocity = {-1, 0};
    problem.slipVelocity = {2, -3};
    problem.resolution = 1e-13;
    SpatialFrozenPhase phase;
    const FrozenResult &result = phase.run(problem);
    ASSERT_EQ(result.status, FrozenStatus::Finished);
    EXPECT_NEAR(result.duration, 1.5, 1e-12);
    EXPECT_NEAR(result.velocity[0], 0.5, 1e-12);
    EXPECT_EQ(result.impulse[1], 0);
    EXPECT_EQ(result.velocity[1], 0);
  }
}

// Homogeneous sphere, mass 2: D_tt = (7/2)/m, D_tn = 0. The slip keeps its direction.
TEST(SpatialFrozenPhase, SphereSlipsThroughTheImpact) {
  const Eigen::Matrix3d D = Eigen::Vector3d(0.5, 1.75, 1.75).asDiagonal();
  SpatialFrozenPhase phase;
  const FrozenProblem problem = oneContact(D, 0.1, -2, {3, -4});
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_NEAR(result.duration, 4, 1e-14);
  const double slip = 5 - 1.75 * 0.1 * 4;
  EXPECT_NEAR(result.velocity[1], 0.6 * slip, 1e-14);
  EXPECT_NEAR(result.velocity[2], -0.8 * slip, 1e-14);
  EXPECT_EQ(result.velocity[0], 0);
}

TEST(SpatialFrozenPhase, SphereSticksWithinTheImpact) {
  const Eigen::Matrix3d D = Eigen::Vector3d(0.5, 1.75, 1.75).asDiagonal();
  SpatialFrozenPhase phase;
  const FrozenProblem problem = oneContact(D, 0.8, -2, {3, -4});
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_EQ(result.velocity[1], 0);
  EXPECT_EQ(result.velocity[2], 0);
  EXPECT_NEAR(result.impulse[0], 4, 1e-14);
  EXPECT_NEAR(result.impulse[1], -3 / 1.75, 1e-14);
  EXPECT_NEAR(result.impulse[2], 4 / 1.75, 1e-14);
  EXPECT_EQ(phase.breakpoints()[1].event, FrozenEvent::Stick);
}

TEST(SpatialFrozenPhase, PoissonsRestitutionOfASphere) {
  const Eigen::Matrix3d D = Eigen::Vector3d(0.5, 1.75, 1.75).asDiagonal();
  SpatialFrozenPhase phase;
  FrozenProblem problem = oneContact(D, 0.1, -2, {3, -4});
  problem.restitution = {0.5};
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_NEAR(result.velocity[0], 1, 1e-14);
  EXPECT_NEAR(std::hypot(result.velocity[1], result.velocity[2]), 5 - 1.75 * 0.1 * 6, 1e-13);
}

// Whatever friction does to a single contact meanwhile, also where it gives the contact more work back than it has stored.
TEST(SpatialFrozenPhase, PoissonsRestitutionOfOneContactIsThatOfItsImpulse) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int gains = 0;
  for (int run = 0; run < 300; ++run) {
    const SpatialBody body = spatialBody(generator, 1);
    Eigen::VectorXd velocity(6);
    for (double &v : velocity)
      v = 2 * uniform(generator);
    velocity[2] -= 1;
    FrozenProblem problem = problemOf(body, velocity, 1);
    if (problem.normalVelocity[0] > -0.1)
      continue;
    SpatialFrozenPhase phase;
    const double compression = phase.run(problem).impulse[0];
    problem.restitution = {1};
    const FrozenResult &result = phase.run(problem);
    ASSERT_EQ(result.status, FrozenStatus::Finished) << run;
    EXPECT_NEAR(result.impulse[0], 2 * compression, 1e-9 * compression) << run;
    gains += result.velocity[0] > -problem.normalVelocity[0] * 1.01 ? 1 : 0;
  }
  EXPECT_GT(gains, 10);
}

// The motion of one contact, unit rate, (v, τ) by the classical Runge–Kutta method in σ, dτ = ‖v_t‖ dσ: regular where the slip vanishes,
// which takes σ → ∞. To c2 = 0 or ‖v_t‖ = 1e-14. Returns τ.
double follow(const Eigen::Matrix3d &D, double friction, Eigen::Vector3d &v, bool &rests) {
  const auto rate = [&](const Eigen::Vector4d &at) -> Eigen::Vector4d {
    const Eigen::Vector2d slip = at.segment<2>(1);
    const double speed = slip.norm();
    Eigen::Vector3d force(1, 0, 0);
    force.tail<2>() = -friction * slip / speed;
    Eigen::Vector4d result(0, 0, 0, speed);
    result.head<3>() = speed * (D * force);
    return result;
  };
  const auto step = [&](const Eigen::Vector4d &y, double h) -> Eigen::Vector4d {
    const Eigen::Vector4d k1 = rate(y), k2 = rate(y + 0.5 * h * k1), k3 = rate(y + 0.5 * h * k2), k4 = rate(y + h * k3);
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  };
  Eigen::Vector4d y(v[0], v[1], v[2], 0);
  double h = 2e-4;
  for (rests = false; !rests && y[0] < -1e-15;) {
    Eigen::Vector4d next = step(y, h);
    // To c2 = 0 by the secant method.
    for (int k = 0; next[0] > 0 && k < 20; ++k)
      next = step(y, h *= y[0] / (y[0] - next[0]));
    y = next;
    rests = y.segment<2>(1).norm() < 1e-14;
  }
  v = y.head<3>();
  return y[3];
}

Eigen::Matrix3d anisotropic() {
  Eigen::Matrix3d D;
  D << 1, 0.2, -0.15, 0.2, 2.5, 0.6, -0.15, 0.6, 1.2;
  return D;
}

TEST(SpatialFrozenPhase, CurvedSlipAgainstFineIntegration) {
  Eigen::Vector3d v(-1, 2, 1.5);
  bool rests = false;
  const FrozenProblem problem = oneContact(anisotropic(), 0.3, v[0], v.tail<2>());
  const double duration = follow(anisotropic(), 0.3, v, rests);
  ASSERT_FALSE(rests);
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_NEAR(result.duration, duration, 1e-9);
  for (int r = 0; r < 3; ++r)
    EXPECT_NEAR(result.velocity[r], v[r], 1e-9);
}

TEST(SpatialFrozenPhase, CurvedSlipComesToRestAndStays) {
  Eigen::Vector3d v(-2, 0.6, 0.5);
  bool rests = false;
  const FrozenProblem problem = oneContact(anisotropic(), 0.6, v[0], v.tail<2>());
  const double duration = follow(anisotropic(), 0.6, v, rests);
  ASSERT_TRUE(rests);
  // Then D_tt λ_t = −D_tn to c2 = 0.
  const Eigen::Matrix3d D = anisotropic();
  const Eigen::Vector2d stick = -D.bottomRightCorner<2, 2>().inverse() * D.bottomLeftCorner<2, 1>();
  ASSERT_LT(stick.norm(), 0.6);
  const double rest = -v[0] / (D(0, 0) + D.topRightCorner<1, 2>() * stick);
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_EQ(result.velocity[1], 0);
  EXPECT_EQ(result.velocity[2], 0);
  EXPECT_NEAR(result.duration, duration + rest, 1e-9);
}

TEST(SpatialFrozenPhase, SlipRestartsInItsOwnDirection) {
  const double friction = 0.05;
  const Eigen::Vector3d v(-2, 0.05, 0.04);
  const FrozenProblem problem = oneContact(anisotropic(), friction, v[0], v.tail<2>());
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  // From zero slip at once.
  const FrozenProblem still = oneContact(anisotropic(), friction, -2, {0, 0});
  const FrozenResult &restarted = phase.run(still);
  ASSERT_EQ(restarted.status, FrozenStatus::Finished);
  const Eigen::Matrix3d D = anisotropic();
  const Eigen::Vector2d slip(restarted.velocity[1], restarted.velocity[2]), u = slip.normalized();
  const Eigen::Vector2d response = D.bottomLeftCorner<2, 1>() - friction * D.bottomRightCorner<2, 2>() * u;
  EXPECT_NEAR(response.x() * u.y() - response.y() * u.x(), 0, 1e-12);
  EXPECT_GT(response.dot(u), 0);
  EXPECT_EQ(restarted.breakpointCount, 1);
}

// The corner of a box slips away from its rest by a three-thousandth of what friction would do across: stiff as soon as it moves at all.
TEST(SpatialFrozenPhase, SlipRestartsSlowly) {
  Eigen::Matrix3d D;
  D << 6.2431348258974086, 1.6240677095507237, -1.1302213814438067, 1.6240677095507237, 2.6430081724159478, 1.4024610596935281,
      -1.1302213814438067, 1.4024610596935281, 4.376673779843161;
  const double friction = 1.0576107993094945;
  FrozenProblem problem = oneContact(D, friction, -3.7044693684817886e-07, {-9.2959094172284651e-09, 2.6666147345810742e-09});
  problem.resolution = 1e-13;
  problem.restitution = {0.55};
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_LT(result.breakpointCount, 100);
  // D_tn − μ D_tt u = k u, k > 0.
  const Eigen::Vector2d slip(result.velocity[1], result.velocity[2]), u = slip.normalized();
  const Eigen::Vector2d acceleration = D.block<2, 1>(1, 0) - friction * D.block<2, 2>(1, 1) * u;
  EXPECT_NEAR(acceleration.x() * u.y() - acceleration.y() * u.x(), 0, 1e-6);
  EXPECT_GT(acceleration.dot(u), 1e-3);
}

// A slip that turns towards where D_s = D_nn − μ D_ntᵀ v_t/‖v_t‖ is negative: the force of the motion grows beyond all bounds on the way
// there, and the frictional impulse begins at D_s = 0, to rounding above it.
TEST(SpatialFrozenPhase, FrictionalImpulseBeginsWhereAResponseReachesZero) {
  Eigen::Matrix3d D;
  D << 1.45, 0.87, -1.13, 0.87, 3.35, -0.17, -1.13, -0.17, 2.82;
  const double friction = 2, speed = 2e-5;
  const double centre = std::atan2(D(0, 2), D(0, 1)), reach = friction * std::hypot(D(0, 1), D(0, 2));
  const auto slip = [&](double response) {
    const double angle = centre - std::acos((D(0, 0) - response) / reach);
    return Eigen::Vector2d(speed * std::cos(angle), speed * std::sin(angle));
  };
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(oneContact(D, friction, 0, slip(1e-7)), 0);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_GT(result.impulse[0], 0.1 * speed);
  EXPECT_GE(result.velocity[0], 0);
  const auto points = phase.breakpoints();
  EXPECT_LT(std::min_element(points.begin(), points.end(), [](const auto &a, const auto &b) { return a.velocity[0] < b.velocity[0]; })
                ->velocity[0],
            -0.01 * speed);
  // Clearly above zero the contact gives way at once.
  EXPECT_EQ(phase.run(oneContact(D, friction, 0, slip(0.1)), 0).duration, 0);
}

// A square plate, mass 1, that lands flat, sliding and spinning: friction at its four corners takes slip and spin to zero together. The
// planar velocities (vx, vy, ω) by the classical Runge–Kutta method in σ, dτ = ‖(v, ω)‖ dσ; the corners push at rate 1. Time of the stop.
double stopOfPlate(double friction, double half, double inertia, Eigen::Vector3d v) {
  const auto rate = [&](const Eigen::Vector4d &at) -> Eigen::Vector4d {
    Eigen::Vector4d result(0, 0, 0, 1);
    for (const double x : {-half, half})
      for (const double y : {-half, half}) {
        const Eigen::Vector2d slip(at[0] - at[2] * y, at[1] + at[2] * x), force = -friction * slip.normalized();
        result += Eigen::Vector4d(force.x(), force.y(), (x * force.y() - y * force.x()) / inertia, 0);
      }
    return at.head<3>().norm() * result;
  };
  Eigen::Vector4d y(v[0], v[1], v[2], 0);
  const double h = 1e-3;
  while (y.head<3>().norm() > 1e-13) {
    const Eigen::Vector4d k1 = rate(y), k2 = rate(y + 0.5 * h * k1), k3 = rate(y + 0.5 * h * k2), k4 = rate(y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return y[3];
}

TEST(SpatialFrozenPhase, SlipAndSpinOfAPlateEndTogether) {
  const double half = 0.4, friction = 0.7, inertia = 0.11;
  const SpatialBody body = spatialBody(1, Eigen::Vector3d(0.06, 0.06, inertia).asDiagonal(),
                                       {{half, half, 0}, {half, -half, 0}, {-half, half, 0}, {-half, -half, 0}});
  Eigen::VectorXd velocity(6);
  velocity << 0.5, 0.2, -3, 0, 0, 1.5;
  const double stop = stopOfPlate(friction, half, inertia, {velocity[0], velocity[1], velocity[5]});
  ASSERT_LT(stop, 0.75);
  SpatialFrozenPhase phase;
  const FrozenResult &result = phase.run(problemOf(body, velocity, friction));
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_NEAR(result.duration, 0.75, 1e-12);
  const auto points = phase.breakpoints();
  const auto stick = std::find_if(points.begin(), points.end(), [](const FrozenBreakpoint &at) { return at.event == FrozenEvent::Stick; });
  ASSERT_NE(stick, points.end());
  EXPECT_NEAR(stick->tau, stop, 1e-8);  // stops are decided at the end of a short step
  for (int row = 4; row < 12; ++row)
    EXPECT_EQ(result.velocity[row], 0) << row;
}

// The path ends, velocities are those of the impulses, energy is lost, and forces are within their cones. Number of its breakpoints.
int expectConsistentPath(const SpatialBody &body, const Eigen::VectorXd &velocity, const FrozenProblem &problem) {
  SpatialFrozenPhase phase;
  const int contacts = problem.normalCount;
  const FrozenResult &result = phase.run(problem);
  EXPECT_EQ(result.status, FrozenStatus::Finished);
  if (result.status != FrozenStatus::Finished)
    return 0;
  const Eigen::Map<const Eigen::VectorXd> impulse(result.impulse.data(), 3 * contacts), after(result.velocity.data(), 3 * contacts);
  const Eigen::VectorXd moved = velocity + body.mass.inverse() * body.rows.transpose() * impulse;
  EXPECT_LT((body.rows * moved - after).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_GE(after.head(contacts).minCoeff(), 0);
  EXPECT_LE(moved.dot(body.mass * moved), velocity.dot(body.mass * velocity) * (1 + 1e-9));
  for (int i = 0; i < contacts; ++i)
    EXPECT_LE(std::hypot(impulse[contacts + 2 * i], impulse[contacts + 2 * i + 1]), problem.friction[2 * i] * impulse[i] + 1e-9);
  return result.breakpointCount;
}

TEST(SpatialFrozenPhase, RandomBodies) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int curved = 0;
  for (int run = 0; run < 120; ++run) {
    SCOPED_TRACE(run);
    const SpatialBody body = spatialBody(generator, 1 + run % 4);
    Eigen::VectorXd velocity(6);
    for (double &v : velocity)
      v = uniform(generator);
    velocity[2] -= 1;
    curved += expectConsistentPath(body, velocity, problemOf(body, velocity, 0.6 * (1 + uniform(generator)))) > 20;
  }
  EXPECT_GT(curved, 15);
}

// The corners of an edge or a face of a box, whose slips depend on each other; faces land tilted or flat.
TEST(SpatialFrozenPhase, RandomBoxes) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto positive = [&](double least, double most) { return least + (most - least) * std::abs(uniform(generator)); };
  for (int run = 0; run < 150; ++run) {
    SCOPED_TRACE(run);
    const double a = positive(0.1, 0.4), b = positive(0.1, 0.4), c = positive(0.1, 0.4);
    std::vector<Eigen::Vector3d> corners = {{a, b, -c}, {a, -b, -c}};
    if (run % 3 != 1) {
      corners.emplace_back(-a, b, -c);
      corners.emplace_back(-a, -b, -c);
    }
    const SpatialBody body =
        spatialBody(1, Eigen::Vector3d((b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3).asDiagonal(), corners);
    Eigen::VectorXd velocity(6);
    for (double &v : velocity)
      v = uniform(generator);
    velocity.tail(3) *= 4;
    if (run % 3 == 2)
      velocity.segment(2, 3) = Eigen::Vector3d(-1, 0, 0);
    FrozenProblem problem = problemOf(body, velocity, positive(0, 2));
    problem.resolution = 1e-13;
    if (run % 2 == 1) {
      std::fill(problem.restitution.begin(), problem.restitution.end(), positive(0, 1));
      std::fill(problem.law.begin(), problem.law.end(), run % 4 == 1 ? ImpactLaw::Poisson : ImpactLaw::Stronge);
    }
    expectConsistentPath(body, velocity, problem);
  }
}

}  // namespace
}  // namespace tf::runtime
