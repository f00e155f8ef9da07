// Collocation of the linear system S' = A(t) S + b(t), with several columns in S, over one interval (Hairer, Wanner, Solving Ordinary
// Differential Equations II, IV.5): its stages Z_i = S_i − S solve Z_i − h Σ a_ij A_j Z_j = h Σ a_ij (A_j S + b_j).
#pragma once

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

class LinearCollocation {
public:
  // For S of size × columns.
  LinearCollocation(std::vector<double> nodes, int size, int columns);

  [[nodiscard]] const std::vector<double> &nodes() const { return nodes_; }
  // From S at the interval's begin to S at its end, of length h, with A_j and b_j at the first of the nodes; `end` is not `begin`.
  void step(double h, const std::vector<Eigen::MatrixXd> &slopes, const std::vector<Eigen::MatrixXd> &offsets, const Eigen::MatrixXd &begin,
            Eigen::MatrixXd &end);
  // Of the last step: the polynomial through S' at the nodes, at the begin or at the end of the interval.
  void rateAtBegin(Eigen::MatrixXd &rate) const { extrapolate(beginWeights_, rate); }
  void rateAtEnd(Eigen::MatrixXd &rate) const { extrapolate(endWeights_, rate); }
  // Of the last step: the largest |S'| at the nodes, entry by entry.
  void largestRate(Eigen::MatrixXd &rate) const;

private:
  void extrapolate(const std::vector<double> &weights, Eigen::MatrixXd &rate) const;

  std::vector<double> nodes_, weights_, coefficients_, beginWeights_, endWeights_;
  Eigen::MatrixXd system_, right_, increments_, product_;
  std::vector<Eigen::MatrixXd> rates_;  // S' at the nodes
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace tf::runtime
