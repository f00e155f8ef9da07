// M as its products with a few directions tell it: some of its columns, and two weighted sums of all of them, of which, for a matrix whose
// rows are sums of few vectors, one gives the diagonal and the other shows whether the rest is as it should be.
#pragma once

#include "runtime/abi/tf_model.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tf::runtime {

class MassSample {
public:
  static constexpr int sums = 2;
  static constexpr int mostColumns = TF_DIRECTIONS - sums;

  // These columns, mostColumns at most, of M [n × n] and sums of columns whose weights are of the size of `scale` [n].
  void choose(std::span<const int> columns, std::span<const double> scale);
  [[nodiscard]] bool has(int column) const { return place_[column] >= 0; }

  // [n × TF_DIRECTIONS]; after the products have been evaluated, read().
  [[nodiscard]] const double *directions() const { return directions_.data(); }
  [[nodiscard]] double *products() { return products_.data(); }
  void read();

  // [n]; zeros where the sample does not have it
  [[nodiscard]] const double *column(int column) const {
    return columns_.data() + static_cast<std::ptrdiff_t>(has(column) ? place_[column] : mostColumns) * size_;
  }
  // Of row i, with sum k < sums.
  [[nodiscard]] double weight(int i, int k) const { return directions_[laneOf(i, k)]; }
  [[nodiscard]] double sum(int i, int k) const { return products_[laneOf(i, k)]; }

  // M_ii, once it has been found out of the sums.
  [[nodiscard]] bool hasDiagonal() const { return hasDiagonal_; }
  [[nodiscard]] const std::vector<double> &diagonal() const { return diagonal_; }
  void setDiagonal(int i, double value) { diagonal_[i] = value; }
  void keepDiagonal() { hasDiagonal_ = true; }

private:
  [[nodiscard]] static std::size_t laneOf(int i, int k) { return static_cast<std::size_t>(i) * TF_DIRECTIONS + mostColumns + k; }

  int size_ = 0, columnCount_ = 0;
  std::vector<int> place_;  // of columns in columns_; −1: none
  std::vector<double> directions_, products_, columns_, diagonal_;
  bool hasDiagonal_ = false;
};

}  // namespace tf::runtime
