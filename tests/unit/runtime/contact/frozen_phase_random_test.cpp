#include "runtime/contact/frozen_phase.h"

#include "tests/unit/runtime/contact/mechanisms.h"
#include "tests/unit/runtime/contact/random_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tf::runtime {
namespace {

using test::RandomContacts;

FrozenProblem randomPhase(RandomContacts &contacts, const Eigen::MatrixXd &J, const Eigen::VectorXd &v, double largestFriction) {
  const int n = static_cast<int>(J.rows()) / 2;
  FrozenProblem problem;
  problem.resize(n, n);
  problem.delassus.map() = J * J.transpose();
  const Eigen::VectorXd c = J * v;
  for (int i = 0; i < n; ++i) {
    problem.normalVelocity[i] = c(i);
    problem.slipVelocity[i] = c(n + i);
    problem.owner[i] = i;
    problem.friction[i] = contacts.uniform(0, largestFriction);
    problem.rate[i] = std::pow(10.0, contacts.uniform(-0.5, 0.5));
  }
  return problem;
}

// J whose normal rows agree more than they oppose: contacts of a body with a floor, not of a vice.
Eigen::MatrixXd looseJacobian(RandomContacts &contacts, int n, int nv) {
  Eigen::MatrixXd J = contacts.matrix(2 * n, nv);
  for (int i = 0; i < n; ++i)
    J(i, 0) = 1;
  return J;
}

TEST(FrozenPhaseRandom, EndsWithoutApproachAndWithoutGainOfEnergy) {
  RandomContacts contacts(41);
  FrozenPhase phase;
  int finished = 0, failed = 0, longest = 0;
  for (int run = 0; run < 4000; ++run) {
    const int n = run % 10 == 0 ? contacts.integer(5, 12) : contacts.integer(1, 4);
    const int nv = contacts.integer(2, 2 * n + 3);
    const Eigen::MatrixXd J = looseJacobian(contacts, n, nv);
    const Eigen::VectorXd v = contacts.matrix(nv, 1) - Eigen::VectorXd::Unit(nv, 0);
    const FrozenProblem problem = randomPhase(contacts, J, v, run % 3 == 0 ? 2.0 : 0.8);
    const FrozenResult &result = phase.run(problem);
    if (result.status != FrozenStatus::Finished) {
      ++failed;
      ASSERT_FALSE(result.rows.empty());
      continue;
    }
    ++finished;
    longest = std::max(longest, result.breakpointCount);
    for (int i = 0; i < n; ++i)
      ASSERT_GE(result.velocity[i], 0) << "run " << run;
    double energy = 0.5 * v.squaredNorm();
    for (const FrozenBreakpoint &point : phase.breakpoints()) {
      const Eigen::VectorXd at = v + J.transpose() * Eigen::Map<const Eigen::VectorXd>(point.impulse.data(), 2 * n);
      const double now = 0.5 * at.squaredNorm();
      ASSERT_LE(now, energy + 1e-12) << "run " << run;
      energy = now;
      // Impulses and velocities belong together.
      const Eigen::VectorXd c = J * at;
      for (int r = 0; r < 2 * n; ++r)
        ASSERT_NEAR(c(r), point.velocity[r], 1e-9 * (1 + v.norm())) << "run " << run;
      for (int i = 0; i < n; ++i) {
        ASSERT_GE(point.force[i], -1e-12);
        ASSERT_LE(std::abs(point.force[n + i]), problem.friction[i] * point.force[i] + 1e-9) << "run " << run;
      }
    }
  }
  EXPECT_EQ(failed, 0) << "of " << finished + failed << ", longest " << longest;
}

// Poisson's law (with the end at w = 0 where several contacts push) and Stronge's, mixed, with different coefficients, friction and rates.
TEST(FrozenPhaseRandom, RestitutionEndsWithoutApproachAndWithoutGainOfEnergy) {
  RandomContacts contacts(51);
  FrozenPhase phase;
  int failed = 0, stored = 0;
  for (int run = 0; run < 6000; ++run) {
    const int n = contacts.integer(1, 6), nv = contacts.integer(2, 2 * n + 3);
    const Eigen::MatrixXd J = looseJacobian(contacts, n, nv);
    const Eigen::VectorXd v = contacts.matrix(nv, 1) - Eigen::VectorXd::Unit(nv, 0);
    FrozenProblem problem = randomPhase(contacts, J, v, run % 3 == 0 ? 2.0 : 0.8);
    for (int i = 0; i < n; ++i) {
      problem.restitution[i] = contacts.integer(0, 3) == 0 ? 1.0 : contacts.uniform(0, 1);
      problem.law[i] = contacts.integer(0, 1) == 0 ? ImpactLaw::Poisson : ImpactLaw::Stronge;
    }
    const FrozenResult &result = phase.run(problem);
    if (result.status != FrozenStatus::Finished) {
      ++failed;
      continue;
    }
    for (int i = 0; i < n; ++i)
      ASSERT_GE(result.velocity[i], 0) << "run " << run;
    double least = 0.5 * v.squaredNorm();
    const double before = least;
    for (const FrozenBreakpoint &point : phase.breakpoints()) {
      stored += point.event == FrozenEvent::Restitution ? 1 : 0;
      const Eigen::VectorXd at = v + J.transpose() * Eigen::Map<const Eigen::VectorXd>(point.impulse.data(), 2 * n);
      ASSERT_LE(0.5 * at.squaredNorm(), before + 1e-12) << "run " << run;
      const Eigen::VectorXd c = J * at;
      for (int r = 0; r < 2 * n; ++r)
        ASSERT_NEAR(c(r), point.velocity[r], 1e-9 * (1 + v.norm())) << "run " << run;
    }
  }
  EXPECT_EQ(failed, 0);
  EXPECT_GT(stored, 3000);
}

// The Filippov right-hand side itself, with tiny explicit steps: chattering about c = 0 averages to the sliding solution.
Eigen::VectorXd integrate(const FrozenProblem &problem, const Eigen::MatrixXd &J, Eigen::VectorXd v, double step, double end) {
  const int n = problem.normalCount;
  for (double tau = 0; tau < end; tau += step) {
    const Eigen::VectorXd c = J * v;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * n);
    for (int i = 0; i < n; ++i)
      if (c(i) < 0) {
        force(i) = problem.rate[i];
        force(n + i) = c(n + i) > 0 ? -problem.friction[i] * force(i) : problem.friction[i] * force(i);
      }
    v += step * (J.transpose() * force);
  }
  return v;
}

