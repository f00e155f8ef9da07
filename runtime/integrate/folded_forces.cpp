#include "runtime/integrate/folded_forces.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void FoldedForces::choose(const RowSystem &rows, const ContactRows &problem, const ContactMode &mode, const ModeForces &start) {
  const int n = rows.normalCount();
  active_.clear();
  slipping_.clear();
  for (int i = 0; i < n; ++i)
    active_.push_back(i);
  for (int row = n; row < rows.count(); ++row) {
    const int sign = mode.slip[row - n];
    if (sign == 0)
      active_.push_back(row);
    else
      slipping_.push_back({row, problem.owner[row - n], sign});
  }
  margins_.assign(start.margins().begin(), start.margins().end());
  columns_.resize(active_.size() * rows.width());
  responses_.resize(columns_.size());
  force_.resize(rows.width());
  unknowns_.resize(active_.size());
  forces_.assign(start.forces().begin(), start.forces().end());
  values_.assign(start.marginValues().begin(), start.marginValues().end());
}

void FoldedForces::foldColumns(const RowSystem &rows, const ContactRows &problem) {
  const int nv = rows.width(), n = rows.normalCount();
  for (std::size_t c = 0; c < active_.size(); ++c)
    std::copy_n(rows.jacobian(active_[c]), nv, columns_.data() + c * nv);
  for (const Slipping &slip : slipping_) {
    if (slip.unknown < 0)
      continue;
    const double factor = -slip.sign * problem.friction[slip.row - n];
    const double *row = rows.jacobian(slip.row);
    double *column = columns_.data() + static_cast<std::ptrdiff_t>(slip.unknown) * nv;
    for (int k = 0; k < nv; ++k)
      column[k] += factor * row[k];
  }
}

// f and the forces of the friction elements that slip.
void FoldedForces::freeForce(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem) {
  const int nv = rows.width(), n = rows.normalCount();
  std::copy_n(at.force.data(), nv, force_.data());
  for (const Slipping &slip : slipping_) {
    if (slip.unknown >= 0)
      continue;
    const double force = -slip.sign * problem.bound[slip.row - n];
    forces_[slip.row] = force;
    const double *row = rows.jacobian(slip.row);
    for (int k = 0; k < nv; ++k)
      force_[k] += force * row[k];
  }
}

void FoldedForces::expand(const ContactRows &problem) {
  const int n = problem.normalCount;
  for (std::size_t c = 0; c < active_.size(); ++c)
    forces_[active_[c]] = unknowns_[c];
  for (const Slipping &slip : slipping_)
    if (slip.unknown >= 0)
      forces_[slip.row] = -slip.sign * problem.friction[slip.row - n] * unknowns_[slip.unknown];
  for (std::size_t k = 0; k < margins_.size(); ++k) {
    const ForceLimit &limit = margins_[k].limit;
    const double own = forces_[limit.row];
    values_[k] = limit.side == 0                  ? own
                 : limit.side == ForceLimit::disk ? problem.limit(limit.row - n, forces_.data()) - std::hypot(own, forces_[limit.row + 1])
                                                  : problem.limit(limit.row - n, forces_.data()) - limit.side * own;
  }
}

bool FoldedForces::evaluate(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, double *acceleration) {
  const int nv = rows.width(), count = static_cast<int>(active_.size());
  freeForce(at, rows, problem);
  at.mobility.accelerate(force_.data(), at.constraintBias.data(), acceleration);
  foldColumns(rows, problem);
  for (int c = 0; c < count; ++c)
    at.mobility.apply(columns_.data() + static_cast<std::ptrdiff_t>(c) * nv, responses_.data() + static_cast<std::ptrdiff_t>(c) * nv);
  DenseMatrix &matrix = factor_.matrix();
  matrix.resize(count, count);
  for (int r = 0; r < count; ++r) {
    for (int c = 0; c < count; ++c)
      matrix(r, c) = rows.product(active_[r], responses_.data() + static_cast<std::ptrdiff_t>(c) * nv);
    unknowns_[r] = -(rows.product(active_[r], acceleration) + rows.modelBias(at, active_[r]));
  }
  if (!factor_.factor(0))
    return false;
  factor_.solve(unknowns_.data());
  for (int c = 0; c < count; ++c) {
    const double *response = responses_.data() + static_cast<std::ptrdiff_t>(c) * nv;
    for (int k = 0; k < nv; ++k)
      acceleration[k] += unknowns_[c] * response[k];
  }
  expand(problem);
  return true;
}

}  // namespace tf::runtime
