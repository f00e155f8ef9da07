#include "runtime/integrate/mass_sample.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tf::runtime {

void MassSample::choose(std::span<const int> columns, std::span<const double> scale) {
  assert(columns.size() <= mostColumns);
  size_ = static_cast<int>(scale.size());
  columnCount_ = static_cast<int>(columns.size());
  place_.assign(scale.size(), -1);
  directions_.assign(scale.size() * TF_DIRECTIONS, 0.0);
  products_.resize(directions_.size());
  columns_.assign((mostColumns + 1) * scale.size(), 0.0);
  diagonal_.resize(scale.size());
  hasDiagonal_ = false;
  for (int k = 0; k < columnCount_; ++k) {
    place_[columns[k]] = k;
    directions_[static_cast<std::size_t>(columns[k]) * TF_DIRECTIONS + k] = 1;
  }
  // Multiples of the golden ratio, which no pattern of the rows can meet, as weights between 1/2 and 1 of either sign: sums of equal terms
  // stay small, and each of them shows.
  constexpr double ratio[sums] = {0.6180339887498949, 0.7548776662466927};
  for (int k = 0; k < sums; ++k)
    for (int i = 0; i < size_; ++i) {
      const double part = std::fmod((i + 1) * ratio[k], 1.0);
      directions_[laneOf(i, k)] = (part < 0.5 ? 0.5 + part : -part) * scale[i];
    }
}

void MassSample::read() {
  for (int k = 0; k < columnCount_; ++k) {
    double *column = columns_.data() + static_cast<std::ptrdiff_t>(k) * size_;
    for (int i = 0; i < size_; ++i)
      column[i] = products_[static_cast<std::size_t>(i) * TF_DIRECTIONS + k];
  }
  hasDiagonal_ = false;
}

}  // namespace tf::runtime
