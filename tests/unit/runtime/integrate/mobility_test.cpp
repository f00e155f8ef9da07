#include "runtime/integrate/mobility.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <limits>

namespace tf::runtime {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct System {
  RowMajor mass, constraints;
  Eigen::VectorXd force, bias;
};

System randomSystem(int velocities, int rows) {
  const RowMajor root = RowMajor::Random(velocities, velocities);
  return {root * root.transpose() + RowMajor::Identity(velocities, velocities), RowMajor::Random(rows, velocities),
          Eigen::VectorXd::Random(velocities), Eigen::VectorXd::Random(rows)};
}

// [M −Hᵀ; H 0] (a, ν) = (f, −bias), least norm where it is not unique.
Eigen::VectorXd saddlePoint(const System &system) {
  const Eigen::Index n = system.mass.rows(), m = system.constraints.rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
  matrix.topLeftCorner(n, n) = system.mass;
  matrix.topRightCorner(n, m) = -system.constraints.transpose();
  matrix.bottomLeftCorner(m, n) = system.constraints;
  Eigen::VectorXd right(n + m);
  right << system.force, -system.bias;
  return matrix.completeOrthogonalDecomposition().solve(right);
}

bool setConstraints(Mobility &mobility, const System &system) {
  const Eigen::VectorXd shares = Eigen::VectorXd::Ones(system.constraints.rows());
  return mobility.setConstraints(system.constraints.data(), shares.data());
}

void load(Mobility &mobility, const System &system) {
  ASSERT_TRUE(mobility.setMass(system.mass.data()));
  ASSERT_TRUE(setConstraints(mobility, system));
}

TEST(Mobility, AccelerationsAndMultipliersSolveTheSaddlePointSystem) {
  const System system = randomSystem(6, 3);
  Mobility mobility(MassMatrix(6), 3);
  load(mobility, system);
  EXPECT_EQ(mobility.rank(), 3);
  Eigen::VectorXd acceleration(6), multipliers(3);
  mobility.accelerate(system.force.data(), system.bias.data(), acceleration.data());
  mobility.multipliers(system.force.data(), system.bias.data(), multipliers.data());
  const Eigen::VectorXd expected = saddlePoint(system);
  EXPECT_LT((acceleration - expected.head(6)).norm(), 1e-12);
  EXPECT_LT((multipliers - expected.tail(3)).norm(), 1e-12);
}

TEST(Mobility, ImpulsesDoNotMoveAgainstConstraints) {
  const System system = randomSystem(5, 2);
  Mobility mobility(MassMatrix(5), 2);
  load(mobility, system);
  Eigen::VectorXd x = system.force;
  mobility.apply(x.data(), x.data());
  EXPECT_LT((system.constraints * x).norm(), 1e-13);
  const RowMajor inverse = system.mass.inverse();
  const RowMajor response = inverse * system.constraints.transpose();
  const RowMajor expected = inverse - response * (system.constraints * response).inverse() * response.transpose();
  EXPECT_LT((x - expected * system.force).norm(), 1e-12);
}

TEST(Mobility, RedundantRowsAreFoundAndChangeNothing) {
  System system = randomSystem(6, 2);
  Mobility independent(MassMatrix(6), 2);
  load(independent, system);
  Eigen::VectorXd expected(6);
  independent.accelerate(system.force.data(), system.bias.data(), expected.data());

  System redundant = system;
  redundant.constraints.resize(3, 6);
  redundant.constraints << system.constraints.row(0), 1e3 * (system.constraints.row(0) - 2 * system.constraints.row(1)),
      system.constraints.row(1);
  redundant.bias.resize(3);
  redundant.bias << system.bias[0], 1e3 * (system.bias[0] - 2 * system.bias[1]), system.bias[1];
  Mobility mobility(MassMatrix(6), 3);
  load(mobility, redundant);
  EXPECT_EQ(mobility.rank(), 2);
  const std::vector<DependentRow> dependent = mobility.dependentRows();
  ASSERT_EQ(dependent.size(), 1U);
  EXPECT_EQ(dependent[0].row, 2);
  EXPECT_EQ(dependent[0].sources, (std::vector{0, 1}));
  Eigen::VectorXd acceleration(6), multipliers(3);
  mobility.accelerate(redundant.force.data(), redundant.bias.data(), acceleration.data());
  EXPECT_LT((acceleration - expected).norm(), 1e-10);
  mobility.multipliers(redundant.force.data(), redundant.bias.data(), multipliers.data());
  EXPECT_LT((redundant.mass * acceleration - redundant.force - redundant.constraints.transpose() * multipliers).norm(), 1e-10);
}

TEST(Mobility, ARowThatVanishesHasNoForce) {
  System system = randomSystem(4, 2);
  system.constraints.row(1).setZero();
  Mobility mobility(MassMatrix(4), 2);
  load(mobility, system);
  EXPECT_EQ(mobility.rank(), 1);
  Eigen::VectorXd multipliers(2);
  mobility.multipliers(system.force.data(), system.bias.data(), multipliers.data());
  EXPECT_EQ(multipliers[1], 0);
}

TEST(Mobility, CorrectionsAreLeastInTheMetricOfTheMass) {
  const System system = randomSystem(5, 2);
  Mobility mobility(MassMatrix(5), 2);
  load(mobility, system);
  const Eigen::VectorXd wanted = Eigen::VectorXd::Random(2);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(5);
  mobility.correct(wanted.data(), change.data());
  EXPECT_LT((system.constraints * change - wanted).norm(), 1e-13);
  // M · change is a combination of the rows of H.
  Eigen::VectorXd along = change;
  mobility.apply((system.mass * change).eval().data(), along.data());
  EXPECT_LT(along.norm(), 1e-12);
}

TEST(Mobility, RefusesRowsThatAreNotFinite) {
  System system = randomSystem(3, 1);
  system.constraints(0, 1) = std::numeric_limits<double>::quiet_NaN();
  Mobility mobility(MassMatrix(3), 1);
  ASSERT_TRUE(mobility.setMass(system.mass.data()));
  EXPECT_FALSE(setConstraints(mobility, system));
}

// Beside the positions where the third row follows from the others it contradicts them.
TEST(Mobility, ChosenRowsStandForAllBesideWhereTheyDependOnEachOther) {
  System system = randomSystem(5, 3);
  system.constraints.row(2) = system.constraints.row(0) + system.constraints.row(1);
  system.bias[2] = system.bias[0] + system.bias[1];
  Mobility mobility(MassMatrix(5), 3);
  load(mobility, system);
  EXPECT_EQ(mobility.rank(), 2);
  EXPECT_FALSE(mobility.chooseIndependent(true)) << "at the first place";
  EXPECT_TRUE(mobility.wasRedundant());
  EXPECT_FALSE(mobility.chooseIndependent(false)) << "at the same one";
  EXPECT_TRUE(mobility.chooseIndependent(true)) << "at the second one";
  Eigen::VectorXd acceleration(5), there(5), multipliers(3);
  mobility.accelerate(system.force.data(), system.bias.data(), acceleration.data());
  mobility.multipliers(system.force.data(), system.bias.data(), multipliers.data());
  const Eigen::VectorXd expected = saddlePoint(system);
  EXPECT_LT((acceleration - expected.head(5)).norm(), 1e-12);
  // Of all that make this motion, those whose rows' lengths weigh them make the least sum of squares.
  Eigen::Vector3d weights(1, 1, -1);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd row = system.constraints.row(k);
    weights[k] *= row.dot(Eigen::MatrixXd(system.mass).ldlt().solve(row));
  }
  EXPECT_NEAR(weights.dot(multipliers), 0, 1e-10);
  System beside = system;
  beside.constraints.row(2) += 1e-3 * RowMajor::Random(1, 5);
  load(mobility, beside);
  EXPECT_EQ(mobility.rank(), 2);
  mobility.accelerate(beside.force.data(), beside.bias.data(), there.data());
  EXPECT_LT((there - acceleration).norm(), 0.1);
  // Another rank: the rows have become other ones.
  beside.constraints.row(2) = RowMajor::Random(1, 5);
  load(mobility, beside);
  EXPECT_TRUE(mobility.chooseIndependent(true));
  EXPECT_EQ(mobility.rank(), 3);
}

