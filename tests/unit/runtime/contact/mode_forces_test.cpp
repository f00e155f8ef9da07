#include "runtime/contact/mode_forces.h"

#include "runtime/contact/contact_solver.h"
#include "tests/unit/runtime/contact/mechanisms.h"
#include "tests/unit/runtime/contact/random_contacts.h"
#include "tests/unit/runtime/contact/spatial_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tf::runtime {
namespace {

using test::accelerationProblem;
using test::body;
using test::RandomContacts;

constexpr double gravity = 9.81;

ContactMode modeOf(std::vector<std::uint8_t> closed, std::vector<std::int8_t> slip) { return {std::move(closed), std::move(slip)}; }

// λ_n = −φ_n / D_s.
TEST(ModeForces, SlidingContactHasTheFormula) {
  ContactProblem problem;
  problem.resize(1, 1);
  problem.delassus.map() << 3, 0.5, 0.5, 2;
  problem.bias = {-4, 1};
  problem.owner[0] = 0;
  problem.friction[0] = 0.4;
  problem.slipSign[0] = 1;
  ModeForces forces;
  ASSERT_TRUE(forces.start(problem, modeOf({1}, {1})));
  const double normal = 4 / (3 - 0.4 * 0.5);
  EXPECT_DOUBLE_EQ(forces.forces()[0], normal);
  EXPECT_DOUBLE_EQ(forces.forces()[1], -0.4 * normal);
  EXPECT_EQ(forces.accelerations()[0], 0.0);
  EXPECT_NEAR(forces.accelerations()[1], 1 + 0.5 * normal - 2 * 0.4 * normal, 1e-15);
  ASSERT_EQ(forces.margins().size(), 2u);
  EXPECT_DOUBLE_EQ(forces.marginValues()[0], normal);
  problem.bias[0] = 1;  // would have to pull
  ASSERT_TRUE(forces.evaluate(problem));
  EXPECT_LT(forces.marginValues()[0], 0);
  EXPECT_EQ(forces.cross(0), MarginOutcome::ModeEnds);
}

// det A relative to the begin of the mode, until it has changed its sign.
TEST(ModeForces, SlipsThatPressTheirContactsInEndTheMode) {
  ContactProblem problem;
  problem.resize(2, 2);
  problem.delassus.map() << 3, 1, 0.5, 0.2, 1, 2, 0.1, 0.4, 0.5, 0.1, 2, 0, 0.2, 0.4, 0, 2;
  problem.bias = {-4, -3, 1, 1};
  problem.owner = {0, 1};
  problem.friction = {0.4, 0.4};
  problem.slipSign = {1, 1};
  ModeForces forces;
  ASSERT_TRUE(forces.start(problem, modeOf({1, 1}, {1, 1})));
  const auto determinant = [&problem] {
    const auto entry = [&problem](int r, int c) { return problem.delassus(r, c) - problem.friction[c] * problem.delassus(r, 2 + c); };
    return entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0);
  };
  ASSERT_EQ(forces.margins().back().limit.row, ModeMargin::pressing);
  const double largest = std::max({std::abs(forces.forces()[0]), std::abs(forces.forces()[1])});
  const double begin = determinant();
  EXPECT_DOUBLE_EQ(forces.marginValues().back(), largest * (1 - PressingMargin::behind));
  for (const double friction : {2.0, 4.0, 8.0}) {
    problem.friction = {friction, 0.4};
    ASSERT_TRUE(forces.evaluate(problem));
    EXPECT_NEAR(forces.marginValues().back(), largest * (determinant() / begin - PressingMargin::behind), 1e-12) << friction;
  }
  EXPECT_LT(forces.marginValues().back(), 0);
  EXPECT_EQ(forces.cross(static_cast<int>(forces.margins().size()) - 1), MarginOutcome::ModeEnds);
}

