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

std::vector<int> pairsOfTangents(const tf_model &model) {
  std::vector<int> pair(model.nt, -1);
  const auto mark = [&pair](const auto &element) {
    for (int k = 0; sharesDisk(element) && k < 2; ++k)
      pair[element.tangent_first + k] = element.tangent_first;
  };
  std::for_each_n(model.contacts, model.nc, mark);
  std::for_each_n(model.frictions, model.nf, mark);
  return pair;
}

void RowSystem::choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem) {
  contacts_ = contacts;
  tangents_ = tangents;
  nv_ = model.nv;
  jacobian_.assign(static_cast<std::size_t>(count()) * nv_, 0.0);
  half_ = scaled_ = jacobian_;
  mobility_ = nullptr;  // until the rows are assembled: those of before are no more
  sum_.resize(nv_);
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

// Rows are read as a whole where that costs no more than looking for their zeros.
void RowSystem::gather(const ModelEvaluation &at, ContactRows &rows) {
  const int n = normalCount();
  const int m = count();
  for (int i = 0; i < m; ++i) {
    double *row = jacobian_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
    if (i < n || side_[i - n] == 0) {
      const double *source = i < n ? at.normal.data() + static_cast<std::ptrdiff_t>(contacts_[i]) * nv_
                                   : at.tangent.data() + static_cast<std::ptrdiff_t>(tangents_[i - n]) * nv_;
      for (int k = 0; k < nv_; ++k)
        row[k] = source[k];
    } else {
      for (int k = 0; k < nv_; ++k)
        row[k] = tangentValue(at.tangent.data() + k, nv_, i - n);
    }
    begin_[i] = 0;
    end_[i] = nv_;
    while (nv_ > narrow && begin_[i] < end_[i] && row[begin_[i]] == 0)
      ++begin_[i];
    while (nv_ > narrow && end_[i] > begin_[i] && row[end_[i] - 1] == 0)
      --end_[i];
  }
  for (int j = 0; j < m - n; ++j) {
    if (contactOf_[j] >= 0)
      rows.friction[j] = at.friction[contactOf_[j]];
    else
      rows.bound[j] = at.bound[tangents_[j]];
    if (side_[j] == 2 && rows.slipSign[j] != 0)
      rows.friction[j] = rows.bound[j] = 0;
  }
}

// Z of row i on the blocks that it moves.
void RowSystem::halve(int i) {
  const double *row = jacobian(i);
  double *half = half_.data() + static_cast<std::ptrdiff_t>(i) * nv_, *scaled = scaled_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
  const MassMatrix &mass = mobility_->mass();
  const bool everywhere = mobility_->isConstrained();
  const int blocks = static_cast<int>(mass.blocks().size());
  for (int k = begin_[i]; k < end_[i] && !everywhere; ++k) {
    const int block = mass.blockOf(k);
    if (row[k] != 0 && (parts_[block].empty() || parts_[block].back().row != i))
      parts_[block].push_back({i, mass.forward(block, row, half, scaled)});
  }
  for (int block = 0; block < blocks && everywhere; ++block) {
    mass.forward(block, row, half, scaled);
    parts_[block].push_back({i, mass.blocks()[block].begin});
  }
  if (everywhere)
    mobility_->constrain(row, half, scaled);
}

void RowSystem::multiply(DenseMatrix &delassus) const {
  const int m = count();
  for (int j = 0; j < m; ++j)
    std::fill_n(delassus.column(j), m, 0.0);
  for (std::size_t block = 0; block < parts_.size(); ++block) {
    const int end = mobility_->mass().blocks()[block].end;
    const std::vector<Part> &parts = parts_[block];
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const int first = std::max(parts[a].first, parts[b].first);
        const std::ptrdiff_t left = static_cast<std::ptrdiff_t>(parts[a].row) * nv_ + first;
        const std::ptrdiff_t right = static_cast<std::ptrdiff_t>(parts[b].row) * nv_ + first;
        delassus(parts[a].row, parts[b].row) += dot(half_.data() + left, scaled_.data() + right, end - first);
      }
  }
  for (int j = 0; j < m; ++j)
    for (int i = j + 1; i < m; ++i)
      delassus(j, i) = delassus(i, j);
}

void RowSystem::respond(const ModelEvaluation &at, DenseMatrix &delassus) {
  mobility_ = &at.mobility;
  parts_.resize(mobility_->mass().blocks().size());
  for (std::vector<Part> &parts : parts_)
    parts.clear();
  for (int i = 0; i < count(); ++i)
    halve(i);
  multiply(delassus);
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
  for (int i = 0; i < count(); ++i)
    bias[i] = product(i, freeAcceleration) + modelBias(at, i);
}

void RowSystem::accelerate(const double *forces, double *acceleration) const {
  if (mobility_ == nullptr)
    return;
  std::fill(sum_.begin(), sum_.end(), 0.0);
  bool any = false;
  for (std::size_t block = 0; block < parts_.size(); ++block) {
    const int end = mobility_->mass().blocks()[block].end;
    for (const Part &part : parts_[block]) {
      const double force = forces[part.row];
      if (force == 0)
        continue;
      any = true;
      const double *row = scaled_.data() + static_cast<std::ptrdiff_t>(part.row) * nv_;
      for (int k = part.first; k < end; ++k)
        sum_[k] += row[k] * force;
    }
  }
  if (any)
    mobility_->mass().addBackward(sum_.data(), acceleration);
}

void RowSystem::addForces(const double *forces, double *target) const {
  for (int i = 0; i < count(); ++i)
    for (int k = begin_[i]; k < end_[i]; ++k)
      target[k] += jacobian_[i * nv_ + k] * forces[i];
}

}  // namespace tf::runtime
