#include "runtime/integrate/semiseparable_system.h"
#include "tests/unit/runtime/integrate/chain_of_rods.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace tf::runtime {
namespace {

using test::Chain;
using test::RowMajor;

Chain randomChain(bool isFree, bool isRelative, int rods, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(-3, 3);
  Chain chain{isFree, isRelative, std::vector<double>(rods)};
  for (double &a : chain.angles)
    a = angle(random);
  return chain;
}

struct System {
  RowMajor mass, rows;  // M; J of all rows
  std::vector<SemiseparableSystem::Row> listed;
  std::vector<int> unknowns;
  std::vector<SemiseparableSystem::Friction> frictions;

  void list() {
    for (Eigen::Index r = 0; r < rows.rows(); ++r) {
      int end = static_cast<int>(rows.cols());
      while (end > 0 && rows(r, end - 1) == 0)
        --end;
      listed.push_back({rows.row(r).data(), end});
    }
  }
  [[nodiscard]] Eigen::MatrixXd unknownRows() const {
    Eigen::MatrixXd J(static_cast<Eigen::Index>(unknowns.size()), rows.cols());
    for (std::size_t u = 0; u < unknowns.size(); ++u)
      J.row(static_cast<Eigen::Index>(u)) = rows.row(unknowns[u]);
    return J;
  }
  [[nodiscard]] Eigen::MatrixXd forces() const {
    Eigen::MatrixXd F = unknownRows();
    for (const auto &friction : frictions)
      F.row(friction.unknown) += friction.factor * rows.row(friction.row);
    return F;
  }
  bool factorise(SemiseparableSystem &system) const {
    return system.factorise(mass.data(), static_cast<int>(mass.rows()), listed, unknowns, frictions);
  }
};

// Nodes on the ground: the first and last ones stick, those between slide.
System onGround(const Chain &chain, const std::vector<int> &nodes) {
  System system{chain.mass(), RowMajor(static_cast<Eigen::Index>(2 * nodes.size()), chain.size()), {}, {}, {}};
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const RowMajor J = chain.jacobian(nodes[k]);
    system.rows.row(static_cast<Eigen::Index>(2 * k)) = J.row(1);
    system.rows.row(static_cast<Eigen::Index>(2 * k + 1)) = J.row(0);
  }
  for (int k = 0; k < static_cast<int>(nodes.size()); ++k) {
    const int unknown = static_cast<int>(system.unknowns.size());
    system.unknowns.push_back(2 * k);
    if (k == 0 || k + 1 == static_cast<int>(nodes.size()))
      system.unknowns.push_back(2 * k + 1);
    else
      system.frictions.push_back({unknown, 2 * k + 1, k % 2 != 0 ? 0.3 : -0.4});
  }
  system.list();
  return system;
}

void expectSolved(const System &system, SemiseparableSystem &solver, const std::string &what) {
  const Eigen::Index n = system.mass.rows(), k = static_cast<Eigen::Index>(system.unknowns.size());
  const Eigen::VectorXd force = Eigen::VectorXd::Random(n), bias = Eigen::VectorXd::Random(k);
  Eigen::VectorXd acceleration(n), forces(k);
  ASSERT_TRUE(solver.solve(force.data(), bias.data(), acceleration.data(), forces.data())) << what;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + k, n + k);
  all.topLeftCorner(n, n) = system.mass;
  all.topRightCorner(n, k) = -system.forces().transpose();
  all.bottomLeftCorner(k, n) = system.unknownRows();
  Eigen::VectorXd right(n + k);
  right << force, -bias;
  const Eigen::VectorXd expected = all.fullPivLu().solve(right);
  EXPECT_LT((acceleration - expected.head(n)).norm(), 1e-10 * expected.head(n).norm()) << what;
  EXPECT_LE((forces - expected.tail(k)).norm(), 1e-10 * expected.tail(k).norm()) << what;
  if (k == 0)
    return;
  // Both numbers of a product that may be far from 1.
  const Eigen::MatrixXd delassus = system.unknownRows() * system.mass.ldlt().solve(system.forces().transpose().eval());
  SemiseparableSystem::Determinant determinant;
  const Eigen::FullPivLU<Eigen::MatrixXd> factor(delassus);
  for (Eigen::Index i = 0; i < k; ++i)
    determinant.multiply(factor.matrixLU()(i, i));
  const auto sign = static_cast<double>(factor.permutationP().determinant() * factor.permutationQ().determinant());
  EXPECT_NEAR(solver.determinant().relativeTo(determinant) * sign, 1, 1e-6) << what;
}

