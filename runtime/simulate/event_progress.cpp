#include "runtime/simulate/event_progress.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

bool EventProgress::add(double time) {
  const int most = 1000 + 100 * elements;
  constexpr double shortTime = 1e-7;  // relative to the time, and of a second
  if (time > since + shortTime * std::max(1.0, std::abs(time)))
    start(time, elements);
  return ++count <= most;
}

bool SwitchProgress::add(int j, double between) {
  constexpr int most = 100;
  constexpr double rounding = 2e-11;
  faint_[j] = std::abs(between) <= rounding ? faint_[j] + 1 : 0;
  return faint_[j] <= most;
}

}  // namespace tf::runtime
