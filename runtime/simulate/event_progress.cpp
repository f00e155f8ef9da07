#include "runtime/simulate/event_progress.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

bool EventProgress::add(double time) {
  constexpr int most = 1000;
  constexpr double shortTime = 1e-7;  // relative to the time, and of a second
  if (time > since + shortTime * std::max(1.0, std::abs(time)))
    start(time);
  return ++count <= most;
}

}  // namespace tf::runtime
