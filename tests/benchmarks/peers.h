// Other simulators, each in a program of its own beside tf_bench that is built only where their packages are installed. Such a program is
// called with the name of a case and a step length and prints the CPU seconds of one run (the least of several) and the values that the
// case compares, in one line.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tf::bench {

struct PeerRun {
  double seconds = 0;
  std::vector<double> values;
};

// Nothing where the program is not there or does not know the case.
[[nodiscard]] std::optional<PeerRun> runPeer(const std::string &program, const std::string &name, double step);

}  // namespace tf::bench
