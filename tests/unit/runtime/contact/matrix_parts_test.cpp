#include "runtime/contact/matrix_parts.h"

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

using ::testing::ElementsAre;

TEST(MatrixParts, EntriesOnEitherSideCouple) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(6, 6);
  matrix(4, 0) = 1e-300;  // 0 – 4 – 2
  matrix(2, 4) = -1;
  matrix(5, 1) = 3;
  matrix(3, 3) = 0;
  MatrixParts parts;
  parts.find(matrix.data(), 6);
  ASSERT_EQ(parts.count(), 3U);
  EXPECT_THAT(parts.rows(0), ElementsAre(0, 2, 4));
  EXPECT_THAT(parts.rows(1), ElementsAre(1, 5));
  EXPECT_THAT(parts.rows(2), ElementsAre(3));
  const Eigen::MatrixXd full = Eigen::MatrixXd::Ones(3, 3);
  parts.find(full.data(), 3);
  ASSERT_EQ(parts.count(), 1U);
  EXPECT_THAT(parts.rows(0), ElementsAre(0, 1, 2));
  parts.find(nullptr, 0);
  EXPECT_EQ(parts.count(), 0U);
}

}  // namespace
}  // namespace tf::runtime