TEST(FrozenPhaseRandom, AgreesWithTinyStepsOfTheFilippovSystem) {
  RandomContacts contacts(42);
  FrozenPhase phase;
  int compared = 0, agreeing = 0, held = 0;
  for (int run = 0; run < 40; ++run) {
    const int n = contacts.integer(1, 3), nv = contacts.integer(3, 6);
    const Eigen::MatrixXd J = looseJacobian(contacts, n, nv);
    const Eigen::VectorXd v = contacts.matrix(nv, 1) - Eigen::VectorXd::Unit(nv, 0);
    const FrozenProblem problem = randomPhase(contacts, J, v, 0.8);
    const FrozenResult &result = phase.run(problem);
    if (result.status != FrozenStatus::Finished || result.duration == 0)
      continue;
    for (const FrozenBreakpoint &point : phase.breakpoints())
      held += point.event == FrozenEvent::Held || point.event == FrozenEvent::Stick ? 1 : 0;
    const double step = result.duration / 60000;
    const Eigen::VectorXd approximate = integrate(problem, J, v, step, result.duration * 1.001);
    const Eigen::VectorXd exact = v + J.transpose() * Eigen::Map<const Eigen::VectorXd>(result.impulse.data(), 2 * n);
    ++compared;
    agreeing += (approximate - exact).norm() < 3e-3 * (1 + v.norm()) ? 1 : 0;
  }
  EXPECT_GT(held, 5);
  EXPECT_GT(compared, 30);
  EXPECT_EQ(agreeing, compared);
}

// Two or three contacts whose zeros of slip and approach follow one another forever within finite τ: the geometric sum equals what
// following the path down to rounding gives.
TEST(FrozenPhaseRandom, GeometricTailsAreSummed) {
  RandomContacts contacts(44);
  FrozenPhase summing, following({.sumTails = false});
  int tails = 0;
  for (int run = 0; run < 60000 && tails < 2; ++run) {
    const int n = contacts.integer(2, 3), nv = contacts.integer(3, 7);
    const Eigen::MatrixXd J = looseJacobian(contacts, n, nv);
    const Eigen::VectorXd v = contacts.matrix(nv, 1) - Eigen::VectorXd::Unit(nv, 0);
    const FrozenProblem problem = randomPhase(contacts, J, v, 2.0);
    const FrozenResult &sum = summing.run(problem);
    const auto points = summing.breakpoints();
    if (std::none_of(points.begin(), points.end(), [](const auto &p) { return p.event == FrozenEvent::Accumulation; }))
      continue;
    ++tails;
    ASSERT_EQ(sum.status, FrozenStatus::Finished);
    const FrozenResult &path = following.run(problem);
    ASSERT_EQ(path.status, FrozenStatus::Finished);
    EXPECT_GT(path.breakpointCount, sum.breakpointCount);
    EXPECT_NEAR(sum.duration, path.duration, 1e-10 * path.duration);
    for (int r = 0; r < 2 * n; ++r) {
      EXPECT_NEAR(sum.velocity[r], path.velocity[r], 1e-10) << "run " << run;
      EXPECT_NEAR(sum.impulse[r], path.impulse[r], 1e-10) << "run " << run;
    }
  }
  EXPECT_EQ(tails, 2);
}

TEST(FrozenPhaseRandom, IsInvariantToACommonFactorOfTheRates) {
  RandomContacts contacts(43);
  FrozenPhase a, b;
  for (int run = 0; run < 300; ++run) {
    const int n = contacts.integer(1, 5), nv = contacts.integer(3, 12);
    const Eigen::MatrixXd J = looseJacobian(contacts, n, nv);
    const Eigen::VectorXd v = contacts.matrix(nv, 1) - Eigen::VectorXd::Unit(nv, 0);
    FrozenProblem problem = randomPhase(contacts, J, v, 1.0);
    const FrozenResult &first = a.run(problem);
    if (first.status != FrozenStatus::Finished)
      continue;
    for (double &rate : problem.rate)
      rate *= 1000;
    const FrozenResult &second = b.run(problem);
    for (int r = 0; r < 2 * n; ++r)
      ASSERT_NEAR(first.velocity[r], second.velocity[r], 1e-10 * (1 + v.norm())) << "run " << run;
    ASSERT_NEAR(first.duration, 1000 * second.duration, 1e-10 * (1 + first.duration)) << "run " << run;
  }
}

}  // namespace
}  // namespace tf::runtime
