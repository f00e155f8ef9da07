// The linear equations of one contact mode: λ = E x + b, where x are the forces of the active rows (w = 0), E carries the friction that
// slipping contacts take along (λ_t = −s μ λ_n) and b what does not depend on x; A x = −(φ + D b) on the active rows, A = D E.
#pragma once

#include "runtime/contact/lu_factor.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

// n normal rows, then m tangential rows, as in ContactProblem. limit_j = friction_j λ_owner + offset_j.
struct ContactRowData {
  int normalCount = 0, tangentCount = 0;
  const DenseMatrix *delassus = nullptr;
  const double *bias = nullptr;      // n + m
  const int *owner = nullptr;        // m; −1: no contact
  const double *friction = nullptr;  // m
  const double *offset = nullptr;    // m
};

class ModeEquations {
public:
  // Begins a mode. `active` (n + m): rows with w = 0. `slip` (m), of rows that are not active: sign s of λ_t = −s·limit, 0 for no force.
  void setMode(const ContactRowData &rows, const std::uint8_t *active, const std::int8_t *slip);

  [[nodiscard]] int activeCount() const { return static_cast<int>(active_.size()); }
  [[nodiscard]] const std::vector<int> &active() const { return active_; }
  // Index of a row in `active`, or −1.
  [[nodiscard]] int position(int row) const { return position_[row]; }
  // dλ_t/dx of the slipping tangential row j by its owner: −s μ; 0 where it does not slip.
  [[nodiscard]] double slipFactor(const ContactRowData &rows, int j) const { return -slip_[j] * rows.friction[j]; }

  // A (activeCount²) into `matrix`.
  void assemble(const ContactRowData &rows, DenseMatrix &matrix) const;
  // Row r of it alone.
  void assembleRow(const ContactRowData &rows, int r, double *row) const;
  // −(φ + D b) on the active rows. `fixedForce` (n): λ_n of the normal rows that are not active.
  void rightHandSide(const ContactRowData &rows, const double *fixedForce, double *rhs);
  // λ = E x + b (after rightHandSide) and w = D λ + φ with exact zeros on the active rows; both, or one of them.
  void expand(const ContactRowData &rows, const double *x, double *force, double *acceleration) const {
    expandForces(rows, x, force);
    accelerations(rows, force, acceleration);
  }
  void expandForces(const ContactRowData &rows, const double *x, double *force) const;
  void accelerations(const ContactRowData &rows, const double *force, double *acceleration) const;

private:
  std::vector<int> active_, position_;
  std::vector<int> slipping_;  // tangential rows that slip
  std::vector<int> loaded_;    // rows whose force is not an unknown
  std::vector<std::int8_t> slip_;
  std::vector<double> constant_;  // b
};

}  // namespace tf::runtime
