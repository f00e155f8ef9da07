#include "runtime/contact/matrix_parts.h"

#include <algorithm>
#include <numeric>

namespace tf::runtime {

void MatrixParts::find(const double *matrix, int size) {
  const auto entry = [matrix, size](int row, int column) { return matrix[static_cast<std::ptrdiff_t>(column) * size + row]; };
  others_.resize(static_cast<std::size_t>(size));
  std::iota(others_.begin(), others_.end(), 0);
  rows_.clear();
  begin_.assign(1, 0);
  while (!others_.empty()) {
    const std::size_t first = rows_.size();
    rows_.push_back(others_.front());
    others_.erase(others_.begin());
    for (std::size_t k = first; k < rows_.size(); ++k)
      std::erase_if(others_, [&, row = rows_[k]](int other) {
        const bool isCoupled = entry(other, row) != 0 || entry(row, other) != 0;
        if (isCoupled)
          rows_.push_back(other);
        return isCoupled;
      });
    std::sort(rows_.begin() + static_cast<std::ptrdiff_t>(first), rows_.end());
    begin_.push_back(static_cast<int>(rows_.size()));
  }
}

}  // namespace tf::runtime
