#include "runtime/contact/dense_kernels.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tf::runtime {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Symmetric, positive definite; rows padded.
RowMajor padded(const Eigen::MatrixXd &matrix) {
  RowMajor result = RowMajor::Zero(matrix.rows(), paddedToLanes(static_cast<int>(matrix.cols())));
  result.leftCols(matrix.cols()) = matrix;
  return result;
}

TEST(DenseKernels, DotIsTheSumOfProducts) {
  for (int n = 0; n <= 40; ++n) {
    const Eigen::VectorXd a = Eigen::VectorXd::Random(n), b = Eigen::VectorXd::Random(n);
    EXPECT_NEAR(denseDot(a.data(), b.data(), n), a.dot(b), 1e-14 * (n + 1)) << n;
  }
}

// To the bit: one product after the other, in any width.
TEST(DenseKernels, AddsColumnsOneAfterTheOther) {
  for (int rows = 0; rows <= 80; ++rows)
    for (const int columns : {0, 1, 7, 30})
      for (const double factor : {1.0, -1.0}) {
        const Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(rows, columns);
        const Eigen::VectorXd x = Eigen::VectorXd::Random(columns), before = Eigen::VectorXd::Random(rows + 1);
        Eigen::VectorXd y = before, expected = before;
        addColumns(matrix.data(), rows, columns, factor, x.data(), y.data());
        for (int k = 0; k < columns; ++k)
          for (int i = 0; i < rows; ++i)
            expected[i] += factor * x[k] * matrix(i, k);
        EXPECT_EQ(y, expected) << rows << " × " << columns;
      }
}

TEST(DenseKernels, FactorsAndSolvesEverySize) {
  for (int n = 1; n <= 40; ++n) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd mass = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
    RowMajor factor = padded(mass);
    const auto stride = static_cast<int>(factor.cols());
    std::vector<double> inverse(n), work(4 * static_cast<std::size_t>(stride));
    ASSERT_EQ(factoriseDense(factor.data(), n, stride, 1e-14, inverse.data(), work.data()), -1);
    Eigen::MatrixXd L = Eigen::MatrixXd::Identity(n, n);
    L.triangularView<Eigen::StrictlyLower>() = factor.leftCols(n);
    const Eigen::VectorXd diagonal = Eigen::Map<Eigen::VectorXd>(inverse.data(), n).cwiseInverse();
    EXPECT_LT((L * diagonal.asDiagonal() * L.transpose() - mass).norm(), 1e-13 * n * mass.norm()) << n;

    // Rows of L from `first` on only, and rows that begin in the middle.
    const int begin = n / 3;
    std::vector<std::ptrdiff_t> start(n);
    std::vector<int> first(n);
    Eigen::MatrixXd banded = Eigen::MatrixXd::Identity(n, n);
    for (int i = 0; i < n; ++i) {
      start[i] = static_cast<std::ptrdiff_t>(i) * stride;
      first[i] = std::max(begin, i - 5);
      for (int k = first[i]; k < i; ++k)
        banded(i, k) = L(i, k);
    }
    RowMajor right = RowMajor::Random(n - begin, paddedToLanes(n / 2 + 1));
    right.topLeftCorner((n - begin) / 2, std::min<Eigen::Index>(right.cols(), panelLanes + 3)).setZero();
    RowMajor z = right;
    forwardPanel(factor.data(), start.data(), first.data(), begin, n, static_cast<int>(z.cols()), z.data());
    EXPECT_LT((banded.bottomRightCorner(n - begin, n - begin) * z - right).norm(), 1e-13 * n * z.norm()) << n;
  }
}

TEST(DenseKernels, FindsThePivotThatIsNotPositive) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(20, 20);
  matrix(13, 12) = matrix(12, 13) = 1;
  RowMajor factor = padded(matrix);
  std::vector<double> inverse(20), work(4 * static_cast<std::size_t>(factor.cols()));
  EXPECT_EQ(factoriseDense(factor.data(), 20, static_cast<int>(factor.cols()), 1e-14, inverse.data(), work.data()), 13);
}

TEST(DenseKernels, MultipliesPanels) {
  for (int rows = 1; rows <= 30; rows += 3) {
    const int stride = paddedToLanes(rows);
    RowMajor z = RowMajor::Random(rows + 7, stride);
    z.topLeftCorner(rows, std::min(stride, panelLanes + 3)).setZero();
    RowMajor product(stride, stride);
    multiplyPanels(z.data(), z.data(), rows + 7, stride, product.data());
    const Eigen::MatrixXd expected = z.transpose() * z;
    for (int i = 0; i < stride; ++i)
      EXPECT_LT((product.row(i).head(i + 1) - expected.row(i).head(i + 1)).norm(), 1e-13 * (rows + 7)) << rows;
  }
}

TEST(DenseKernels, ReflectsSeveralColumnsAsOneByOne) {
  for (int rows = 8; rows <= 40; ++rows) {
    Eigen::MatrixXd single = Eigen::MatrixXd::Random(rows, 8), together = single;
    Eigen::VectorXd diagonal(8), scale(8), cross(8), other(8);
    for (int c = 0; c < 8; ++c)
      ASSERT_TRUE(reflectColumn(single.data(), rows, c, 1e-12, scale.data(), cross.data(), diagonal[c]));
    for (int c = 0; c < 8; ++c) {
      const int from = c / reflectionWidth * reflectionWidth;
      if (c == from)
        reflectColumns(together.data(), rows, c, scale.data(), cross.data());
      ASSERT_TRUE(reflectColumn(together.data(), rows, c, 1e-12, scale.data(), cross.data(), other[c], from));
    }
    EXPECT_EQ(single, together) << rows;
    EXPECT_EQ(diagonal, other) << rows;
  }
}

TEST(DenseKernels, ReflectsColumnsOntoATriangle) {
  for (int rows = 1; rows <= 30; ++rows) {
    const int columns = (rows + 1) / 2;
    const Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(rows, columns);
    Eigen::MatrixXd factor = matrix;
    Eigen::VectorXd diagonal(columns), scale(columns), cross(columns);
    for (int c = 0; c < columns; ++c)
      ASSERT_TRUE(reflectColumn(factor.data(), rows, c, 1e-12, scale.data(), cross.data(), diagonal[c]));
    for (int c = 0; c < columns; ++c) {
      Eigen::VectorXd column = Eigen::VectorXd::Zero(rows);
      column.head(c) = factor.col(c).head(c);
      column[c] = diagonal[c];
      applyReflections(factor.data(), rows, columns, scale.data(), cross.data(), column.data());
      EXPECT_LT((column - matrix.col(c)).norm(), 1e-13) << rows;
    }
  }
  Eigen::MatrixXd dependent = Eigen::MatrixXd::Random(10, 3);
  dependent.col(2) = dependent.col(0) - 2 * dependent.col(1);
  Eigen::VectorXd diagonal(3), scale(3), cross(3);
  EXPECT_TRUE(reflectColumn(dependent.data(), 10, 0, 1e-12, scale.data(), cross.data(), diagonal[0]));
  EXPECT_TRUE(reflectColumn(dependent.data(), 10, 1, 1e-12, scale.data(), cross.data(), diagonal[1]));
  EXPECT_FALSE(reflectColumn(dependent.data(), 10, 2, 1e-12, scale.data(), cross.data(), diagonal[2]));
}

}  // namespace
}  // namespace tf::runtime
