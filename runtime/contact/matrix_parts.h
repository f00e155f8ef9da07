// The parts that a square matrix falls into: sets of rows, and of the columns with the same numbers, between which it has no entries. Those
// of bodies apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tf::runtime {

class MatrixParts {
public:
  // Of the column-major matrix [size × size], by the entries that differ from zero.
  void find(const double *matrix, int size);
  [[nodiscard]] std::size_t count() const { return begin_.size() - 1; }
  // Rows of a part, ascending.
  [[nodiscard]] std::span<const int> rows(std::size_t part) const {
    return {rows_.data() + begin_[part], static_cast<std::size_t>(begin_[part + 1] - begin_[part])};
  }

private:
  std::vector<int> begin_{0}, rows_;  // of parts in rows_, and the end
  std::vector<int> part_;             // that is being found
  std::vector<std::uint8_t> isListed_;
};

}  // namespace tf::runtime
