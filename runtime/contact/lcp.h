// Mixed linear complementarity problem w = M z + q: rows 0 ≤ z ⟂ w ≥ 0 and free rows, z of any sign and w = 0. Lemke's complementary
// pivoting (Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, section 4.4) with the lexicographic ratio test, so that
// degenerate problems end too.
#pragma once

#include "runtime/contact/dense.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

class LinearComplementarity {
public:
  enum class Status : std::uint8_t {
    Solved,
    Ray,           // secondary ray: no solution if M is copositive-plus on the feasible set, else unknown
    Contradictory  // a free row that depends on other free rows contradicts them
  };

  // M and q are zero and no row is free afterwards.
  void resize(int size);
  DenseMatrix &matrix() { return matrix_; }
  std::vector<double> &bias() { return bias_; }
  void setFree(int row) { free_[row] = 1; }
  // Entries > 0 of the auxiliary column (1 where not set): another choice may reach a solution where a ray was met.
  std::vector<double> &covering() { return covering_; }

  // M and q should be scaled to entries of about 1. A free row that depends on the others has z = 0 and must be consistent to `tolerance`.
  Status solve(double tolerance);

  [[nodiscard]] const std::vector<double> &z() const { return z_; }
  [[nodiscard]] int pivots() const { return pivots_; }

private:
  double *row(int i) { return tableau_.data() + static_cast<std::size_t>(i) * static_cast<std::size_t>(width_); }
  void pivot(int leavingRow, int column);
  Status eliminateFree(double tolerance);
  int leavingRow(int column);
  bool lexicographicallySmaller(int a, int b, int column);

  int size_ = 0, width_ = 0, pivots_ = 0;
  DenseMatrix matrix_;
  std::vector<double> bias_, covering_, z_;
  std::vector<std::uint8_t> free_;
  // Rows: basic variables. Columns: w (0 … N−1), z (N … 2N−1), covering variable (2N), right-hand side (2N + 1).
  std::vector<double> tableau_;
  std::vector<int> basic_;
  std::vector<std::uint8_t> unrestricted_, dropped_;  // of rows: the basic variable has any sign; the row says 0 = 0
};

}  // namespace tf::runtime