TEST(Mobility, RowsThatDependOnEachOtherAtOnePlaceAllCount) {
  System system = randomSystem(5, 2), singular = system;
  singular.constraints.row(1) = 2 * singular.constraints.row(0);
  Mobility mobility(MassMatrix(5), 2);
  load(mobility, singular);
  EXPECT_FALSE(mobility.chooseIndependent(true));
  load(mobility, system);
  EXPECT_FALSE(mobility.chooseIndependent(true));
  EXPECT_EQ(mobility.rank(), 2);
  load(mobility, singular);
  EXPECT_FALSE(mobility.chooseIndependent(true));
  load(mobility, system);
  EXPECT_EQ(mobility.rank(), 2);
}

// Where even fewer are independent, at one place of the motion, the choice stays what it was.
TEST(Mobility, ChosenRowsStayWhereTheyDependOnEachOtherAtOnePlace) {
  System system = randomSystem(5, 3);
  system.constraints.row(2) = system.constraints.row(0) + system.constraints.row(1);
  System singular = system;
  singular.constraints.row(1) = singular.constraints.row(0);
  singular.constraints.row(2) = 2 * singular.constraints.row(0);
  Mobility mobility(MassMatrix(5), 3);
  load(mobility, system);
  mobility.chooseIndependent(true);
  ASSERT_TRUE(mobility.chooseIndependent(true));
  ASSERT_TRUE(mobility.weakestRow());
  EXPECT_GT(mobility.weakestRow()->part, 1e-3);
  load(mobility, singular);
  EXPECT_FALSE(mobility.chooseIndependent(true));
  EXPECT_EQ(mobility.rank(), 1);
  EXPECT_FALSE(mobility.weakestRow());
  load(mobility, system);
  EXPECT_FALSE(mobility.chooseIndependent(true));
  EXPECT_EQ(mobility.rank(), 2);
}

// A row of errors only is none.
TEST(Mobility, RowsThatHaveVanishedHoldNothing) {
  System system = randomSystem(4, 2);
  system.constraints.row(1) *= 1e-11;
  Mobility mobility(MassMatrix(4), 2);
  ASSERT_TRUE(mobility.setMass(system.mass.data()));
  const double shares[] = {1, 1e-11};
  ASSERT_TRUE(mobility.setConstraints(system.constraints.data(), shares));
  EXPECT_EQ(mobility.rank(), 1);
  ASSERT_EQ(mobility.dependentRows().size(), 1U);
  EXPECT_EQ(mobility.dependentRows()[0].row, 1);
  // As small as it has always been, it counts.
  ASSERT_TRUE(setConstraints(mobility, system));
  EXPECT_EQ(mobility.rank(), 2);
}

}  // namespace
}  // namespace tf::runtime
