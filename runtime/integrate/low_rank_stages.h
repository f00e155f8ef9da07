// The linear equations of Newton's method for the stages of a collocation, Z_i − h Σ_j a_ij J_j Z_j = r_i, where the Jacobians are of low
// rank, J_j = L_j R_jᵀ: with u_j = R_jᵀ Z_j they are Z_i = r_i + h Σ_j a_ij L_j u_j, of which the u_j are all that has to be solved for
// (Woodbury). What of a right-hand side is stiff is often no more than that.
#pragma once

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

class LowRankStages {
public:
  // For `size` variables and the s coefficients a_ij of each of the s stages, row by row.
  LowRankStages(int size, std::vector<double> coefficients);

  // Of all L_j and R_j, whose entries are undefined where it has changed.
  void setRank(int rank);
  // L_j and R_j [size × rank], j from 0: to be set before factorise().
  [[nodiscard]] Eigen::MatrixXd &left(int stage) { return left_[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] Eigen::MatrixXd &right(int stage) { return right_[static_cast<std::size_t>(stage)]; }
  void factorise(double h);
  // r_1, …, r_s [each of size] become Z_1, …, Z_s.
  void solve(Eigen::VectorXd &stages);

private:
  [[nodiscard]] double coefficient(int i, int j) const { return coefficients_[static_cast<std::size_t>(i) * stages_ + j]; }

  int n_, stages_;
  std::vector<double> coefficients_;
  double h_ = 0;
  Eigen::Index rank_ = 0;
  std::vector<Eigen::MatrixXd> left_, right_;
  Eigen::MatrixXd matrix_;  // 1 − h A ⊗ R_iᵀ L_j
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  Eigen::VectorXd reduced_, change_;  // u; L_j u_j
};

}  // namespace tf::runtime
