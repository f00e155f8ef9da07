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

private:
  std::vector<double> nodes_, weights_, coefficients_;
  Eigen::MatrixXd system_, right_, increments_, product_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
};

}  // namespace tf::runtime
