#include "runtime/integrate/linear_collocation.h"

#include "runtime/integrate/collocation.h"

namespace tf::runtime {

LinearCollocation::LinearCollocation(std::vector<double> nodes, int size, int columns)
    : nodes_(std::move(nodes)), coefficients_(collocationCoefficients(nodes_)), product_(size, columns) {
  const int stages = static_cast<int>(nodes_.size());
  weights_ = interpolatoryWeights(nodes_, integralMoments(stages, 1));
  std::vector<long double> atBegin(nodes_.size(), 0), atEnd(nodes_.size(), 1);  // x^k there
  atBegin.front() = 1;
  beginWeights_ = interpolatoryWeights(nodes_, atBegin);
  endWeights_ = interpolatoryWeights(nodes_, atEnd);
  rates_.assign(nodes_.size(), product_);
  const Eigen::Index rows = static_cast<Eigen::Index>(stages) * size;
  system_.resize(rows, rows);
  right_.resize(rows, columns);
  increments_.resize(rows, columns);
  factor_ = Eigen::PartialPivLU<Eigen::MatrixXd>(rows);
}

void LinearCollocation::step(double h, const std::vector<Eigen::MatrixXd> &slopes, const std::vector<Eigen::MatrixXd> &offsets,
                             const Eigen::MatrixXd &begin, Eigen::MatrixXd &end) {
  const std::size_t stages = nodes_.size();
  const Eigen::Index n = begin.rows();
  system_.setIdentity();
  right_.setZero();
  for (std::size_t j = 0; j < stages; ++j) {
    product_.noalias() = slopes[j] * begin;
    product_ += offsets[j];
    for (std::size_t i = 0; i < stages; ++i) {
      const double a = h * coefficients_[i * stages + j];
      const auto row = static_cast<Eigen::Index>(i) * n, column = static_cast<Eigen::Index>(j) * n;
      system_.block(row, column, n, n) -= a * slopes[j];
      right_.middleRows(row, n) += a * product_;
    }
  }
  factor_.compute(system_);
  increments_ = factor_.solve(right_);
  end = begin;
  for (std::size_t j = 0; j < stages; ++j) {
    auto stage = increments_.middleRows(static_cast<Eigen::Index>(j) * n, n);
    stage += begin;
    rates_[j].noalias() = slopes[j] * stage;
    rates_[j] += offsets[j];
    end += h * weights_[j] * rates_[j];
  }
}

void LinearCollocation::extrapolate(const std::vector<double> &weights, Eigen::MatrixXd &rate) const {
  rate = weights.front() * rates_.front();
  for (std::size_t j = 1; j < rates_.size(); ++j)
    rate += weights[j] * rates_[j];
}

void LinearCollocation::largestRate(Eigen::MatrixXd &rate) const {
  rate = rates_.front().cwiseAbs();
  for (const Eigen::MatrixXd &other : rates_)
    rate = rate.cwiseMax(other.cwiseAbs());
}

}  // namespace tf::runtime
