// From a source file to results in a new process: with an empty cache of compiled models, and with a filled one.
#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace tf::bench {

std::vector<Measurement> coldStart(const Setup &setup) {
  const std::string file = TF_SOURCE_DIR "/examples/particle.tf";
  const std::vector<std::string> command = {setup.tfc, "run", file, "-o", setup.work + "/particle.csv"};
  std::vector<double> cold, warm;
  for (int repetition = 0; repetition < 7; ++repetition) {
    const std::string cache = fmt::format("{}/cold-{}", setup.work, repetition);
    std::filesystem::create_directories(cache);
    cold.push_back(runProgram(command, cache));
    warm.push_back(runProgram(command, cache));
  }
  std::ranges::sort(cold);
  std::ranges::sort(warm);
  const std::size_t median = cold.size() / 2;
  return {{.name = "tfc run examples/particle.tf, cold (wall, median)",
           .unit = "ms",
           .value = 1e3 * cold[median],
           .bar = 80,
           .note = fmt::format("least {:.1f}", 1e3 * cold[0])},
          {.name = "tfc run examples/particle.tf, compiled before",
           .unit = "ms",
           .value = 1e3 * warm[median],
           .note = fmt::format("least {:.1f}", 1e3 * warm[0])}};
}

}  // namespace tf::bench