// Beside two rows that are one, whose matrix has no determinant, the largest load relative to the sum of all normal forces.
TEST(ModeForces, SlipsThatTurnAndPressTheirContactInBesideRedundantRowsEndTheMode) {
  ContactProblem problem;
  problem.resize(3, 2);
  problem.delassus.map() << 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 0, 1;
  problem.bias = {-2, -2, -3, 1, 0};
  problem.owner = {2, 2};
  problem.partner = {1, 0};
  problem.slipSign = {1, 1};
  problem.friction = {0.4, 0};
  ModeForces forces;
  ASSERT_TRUE(forces.start(problem, modeOf({1, 1, 1}, {1, 1})));
  ASSERT_TRUE(forces.redundant());
  ASSERT_EQ(forces.margins().back().limit.row, ModeMargin::pressing);
  const double largest = 3 / (1 - 0.4 * 0.5), load = 3;
  for (const double friction : {0.4, 1.9, 1.9999, 2.0001}) {
    problem.friction = {friction, 0};
    ASSERT_TRUE(forces.evaluate(problem));
    const double sum = 2 + 3 / (1 - 0.5 * friction);
    EXPECT_NEAR(forces.marginValues().back(), largest * (load / sum - PressingMargin::before), 1e-12) << friction;
  }
  EXPECT_LT(forces.marginValues().back(), 0);
  EXPECT_EQ(forces.cross(static_cast<int>(forces.margins().size()) - 1), MarginOutcome::ModeEnds);
}

TEST(ModeForces, StickHasTwoMargins) {
  ContactProblem problem;
  problem.resize(1, 2);
  problem.delassus.map() << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  problem.bias = {-10, 3, -1};
  problem.owner = {0, -1};
  problem.friction = {0.5, 0};
  problem.bound = {0, 2};
  ModeForces forces;
  ASSERT_TRUE(forces.start(problem, modeOf({1}, {0, 0})));
  ASSERT_EQ(forces.margins().size(), 5u);
  EXPECT_EQ(forces.margins()[1].limit, (ForceLimit{1, 1}));
  EXPECT_DOUBLE_EQ(forces.marginValues()[1], 5 + 3);
  EXPECT_DOUBLE_EQ(forces.marginValues()[2], 5 - 3);
  EXPECT_DOUBLE_EQ(forces.marginValues()[3], 2 - 1);
  EXPECT_DOUBLE_EQ(forces.marginValues()[4], 2 + 1);
}

TEST(ModeForces, AgreesWithTheSolverInItsMode) {
  RandomContacts contacts(31);
  ContactSolver solver;
  ModeForces forces;
  for (int run = 0; run < 500; ++run) {
    const ContactProblem problem = contacts.problem(contacts.integer(1, 6), contacts.integer(0, 2), contacts.integer(2, 16), 0.6, 0.5);
    const ContactSolution &found = solver.solve(problem);
    if (found.status != ContactStatus::Solved)
      continue;
    ASSERT_TRUE(forces.start(problem, found.mode)) << "run " << run;
    ASSERT_EQ(forces.redundant(), found.redundant) << "run " << run;
    for (int r = 0; r < problem.count(); ++r)
      ASSERT_NEAR(forces.forces()[r], found.forces[r], 1e-7 * (1 + std::abs(found.forces[r]))) << "run " << run;
    const std::vector<double> first(forces.forces().begin(), forces.forces().end());
    ASSERT_TRUE(forces.evaluate(problem));
    for (int r = 0; r < problem.count(); ++r)
      ASSERT_NEAR(forces.forces()[r], first[r], 1e-9 * (1 + std::abs(first[r]))) << "run " << run;
  }
}

// The solver's set of forces is taken where it is that of the mode, once.
TEST(ModeForces, BeginsWithWhatTheSolverHasFound) {
  RandomContacts contacts(32);
  ContactSolver solver;
  ModeForces taken, fresh;
  int took = 0;
  for (int run = 0; run < 300; ++run) {
    const ContactProblem problem = contacts.problem(contacts.integer(1, 6), contacts.integer(0, 2), contacts.integer(2, 16), 0.6, 0.5);
    const ContactSolution &found = solver.solve(problem);
    if (found.status != ContactStatus::Solved)
      continue;
    took += solver.forceSet()->hasMode(problem, found.mode) ? 1 : 0;
    ASSERT_TRUE(taken.start(problem, found.mode, &solver.forceSet())) << "run " << run;
    EXPECT_FALSE(solver.forceSet()->hasMode(problem, found.mode)) << "run " << run;
    ASSERT_TRUE(fresh.start(problem, found.mode)) << "run " << run;
    ASSERT_EQ(taken.redundant(), fresh.redundant()) << "run " << run;
    const auto same = [run](std::span<const double> a, std::span<const double> b) {
      EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << "run " << run;
    };
    same(taken.forces(), fresh.forces());
    same(taken.accelerations(), fresh.accelerations());
    same(taken.marginValues(), fresh.marginValues());
    // The same modes of another problem, too.
    ContactProblem heavier = problem;
    for (double &bias : heavier.bias)
      bias *= 1.25;
    ASSERT_EQ(taken.evaluate(heavier), fresh.evaluate(heavier)) << "run " << run;
    same(taken.forces(), fresh.forces());
  }
  EXPECT_GT(took, 100);
}

