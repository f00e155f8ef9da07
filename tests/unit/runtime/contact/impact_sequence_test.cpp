// Accumulating impacts with constant coefficients against closed forms.
#include "runtime/contact/impact_sequence.h"

#include "tests/unit/runtime/contact/mechanisms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

constexpr double g = 9.81;

// t_acc = t_1 + 2 ε v_1 / (g (1 − ε)) of a ball; n of them side by side.
SequenceProblem balls(const std::vector<double> &height, const std::vector<double> &restitution) {
  SequenceProblem problem;
  const int n = static_cast<int>(height.size());
  problem.resize(n, 0);
  for (int i = 0; i < n; ++i) {
    problem.delassus(i, i) = 1;
    problem.bias[i] = -g;
    problem.gap[i] = height[i];
    problem.restitution[i] = restitution[i];
  }
  return problem;
}

double restTime(double height, double restitution) { return std::sqrt(2 * height / g) * (1 + 2 * restitution / (1 - restitution)); }

TEST(ImpactSequence, BallComesToRestAtTheSumOfTheSeries) {
  ImpactSequence sequence;
  for (const double restitution : {0.1, 0.5, 0.9, 0.99}) {
    const SequenceProblem problem = balls({2}, {restitution});
    const AccumulationPoint *point = sequence.follow(problem);
    ASSERT_NE(point, nullptr);
    const double end = restTime(2, restitution);
    EXPECT_NEAR(point->time, end, 1e-12 * end);
    EXPECT_EQ(point->contacts, std::vector<int>{0});
    EXPECT_NEAR(point->impulse[0], g * end, 1e-11 * end);
    // The height has become zero: 2 − g t²/2 + ∫ impulse dt = 0.
    EXPECT_NEAR(point->impulseMoment[0], 0.5 * g * end * end - 2, 1e-11 * end * end);
  }
}

TEST(ImpactSequence, TwoBallsHaveTheirOwnPoints) {
  ImpactSequence sequence;
  const SequenceProblem problem = balls({2, 1.1}, {0.6, 0.65});
  const AccumulationPoint *point = sequence.follow(problem);
  ASSERT_NE(point, nullptr);
  ASSERT_LT(restTime(1.1, 0.65), restTime(2, 0.6));
  EXPECT_NEAR(point->time, restTime(1.1, 0.65), 1e-11);
  EXPECT_EQ(point->contacts, std::vector<int>{1});
  // The other ball is where its own impacts have brought it: v = −g t + impulse.
  const double first = std::sqrt(4 / g);
  double time = first, speed = g * first;
  while (time < point->time) {
    speed *= 0.6;
    time += 2 * speed / g;
  }
  const double velocity = speed - g * (point->time - (time - 2 * speed / g));
  EXPECT_NEAR(-g * point->time + point->impulse[0], velocity, 1e-10);
}

// Beside a ball that lies on another one, with the forces 2 g and g: impacts do not reach them.
TEST(ImpactSequence, ImpactsLeaveWhatTheyDoNotReach) {
  SequenceProblem problem = balls({2, 0, 0}, {0.5, 0.5, 0.5});
  problem.delassus(2, 2) = 2;
  problem.delassus(1, 2) = problem.delassus(2, 1) = -1;
  problem.bias[2] = 0;
  ImpactSequence sequence;
  const AccumulationPoint *point = sequence.follow(problem);
  ASSERT_NE(point, nullptr);
  const double end = restTime(2, 0.5);
  EXPECT_NEAR(point->time, end, 1e-12 * end);
  EXPECT_EQ(point->contacts, std::vector<int>{0});
  EXPECT_NEAR(point->impulse[0], g * end, 1e-11 * end);
  EXPECT_NEAR(point->impulse[1], 2 * g * end, 1e-11 * end);
  EXPECT_NEAR(point->impulse[2], g * end, 1e-11 * end);
  EXPECT_EQ(point->frozenImpulse[1], 0);
  EXPECT_EQ(point->frozenImpulse[2], 0);
}

