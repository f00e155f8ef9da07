// Figures of the benchmarks, their bars, and clocks.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace tf::bench {

struct Measurement {
  std::string name, unit;
  double value = 0;
  double bar = std::numeric_limits<double>::quiet_NaN();  // NaN: none
  bool atLeast = false;                                   // the bar is a lower one
  std::string note = {};

  [[nodiscard]] bool hasBar() const { return bar == bar; }
  [[nodiscard]] bool passes() const { return !hasBar() || (atLeast ? value >= bar : value <= bar); }
};

struct Setup {
  std::string tfc;      // the program
  std::string work;     // an empty folder for files
  std::string sources;  // Modelica sources for the parser; empty: generated ones
};

// Each throws std::runtime_error if it cannot measure.
[[nodiscard]] std::vector<Measurement> coldStart(const Setup &setup);
[[nodiscard]] std::vector<Measurement> hotSimulation(const Setup &setup);
// Prints its table as it goes; the figures are those that have bars.
[[nodiscard]] std::vector<Measurement> workPrecision(const Setup &setup);
[[nodiscard]] std::vector<Measurement> rightHandSide(const Setup &setup);
[[nodiscard]] std::vector<Measurement> compileTime(const Setup &setup);
[[nodiscard]] std::vector<Measurement> parserSpeed(const Setup &setup);

[[nodiscard]] double wallSeconds();
[[nodiscard]] double cpuSeconds();  // of this process

// CPU time of one call in seconds, for each of `calls`: the least mean over many batches of about 1 ms (at least one call). The calls take
// turns batch by batch: what shares a core with this process slows all of them for tenths of a second at a time, and a ratio of two of them
// would tell which was measured when.
[[nodiscard]] std::vector<double> cpuPerCall(const std::vector<std::function<void()>> &calls);
[[nodiscard]] double cpuPerCall(const std::function<void()> &call);

struct ProgramTime {
  double wall = 0, cpu = 0;  // seconds
};

// Runs a program (argv[0] is its path) without output. Throws with its arguments if it does not exit with 0. `cache`: the folder of
// compiled models that it uses.
ProgramTime runProgram(const std::vector<std::string> &arguments, const std::string &cache);

// `tfc compile` of a file into a shared library in the work folder; its path.
[[nodiscard]] std::string compileModel(const Setup &setup, const std::string &file, const std::vector<std::string> &options = {});

[[nodiscard]] std::string table(const std::vector<Measurement> &measurements);
[[nodiscard]] std::string json(const std::vector<Measurement> &measurements);

}  // namespace tf::bench