// Derivatives along a line D + hE, φ + hψ against central differences; in redundant modes too.
TEST(ModeForces, RatesAreTheDerivative) {
  RandomContacts contacts(32);
  ContactSolver solver;
  ModeForces forces;
  int redundant = 0, compared = 0;
  for (int run = 0; run < 300; ++run) {
    const int n = contacts.integer(1, 4), nv = contacts.integer(2, 10);
    const ContactProblem problem = contacts.problem(n, 0, nv, 0.5, run % 2 ? 1.0 : 0.0);
    const ContactSolution found = solver.solve(problem);
    if (found.status != ContactStatus::Solved || !found.degenerate.empty())
      continue;
    const int count = problem.count();
    // D stays; φ moves within its range, and μ where that does not change the shares of redundant contacts (see below).
    const double muRate = found.redundant ? 0.0 : 0.1;
    const Eigen::VectorXd psi = problem.delassus.map() * contacts.matrix(count, 1);
    const auto at = [&](double h) {
      ContactProblem moved = problem;
      for (int r = 0; r < count; ++r)
        moved.bias[r] += h * psi(r);
      for (double &mu : moved.friction)
        mu += muRate * h;
      return moved;
    };
    const double h = 1e-5;
    const ContactProblem plus = at(h), minus = at(-h);
    ASSERT_TRUE(forces.start(problem, found.mode));
    if (!forces.evaluate(plus))
      continue;
    const std::vector<double> after(forces.forces().begin(), forces.forces().end());
    ASSERT_TRUE(forces.evaluate(minus));
    const std::vector<double> before(forces.forces().begin(), forces.forces().end());
    ASSERT_TRUE(forces.evaluate(problem));
    std::vector<double> limitRate(n), rate(count), accelerationRate(psi.begin(), psi.end());
    for (int j = 0; j < n; ++j)
      limitRate[j] = muRate * forces.forces()[j];
    forces.forceRates(accelerationRate, limitRate, rate);
    redundant += forces.redundant() ? 1 : 0;
    ++compared;
    for (int r = 0; r < count; ++r)
      ASSERT_NEAR(rate[r], (after[r] - before[r]) / (2 * h), 2e-4 * (1 + std::abs(rate[r]))) << "run " << run << " row " << r;
  }
  EXPECT_GT(redundant, 10);
  EXPECT_GT(compared, 100);
}

// Contacts with all of J, the force and the coefficients changing along h, of slips of one or two components some of which stick. All rows
// have forces that hold them at zero, so that they stay consistent.
struct MovingContacts {
  ContactProblem begin;
  ContactMode mode;
  Eigen::MatrixXd rows, rowRate;
  Eigen::VectorXd force, forceRate;
  std::vector<double> frictionRate;

  MovingContacts(RandomContacts &contacts, int n, int components, int velocities) {
    const int m = n * components;
    begin.resize(n, m);
    mode = modeOf(std::vector<std::uint8_t>(n, 1), std::vector<std::int8_t>(m, 0));
    rows = contacts.matrix(n + m, velocities);
    rowRate = contacts.matrix(n + m, velocities);
    frictionRate.assign(m, 0.0);
    Eigen::VectorXd held(n + m);
    for (int i = 0; i < n; ++i) {
      held[i] = contacts.uniform(1, 3);
      const bool slips = contacts.uniform(0, 1) < 0.5;
      for (int j = i * components; j < (i + 1) * components; ++j) {
        const bool isAcross = slips && j > i * components;
        begin.owner[j] = i;
        begin.partner[j] = components == 2 ? j ^ 1 : -1;
        begin.friction[j] = isAcross ? 0 : slips ? contacts.uniform(0.1, 0.6) : 3;
        begin.slipSign[j] = mode.slip[j] = slips ? 1 : 0;
        frictionRate[j] = isAcross ? 0 : contacts.uniform(-1, 1);
        held[n + j] = slips ? -begin.friction[j] * held[i] : contacts.uniform(-0.3, 0.3);
      }
    }
    force = -rows.transpose() * held;
    forceRate = contacts.matrix(velocities, 1);
  }
  [[nodiscard]] ContactProblem at(double h) const {
    ContactProblem problem = begin;
    const Eigen::MatrixXd moved = rows + h * rowRate;
    problem.delassus.map() = moved * moved.transpose();
    Eigen::Map<Eigen::VectorXd>(problem.bias.data(), moved.rows()) = moved * (force + h * forceRate);
    for (int j = 0; j < problem.tangentCount; ++j)
      problem.friction[j] += h * frictionRate[j];
    return problem;
  }
  [[nodiscard]] Eigen::VectorXd delassusRate(std::span<const double> times) const {
    const Eigen::Map<const Eigen::VectorXd> x(times.data(), rows.rows());
    return rowRate * (rows.transpose() * x) + rows * (rowRate.transpose() * x);
  }
};

