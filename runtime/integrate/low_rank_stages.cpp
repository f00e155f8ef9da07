#include "runtime/integrate/low_rank_stages.h"

#include <cmath>
#include <utility>

namespace tf::runtime {

LowRankStages::LowRankStages(int size, std::vector<double> coefficients)
    : n_(size), stages_(static_cast<int>(std::lround(std::sqrt(static_cast<double>(coefficients.size()))))),
      coefficients_(std::move(coefficients)), left_(static_cast<std::size_t>(stages_)), right_(static_cast<std::size_t>(stages_)) {
  setRank(0);
}

void LowRankStages::setRank(int rank) {
  rank_ = rank;
  for (std::vector<Eigen::MatrixXd> *matrices : {&left_, &right_})
    for (Eigen::MatrixXd &matrix : *matrices)
      matrix.resize(n_, rank);
}

void LowRankStages::factorise(double h) {
  h_ = h;
  if (rank_ == 0)
    return;
  matrix_.setIdentity(rank_ * stages_, rank_ * stages_);
  for (int i = 0; i < stages_; ++i)
    for (int j = 0; j < stages_; ++j)
      matrix_.block(i * rank_, j * rank_, rank_, rank_).noalias() -= h_ * coefficient(i, j) * right(i).transpose() * left(j);
  factor_.compute(matrix_);
}

void LowRankStages::solve(Eigen::VectorXd &stages) {
  if (rank_ == 0)
    return;
  reduced_.resize(rank_ * stages_);
  for (int i = 0; i < stages_; ++i)
    reduced_.segment(i * rank_, rank_).noalias() = right(i).transpose() * stages.segment(i * n_, n_);
  reduced_ = factor_.solve(reduced_).eval();
  for (int j = 0; j < stages_; ++j) {
    change_.noalias() = h_ * left(j) * reduced_.segment(j * rank_, rank_);
    for (int i = 0; i < stages_; ++i)
      stages.segment(i * n_, n_) += coefficient(i, j) * change_;
  }
}

}  // namespace tf::runtime
