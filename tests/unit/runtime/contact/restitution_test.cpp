// Frozen phases with restitution (theory.md section 3) against closed forms.
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/restitution.h"

#include "tests/unit/runtime/contact/mechanisms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>
#include <vector>

namespace tf::runtime {
namespace {

using test::body;
using test::frozen;
using test::Mechanism;
using test::velocityAfter;

constexpr ImpactLaw allLaws[] = {ImpactLaw::Poisson, ImpactLaw::Stronge, ImpactLaw::Newton};

// Balls in a row with the given masses, without friction: contact i between ball i and i + 1.
struct Row {
  Eigen::VectorXd mass, v;

  [[nodiscard]] Eigen::MatrixXd jacobian() const {
    const auto n = v.size() - 1;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      J(i, i) = -1;
      J(i, i + 1) = 1;
    }
    return J;
  }
  [[nodiscard]] FrozenProblem problem(double restitution, ImpactLaw law) const {
    const Eigen::MatrixXd J = jacobian();
    FrozenProblem result;
    result.resize(static_cast<int>(J.rows()), 0);
    result.delassus.map() = J * mass.cwiseInverse().asDiagonal() * J.transpose();
    const Eigen::VectorXd c = J * v;
    result.normalVelocity.assign(c.begin(), c.end());
    result.restitution.assign(result.normalCount, restitution);
    result.law.assign(result.normalCount, law);
    return result;
  }
  [[nodiscard]] Eigen::VectorXd after(const FrozenResult &result) const {
    return v + mass.cwiseInverse().asDiagonal() *
                   (jacobian().transpose() * Eigen::Map<const Eigen::VectorXd>(result.impulse.data(), v.size() - 1));
  }
  [[nodiscard]] double energy(const Eigen::VectorXd &velocity) const { return 0.5 * velocity.dot(mass.asDiagonal() * velocity); }
};

double energy(const Mechanism &mechanism, const Eigen::VectorXd &v) { return 0.5 * v.dot(mechanism.mass * v); }

FrozenProblem with(FrozenProblem problem, double restitution, ImpactLaw law) {
  problem.restitution.assign(problem.normalCount, restitution);
  problem.law.assign(problem.normalCount, law);
  return problem;
}

// The rule for several contacts takes from those of Poisson's law that have done no work what they have stored, and from no others.
TEST(FrozenRestitution, ASecondContactChangesThePushOfThoseThatItEnds) {
  const std::vector<double> coefficient = {0.5, 0.5}, rate = {1, 1}, velocity = {-1, 0};
  for (const ImpactLaw law : allLaws) {
    const std::vector<ImpactLaw> laws = {law, law};
    Restitution restitution;
    restitution.begin(coefficient, laws, rate, velocity);
    EXPECT_FALSE(restitution.push(std::vector<double>{1, 0}));
    EXPECT_FALSE(restitution.push(std::vector<double>{1, 1})) << "nothing has been stored";
    restitution.begin(coefficient, laws, rate, velocity);
    EXPECT_FALSE(restitution.push(std::vector<double>{1, 0}));
    restitution.set(0, 0.5, 0);
    EXPECT_EQ(restitution.push(std::vector<double>{1, 1}), law == ImpactLaw::Poisson);
    EXPECT_EQ(restitution.impulse(0), law == ImpactLaw::Poisson ? 0 : 0.5);
    EXPECT_FALSE(restitution.push(std::vector<double>{1, 1})) << "the rule holds already";
  }
}

TEST(FrozenRestitution, OneBallLeavesWithItsShareOfTheSpeed) {
  for (const ImpactLaw law : allLaws)
    for (const double restitution : {0.0, 0.3, 1.0}) {
      FrozenProblem problem;
      problem.resize(1, 0);
      problem.delassus(0, 0) = 0.5;
      problem.normalVelocity[0] = -5;
      problem.rate[0] = 4;
      FrozenPhase phase;
      const FrozenResult &result = phase.run(with(problem, restitution, law));
      ASSERT_EQ(result.status, FrozenStatus::Finished);
      EXPECT_NEAR(result.velocity[0], 5 * restitution, 1e-14);
      EXPECT_NEAR(result.impulse[0], 10 * (1 + restitution), 1e-13);
      EXPECT_NEAR(result.duration, 2.5 * (1 + restitution), 1e-13);
      if (restitution > 0 && law != ImpactLaw::Newton) {
        EXPECT_EQ(phase.breakpoints()[1].event, FrozenEvent::Restitution);
      }
      EXPECT_EQ(phase.breakpoints().back().event, FrozenEvent::Separation);
    }
}

TEST(FrozenRestitution, TwoBallsExchangeMomentum) {
  const Row row{Eigen::Vector2d(1, 3), Eigen::Vector2d(2, -1)};
  FrozenPhase phase;
  for (const ImpactLaw law : allLaws)
    for (const double restitution : {0.25, 1.0}) {
      const FrozenResult &result = phase.run(row.problem(restitution, law));
      const Eigen::VectorXd v = row.after(result);
      const double common = (2 - 3) / 4.0;  // of the centre of mass
      EXPECT_NEAR(v(0), common - restitution * (2 - common), 1e-14);
      EXPECT_NEAR(v(1), common - restitution * (-1 - common), 1e-14);
    }
}

// Poisson's law alone would give 70 % more energy.
TEST(FrozenRestitution, ThreeBallsDoNotGainEnergy) {
  const Row row{Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0, -0.5)};
  FrozenPhase phase;
  for (const ImpactLaw law : {ImpactLaw::Poisson, ImpactLaw::Stronge}) {
    const FrozenResult &result = phase.run(row.problem(1, law));
    ASSERT_EQ(result.status, FrozenStatus::Finished);
    const Eigen::VectorXd v = row.after(result);
    EXPECT_LE(row.energy(v), row.energy(row.v) + 1e-14);
    EXPECT_GT(row.energy(v), 0.5 * row.energy(row.v));
    EXPECT_NEAR(v.sum(), 0.5, 1e-14);
    EXPECT_GE(v(1) - v(0), -1e-14);
    EXPECT_GE(v(2) - v(1), -1e-14);
  }
}

