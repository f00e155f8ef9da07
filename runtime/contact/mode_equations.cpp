#include "runtime/contact/mode_equations.h"

#include "runtime/contact/dense_kernels.h"

#include <algorithm>

namespace tf::runtime {

void ModeEquations::setMode(const ContactRowData &rows, const std::uint8_t *active, const std::int8_t *slip) {
  const int n = rows.normalCount, m = rows.tangentCount;
  active_.clear();
  slipping_.clear();
  position_.resize(n + m);
  slip_.resize(m);
  constant_.assign(n + m, 0.0);
  loaded_.clear();
  for (int r = 0; r < n + m; ++r) {
    position_[r] = active[r] ? static_cast<int>(active_.size()) : -1;
    if (active[r])
      active_.push_back(r);
    else if (r < n || slip[r - n] != 0)
      loaded_.push_back(r);
  }
  for (int j = 0; j < m; ++j) {
    slip_[j] = active[n + j] ? std::int8_t{0} : slip[j];
    if (slip_[j] != 0)
      slipping_.push_back(j);
  }
}

void ModeEquations::assemble(const ContactRowData &rows, DenseMatrix &matrix) const {
  const int k = activeCount(), n = rows.normalCount;
  matrix.resize(k, k);
  for (int c = 0; c < k; ++c) {
    const double *source = rows.delassus->column(active_[c]);
    double *target = matrix.column(c);
    for (int r = 0; r < k; ++r)
      target[r] = source[active_[r]];
  }
  for (const int j : slipping_) {
    const int owner = rows.owner[j];
    if (owner < 0 || position_[owner] < 0)
      continue;
    const double factor = slipFactor(rows, j);
    const double *source = rows.delassus->column(n + j);
    double *target = matrix.column(position_[owner]);
    for (int r = 0; r < k; ++r)
      target[r] += factor * source[active_[r]];
  }
}

void ModeEquations::assembleRow(const ContactRowData &rows, int r, double *row) const {
  const double *source = rows.delassus->column(active_[r]);
  for (int c = 0; c < activeCount(); ++c)
    row[c] = source[active_[c]];
  for (const int j : slipping_) {
    const int owner = rows.owner[j];
    if (owner >= 0 && position_[owner] >= 0)
      row[position_[owner]] += slipFactor(rows, j) * source[rows.normalCount + j];
  }
}

void ModeEquations::rightHandSide(const ContactRowData &rows, const double *fixedForce, double *rhs) {
  const int k = activeCount(), n = rows.normalCount;
  for (int r = 0; r < k; ++r)
    rhs[r] = -rows.bias[active_[r]];
  // Normal rows come first, so that a slipping row finds its owner's force.
  for (const int row : loaded_) {
    double force = 0;
    if (row < n) {
      force = fixedForce[row];
    } else {
      const int j = row - n, owner = rows.owner[j];
      force = -slip_[j] * (rows.offset[j] + (owner >= 0 ? rows.friction[j] * constant_[owner] : 0.0));
    }
    constant_[row] = force;
    if (force == 0)
      continue;
    const double *column = rows.delassus->column(row);
    for (int r = 0; r < k; ++r)
      rhs[r] -= column[active_[r]] * force;
  }
}

void ModeEquations::expandForces(const ContactRowData &rows, const double *x, double *force) const {
  const int n = rows.normalCount, count = n + rows.tangentCount;
  for (int r = 0; r < count; ++r)
    force[r] = position_[r] >= 0 ? x[position_[r]] : constant_[r];
  for (const int j : slipping_) {
    const int owner = rows.owner[j];
    if (owner >= 0 && position_[owner] >= 0)
      force[n + j] += slipFactor(rows, j) * force[owner];
  }
}

void ModeEquations::accelerations(const ContactRowData &rows, const double *force, double *acceleration) const {
  const int count = rows.normalCount + rows.tangentCount;
  std::copy_n(rows.bias, count, acceleration);
  addColumns(rows.delassus->data(), count, count, 1, force, acceleration);
  for (const int r : active_)
    acceleration[r] = 0;
}

}  // namespace tf::runtime
