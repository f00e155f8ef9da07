#include "runtime/contact/equal_shares.h"

#include <cmath>
#include <cstddef>

namespace tf::runtime {

bool EqualShares::choose(const DenseMatrix &delassus, const std::vector<int> &rows, const std::vector<std::uint8_t> &isAlone, int count) {
  const std::size_t unknowns = rows.size();
  set_.resize(unknowns);
  sample_.clear();
  root_.clear();
  for (std::size_t p = 0; p < unknowns; ++p) {
    std::size_t s = isAlone[p] != 0 ? sample_.size() : 0;
    while (s < sample_.size() && (isAlone[sample_[s]] != 0 || !areEqualColumns(delassus, rows[sample_[s]], rows[p])))
      ++s;
    set_[p] = static_cast<int>(s);
    if (s < sample_.size()) {
      root_[s] += 1;
      continue;
    }
    if (static_cast<int>(s) == count)
      return false;
    sample_.push_back(static_cast<int>(p));
    root_.push_back(1);
  }
  if (static_cast<int>(sample_.size()) != count)
    return false;
  for (double &root : root_)
    root = std::sqrt(root);
  factor_.matrix().resize(count, count);
  bounds_.resize(count);
  return true;
}

// The least-norm point is a sum of the normals N: Nᵀ y = bounds, y = N multipliers.
bool EqualShares::solve(double dependence) {
  hasMultipliers_ = false;
  if (!factor_.factor(dependence))
    return false;
  factor_.solveTransposed(bounds_.data());
  return true;
}

const std::vector<double> &EqualShares::multipliers() {
  if (!hasMultipliers_) {
    multipliers_ = bounds_;
    factor_.solve(multipliers_.data());
  }
  hasMultipliers_ = true;
  return multipliers_;
}

}  // namespace tf::runtime
