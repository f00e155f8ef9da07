// The null space of a matrix A by the factorisation of its transpose (Golub and Van Loan, Matrix Computations, section 5.4.2).
#pragma once

#include <Eigen/Dense>

namespace tf::runtime {

// An orthonormal basis, columns − rank of A in number, into the columns of `kernel`; `transposed` is the factorisation of Aᵀ.
inline void findNullSpace(const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> &transposed, Eigen::MatrixXd &kernel) {
  const Eigen::Index size = transposed.rows(), count = size - transposed.rank();
  kernel.setZero(size, count);
  kernel.bottomRows(count).setIdentity();
  kernel.applyOnTheLeft(transposed.householderQ());
}

}  // namespace tf::runtime
