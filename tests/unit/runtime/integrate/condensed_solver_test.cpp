#include "runtime/integrate/condensed_solver.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>

namespace tf::runtime {
namespace {

// Of a system with three coordinates, their velocities and two other states, with the step γ.
class CondensedSolver : public testing::Test {
public:
  CondensedSolver() {
    SUNContext_Create(nullptr, &context);
    matrix = SUNDenseMatrix(size, size, context);
    right = N_VNew_Serial(size, context);
    solution = N_VNew_Serial(size, context);
    solver = makeCondensedSolver(coordinates, size, context);
  }
  ~CondensedSolver() override {
    SUNLinSolFree(solver);
    N_VDestroy(solution);
    N_VDestroy(right);
    SUNMatDestroy(matrix);
    SUNContext_Free(&context);
  }

protected:
  static constexpr int coordinates = 3, size = 8;
  static constexpr double gamma = 0.3;

  // I − γ J with q' = v, and other rows of J in [−1, 1].
  static Eigen::MatrixXd implicitMatrix() {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Random(size, size);
    jacobian.topRows(coordinates).setZero();
    jacobian.block(0, coordinates, coordinates, coordinates).setIdentity();
    return Eigen::MatrixXd::Identity(size, size) - gamma * jacobian;
  }
  int setUp(const Eigen::MatrixXd &a) {
    std::copy_n(a.data(), a.size(), SUNDenseMatrix_Data(matrix));
    return SUNLinSolSetup(solver, matrix);
  }

  SUNContext context = nullptr;
  SUNMatrix matrix = nullptr;
  N_Vector right = nullptr, solution = nullptr;
  SUNLinearSolver solver = nullptr;
};

TEST_F(CondensedSolver, SolvesAsWithTheWholeMatrix) {
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::MatrixXd a = implicitMatrix();
    const Eigen::VectorXd b = Eigen::VectorXd::Random(size), expected = a.fullPivLu().solve(b);
    ASSERT_EQ(setUp(a), SUNLS_SUCCESS);
    std::copy_n(b.data(), size, N_VGetArrayPointer(right));
    ASSERT_EQ(SUNLinSolSolve(solver, matrix, solution, right, 0), SUNLS_SUCCESS);
    for (int i = 0; i < size; ++i)
      EXPECT_NEAR(N_VGetArrayPointer(solution)[i], expected[i], 1e-12) << i;
  }
}

TEST_F(CondensedSolver, TellsThatTheMatrixIsSingular) {
  Eigen::MatrixXd a = implicitMatrix();
  a.row(size - 1).setZero();
  EXPECT_NE(setUp(a), SUNLS_SUCCESS);
}

}  // namespace
}  // namespace tf::runtime