TEST(SemiseparableSystem, SolvesChainsOfRodsWithContacts) {
  for (const bool isFree : {true, false})
    for (const bool isRelative : {true, false})
      for (const int rods : {8, 20, 60})
        for (unsigned seed = 0; seed < 4; ++seed) {
          const Chain chain = randomChain(isFree, isRelative, rods, seed);
          SemiseparableSystem solver;
          const std::string what =
              std::to_string(isFree) + std::to_string(isRelative) + " " + std::to_string(rods) + " rods, " + std::to_string(seed);
          const System free{chain.mass(), RowMajor(0, chain.size()), {}, {}, {}};
          ASSERT_TRUE(free.factorise(solver)) << what;
          EXPECT_EQ(solver.vectorCount(), isRelative ? 3 : 2) << what;
          expectSolved(free, solver, what);
          const System touching = onGround(chain, {2, rods / 2, rods - 1, rods});
          ASSERT_TRUE(touching.factorise(solver)) << what;
          EXPECT_EQ(solver.vectorCount(), isRelative ? 3 : 2) << what;
          expectSolved(touching, solver, what);
        }
}

// Parallel rods, whose vectors are parallel up to any place or nearly so. The end of a straight chain that hangs from a fixed point cannot
// be held along it.
TEST(SemiseparableSystem, SolvesStraightChains) {
  for (const bool isFree : {true, false})
    for (const double bend : {0.0, 1e-12, 1e-7, 1e-3}) {
      if (!isFree && bend < 1e-3)
        continue;
      Chain chain{isFree, false, std::vector<double>(30, 0.7)};
      for (int i = 0; i < 30; ++i)
        chain.angles[i] += bend * i * i;
      SemiseparableSystem solver;
      const System system = onGround(chain, {30});
      ASSERT_TRUE(system.factorise(solver)) << bend;
      expectSolved(system, solver, std::to_string(bend));
    }
}

// Of other angles, with the vectors of the same rows.
TEST(SemiseparableSystem, SolvesTheSameChainElsewhere) {
  for (const bool isFree : {true, false})
    for (const bool isRelative : {true, false}) {
      Chain chain = randomChain(isFree, isRelative, 30, 5);
      const System first = onGround(chain, {2, 15, 29, 30});
      SemiseparableSystem solver;
      ASSERT_TRUE(first.factorise(solver));
      for (const double turned : {1e-9, 0.02, 0.7, 2.0}) {
        for (int i = 0; i < 30; ++i)
          chain.angles[i] += turned * std::cos(i);
        const System system = onGround(chain, {2, 15, 29, 30});
        ASSERT_TRUE(solver.refactorise(system.mass.data(), system.listed)) << turned;
        EXPECT_EQ(solver.vectorCount(), isRelative ? 3 : 2) << turned;
        expectSolved(system, solver, std::to_string(turned));
      }
    }
}

// A row that is no sum of the vectors any more is noticed, not solved for.
// M by its products with the directions of the sample.
MassSample sampleOf(const SemiseparableSystem &solver, const RowMajor &mass) {
  MassSample sample;
  sample.choose(solver.columns(), solver.scale());
  using Directions = Eigen::Matrix<double, Eigen::Dynamic, TF_DIRECTIONS, Eigen::RowMajor>;
  const Eigen::Map<const Directions> directions(sample.directions(), mass.rows(), TF_DIRECTIONS);
  Eigen::Map<Directions>(sample.products(), mass.rows(), TF_DIRECTIONS) = mass * directions;
  sample.read();
  return sample;
}