// The middle contact is held while the first one pushes, and stores nothing.
TEST(FrozenRestitution, RestingNeighbourIsCarriedAlong) {
  const Row row{Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 0, 0)};
  FrozenPhase phase;
  for (const ImpactLaw law : allLaws) {
    const Eigen::VectorXd v = row.after(phase.run(row.problem(1, law)));
    EXPECT_NEAR(v(0), -1.0 / 3, 1e-14);
    EXPECT_NEAR(v(1), 2.0 / 3, 1e-14);
    EXPECT_NEAR(v(2), 2.0 / 3, 1e-14);
  }
}

TEST(FrozenRestitution, TightSlotComesToRest) {
  for (const ImpactLaw law : allLaws)
    for (const double second : {1.0, 0.5, 3.0}) {
      FrozenProblem problem;  // a particle between two walls
      problem.resize(2, 0);
      problem.delassus.map() << 1, -1, -1, 1;
      problem.normalVelocity = {-1, 1};
      problem.rate = {1, second};
      FrozenPhase phase;
      const FrozenResult &result = phase.run(with(problem, 1, law));
      ASSERT_EQ(result.status, FrozenStatus::Finished);
      EXPECT_NEAR(result.velocity[0], 0, 1e-14);
      EXPECT_NEAR(result.velocity[1], 0, 1e-14);
    }
}

// A sphere: D_nt = 0, D_tt = 7/2; slip falls by 7/2 μ (1 + ε) times the approach speed, or to zero.
TEST(FrozenRestitution, SuperballSlipsOrGrips) {
  const double r = 0.5;
  for (const ImpactLaw law : allLaws)
    for (const double mu : {0.1, 0.6})
      for (const double restitution : {0.4, 1.0}) {
        const Mechanism ball = body(1, 0.4 * r * r, 0, {{0, -r}}, mu);
        const Eigen::Vector3d v(3, -2, -1);
        FrozenPhase phase;
        const FrozenResult &result = phase.run(with(frozen(ball, v, {0}), restitution, law));
        const Eigen::VectorXd after = velocityAfter(ball, v, {0}, result.impulse);
        const double slip = 3 - r;
        const double impulse = std::min(mu * (1 + restitution) * 2, slip / 3.5);
        EXPECT_NEAR(after(0), 3 - impulse, 1e-14);
        EXPECT_NEAR(after(1), 2 * restitution, 1e-14);
        EXPECT_NEAR(after(2), -1 - impulse * r / (0.4 * r * r), 1e-13);
      }
}

