#include "runtime/integrate/condensed_solver.h"

#include <sunmatrix/sunmatrix_dense.h>

#include <Eigen/Dense>

namespace tf::runtime {

namespace {

// A = ((1, U), (C, R)), U = (diag(u), 0): S = R − C U.
struct Condensed {
  int coordinates, rest;
  Eigen::VectorXd u, reduced;
  Eigen::MatrixXd coupling, schur;  // C, S
  Eigen::PartialPivLU<Eigen::MatrixXd> factor;

  Condensed(int coordinateCount, int size)
      : coordinates(coordinateCount), rest(size - coordinateCount), u(coordinates), reduced(rest), coupling(rest, coordinates),
        factor(rest) {}
};

Condensed &contentOf(SUNLinearSolver solver) { return *static_cast<Condensed *>(solver->content); }

SUNLinearSolver_Type typeOf(SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; }

int factorise(SUNLinearSolver solver, SUNMatrix matrix) {
  Condensed &c = contentOf(solver);
  const Eigen::Index n = c.coordinates + c.rest;
  const Eigen::Map<const Eigen::MatrixXd> a(SUNDenseMatrix_Data(matrix), n, n);
  c.u = a.topRightCorner(c.coordinates, c.rest).diagonal();
  c.coupling = a.bottomLeftCorner(c.rest, c.coordinates);
  c.schur = a.bottomRightCorner(c.rest, c.rest);
  c.schur.leftCols(c.coordinates).noalias() -= c.coupling * c.u.asDiagonal();
  c.factor.compute(c.schur);
  const auto pivots = c.factor.matrixLU().diagonal().array();
  return (pivots != 0 && pivots.isFinite()).all() ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL;
}

int solve(SUNLinearSolver solver, SUNMatrix /*matrix*/, N_Vector x, N_Vector b, realtype /*tolerance*/) {
  Condensed &c = contentOf(solver);
  const Eigen::Index n = c.coordinates + c.rest;
  const Eigen::Map<const Eigen::VectorXd> right(N_VGetArrayPointer(b), n);
  Eigen::Map<Eigen::VectorXd> solution(N_VGetArrayPointer(x), n);
  c.reduced = right.tail(c.rest);
  c.reduced.noalias() -= c.coupling * right.head(c.coordinates);
  solution.tail(c.rest) = c.factor.solve(c.reduced);
  solution.head(c.coordinates) = right.head(c.coordinates) - c.u.cwiseProduct(solution.segment(c.coordinates, c.coordinates));
  return SUNLS_SUCCESS;
}

int release(SUNLinearSolver solver) {
  delete &contentOf(solver);
  SUNLinSolFreeEmpty(solver);
  return SUNLS_SUCCESS;
}

}  // namespace

SUNLinearSolver makeCondensedSolver(int coordinates, int size, SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  if (solver == nullptr)
    return nullptr;
  solver->ops->gettype = typeOf;
  solver->ops->setup = factorise;
  solver->ops->solve = solve;
  solver->ops->free = release;
  solver->content = new Condensed(coordinates, size);
  return solver;
}

}  // namespace tf::runtime
