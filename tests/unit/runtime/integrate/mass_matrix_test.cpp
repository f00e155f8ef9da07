#include "runtime/integrate/mass_matrix.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tf::runtime {
namespace {

// The rows and columns of the entries below the diagonal that are not zero.
struct Structure {
  std::vector<std::int32_t> rows{0}, columns;
  explicit Structure(const Eigen::MatrixXd &mass) {
    for (Eigen::Index i = 0; i < mass.rows(); ++i) {
      for (Eigen::Index j = 0; j < i; ++j)
        if (mass(i, j) != 0)
          columns.push_back(static_cast<std::int32_t>(j));
      rows.push_back(static_cast<std::int32_t>(columns.size()));
    }
  }
  [[nodiscard]] MassMatrix matrix() const { return MassMatrix(static_cast<int>(rows.size()) - 1, rows.data(), columns.data()); }
};

// Every size that has code of its own, and some that have none.
TEST(MassMatrix, SolvesDenseSystems) {
  for (int n = 1; n <= 20; ++n) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd mass = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd right = Eigen::VectorXd::Random(n);
    MassMatrix factor(n);
    ASSERT_TRUE(factor.factorise(mass.data()));
    Eigen::VectorXd solution = right;
    factor.solve(solution.data(), solution.data());
    EXPECT_LT((mass * solution - right).norm(), 1e-12 * n) << n;
  }
}

// Of large blocks, for many right sides together as for one.
TEST(MassMatrix, FirstHalvesOfManyRowsAreThoseOfEachRow) {
  for (const int n : {8, 13, 30}) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd mass = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
    MassMatrix factor(n);
    ASSERT_TRUE(factor.factorise(mass.data()));
    ASSERT_TRUE(factor.isLarge(0));
    const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(n, 8);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> panel(n, 8);
    for (int place = 0; place < n; ++place)
      panel.row(place) = rows.row(factor.rowAt(place));
    factor.forwardPanel(0, 8, panel.data());
    for (int c = 0; c < 8; ++c) {
      Eigen::VectorXd half(n), scaled(n);
      factor.forward(0, rows.col(c).data(), half.data(), scaled.data());
      EXPECT_LT((panel.col(c) - half).norm(), 1e-12 * n);
      EXPECT_EQ(scaled[n - 1], half[n - 1] * factor.inverseAt(n - 1));
    }
  }
}

TEST(MassMatrix, SolvesDiagonalSystems) {
  const double mass[] = {2, 0, 0, 4};
  const double right[] = {1, 1};
  double solution[2];
  MassMatrix factor(2);
  ASSERT_TRUE(factor.factorise(mass));
  factor.solve(right, solution);
  EXPECT_EQ(solution[0], 0.5);
  EXPECT_EQ(solution[1], 0.25);
}

TEST(MassMatrix, NamesTheRowWithoutInertia) {
  const double singular[] = {1, 1, 1, 1};
  MassMatrix factor(2);
  EXPECT_FALSE(factor.factorise(singular));
  EXPECT_EQ(factor.failedRow(), 1);
  const double massless[] = {0, 0, 0, 1};
  EXPECT_FALSE(factor.factorise(massless));
  EXPECT_EQ(factor.failedRow(), 0);
}

// Masses between springs of inertia (tridiagonal), a cart with pendulums (first row full) in both orders, bodies apart, trees.
TEST(MassMatrix, SolvesWithinEnvelopes) {
  constexpr int n = 30;
  for (int kind = 0; kind < 5; ++kind) {
    Eigen::MatrixXd mass = 10 * Eigen::MatrixXd::Identity(n, n);
    const auto couple = [&](int i, int j) { mass(i, j) = mass(j, i) = std::sin(1.0 + i + 3 * j); };
    for (int i = 1; i < n; ++i) {
      if (kind == 0)
        couple(i, i - 1);
      else if (kind == 1)
        couple(i, 0);
      else if (kind == 2 && i < n - 1)
        couple(i, n - 1);
      else if (kind == 3 && i % 3 != 0)
        couple(i, i - i % 3);
      else if (kind == 4)
        for (int parent = (i - 1) / 2; parent > 0; parent = (parent - 1) / 2)
          couple(i, parent);
    }
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n, -1, 2);
    MassMatrix factor = Structure(mass).matrix();
    ASSERT_TRUE(factor.factorise(mass.data())) << kind;
    Eigen::VectorXd solution(n);
    factor.solve(right.data(), solution.data());
    EXPECT_LT((mass * solution - right).norm(), 1e-12) << kind;
    mass(7, 7) = -1;
    EXPECT_FALSE(factor.factorise(mass.data())) << kind;
  }
}

TEST(MassMatrix, FailsWhereTheMatrixIsNotPositiveDefiniteOrNotFinite) {
  for (const int n : {3, 9}) {
    MassMatrix factor(n);
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(n, n);
      mass(1, 1) = bad;
      EXPECT_FALSE(factor.factorise(mass.data())) << n << " " << bad;
      EXPECT_EQ(factor.failedRow(), 1);
      mass(1, 1) = 4;
      ASSERT_TRUE(factor.factorise(mass.data()));
      std::vector<double> x(static_cast<std::size_t>(n), 1.0);
      factor.solve(x.data(), x.data());
      EXPECT_EQ(x[1], 0.25);
    }
  }
}

// Blocks of one to twelve rows whose numbers are mixed: each block's half solutions give the products b M⁻¹ c of its rows.
TEST(MassMatrix, HalvesOfSolutionsGiveProducts) {
  constexpr int n = 78;
  std::vector<int> mixed(n);
  for (int k = 0; k < n; ++k)
    mixed[k] = (k * 29) % n;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
  for (int size = 1, first = 0; size <= 12; first += size++) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(size, size);
    const Eigen::MatrixXd block = root * root.transpose() + Eigen::MatrixXd::Identity(size, size);
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j)
        mass(mixed[first + i], mixed[first + j]) = block(i, j);
  }
  MassMatrix factor = Structure(mass).matrix();
  ASSERT_EQ(factor.blocks().size(), 12U);
  ASSERT_TRUE(factor.factorise(mass.data()));
  const Eigen::VectorXd b = Eigen::VectorXd::Random(n), c = Eigen::VectorXd::Random(n);
  std::vector<double> zb(n), sb(n), zc(n), sc(n);
  double product = 0;
  for (int block = 0; block < 12; ++block) {
    factor.forward(block, b.data(), zb.data(), sb.data());
    factor.forward(block, c.data(), zc.data(), sc.data());
    for (int place = factor.blocks()[block].begin; place < factor.blocks()[block].end; ++place)
      product += zb[place] * sc[place];
  }
  EXPECT_NEAR(product, b.dot(mass.ldlt().solve(c)), 1e-12 * n);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  factor.addBackward(sb.data(), x.data());
  EXPECT_LT((mass * x - b).norm(), 1e-12 * n);
  // Leading zeros in the order of elimination are seen.
  const int last = factor.blocks().back().end - 1;
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(n);
  for (int row = 0; row < n; ++row) {
    unit.setZero();
    unit[row] = 1;
    const int block = factor.blockOf(row), from = factor.forward(block, unit.data(), zb.data(), sb.data());
    EXPECT_GE(from, factor.blocks()[block].begin);
    EXPECT_LE(from, last);
    EXPECT_EQ(zb[from], 1.0);
  }
}

}  // namespace
}  // namespace tf::runtime
