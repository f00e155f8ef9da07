#include "runtime/integrate/row_system.h"

#include "runtime/integrate/dot.h"

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

std::vector<int> pairsOfTangents(const tf_model &model) {
  std::vector<int> pair(model.nt, -1);
  const auto mark = [&pair](int first, int count) {
    for (int k = 0; count == 2 && k < 2; ++k)
      pair[first + k] = first;
  };
  for (int i = 0; i < model.nc; ++i)
    mark(model.contacts[i].tangent_first, model.contacts[i].tangent_count);
  for (int i = 0; i < model.nf; ++i)
    mark(model.frictions[i].tangent_first, model.frictions[i].tangent_count);
  return pair;
}

void RowSystem::choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem) {
  contacts_ = contacts;
  tangents_ = tangents;
  nv_ = model.nv;
  jacobian_.assign(static_cast<std::size_t>(count()) * nv_, 0.0);
  mobility_ = jacobian_;
  begin_.assign(count(), 0);
  end_.assign(count(), nv_);
  contactOf_.clear();
  side_.clear();
  frame_.assign(tangents.size(), Frame{});
  if (owner_.empty() && !tangents_.empty()) {
    owner_ = contactsOfTangents(model);
    pair_ = pairsOfTangents(model);
  }
  for (std::size_t j = 0; j < tangents_.size(); ++j) {
    contactOf_.push_back(owner_[tangents_[j]]);
    side_.push_back(pair_[tangents_[j]] < 0 ? 0 : pair_[tangents_[j]] == tangents_[j] ? 1 : 2);
    problem.partner[j] = side_[j] == 0 ? -1 : static_cast<int>(j) + (side_[j] == 1 ? 1 : -1);
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
    double *row = jacobian_.data() + i * nv_;
    if (i < n || side_[i - n] == 0)
      std::copy_n(i < n ? at.normal.data() + contacts_[i] * nv_ : at.tangent.data() + tangents_[i - n] * nv_, nv_, row);
    else
      for (int k = 0; k < nv_; ++k)
        row[k] = tangentValue(at.tangent.data() + k, nv_, i - n);
    begin_[i] = 0;
    end_[i] = nv_;
    while (begin_[i] < end_[i] && row[begin_[i]] == 0)
      ++begin_[i];
    while (end_[i] > begin_[i] && row[end_[i] - 1] == 0)
      --end_[i];
    at.mobility.apply(row, mobility_.data() + i * nv_);
  }
  for (int i = 0; i < m; ++i)
    for (int j = 0; j <= i; ++j)
      delassus(i, j) = delassus(j, i) = product(i, mobility_.data() + j * nv_);
  for (int j = 0; j < m - n; ++j) {
    if (contactOf_[j] >= 0)
      rows.friction[j] = at.friction[contactOf_[j]];
    else
      rows.bound[j] = at.bound[tangents_[j]];
    if (side_[j] == 2 && rows.slipSign[j] != 0)
      rows.friction[j] = rows.bound[j] = 0;
  }
}

double RowSystem::tangentValue(const double *modelRows, int stride, int j) const {
  const double own = modelRows[tangents_[j] * stride];
  if (side_[j] == 0)
    return own;
  if (side_[j] == 1)
    return frame_[j].c * own + frame_[j].s * modelRows[tangents_[j + 1] * stride];
  return frame_[j - 1].c * own - frame_[j - 1].s * modelRows[tangents_[j - 1] * stride];
}

void RowSystem::spreadTangentForces(const double *forces, double *modelForces) const {
  for (std::size_t j = 0; j < tangents_.size(); ++j) {
    if (side_[j] == 0)
      modelForces[tangents_[j]] = forces[j];
    if (side_[j] != 1)
      continue;
    const Frame &frame = frame_[j];
    modelForces[tangents_[j]] = frame.c * forces[j] - frame.s * forces[j + 1];
    modelForces[tangents_[j + 1]] = frame.s * forces[j] + frame.c * forces[j + 1];
  }
}

void RowSystem::bias(const ModelEvaluation &at, const double *freeAcceleration, std::vector<double> &bias) const {
  const int n = normalCount();
  for (int i = 0; i < count(); ++i)
    bias[i] = product(i, freeAcceleration) + (i < n ? at.normalBias[contacts_[i]] : tangentValue(at.tangentBias.data(), 1, i - n));
}

void RowSystem::accelerate(const double *forces, double *acceleration) const {
  for (int i = 0; i < count(); ++i)
    for (int k = 0; k < nv_; ++k)
      acceleration[k] += mobility_[i * nv_ + k] * forces[i];
}

void RowSystem::addForces(const double *forces, double *target) const {
  for (int i = 0; i < count(); ++i)
    for (int k = begin_[i]; k < end_[i]; ++k)
      target[k] += jacobian_[i * nv_ + k] * forces[i];
}

double RowSystem::product(int row, const double *x) const {
  return dot(jacobian(row) + begin_[row], x + begin_[row], end_[row] - begin_[row]);
}

}  // namespace tf::runtime
