#include "runtime/contact/matrix_parts.h"

#include "runtime/contact/coupling.h"

#include <algorithm>
#include <ranges>

namespace tf::runtime {

void MatrixParts::find(const double *matrix, int size) {
  const auto entry = [matrix, size](int row, int column) { return matrix[static_cast<std::ptrdiff_t>(column) * size + row]; };
  const auto all = std::views::iota(0, size);
  isListed_.assign(static_cast<std::size_t>(size), 0);
  rows_.clear();
  begin_.assign(1, 0);
  for (const int first : all) {
    if (isListed_[first])
      continue;
    isListed_[first] = 1;
    part_.assign(1, first);
    addCoupled(part_, isListed_, all, [&entry](int a, int b) { return entry(b, a) != 0 || entry(a, b) != 0; });
    std::sort(part_.begin(), part_.end());
    rows_.insert(rows_.end(), part_.begin(), part_.end());
    begin_.push_back(static_cast<int>(rows_.size()));
  }
}

}  // namespace tf::runtime
