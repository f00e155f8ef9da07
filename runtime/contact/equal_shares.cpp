#include "runtime/contact/equal_shares.h"

#include <cmath>
#include <cstddef>
#include <cstring>

namespace tf::runtime {

bool EqualShares::choose(const DenseMatrix &delassus, const std::vector<int> &rows, const std::vector<std::uint8_t> &isAlone, int count) {
  const std::size_t unknowns = rows.size(), bytes = sizeof(double) * static_cast<std::size_t>(delassus.rows());
  set_.resize(unknowns);
  sample_.clear();
  root_.clear();
  diagonal_.clear();
  for (std::size_t p = 0; p < unknowns; ++p) {
    const double diagonal = delassus(rows[p], rows[p]);
    std::size_t s = isAlone[p] != 0 ? sample_.size() : 0;
    while (s < sample_.size() && (diagonal_[s] != diagonal || isAlone[sample_[s]] != 0 ||
                                  std::memcmp(delassus.column(rows[sample_[s]]), delassus.column(rows[p]), bytes) != 0))
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
    diagonal_.push_back(diagonal);
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