TEST(ModeForces, SharesOfRedundantRowsFollowTheProblem) {
  RandomContacts contacts(34);
  ModeForces forces;
  int compared[] = {0, 0}, saturated = 0;
  for (int run = 0; run < 600; ++run) {
    const int components = 1 + run % 2, n = contacts.integer(3, 5);
    const MovingContacts moving(contacts, n, components, contacts.integer(2, n - 1));
    const ContactProblem problem = moving.at(0);
    if (!forces.start(problem, moving.mode) || !forces.redundant() || !forces.sharesAreSmooth())
      continue;
    // Of order 4, with the limits that are saturated at h = 0.
    const double h = 1e-4;
    const auto at = [&](double place) {
      const ContactProblem moved = moving.at(place);
      EXPECT_TRUE(forces.evaluate(moved)) << "run " << run;
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(forces.forces().data(), problem.count()));
    };
    const Eigen::VectorXd expected = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    if (expected.lpNorm<Eigen::Infinity>() > 100)
      continue;  // nearly singular
    ASSERT_TRUE(forces.evaluate(problem));
    const Eigen::VectorXd accelerationRate =
        moving.delassusRate(forces.forces()) + moving.rowRate * moving.force + moving.rows * moving.forceRate;
    const Eigen::VectorXd multiplierRate = moving.delassusRate(forces.shareMultipliers());
    std::vector<double> limitRate(problem.tangentCount), rate(problem.count());
    for (int j = 0; j < problem.tangentCount; ++j)
      limitRate[j] = moving.frictionRate[j] * forces.forces()[problem.owner[j]];
    const ShareRates shares = {multiplierRate.data(), moving.frictionRate.data()};
    forces.forceRates({accelerationRate.data(), static_cast<std::size_t>(accelerationRate.size())}, limitRate, rate, &shares);
    ++compared[components - 1];
    saturated += std::any_of(forces.margins().begin(), forces.margins().end(), [](const ModeMargin &margin) { return margin.multiplier; });
    for (int r = 0; r < problem.count(); ++r)
      ASSERT_NEAR(rate[r], expected[r], 1e-7 * (1 + expected.lpNorm<Eigen::Infinity>())) << "run " << run << " row " << r;
  }
  EXPECT_GT(compared[0], 100);
  EXPECT_GT(compared[1], 50);
  EXPECT_GT(saturated, 20);
}

