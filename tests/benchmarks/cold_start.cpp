// From a source file to results in a new process: with an empty cache of compiled models, and with a filled one.
#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace tf::bench {

std::vector<Measurement> coldStart(const Setup &setup) {
  const std::string file = TF_SOURCE_DIR "/examples/particle.tf";
  const std::vector<std::string> command = {setup.tfc, "run", file, "-o", setup.work + "/particle.csv"};
  std::vector<ProgramTime> cold, warm;
  for (int repetition = 0; repetition < 7; ++repetition) {
    const std::string cache = fmt::format("{}/cold-{}", setup.work, repetition);
    std::filesystem::create_directories(cache);
    cold.push_back(runProgram(command, cache));
    warm.push_back(runProgram(command, cache));
  }
  const auto measurement = [](const std::string &name, std::vector<ProgramTime> &times) {
    std::ranges::sort(times, {}, &ProgramTime::wall);
    const ProgramTime &median = times[times.size() / 2];
    return Measurement{.name = name,
                       .unit = "ms",
                       .value = 1e3 * median.wall,
                       .note = fmt::format("CPU {:.1f}, least {:.1f}", 1e3 * median.cpu, 1e3 * times[0].wall)};
  };
  std::vector<Measurement> out = {measurement("tfc run examples/particle.tf, cold (wall, median)", cold),
                                  measurement("tfc run examples/particle.tf, compiled before", warm)};
  out[0].bar = 80;
  return out;
}

}  // namespace tf::bench
