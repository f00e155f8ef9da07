// The linear equations of Newton's method for the stages of a collocation, Z_i − h Σ_j a_ij J_j Z_j = r_i, with J_j the Jacobian of the
// j-th stage. Variables that depend on each other are solved for together, the others one after the other (the strongly connected parts of
// the Jacobians' pattern): bodies that touch nothing, or one another only, are equations of their own. Of variables that depend on each
// other those with J = 0 among themselves, as coordinates have in q' = v, are eliminated before the rest is factorised.
#pragma once

#include <Eigen/Dense>

#include <cstdint>
#include <vector>

namespace tf::runtime {

class StageEquations {
public:
  // For `size` variables and the s coefficients a_ij of each of the s stages, row by row.
  StageEquations(int size, std::vector<double> coefficients);

  // J_j [size × size], j from 0: to be set before factorise().
  [[nodiscard]] Eigen::MatrixXd &jacobian(int stage) { return jacobians_[static_cast<std::size_t>(stage)]; }
  void factorise(double h);
  // r_1, …, r_s [each of size] become Z_1, …, Z_s.
  void solve(Eigen::VectorXd &stages);

private:
  // Of variables that depend on each other.
  struct Part {
    std::vector<int> eliminated, rest;
    Eigen::PartialPivLU<Eigen::MatrixXd> factor;  // of the rest, stage by stage
  };

  void findDependencies();
  void splitParts();
  void chooseEliminated(const std::vector<int> &members, Part &part) const;
  void factorise(Part &part);
  void gather(const Part &part, const Eigen::VectorXd &stages);
  void spread(const std::vector<int> &variables, const Eigen::MatrixXd &values, Eigen::VectorXd &stages);
  [[nodiscard]] double coefficient(int i, int j) const { return coefficients_[static_cast<std::size_t>(i) * stages_ + j]; }
  // Bit j of row i.
  [[nodiscard]] bool isSet(const std::vector<std::uint64_t> &rows, int i, int j) const {
    return (rows[static_cast<std::size_t>(i) * words_ + j / 64] >> (j % 64) & 1U) != 0;
  }

  int n_, stages_, words_;
  std::vector<double> coefficients_;
  double h_ = 0;
  std::vector<Eigen::MatrixXd> jacobians_;
  std::vector<std::uint64_t> direct_;   // rows of bits: the rate of variable i depends on variable j
  std::vector<std::uint64_t> reach_;    // it does so through others, or j is i
  std::vector<int> reachCounts_;        // bits of each row of reach_
  std::vector<int> order_;              // of the variables: those that depend on fewer first
  std::vector<std::uint8_t> isInPart_;  // variables
  std::vector<Part> parts_;             // each depends on those before it
  std::size_t partCount_ = 0;
  std::vector<int> members_;
  Eigen::MatrixXd schur_, coupling_, known_, eliminatedValues_, restValues_, product_;  // known_: J_j Z_j of what is solved for
  Eigen::VectorXd right_;
};

}  // namespace tf::runtime