TEST(SemiseparableSystem, SolvesWithASampleOfTheMassMatrix) {
  for (const bool isFree : {false, true})
    for (const bool isRelative : {false, true})
      for (const int rods : {12, 30, 60}) {
        const std::string what = std::to_string(rods) + (isFree ? " free" : " hung") + (isRelative ? " relative" : " absolute");
        const std::vector<int> nodes = {2, rods / 2, rods};
        System begin = onGround(randomChain(isFree, isRelative, rods, 5), nodes);
        SemiseparableSystem solver;
        ASSERT_TRUE(begin.factorise(solver)) << what;
        if (solver.columns().size() > MassSample::mostColumns)
          continue;
        Chain moved = randomChain(isFree, isRelative, rods, 5);
        for (std::size_t k = 0; k < moved.angles.size(); ++k)
          moved.angles[k] += 0.01 * std::sin(static_cast<double>(k));
        const System later = onGround(moved, nodes);
        MassSample sample = sampleOf(solver, later.mass);
        ASSERT_TRUE(solver.refactorise(sample, later.listed, 1e-9)) << what;
        ASSERT_TRUE(sample.hasDiagonal());
        for (Eigen::Index i = 0; i < later.mass.rows(); ++i)
          EXPECT_NEAR(sample.diagonal()[static_cast<std::size_t>(i)] / later.mass(i, i), 1, 1e-10) << what << ' ' << i;
        const Eigen::Index n = later.mass.rows(), unknowns = static_cast<Eigen::Index>(later.unknowns.size());
        const Eigen::VectorXd force = Eigen::VectorXd::Random(n), bias = Eigen::VectorXd::Random(unknowns);
        Eigen::VectorXd sampled(n), exact(n), forces(unknowns);
        ASSERT_TRUE(solver.solve(force.data(), bias.data(), sampled.data(), forces.data(), 1e-11)) << what;
        SemiseparableSystem whole;
        ASSERT_TRUE(later.factorise(whole)) << what;
        ASSERT_TRUE(whole.solve(force.data(), bias.data(), exact.data(), forces.data())) << what;
        EXPECT_LE((sampled - exact).norm(), 1e-7 * exact.norm()) << what;
      }
}

TEST(SemiseparableSystem, RefusesSamplesOfOtherMatrices) {
  constexpr int rods = 20;
  System system = onGround(randomChain(true, false, rods, 8), {0, rods});
  SemiseparableSystem solver;
  ASSERT_TRUE(system.factorise(solver));
  MassSample same = sampleOf(solver, system.mass);
  EXPECT_TRUE(solver.refactorise(same, system.listed, 1e-12));
  RowMajor other = system.mass;
  other(3, 9) *= 1 + 1e-6;
  other(9, 3) = other(3, 9);
  MassSample changed = sampleOf(solver, other);
  EXPECT_FALSE(solver.refactorise(changed, system.listed, 1e-9));
  const std::vector<int> few(solver.columns().begin() + 1, solver.columns().end());
  MassSample lacking;
  lacking.choose(few, solver.scale());
  lacking.read();
  EXPECT_FALSE(solver.refactorise(lacking, system.listed, 1e-9));
  other = -system.mass;
  MassSample negative = sampleOf(solver, other);
  EXPECT_FALSE(solver.refactorise(negative, system.listed, 1e-9));
}