// A rod whose slip ends within the compression and then sticks: D_s, then D_nn − D_nt²/D_tt; the three laws differ.
TEST(FrozenRestitution, RodThatSticksFollowsEachLaw) {
  const double mu = 0.8, restitution = 0.5;
  const Mechanism rod = body(1, 1.0 / 12, 0.9, {{-0.5, 0}}, mu);
  const Eigen::Vector3d v(0.3, -2, 0);
  const FrozenProblem problem = frozen(rod, v, {0});
  const double Dnn = problem.delassus(0, 0), Dnt = problem.delassus(0, 1), Dtt = problem.delassus(1, 1);
  const double c2 = problem.normalVelocity[0], c3 = problem.slipVelocity[0];
  ASSERT_GT(c3, 0);
  ASSERT_LT(std::abs(Dnt), mu * Dtt);
  const double Ds = Dnn - mu * Dnt, stick = Dnn - Dnt * Dnt / Dtt;
  const double grip = c3 / (mu * Dtt - Dnt);  // normal impulse at which slip ends
  const double atGrip = c2 + Ds * grip;
  ASSERT_LT(atGrip, 0);
  const double compression = grip - atGrip / stick;
  const double work = -(c2 * grip + 0.5 * Ds * grip * grip) + 0.5 * atGrip * atGrip / stick;
  FrozenPhase phase;
  const FrozenResult poisson = phase.run(with(problem, restitution, ImpactLaw::Poisson));
  EXPECT_NEAR(poisson.impulse[0], (1 + restitution) * compression, 1e-14);
  EXPECT_NEAR(poisson.velocity[0], stick * restitution * compression, 1e-14);
  const FrozenResult stronge = phase.run(with(problem, restitution, ImpactLaw::Stronge));
  EXPECT_NEAR(stronge.velocity[0], restitution * std::sqrt(2 * stick * work), 1e-14);
  const FrozenResult newton = phase.run(with(problem, restitution, ImpactLaw::Newton));
  EXPECT_NEAR(newton.velocity[0], -restitution * c2, 1e-14);
  EXPECT_EQ(newton.velocity[1], 0.0);
  EXPECT_GT(std::abs(poisson.velocity[0] - newton.velocity[0]), 1e-3);
  EXPECT_GT(std::abs(poisson.velocity[0] - stronge.velocity[0]), 1e-3);
}

// Kane's paradox: with friction that reverses or sticks within the impact, Newton's law may gain energy. The two others do not.
TEST(FrozenRestitution, NewtonMayGainEnergyWhereTheOthersDoNot) {
  FrozenPhase phase;
  double largest = -1;
  for (double th = 0.05; th < 1.5; th += 0.05)
    for (double slip = -4; slip < 4; slip += 0.1) {
      const Mechanism rod = body(1, 1.0 / 12, th, {{-0.5, 0}}, 0.7);
      const Eigen::Vector3d v(-slip, -1, 0);
      const double before = energy(rod, v);
      for (const ImpactLaw law : allLaws) {
        const FrozenResult &result = phase.run(with(frozen(rod, v, {0}), 0.9, law));
        ASSERT_EQ(result.status, FrozenStatus::Finished);
        const double gain = energy(rod, velocityAfter(rod, v, {0}, result.impulse)) / before - 1;
        if (law == ImpactLaw::Newton)
          largest = std::max(largest, gain);
        else
          ASSERT_LE(gain, 1e-13);
      }
    }
  EXPECT_GT(largest, 0.05);
}

// The compression of a frictional impulse stores p, so that it rebounds.
TEST(FrozenRestitution, PainleveRodRebounds) {
  const auto rod = body(1, 1.0 / 32, std::numbers::pi / 3, {{-0.5, 0}}, 1);
  const Eigen::Vector3d v(-10, 0, 0);
  FrozenProblem problem = frozen(rod, v, {0});
  problem.normalVelocity[0] = 0;
  const double Dnn = problem.delassus(0, 0), Dnt = problem.delassus(0, 1), Dtt = problem.delassus(1, 1);
  FrozenPhase phase;
  for (const double restitution : {0.5, 1.0}) {
    const FrozenResult &result = phase.run(with(problem, restitution, ImpactLaw::Poisson), 0);
    ASSERT_EQ(result.status, FrozenStatus::Finished);
    const double compression = 3.849001794598;
    EXPECT_NEAR(result.impulse[0], (1 + restitution) * compression, 1e-11);
    EXPECT_NEAR(result.velocity[0], (Dnn - Dnt * Dnt / Dtt) * restitution * compression, 1e-11);
    EXPECT_EQ(result.velocity[1], 0.0);
  }
}

// Each contact has its own coefficient, law and rate.
TEST(FrozenRestitution, ContactsThatDoNotTouchEachOtherKeepTheirOwnLaws) {
  FrozenProblem problem;
  problem.resize(3, 0);
  for (int i = 0; i < 3; ++i) {
    problem.delassus(i, i) = 1 + i;
    problem.normalVelocity[i] = -1 - 0.5 * i;
    problem.rate[i] = 1 + 3 * i;
  }
  problem.restitution = {0.2, 0.7, 1.0};
  problem.law = {ImpactLaw::Poisson, ImpactLaw::Stronge, ImpactLaw::Newton};
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  EXPECT_NEAR(result.velocity[0], 0.2, 1e-14);
  EXPECT_NEAR(result.velocity[1], 0.7 * 1.5, 1e-14);
  EXPECT_NEAR(result.velocity[2], 2, 1e-14);
}

