// What a run tells on the terminal: progress, summary, final values.
#pragma once

#include "compiler/driver/result_rows.h"
#include "runtime/tf.h"

#include <chrono>
#include <string>
#include <vector>

namespace tf::driver {

// CPU seconds of the process.
[[nodiscard]] double cpuTime();

// Where the CPU time went, in seconds; `compile` counts from the process' start.
struct RunTimes {
  double compile = 0, initialise = 0, simulate = 0;
};

// A line on the standard error that shows how far a run is, if that is a terminal and the run takes more than a second.
class Progress {
public:
  Progress(bool isWanted, double start, double stop);
  ~Progress();
  Progress(const Progress &) = delete;
  Progress &operator=(const Progress &) = delete;
  void at(double time);

private:
  using Clock = std::chrono::steady_clock;
  bool isWanted_, isShown_ = false;
  double start_, stop_;
  Clock::time_point next_;
};

struct SummaryInput {
  tf_simulation *simulation = nullptr;
  double startTime = 0;
  RunTimes times;
  std::string origin;  // of the code: "compiled", "cached", "loaded"
  bool isTerminated = false, isVerbose = false;
};

[[nodiscard]] std::string summary(const SummaryInput &input, const ResultRows &rows);

// "name = value unit" for time and what the patterns of --variables select; without any for coordinates, velocities, states and outputs.
[[nodiscard]] std::string finalValues(tf_simulation *simulation, const std::vector<std::string> &patterns);

}  // namespace tf::driver