// Onto the upper one of two balls: the impact reaches the lower one's contact with the floor, from one to the next.
TEST(ImpactSequence, ImpactsReachRestingContactsOneAfterTheOther) {
  SequenceProblem problem = balls({2, 0, 0}, {0.5, 0, 0});
  problem.delassus(0, 0) = problem.delassus(2, 2) = 2;
  problem.delassus(0, 2) = problem.delassus(2, 0) = problem.delassus(1, 2) = problem.delassus(2, 1) = -1;
  problem.bias[2] = 0;
  ImpactSequence sequence;
  const AccumulationPoint *point = sequence.follow(problem);
  ASSERT_NE(point, nullptr);
  EXPECT_GT(point->frozenImpulse[0], 0);
  EXPECT_GT(point->frozenImpulse[1], 0);
  EXPECT_GT(point->frozenImpulse[2], 0);
}

TEST(ImpactSequence, ElasticBallDoesNotComeToRest) {
  ImpactSequence sequence;
  EXPECT_EQ(sequence.follow(balls({1}, {1})), nullptr);
}

TEST(ImpactSequence, BallAloneInTheAirHasNoPoint) {
  ImpactSequence sequence;
  SequenceProblem problem = balls({1}, {0.5});
  problem.bias[0] = 1;
  EXPECT_EQ(sequence.follow(problem), nullptr);
}

// A ball that bounces down a slope (angle a, μ): tangential speed changes by g sin a t and by at most μ of the normal impulses, which are
// g cos a t until rest (plus the first speed).
TEST(ImpactSequence, BallOnASlopeKeepsItsSlip) {
  const double a = 0.5, mu = 0.2, restitution = 0.7, height = 0.01;
  SequenceProblem problem;
  problem.resize(1, 1);
  problem.delassus(0, 0) = problem.delassus(1, 1) = 1;
  problem.bias = {-g * std::cos(a), g * std::sin(a)};
  problem.gap[0] = height;
  problem.velocity = {0, 3};
  problem.owner[0] = 0;
  problem.friction[0] = mu;
  problem.restitution[0] = restitution;
  ImpactSequence sequence;
  const AccumulationPoint *point = sequence.follow(problem);
  ASSERT_NE(point, nullptr);
  const double end = std::sqrt(2 * height / (g * std::cos(a))) * (1 + restitution) / (1 - restitution);
  EXPECT_NEAR(point->time, end, 1e-13);
  EXPECT_NEAR(point->impulse[0], g * std::cos(a) * end, 1e-12);
  EXPECT_NEAR(point->impulse[1], -mu * g * std::cos(a) * end, 1e-12);
  EXPECT_TRUE(point->sticking.empty());
}

// Housner's block: small rocking without restitution, in the linear approximation. Each impact leaves the share (1 − 3/2 sin²α)... of the
// inertia about the new corner, and rocking takes 2 ω / |ω'|.
TEST(ImpactSequence, RockingBlockComesToRestOnBothCorners) {
  const double b = 0.2, h = 0.6, inertia = (b * b + h * h) / 3, speed = 1e-3;
  const auto block = test::body(1, inertia, 0, {{-b, -h}, {b, -h}}, 0.8);
  SequenceProblem problem;
  problem.resize(2, 2);
  const Eigen::MatrixXd J = block.jacobian();
  problem.delassus.map() = block.delassus();
  const Eigen::VectorXd free = J * Eigen::Vector3d(0, -g, 0);
  // Turning about the left corner (closed): the right one is opening.
  const Eigen::VectorXd velocity = J * Eigen::Vector3d(-h * speed, b * speed, speed);
  for (int r = 0; r < 4; ++r) {
    problem.bias[r] = free(r);
    problem.velocity[r] = std::abs(velocity(r)) < 1e-15 ? 0 : velocity(r);
  }
  for (int i = 0; i < 2; ++i) {
    problem.owner[i] = i;
    problem.friction[i] = 0.8;
  }
  ImpactSequence sequence;
  const AccumulationPoint *point = sequence.follow(problem);
  ASSERT_NE(point, nullptr);
  const double corner = inertia + b * b + h * h;
  const double ratio = (inertia + h * h - b * b) / corner;  // both corners stick
  const double fall = g * b / corner;
  EXPECT_NEAR(point->time, 2 * speed / fall / (1 - ratio), 1e-10 * point->time);
  EXPECT_EQ(point->contacts, (std::vector<int>{0, 1}));
  EXPECT_EQ(point->sticking, (std::vector<int>{0, 1}));
}

