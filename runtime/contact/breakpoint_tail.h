// Finds out that the breakpoints of a frozen phase repeat: a cycle of the same rows whose pieces shrink by a constant factor has infinitely
// many breakpoints in finite numerical time, and its sum is geometric (theory.md section 3). With the factor 1 it repeats as it is.
#pragma once

#include <span>
#include <vector>

namespace tf::runtime {

class BreakpointTail {
public:
  // `width`: number of values that a piece changes (velocities, impulses and τ), of which the first `compared` shrink by the factor of
  // the cycle; the others (work, quadratic in velocities) are only recorded.
  void reset(int width, int compared);
  // The piece that ends at a zero of `row`, with its increments.
  void add(int row, std::span<const double> increment);

  // The last cycles repeat with a constant factor; then period() and factor() say how.
  bool repeats();
  [[nodiscard]] int period() const { return period_; }
  [[nodiscard]] double factor() const { return factor_; }
  // Sum of all increments to come, of value k: its increment over the last cycle times factor/(1 − factor).
  [[nodiscard]] double tail(int k) const { return cycle_[k] * factor_ / (1 - factor_); }
  // Increment of value k over the last cycle, and the sum of the magnitudes of its parts.
  [[nodiscard]] double cycle(int k) const { return cycle_[k]; }
  [[nodiscard]] double cycleVariation(int k) const { return variation_[k]; }
  // At least the sum of the magnitudes of all increments to come, of value k.
  [[nodiscard]] double variation(int k) const { return variation_[k] * factor_ / (1 - factor_); }
  // Row of the piece `back` pieces ago (0: the last).
  [[nodiscard]] int row(int back) const { return rows_[slot(back)]; }

private:
  static constexpr int longestPeriod = 32, memory = 3 * longestPeriod;
  [[nodiscard]] int slot(int back) const { return static_cast<int>((count_ - 1 - back) % memory); }
  [[nodiscard]] bool sameRows(int period) const;
  void sumCycle(int period, int cyclesBack, std::vector<double> &sum) const;

  int width_ = 0, compared_ = 0, period_ = 0;
  long count_ = 0;
  double factor_ = 0;
  std::vector<int> rows_;
  std::vector<double> increments_, cycle_, before_, earlier_, variation_;
};

}  // namespace tf::runtime
