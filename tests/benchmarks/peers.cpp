#include "tests/benchmarks/peers.h"

#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <sstream>

namespace tf::bench {

std::optional<PeerRun> runPeer(const std::string &program, const std::string &name, double step) {
  if (!std::filesystem::exists(program)) {
    return std::nullopt;
  }
  // One thread: CPU time is compared.
  const std::string command = fmt::format("OPENBLAS_NUM_THREADS=1 '{}' {} {:.17g} 2>/dev/null", program, name, step);
  std::string text;
  FILE *pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return std::nullopt;
  }
  char part[256];
  while (std::fgets(part, sizeof part, pipe) != nullptr) {
    text += part;
  }
  if (pclose(pipe) != 0) {
    return std::nullopt;
  }
  // The simulators may print lines of their own before.
  std::istringstream line(text.substr(text.find_last_of('\n', text.size() - 2) + 1));
  PeerRun run;
  if (!(line >> run.seconds)) {
    return std::nullopt;
  }
  for (double value = 0; line >> value;) {
    run.values.push_back(value);
  }
  return run;
}

}  // namespace tf::bench
