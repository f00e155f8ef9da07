#include "runtime/integrate/row_system.h"

#include <algorithm>
#include <cassert>

namespace tf::runtime {

std::vector<int> contactsOfTangents(const tf_model &model) {
  std::vector<int> owner(model.nt, -1);
  for (int i = 0; i < model.nc; ++i)
    for (int k = 0; k < model.contacts[i].tangent_count; ++k)
      owner[model.contacts[i].tangent_first + k] = i;
  return owner;
}

void RowSystem::choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem) {
  contacts_ = contacts;
  tangents_ = tangents;
  nv_ = model.nv;
  jacobian_.assign(static_cast<std::size_t>(count()) * nv_, 0.0);
  mobility_ = jacobian_;
  contactOf_.clear();
  const std::vector<int> owner = contactsOfTangents(model);
  for (std::size_t j = 0; j < tangents_.size(); ++j) {
    contactOf_.push_back(owner[tangents_[j]]);
    if (contactOf_[j] < 0) {
      problem.owner[j] = -1;
      continue;
    }
    const auto place = std::find(contacts_.begin(), contacts_.end(), contactOf_[j]);
    assert(place != contacts_.end());
    problem.owner[j] = static_cast<int>(place - contacts_.begin());
  }
}

void RowSystem::assemble(const ModelEvaluation &at, DenseMatrix &delassus, ContactRows &rows) {
  const int n = normalCount();
  const int m = count();
  for (int i = 0; i < m; ++i) {
    const double *source = i < n ? at.normal.data() + contacts_[i] * nv_ : at.tangent.data() + tangents_[i - n] * nv_;
    std::copy_n(source, nv_, jacobian_.data() + i * nv_);
    at.mobility.apply(source, mobility_.data() + i * nv_);
  }
  for (int i = 0; i < m; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < nv_; ++k)
        sum += jacobian_[i * nv_ + k] * mobility_[j * nv_ + k];
      delassus(i, j) = delassus(j, i) = sum;
    }
  for (int j = 0; j < m - n; ++j) {
    if (contactOf_[j] >= 0)
      rows.friction[j] = at.friction[contactOf_[j]];
    else
      rows.bound[j] = at.bound[tangents_[j]];
  }
}

void RowSystem::bias(const ModelEvaluation &at, const double *freeAcceleration, std::vector<double> &bias) const {
  const int n = normalCount();
  for (int i = 0; i < count(); ++i)
    bias[i] = product(i, freeAcceleration) + (i < n ? at.normalBias[contacts_[i]] : at.tangentBias[tangents_[i - n]]);
}

void RowSystem::accelerate(const double *forces, double *acceleration) const {
  for (int i = 0; i < count(); ++i)
    for (int k = 0; k < nv_; ++k)
      acceleration[k] += mobility_[i * nv_ + k] * forces[i];
}

void RowSystem::addForces(const double *forces, double *target) const {
  for (int i = 0; i < count(); ++i)
    for (int k = 0; k < nv_; ++k)
      target[k] += jacobian_[i * nv_ + k] * forces[i];
}

double RowSystem::product(int row, const double *x) const {
  double sum = 0;
  for (int k = 0; k < nv_; ++k)
    sum += jacobian_[row * nv_ + k] * x[k];
  return sum;
}

}  // namespace tf::runtime
