#include "runtime/model/nearest_name.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace tf::runtime {

int editDistance(std::string_view a, std::string_view b, int limit) {
  const std::size_t n = b.size();
  if (std::abs(static_cast<long>(a.size()) - static_cast<long>(n)) > limit)
    return limit + 1;
  std::vector<int> beforeLast(n + 1), last(n + 1), row(n + 1);
  for (std::size_t j = 0; j <= n; ++j)
    last[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    int least = row[0];
    for (std::size_t j = 1; j <= n; ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], beforeLast[j - 2] + 1);
      least = std::min(least, row[j]);
    }
    if (least > limit)
      return limit + 1;
    std::swap(beforeLast, last);
    std::swap(last, row);
  }
  return std::min(last[n], limit + 1);
}

NearestName::NearestName(std::string_view written)
    : written_(written), distance_(static_cast<int>(std::clamp<std::size_t>(written.size() / 3, 1, 4)) + 1) {}

void NearestName::offer(std::string_view candidate) {
  const int distance = editDistance(written_, candidate, distance_ - 1);
  if (distance < distance_) {
    distance_ = distance;
    best_ = candidate;
  }
}

std::string NearestName::suggestion() const { return best_.empty() ? "" : "; did you mean '" + best_ + "'?"; }

}  // namespace tf::runtime