// Both ends of a rod on a floor, one of them also at a wall, with friction that presses it into the corner: Newton's targets cannot all be
// reached there. Without the rule for these the contacts push for ever, some in turns, others against forces that keep all in place.
TEST(FrozenRestitution, NewtonsTargetsThatOtherContactsMakeImpossibleAreGivenUp) {
  std::mt19937 random(1);
  const auto pick = [&](std::initializer_list<double> of) {
    return of.begin()[std::uniform_int_distribution<std::size_t>(0, of.size() - 1)(random)];
  };
  std::uniform_real_distribution<double> speed(-1, 1);
  int reached = 0, givenUp = 0;
  for (int run = 0; run < 5000; ++run) {
    const double th = pick({0.3, 0.5, 0.8, 1.1, 1.3}), half = 0.5, x = half * std::cos(th), y = half * std::sin(th);
    Mechanism rod;
    rod.mass = Eigen::Vector3d(1, 1, 1.0 / 12).asDiagonal();
    rod.normal.resize(3, 3);
    rod.tangent.resize(3, 3);
    rod.normal << 0, 1, -x, 1, 0, y, 0, 1, x;
    rod.tangent << 1, 0, y, 0, 1, -x, 1, 0, -y;
    FrozenProblem problem =
        with(frozen(rod, Eigen::Vector3d(speed(random), speed(random), 3 * speed(random)), {0, 1, 2}), 0, ImpactLaw::Newton);
    const double floor = pick({0.3, 0.7, 1.2, 2}), wall = pick({0.3, 0.7, 1.2, 2});
    problem.friction = {floor, wall, floor};
    const double end = pick({0, 0.3, 0.7, 1}), other = pick({0, 0.3, 0.7, 1});
    problem.restitution = {end, other, other};
    FrozenPhase phase;
    const FrozenResult &result = phase.run(problem);
    ASSERT_EQ(result.status, FrozenStatus::Finished) << "run " << run;
    for (int i = 0; i < 3; ++i) {
      EXPECT_GE(result.velocity[i], -1e-13) << "run " << run;
      EXPECT_GE(result.impulse[i], 0) << "run " << run;
      const double target = -problem.restitution[i] * std::min(problem.normalVelocity[i], 0.0);
      ++(result.velocity[i] >= target - 1e-12 ? reached : givenUp);
    }
  }
  EXPECT_GT(reached, 14000);
  EXPECT_GT(givenUp, 5);
}

// A step that takes a contact from its compression into its restitution, or back, is as two steps that meet where its velocity is zero.
TEST(Restitution, ThroughZeroIsThatOfBothParts) {
  const auto started = [](ImpactLaw law) {
    Restitution restitution;
    const double coefficient = 0.6, rate = 1.5, velocity = -3;
    restitution.begin({&coefficient, 1}, {&law, 1}, {&rate, 1}, {&velocity, 1});
    return restitution;
  };
  constexpr double v = -3, a = 2, turn = 1.5;
  for (const ImpactLaw law : {ImpactLaw::Poisson, ImpactLaw::Stronge}) {
    Restitution parts = started(law), whole = parts;
    parts.advance(0, v, a, turn, false);
    const double left = parts.exhaustion(0, 0, a);
    EXPECT_NEAR(left, 0.6 * turn, 1e-14);
    EXPECT_NEAR(whole.exhaustionThroughZero(0, v, a), turn + left, 1e-14);
    parts.advance(0, 0, a, 0.5 * left, false);
    whole.advanceThroughZero(0, v, a, turn + 0.5 * left, false);
    EXPECT_NEAR(whole.impulse(0), parts.impulse(0), 1e-14);
    EXPECT_NEAR(whole.work(0), parts.work(0), 1e-14);
    // Back again: what is left outlasts the way up.
    const double up = a * 0.5 * left, down = -100;
    EXPECT_EQ(whole.exhaustionThroughZero(0, up, down), infinity);
    parts.advance(0, up, down, -up / down, false);
    parts.advance(0, 0, down, 0.1, false);
    whole.advanceThroughZero(0, up, down, -up / down + 0.1, false);
    EXPECT_NEAR(whole.impulse(0), parts.impulse(0), 1e-13);
    EXPECT_NEAR(whole.work(0), parts.work(0), 1e-13);
  }
}

TEST(FrozenRestitution, ClosingWallsAreAnError) {
  for (const ImpactLaw law : allLaws) {
    FrozenProblem problem;
    problem.resize(2, 0);
    problem.delassus.map() << 1, -1, -1, 1;
    problem.normalVelocity = {-1, -0.5};
    FrozenPhase phase;
    EXPECT_EQ(phase.run(with(problem, 0.5, law)).status, FrozenStatus::Unbounded);
  }
}

}  // namespace
}  // namespace tf::runtime