TEST(SemiseparableSystem, NoticesThatVectorsAreMissing) {
  const Chain chain = randomChain(true, false, 20, 6);
  System system = onGround(chain, {3, 20});
  SemiseparableSystem solver;
  ASSERT_TRUE(system.factorise(solver));
  system.rows(0, 1) += 1e-3;
  const Eigen::VectorXd force = Eigen::VectorXd::Random(chain.size()), bias = Eigen::VectorXd::Random(4);
  Eigen::VectorXd acceleration(chain.size()), forces(4);
  EXPECT_FALSE(solver.refactorise(system.mass.data(), system.listed) &&
               solver.solve(force.data(), bias.data(), acceleration.data(), forces.data()));
  ASSERT_TRUE(system.factorise(solver));
  expectSolved(system, solver, "found anew");
}

// What is not linked in a row has too many vectors.
TEST(SemiseparableSystem, RefusesOtherMatrices) {
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(30, 30);
  const System system{root * root.transpose() + Eigen::MatrixXd::Identity(30, 30), RowMajor(0, 30), {}, {}, {}};
  SemiseparableSystem solver;
  EXPECT_FALSE(system.factorise(solver));
}

// Rows of a chain, and one row that is no part of it.
TEST(SemiseparableSystem, TakesRowsOfTheirOwn) {
  const Chain chain = randomChain(true, false, 20, 1);
  System system = onGround(chain, {3, 20});
  system.rows.row(1) = Eigen::VectorXd::Random(chain.size());
  system.listed.clear();
  system.list();
  SemiseparableSystem solver;
  ASSERT_TRUE(system.factorise(solver));
  EXPECT_EQ(solver.vectorCount(), 3);
  expectSolved(system, solver, "a row of its own");
}

// Two equal rows have no unique forces.
TEST(SemiseparableSystem, RefusesDependentRows) {
  const Chain chain = randomChain(true, false, 20, 2);
  System system = onGround(chain, {3, 20});
  system.rows.row(2) = system.rows.row(0);
  system.listed.clear();
  system.list();
  SemiseparableSystem solver;
  const Eigen::VectorXd force = Eigen::VectorXd::Random(chain.size()), bias = Eigen::VectorXd::Random(4);
  Eigen::VectorXd acceleration(chain.size()), forces(4);
  EXPECT_FALSE(system.factorise(solver) && solver.solve(force.data(), bias.data(), acceleration.data(), forces.data()));
}

TEST(SemiseparableSystem, RefusesNumbersThatAreNone) {
  const Chain chain = randomChain(true, false, 20, 3);
  System system = onGround(chain, {3, 20});
  system.mass(4, 2) = system.mass(2, 4) = std::nan("");
  SemiseparableSystem solver;
  EXPECT_FALSE(system.factorise(solver));
  const System sound = onGround(chain, {3, 20});
  ASSERT_TRUE(sound.factorise(solver));
  std::vector<double> force(20 + 2, 1), bias(sound.unknowns.size(), 1), acceleration(force), forces(bias);
  EXPECT_FALSE(solver.refactorise(system.mass.data(), system.listed) &&
               solver.solve(force.data(), bias.data(), acceleration.data(), forces.data()));
}

// Rows alone hold to the accuracy, whatever is left of the rest.
TEST(SemiseparableSystem, ChecksRowsAlone) {
  const Chain chain = randomChain(true, false, 30, 7);
  const System system = onGround(chain, {4, 17, 30});
  SemiseparableSystem solver;
  solver.followDeterminant(false);
  ASSERT_TRUE(system.factorise(solver));
  const Eigen::VectorXd force = Eigen::VectorXd::Zero(32),
                        bias = Eigen::VectorXd::Random(static_cast<Eigen::Index>(system.unknowns.size()));
  Eigen::VectorXd acceleration(32), forces(bias.size());
  ASSERT_TRUE(solver.solve(force.data(), bias.data(), acceleration.data(), forces.data(), 1e-10, SemiseparableSystem::Check::Rows));
  EXPECT_LT((system.unknownRows() * acceleration + bias).norm(), 1e-9 * bias.norm());
  EXPECT_LT((system.mass * acceleration - system.forces().transpose() * forces).norm(), 1e-9 * forces.norm());
}

}  // namespace
}  // namespace tf::runtime
