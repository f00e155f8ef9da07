// The forces of a mode whose redundant rows are equal, as those of a body that lies flat: what sets of equal unknowns add up to follows
// from square equations, and the least-norm force has equal shares of it.
#pragma once

#include "runtime/contact/lu_factor.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

class EqualShares {
public:
  // Sets of the unknowns that are forces of `rows` of D with equal columns; one that is alone [rows] is a set of its own. False: their
  // number is not `count`, that of the constraints.
  bool choose(const DenseMatrix &delassus, const std::vector<int> &rows, const std::vector<std::uint8_t> &isAlone, int count);

  [[nodiscard]] int count() const { return static_cast<int>(sample_.size()); }
  // Of the unknowns: its set.
  [[nodiscard]] const std::vector<int> &set() const { return set_; }
  // Of the sets: its first unknown, and √(number of unknowns).
  [[nodiscard]] int sample(int s) const { return sample_[s]; }
  [[nodiscard]] double root(int s) const { return root_[s]; }

  // Normal of a constraint [count], of unit length: its entry for the unknowns of a set times the root; then its bound.
  double *normal(int constraint) { return factor_.matrix().column(constraint); }
  double &bound(int constraint) { return bounds_[constraint]; }
  // False where a constraint depends on others: what is left of its normal is not above `dependence`.
  bool solve(double dependence);
  // Of each unknown of a set.
  [[nodiscard]] double share(int s) const { return bounds_[s] / root_[s]; }
  // Of the constraints, in the least-norm problem; after `solve`.
  const std::vector<double> &multipliers();

private:
  std::vector<int> set_, sample_;
  std::vector<double> root_;
  LuFactor factor_;
  std::vector<double> bounds_;  // after `solve`: of sets, √(number of unknowns) times each one's share
  std::vector<double> multipliers_;
  bool hasMultipliers_ = false;
};

}  // namespace tf::runtime
