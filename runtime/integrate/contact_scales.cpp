#include "runtime/integrate/contact_scales.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tf::runtime {

ContactScales::ContactScales(const tf_model &model)
    : model_(&model), nominal_(static_cast<std::size_t>(model.nq) + model.nv + model.nz + 1, 1.0), lengths_(model.nv, 1.0),
      rows_(static_cast<std::size_t>(model.nc) + model.nt + model.nh) {
  sizes_.resize(rows_.size() * model.nv);
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
    const double nominal = nominal_[static_cast<std::size_t>(model.nq) + k];
    inverse_.push_back(1 / nominal);
    largestNominal_ = std::max(largestNominal_, nominal);
    if (coordinate_[k] >= 0)
      lengths_[k] = nominal_[coordinate_[k]];
  }
  finish();
}

void ContactScales::start() { std::fill(sizes_.begin(), sizes_.end(), 0.0); }

void ContactScales::include(const double *normal, const double *tangent, const double *constraint) {
  includeRows(0, model_->nc, normal);
  includeRows(model_->nc, model_->nt, tangent);
  includeRows(model_->nc + model_->nt, model_->nh, constraint);
}

void ContactScales::includeRows(int first, int count, const double *entries) {
  const std::ptrdiff_t nv = model_->nv;
  double *sizes = sizes_.data() + first * nv;
  for (std::ptrdiff_t k = 0; k < count * nv; ++k) {
    const double size = std::abs(entries[k]);
    sizes[k] = size > sizes[k] && size <= std::numeric_limits<double>::max() ? size : sizes[k];
  }
}

// Rows that nothing has moved at the points included have the nominal magnitude of the coordinates that they depend on.
void ContactScales::finish() {
  levers_.resize(sizes_.size() - std::count(sizes_.begin(), sizes_.end(), 0.0));
  const double *size = sizes_.data(), *nominal = nominal_.data() + model_->nq;
  int count = 0;
  for (Row &row : rows_) {
    row = {count, 0, 0, 0, 0};
    for (int k = 0; k < model_->nv; ++k, ++size) {
      if (!(*size > 0))
        continue;
      levers_[count++] = {k, *size};
      row.length = std::max(row.length, *size * lengths_[k]);
      row.speed = std::max(row.speed, *size * nominal[k]);
      row.lever = std::max(row.lever, coordinate_[k] >= 0 ? *size : 0);
    }
    row.count = count - row.first;
  }
  const auto fill = [this](int row, double given) {
    if (double &length = rows_[row].length; !(length > 0))
      length = given > 0 ? given : 1;
  };
  for (int i = 0; i < model_->nc; ++i)
    fill(i, model_->contacts[i].nominal);
  for (int k = 0; k < model_->nk; ++k)
    for (int h = model_->constraints[k].row_first; h < model_->constraints[k].row_first + model_->constraints[k].row_count; ++h)
      fill(model_->nc + model_->nt + h, model_->constraints[k].nominal);
}

double ContactScales::length(int index, const double *q) const {
  const Row &row = rows_[index];
  double largest = 0;
  for (const Lever *lever = levers_.data() + row.first, *end = lever + row.count; lever != end; ++lever)
    if (const int i = coordinate_[lever->velocity]; i >= 0)
      largest = std::max(largest, lever->size * std::abs(q[i]));
  return std::max(row.length, resolved * largest);
}

double ContactScales::share(int row, const double *entries) const {
  double length = 0;
  for (int k = 0; k < model_->nv; ++k)
    length = std::max(length, std::abs(entries[k]) * lengths_[k]);
  return length / residual(row);
}

double ContactScales::farthest(const double *q) const {
  double largest = 0;
  for (const int i : coordinate_)
    largest = std::max(largest, i >= 0 ? std::abs(q[i]) : 0);
  return largest;
}

double ContactScales::fastest(const double *v) const {
  constexpr int chunk = 8;
  double largest = 1;
  int k = 0;
  // Several maxima: one would be waited for.
  if (model_->nv >= chunk) {
    double parts[chunk] = {1};
    for (; k + chunk <= model_->nv; k += chunk)
      for (int j = 0; j < chunk; ++j)
        parts[j] = std::max(parts[j], std::abs(v[k + j]) * inverse_[k + j]);
    largest = *std::max_element(parts, parts + chunk);
  }
  for (; k < model_->nv; ++k)
    largest = std::max(largest, std::abs(v[k]) * inverse_[k]);
  return largest;
}

double ContactScales::speed(int index, const double *v, double most) const {
  const Row &row = rows_[index];
  const double fastest = this->fastest(v);
  if (!(row.speed > 0))
    return model_->nv > 0 ? largestNominal_ * fastest : 1;
  // The sum is not less than its largest part.
  if (fastest <= most)
    return row.speed * fastest;
  const double *nominal = nominal_.data() + model_->nq;
  // Several sums: one would be waited for.
  constexpr int chunk = 4;
  double sums[chunk] = {};
  for (int k = 0; k < row.count; ++k) {
    const Lever &lever = levers_[row.first + k];
    sums[k % chunk] += lever.size * std::max(nominal[lever.velocity], std::abs(v[lever.velocity]));
  }
  return std::min(row.speed * fastest, most * ((sums[0] + sums[1]) + (sums[2] + sums[3])));
}

}  // namespace tf::runtime