// A rod falls flat with restitution: both ends, many accumulations of one end between the impacts of the other.
TEST(ImpactSequence, BouncingRodComesToRestOnBothEnds) {
  const auto rod = test::body(1, 1.0 / 12, 0, {{-0.5, 0}, {0.5, 0}}, 0);
  ImpactSequence sequence;
  for (const double restitution : {0.2, 0.5, 0.8})
    for (const double tilt : {0.0, 0.001, 0.004}) {
      SequenceProblem problem;
      problem.resize(2, 0);
      problem.delassus.map() = rod.delassus().topLeftCorner(2, 2);
      problem.bias = {-g, -g};
      problem.gap = {0.01 - tilt, 0.01 + tilt};
      problem.restitution = {restitution, restitution};
      const AccumulationPoint *point = sequence.follow(problem);
      ASSERT_NE(point, nullptr) << restitution << ' ' << tilt;
      // Momentum: both ends at rest if both belong to it.
      if (point->contacts.size() == 2) {
        EXPECT_NEAR(point->impulse[0] + point->impulse[1], g * point->time, 1e-9);
        EXPECT_NEAR(point->impulseMoment[0] + point->impulseMoment[1], 0.5 * g * point->time * point->time - 0.01, 1e-10);
        EXPECT_NEAR(point->impulseMoment[0], point->impulseMoment[1] + tilt * 2 / 6, 1e-10);
      }
    }
}

// A rod of unit length on two supports at ±d from its middle, inside its radius of gyration: an impact of one support lifts the other end.
// One end comes to rest within each hop of the other one. Times: all impacts down to 1e-28 m/s followed with 60 digits.
TEST(ImpactSequence, AccumulationsThatAccumulateAreSummed) {
  struct Rod {
    double distance, tilt, end;
  };
  for (const auto &[distance, tilt, end] :
       {Rod{0.2, 0.05, 1.7457585442706273758}, Rod{0.28, 0.05, 1.5351560528686501025}, Rod{0.28, 0.5, 1.3006552134800441317}}) {
    SequenceProblem problem;
    problem.resize(2, 0);
    const double own = 1 + 12 * distance * distance, other = 1 - 12 * distance * distance;
    problem.delassus.map() << own, other, other, own;
    problem.bias = {-g, -g};
    problem.gap = {0.5 - distance * tilt, 0.5 + distance * tilt};
    problem.restitution = {0.644, 0.248};
    ImpactSequence sequence;
    const AccumulationPoint *point = sequence.follow(problem);
    ASSERT_NE(point, nullptr);
    EXPECT_EQ(point->contacts, std::vector<int>{1});
    EXPECT_LT(point->time, end);
    point = sequence.follow(problem, Accumulation::OfAccumulations);
    ASSERT_NE(point, nullptr);
    EXPECT_EQ(point->contacts, (std::vector<int>{0, 1}));
    EXPECT_NEAR(point->time, end, 1e-12);
    EXPECT_NEAR(point->impulse[0] + point->impulse[1], g * end, 1e-11);
  }
  ImpactSequence sequence;
  EXPECT_EQ(sequence.follow(balls({2}, {0.5}), Accumulation::OfAccumulations), nullptr);
  EXPECT_EQ(sequence.follow(balls({2, 1.1}, {0.6, 0.65}), Accumulation::OfAccumulations), nullptr);
}

}  // namespace
}  // namespace tf::runtime
