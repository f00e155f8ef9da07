#include "runtime/integrate/folded_forces.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void FoldedForces::choose(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, const ContactMode &mode,
                          const ModeForces &start) {
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
      slipping_.push_back({row, problem.owner[row - n], static_cast<double>(sign)});
  }
  columns_.resize(active_.size() * rows.width());
  responses_.resize(columns_.size());
  force_.resize(rows.width());
  unknowns_.resize(active_.size());
  margins_.clear();
  forces_.clear();
  values_.clear();
  if (rows.count() > 0) {
    margins_.assign(start.margins().begin(), start.margins().end());
    forces_.assign(start.forces().begin(), start.forces().end());
    values_.assign(start.marginValues().begin(), start.marginValues().end());
  }
  isSmall_ = chooseSmall(at, rows, problem);
  inverseDeterminant_ = 1;
  if (margins_.empty() || !start.mayPress())
    return;
  pressing_ = start.pressing();
  for (const double factor : pressing_.inverseDeterminant)
    inverseDeterminant_ *= factor;
}

// Of the equations of the last evaluation, relative to the begin of the mode.
double FoldedForces::relativeDeterminant() const {
  return isSmall_ ? determinant_ * inverseDeterminant_ : factor_.determinantTimes(pressing_.inverseDeterminant);
}

bool FoldedForces::chooseSmall(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem) {
  const int n = rows.normalCount(), nv = rows.width();
  const auto tangent = [&](int row) { return at.tangent.data() + static_cast<std::ptrdiff_t>(rows.tangents()[row - n]) * nv; };
  std::vector<SmallSystem::ActiveRow> &active = small_.clear();
  for (const int row : active_) {
    if (row < n)
      active.push_back(
          {at.normal.data() + static_cast<std::ptrdiff_t>(rows.contacts()[row]) * nv, at.normalBias.data() + rows.contacts()[row]});
    else
      active.push_back({tangent(row), at.tangentBias.data() + rows.tangents()[row - n]});
  }
  for (const Slipping &slip : slipping_) {
    const int j = slip.row - n;
    // The rows of a slip with two components turn with it.
    if (problem.partner[j] >= 0)
      return false;
    if (slip.unknown < 0) {
      small_.addSlipping({tangent(slip.row), at.bound.data() + rows.tangents()[j], slip.sign});
      continue;
    }
    SmallSystem::SlippingRow &own = active[slip.unknown].slip;
    if (own.jacobian != nullptr)
      return false;
    own = {tangent(slip.row), at.friction.data() + rows.contacts()[slip.unknown], slip.sign};
  }
  return small_.start(at);
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
    rows.addForce(slip.row, -slip.sign * problem.bound[slip.row - n], force_.data());
  }
}

void FoldedForces::expand(const ContactRows &problem) {
  const int n = problem.normalCount;
  double *const forces = forces_.data();
  const double *unknown = unknowns_.data();
  for (const int row : active_)
    forces[row] = *unknown++;
  for (const Slipping &slip : slipping_)
    forces[slip.row] = -slip.sign * problem.limit(slip.row - n, forces);
  double *value = values_.data();
  for (const ModeMargin &margin : margins_) {
    const ForceLimit &limit = margin.limit;
    if (limit.row == ModeMargin::pressing)
      *value++ = pressing_.value(relativeDeterminant());
    else if (limit.side == 0)
      *value++ = forces[limit.row];
    else if (limit.side == ForceLimit::disk)
      *value++ = problem.limit(limit.row - n, forces) - std::hypot(forces[limit.row], forces[limit.row + 1]);
    else
      *value++ = problem.limit(limit.row - n, forces) - limit.side * forces[limit.row];
  }
}

bool FoldedForces::correct(const ModelEvaluation &at, const std::uint8_t *takesPart, const double *residual, double *change) const {
  double residuals[SmallSystem::mostUnknowns];
  int count = 0;
  for (std::size_t c = 0; c < active_.size() && takesPart[active_[c]] != 0; ++c)
    residuals[count++] = residual[active_[c]];
  for (std::size_t c = static_cast<std::size_t>(count); c < active_.size(); ++c)
    if (takesPart[active_[c]] != 0)
      return false;
  return small_.correct(at, count, residuals, change);
}

bool FoldedForces::evaluateSmall(const ModelEvaluation &at, const ContactRows &problem, double *acceleration) {
  if (!small_.solve(at, unknowns_.data(), acceleration, determinant_))
    return false;
  expand(problem);
  return true;
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
