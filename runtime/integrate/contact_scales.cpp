#include "runtime/integrate/contact_scales.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tf::runtime {

ContactScales::ContactScales(const tf_model &model)
    : model_(&model), nominal_(static_cast<std::size_t>(model.nq) + model.nv + model.nz + 1, 1.0), lengths_(model.nv, 1.0),
      levers_(static_cast<std::size_t>(model.nc) + model.nt + model.nh), least_(levers_.size()) {
  for (int k = 0; k < model.variable_count; ++k) {
    const tf_variable &variable = model.variables[k];
    const int first = variable.kind == TF_KIND_COORDINATE ? 0
                      : variable.kind == TF_KIND_VELOCITY ? model.nq
                      : variable.kind == TF_KIND_STATE    ? model.nq + model.nv
                                                          : -1;
    if (first >= 0 && std::abs(variable.nominal) > 0)
      nominal_[static_cast<std::size_t>(first) + variable.index] = std::abs(variable.nominal);
  }
  for (int i = 0; i < model.nq; ++i) {
    const bool isRotation = std::find(model.quaternions, model.quaternions + model.nr, i) != model.quaternions + model.nr;
    coordinate_.insert(coordinate_.end(), isRotation ? 3 : 1, isRotation ? -1 : i);
    i += isRotation ? 3 : 0;
  }
  for (int k = 0; k < model.nv; ++k) {
    inverse_.push_back(1 / nominal_[static_cast<std::size_t>(model.nq) + k]);
    if (coordinate_[k] >= 0)
      lengths_[k] = nominal_[coordinate_[k]];
  }
  finish();
}

void ContactScales::start() {
  for (std::vector<Lever> &row : levers_)
    row.clear();
}

void ContactScales::include(const double *normal, const double *tangent, const double *constraint) {
  const std::ptrdiff_t nv = model_->nv;
  for (int i = 0; i < model_->nc; ++i)
    includeRow(i, normal + i * nv);
  for (int j = 0; j < model_->nt; ++j)
    includeRow(model_->nc + j, tangent + j * nv);
  for (int h = 0; h < model_->nh; ++h)
    includeRow(model_->nc + model_->nt + h, constraint + h * nv);
}

// Levers of a row are in the order of the velocities.
void ContactScales::includeRow(int row, const double *entries) {
  std::vector<Lever> &levers = levers_[row];
  std::size_t place = 0;
  for (int k = 0; k < model_->nv; ++k) {
    while (place < levers.size() && levers[place].velocity < k)
      ++place;
    const double size = std::abs(entries[k]);
    if (!(size > 0) || !std::isfinite(size))
      continue;
    if (place < levers.size() && levers[place].velocity == k)
      levers[place].size = std::max(levers[place].size, size);
    else
      levers.insert(levers.begin() + static_cast<std::ptrdiff_t>(place), {k, size});
  }
}

// Rows that nothing has moved at the points included have the nominal magnitude of the coordinates that they depend on.
void ContactScales::finish() {
  for (std::size_t row = 0; row < levers_.size(); ++row) {
    least_[row] = 0;
    for (const Lever &lever : levers_[row])
      least_[row] = std::max(least_[row], lever.size * lengths_[lever.velocity]);
  }
  const auto fill = [this](int row, double nominal) {
    if (!(least_[row] > 0))
      least_[row] = nominal > 0 ? nominal : 1;
  };
  for (int i = 0; i < model_->nc; ++i)
    fill(i, model_->contacts[i].nominal);
  for (int k = 0; k < model_->nk; ++k)
    for (int h = model_->constraints[k].row_first; h < model_->constraints[k].row_first + model_->constraints[k].row_count; ++h)
      fill(model_->nc + model_->nt + h, model_->constraints[k].nominal);
}

double ContactScales::length(int row, const double *q) const {
  // Sums of coordinates are off by a few rounding errors of the largest one.
  constexpr double resolved = 2e-3;
  double largest = 0;
  for (const Lever &lever : levers_[row])
    if (const int i = coordinate_[lever.velocity]; i >= 0)
      largest = std::max(largest, lever.size * std::abs(q[i]));
  return std::max(least_[row], resolved * largest);
}

// Several maxima: one would be waited for.
double ContactScales::fastest(const double *v) const {
  constexpr int chunk = 8;
  double parts[chunk] = {1};
  int k = 0;
  for (; k + chunk <= model_->nv; k += chunk)
    for (int j = 0; j < chunk; ++j)
      parts[j] = std::max(parts[j], std::abs(v[k + j]) * inverse_[k + j]);
  for (; k < model_->nv; ++k)
    parts[0] = std::max(parts[0], std::abs(v[k]) * inverse_[k]);
  return *std::max_element(parts, parts + chunk);
}

double ContactScales::speed(int row, const double *v, double most) const {
  const double *nominal = nominal_.data() + model_->nq;
  double own = 0, sum = 0;
  for (const Lever &lever : levers_[row]) {
    own = std::max(own, lever.size * nominal[lever.velocity]);
    sum += lever.size * std::max(nominal[lever.velocity], std::abs(v[lever.velocity]));
  }
  if (own > 0)
    return std::min(own * fastest(v), most * sum);
  return model_->nv > 0 ? *std::max_element(nominal, nominal + model_->nv) * fastest(v) : 1;
}

}  // namespace tf::runtime
