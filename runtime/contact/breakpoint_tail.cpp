#include "runtime/contact/breakpoint_tail.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Agreement of two successive contraction factors. The tail that is summed is a small part of the whole, and its error smaller by this.
constexpr double agreement = 1e-9;

}  // namespace

void BreakpointTail::reset(int width, int compared) {
  width_ = width;
  compared_ = compared;
  count_ = 0;
  period_ = 0;
  rows_.resize(memory);
  increments_.resize(static_cast<std::size_t>(memory) * static_cast<std::size_t>(width));
}

void BreakpointTail::add(int row, std::span<const double> increment) {
  ++count_;
  rows_[slot(0)] = row;
  std::copy(increment.begin(), increment.end(), increments_.begin() + static_cast<std::ptrdiff_t>(slot(0)) * width_);
}

bool BreakpointTail::sameRows(int period) const {
  for (int back = 0; back < 2 * period; ++back)
    if (row(back) != row(back + period))
      return false;
  return true;
}

void BreakpointTail::sumCycle(int period, int cyclesBack, std::vector<double> &sum) const {
  sum.assign(width_, 0.0);
  for (int back = cyclesBack * period; back < (cyclesBack + 1) * period; ++back) {
    const double *increment = increments_.data() + static_cast<std::ptrdiff_t>(slot(back)) * width_;
    for (int k = 0; k < width_; ++k)
      sum[k] += increment[k];
  }
}

bool BreakpointTail::repeats() {
  for (int period = 1; period <= longestPeriod && 3 * period <= count_; ++period) {
    if (!sameRows(period))
      continue;
    sumCycle(period, 0, cycle_);
    sumCycle(period, 1, before_);
    sumCycle(period, 2, earlier_);
    double product = 0, squares = 0, largest = 0;
    for (int k = 0; k < compared_; ++k) {
      product += cycle_[k] * before_[k];
      squares += before_[k] * before_[k];
      largest = std::max(largest, std::abs(before_[k]));
    }
    if (!(squares > 0))
      continue;
    factor_ = product / squares;
    bool constant = true;
    for (int k = 0; k < compared_ && constant; ++k)
      constant = std::abs(cycle_[k] - factor_ * before_[k]) <= agreement * largest &&
                 std::abs(before_[k] * factor_ - factor_ * factor_ * earlier_[k]) <= agreement * largest;
    if (constant) {
      period_ = period;
      variation_.assign(width_, 0.0);
      for (int back = 0; back < period; ++back)
        for (int k = 0; k < width_; ++k)
          variation_[k] += std::abs(increments_[static_cast<std::size_t>(slot(back)) * static_cast<std::size_t>(width_) + k]);
      return true;
    }
  }
  return false;
}

}  // namespace tf::runtime