// A box on two sticking corners is pulled harder and harder: first the least-norm force touches a cone and is chosen again, then the set
// of forces is empty and the mode ends: where the pull is μ m g.
TEST(ModeForces, RedundantModeEndsWhenItsSetIsEmpty) {
  const auto box = body(1, 0.1, 0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  const auto at = [&](double pull) {
    // Pulled high up: the left corner is unloaded.
    const Eigen::Vector3d force(pull, -gravity, 0.1 * pull);
    const Eigen::VectorXd free = box.jacobian() * box.mass.ldlt().solve(force);
    return accelerationProblem(box, free, {0, 0});
  };
  ModeForces forces;
  ContactProblem problem = at(0);
  ASSERT_TRUE(forces.start(problem, modeOf({1, 1}, {0, 0})));
  ASSERT_TRUE(forces.redundant());
  int rechosen = 0;
  double pull = 0, end = -1;
  while (end < 0 && pull < 10) {
    double step = 0.5;
    problem = at(pull + step);
    ASSERT_TRUE(forces.evaluate(problem));
    int crossed = -1;
    for (std::size_t k = 0; k < forces.margins().size(); ++k)
      if (forces.marginValues()[k] < 0)
        crossed = static_cast<int>(k);
    if (crossed < 0) {
      pull += step;
      continue;
    }
    // Bisection for the first margin that vanishes.
    double low = pull, high = pull + step;
    for (int iteration = 0; iteration < 60; ++iteration) {
      const double middle = 0.5 * (low + high);
      problem = at(middle);
      ASSERT_TRUE(forces.evaluate(problem));
      bool negative = false;
      for (std::size_t k = 0; k < forces.margins().size(); ++k)
        if (forces.marginValues()[k] < 0) {
          negative = true;
          crossed = static_cast<int>(k);
        }
      (negative ? high : low) = middle;
    }
    pull = high;
    problem = at(pull);
    ASSERT_TRUE(forces.evaluate(problem));
    if (forces.cross(crossed) == MarginOutcome::ModeEnds)
      end = pull;
    else
      ++rechosen;
  }
  EXPECT_EQ(rechosen, 1);
  EXPECT_NEAR(end, 0.5 * gravity, 1e-12);
}

// Four feet of a table that is pulled and turned harder and harder: the least forces within all cones, followed from point to point, are
// those that a mode begins with there. Some feet reach their limit on the way.
TEST(ModeForces, FollowsTheLeastForcesWithinCones) {
  const double friction = 0.5;
  const test::SpatialBody table = test::spatialBody(2, Eigen::Vector3d(0.3, 0.3, 0.4).asDiagonal(),
                                                    {{0.5, 0.4, -0.5}, {-0.5, 0.4, -0.5}, {-0.5, -0.4, -0.5}, {0.5, -0.4, -0.5}});
  const auto at = [&](double pull) {
    ContactProblem problem;
    problem.resize(4, 8);
    problem.delassus.map() = table.rows * table.mass.inverse() * table.rows.transpose();
    Eigen::VectorXd force(6);
    force << 3 * pull, 4 * pull, -20, 0, 0.5 * pull, 0.8 * pull;
    Eigen::Map<Eigen::VectorXd>(problem.bias.data(), 12) = table.rows * table.mass.inverse() * force;
    for (int j = 0; j < 8; ++j) {
      problem.owner[j] = j / 2;
      problem.partner[j] = j ^ 1;
      problem.friction[j] = friction;
    }
    return problem;
  };
  const ContactMode mode = modeOf({1, 1, 1, 1}, std::vector<std::int8_t>(8, 0));
  ModeForces forces, fresh;
  double pull = 0;
  ContactProblem problem = at(pull);
  // Up to where the least forces of all leave a cone.
  while (forces.start(problem = at(pull += 0.01), mode) && forces.margins().size() > 1 && pull < 5) {
  }
  ASSERT_LT(pull, 5);
  int compared = 0;
  for (ContactProblem begin = at(pull); fresh.start(begin, mode); begin = at(pull), ++compared) {
    problem = begin;
    ASSERT_TRUE(forces.evaluate(problem));
    for (int r = 0; r < 12; ++r)
      EXPECT_NEAR(forces.forces()[r], fresh.forces()[r], 1e-10) << r << " at " << pull;
    for (int i = 0; i < 4; ++i)
      EXPECT_LE(std::hypot(forces.forces()[4 + 2 * i], forces.forces()[5 + 2 * i]), friction * forces.forces()[i] + 1e-10);
    EXPECT_NEAR(forces.marginValues()[0], fresh.marginValues()[0], 1e-5 * fresh.marginValues()[0] + 1e-12);
    pull += 0.003;
  }
  EXPECT_GT(compared, 10);
}

TEST(ModeForces, ContradictoryRedundantRowsAreRefused) {
  ContactProblem problem;  // two contacts on one freedom that want different accelerations
  problem.resize(2, 0);
  problem.delassus.map() << 1, 1, 1, 1;
  problem.bias = {-1, -2};
  ModeForces forces;
  EXPECT_FALSE(forces.start(problem, modeOf({1, 1}, {})));
}

// Rows that depend on each other where the mode begins need not do so later: what one of them cannot follow ends the mode.
TEST(ModeForces, RedundantRowsThatBeginToContradictEndTheMode) {
  ContactProblem problem;
  problem.resize(2, 0);
  problem.delassus.map() << 1, 1, 1, 1;
  problem.bias = {-1, -1};
  ModeForces forces;
  ASSERT_TRUE(forces.start(problem, modeOf({1, 1}, {})));
  ASSERT_EQ(forces.margins().size(), 3U);
  EXPECT_GT(forces.marginValues()[2], 0.5);
  problem.bias[1] = -1 - 1e-12;
  ASSERT_TRUE(forces.evaluate(problem));
  EXPECT_GT(forces.marginValues()[2], 0.5);
  problem.bias[1] = -1 - 1e-7;
  ASSERT_TRUE(forces.evaluate(problem));
  EXPECT_LT(forces.marginValues()[2], 0);
  EXPECT_EQ(forces.cross(2), MarginOutcome::ModeEnds);
}

}  // namespace
}  // namespace tf::runtime
