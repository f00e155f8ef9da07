#include "runtime/simulate/event_progress.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

bool EventProgress::add(double time) {
  const int most = 1000 + 100 * elements;
  constexpr double shortTime = 1e-7;    // of the run up to here, and of a second
  constexpr double resolution = 2e-12;  // of the time, which may have begun long before the run
  if (time > since + std::max(shortTime * std::max(1.0, time - begin), resolution * std::abs(time))) {
    since = time;
    count = 0;
  }
  return ++count <= most;
}

void SwitchProgress::start(int switches) {
  faint_.assign(switches, 0);
  latest_.resize(switches);
  for (std::array<double, several> &times : latest_)
    times.fill(-std::numeric_limits<double>::infinity());
}

bool SwitchProgress::add(int j, double between) {
  constexpr int most = 100;
  constexpr double rounding = 2e-11;
  faint_[j] = std::abs(between) <= rounding ? faint_[j] + 1 : 0;
  return faint_[j] <= most;
}

void SwitchProgress::changed(int j, double time) {
  std::array<double, several> &times = latest_[j];
  std::copy_backward(times.begin(), times.end() - 1, times.end());
  times.front() = time;
}

bool SwitchProgress::isRapid(int j, double time) const {
  const std::array<double, several> &times = latest_[j];
  return std::isfinite(times.back()) && time - times.front() <= times.front() - times.back();
}

}  // namespace tf::runtime
