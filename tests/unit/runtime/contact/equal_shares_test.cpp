#include "runtime/contact/equal_shares.h"
#include "runtime/contact/least_norm.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace tf::runtime {
namespace {

// D of rows of which some are equal; `kind` of a row: the row of the regular matrix that it is.
class EqualRows {
public:
  EqualRows(int kinds, std::vector<int> kind, unsigned seed) : kind_(std::move(kind)), random_(seed) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(kinds, kinds, [this] { return uniform_(random_); });
    const Eigen::MatrixXd regular = root * root.transpose() + Eigen::MatrixXd::Identity(kinds, kinds);
    delassus.resize(count(), count());
    for (int j = 0; j < count(); ++j)
      for (int i = 0; i < count(); ++i)
        delassus(i, j) = regular(kind_[i], kind_[j]);
    rows.resize(kind_.size());
    std::iota(rows.begin(), rows.end(), 0);
  }
  [[nodiscard]] int count() const { return static_cast<int>(kind_.size()); }
  double number() { return uniform_(random_); }

  DenseMatrix delassus;
  std::vector<int> rows;

private:
  std::vector<int> kind_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST(EqualShares, FindsTheSets) {
  EqualRows problem(3, {0, 1, 0, 2, 1, 0}, 1);
  EqualShares shares;
  const std::vector<std::uint8_t> none(6, 0);
  ASSERT_TRUE(shares.choose(problem.delassus, problem.rows, none, 3));
  EXPECT_EQ(shares.set(), (std::vector<int>{0, 1, 0, 2, 1, 0}));
  EXPECT_EQ(shares.sample(2), 3);
  EXPECT_DOUBLE_EQ(shares.root(0) * shares.root(0), 3);
  EXPECT_FALSE(shares.choose(problem.delassus, problem.rows, none, 2));
  EXPECT_FALSE(shares.choose(problem.delassus, problem.rows, none, 4));
  ASSERT_TRUE(shares.choose(problem.delassus, problem.rows, {0, 0, 1, 0, 0, 0}, 4));
  EXPECT_EQ(shares.set(), (std::vector<int>{0, 1, 2, 3, 1, 0}));
  ASSERT_TRUE(shares.choose(problem.delassus, {4, 1, 3}, {0, 0, 0}, 2));
  EXPECT_EQ(shares.set(), (std::vector<int>{0, 0, 1}));
}

// One equation for each kind of rows and, of an unknown that is alone, a value.
TEST(EqualShares, AreThoseOfTheLeastNorm) {
  const std::vector<int> kind = {0, 1, 0, 2, 1, 0, 3, 3, 2, 4}, equations = {0, 1, 3, 6, 9};
  for (unsigned run = 0; run < 20; ++run) {
    EqualRows problem(5, kind, run);
    const int n = problem.count(), constraints = static_cast<int>(equations.size()) + 1, alone = 5;
    std::vector<std::uint8_t> isAlone(kind.size(), 0);
    isAlone[alone] = 1;
    EqualShares shares;
    ASSERT_TRUE(shares.choose(problem.delassus, problem.rows, isAlone, constraints));
    LeastNorm expected;
    expected.resize(n, constraints, 0);
    for (int c = 0; c < constraints; ++c) {
      Eigen::VectorXd normal = Eigen::VectorXd::Unit(n, alone);
      if (c + 1 < constraints)
        normal = problem.delassus.map().col(equations[c]).normalized();
      std::copy_n(normal.data(), n, expected.normal(c));
      expected.bound(c) = shares.bound(c) = problem.number();
      for (int s = 0; s < constraints; ++s)
        shares.normal(c)[s] = normal[shares.sample(s)] * shares.root(s);
    }
    ASSERT_EQ(expected.solve(1e-12, 1e-9), LeastNorm::Status::Solved);
    ASSERT_TRUE(shares.solve(1e-13));
    for (int i = 0; i < n; ++i)
      EXPECT_NEAR(shares.share(shares.set()[i]), expected.point()[i], 1e-11) << "run " << run << " unknown " << i;
    for (int c = 0; c < constraints; ++c)
      EXPECT_NEAR(shares.multipliers()[c], expected.multipliers()[c], 1e-10) << "run " << run << " constraint " << c;
  }
}

TEST(EqualShares, RefusesDependentConstraints) {
  EqualRows problem(2, {0, 1, 0}, 3);
  EqualShares shares;
  ASSERT_TRUE(shares.choose(problem.delassus, problem.rows, {0, 0, 0}, 2));
  for (int c = 0; c < 2; ++c)
    shares.normal(c)[0] = shares.normal(c)[1] = shares.bound(c) = 1;
  EXPECT_FALSE(shares.solve(1e-13));
}

}  // namespace
}  // namespace tf::runtime
