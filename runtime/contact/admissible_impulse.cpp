#include "runtime/contact/admissible_impulse.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Of impulses, relative to the largest one.
constexpr double impulseRounding = 1e-12;

double largest(const std::vector<double> &values) {
  double size = 0;
  for (const double value : values)
    size = std::max(size, std::abs(value));
  return size;
}

}  // namespace

// What every impact is asked, of which few need more.
bool AdmissibleImpulse::leavesCones(const FrozenProblem &problem, const std::vector<double> &impulse) const {
  const int n = problem.normalCount;
  for (int j = 0; j < problem.tangentCount; ++j) {
    const int partner = problem.partner[j];
    const double size = std::hypot(impulse[n + j], partner < 0 ? 0.0 : impulse[n + partner]);
    if (size > problem.friction[j] * impulse[problem.owner[j]] + allowed_)
      return true;
  }
  return false;
}

void AdmissibleImpulse::chooseRows(const FrozenProblem &problem, const std::vector<double> &velocity, const std::vector<double> &impulse) {
  const int n = problem.normalCount;
  changes_.assign(static_cast<std::size_t>(n), 0);
  for (int i = 0; i < n; ++i)
    changes_[i] = impulse[i] > allowed_;
  for (int j = 0; j < problem.tangentCount; ++j)
    if (std::abs(velocity[n + j]) > problem.resolution)
      changes_[problem.owner[j]] = 0;
  rows_.clear();
  for (int i = 0; i < n; ++i)
    if (changes_[i])
      rows_.push_back(i);
  frictions_.clear();
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (!changes_[problem.owner[j]])
      continue;
    rows_.push_back(n + j);
    if (const int partner = problem.partner[j]; partner < 0 || partner > j)
      frictions_.push_back({problem.owner[j], n + j, partner < 0 ? -1 : n + partner, problem.friction[j]});
  }
}

void AdmissibleImpulse::choose(const FrozenProblem &problem, const std::vector<double> &velocity, std::vector<double> &impulse) {
  allowed_ = impulseRounding * largest(impulse);
  if (!leavesCones(problem, impulse))
    return;
  chooseRows(problem, velocity, impulse);
  if (frictions_.empty())
    return;
  const auto place = [this](int row) {
    return row < 0 ? -1 : static_cast<int>(std::lower_bound(rows_.begin(), rows_.end(), row) - rows_.begin());
  };
  const int count = static_cast<int>(rows_.size());
  const int normals = static_cast<int>(std::lower_bound(rows_.begin(), rows_.end(), problem.normalCount) - rows_.begin());
  forces_.forget();
  forces_.resize(count, normals + static_cast<int>(frictions_.size()));
  Eigen::VectorXd own(count);
  for (int k = 0; k < count; ++k) {
    own[k] = impulse[rows_[k]];
    for (int l = 0; l < count; ++l)
      forces_.matrix()(k, l) = problem.delassus(rows_[k], rows_[l]);
  }
  forces_.rhs() = forces_.matrix() * own;
  for (int k = 0; k < normals; ++k)
    forces_.limit(k) = {k, 1, 0, -1, -1};
  for (std::size_t k = 0; k < frictions_.size(); ++k)
    forces_.limit(normals + static_cast<int>(k)) = {place(frictions_[k].owner), frictions_[k].coefficient, 0, place(frictions_[k].first),
                                                    place(frictions_[k].second)};
  constexpr double consistent = 1e-9;
  if (!forces_.prepare(consistent) || !(forces_.largestSlack() > 0))
    return;
  const Eigen::VectorXd &admissible = forces_.leastNorm();
  for (int k = 0; k < count; ++k)
    impulse[rows_[k]] = admissible[k];
}

}  // namespace tf::runtime
