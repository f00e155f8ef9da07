// Benchmarks of tfc: one table of figures, each beside its bar. --tfc PROGRAM [--json FILE] [--only WORD] [--sources DIR]
#include "tests/benchmarks/measurement.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

namespace {

struct Group {
  const char *name;
  std::vector<tf::bench::Measurement> (*measure)(const tf::bench::Setup &);
};

constexpr Group kGroups[] = {{"cold", tf::bench::coldStart},          {"hot", tf::bench::hotSimulation},
                             {"precision", tf::bench::workPrecision}, {"rhs", tf::bench::rightHandSide},
                             {"compile", tf::bench::compileTime},     {"parser", tf::bench::parserSpeed}};

std::string temporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "tf-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("cannot make a temporary folder");
  }
  return name;
}

int measure(std::map<std::string, std::string> options) {
  tf::bench::Setup setup{.tfc = options["--tfc"], .work = temporaryFolder(), .sources = options["--sources"]};
  std::vector<tf::bench::Measurement> all;
  bool failed = false;
  for (const Group &group : kGroups) {
    if (!options["--only"].empty() && options["--only"] != group.name) {
      continue;
    }
    try {
      const auto measurements = group.measure(setup);
      all.insert(all.end(), measurements.begin(), measurements.end());
    } catch (const std::exception &error) {
      std::fprintf(stderr, "tf_bench: %s: %s\n", group.name, error.what());
      failed = true;
    }
  }
  std::filesystem::remove_all(setup.work);
  std::fputs(tf::bench::table(all).c_str(), stdout);
  if (!options["--json"].empty()) {
    std::ofstream(options["--json"]) << tf::bench::json(all);
  }
  return failed ? 1 : 0;
}

}  // namespace

int main(int argc, char **argv) {
  std::map<std::string, std::string> options;
  for (int i = 1; i + 1 < argc; i += 2) {
    options[argv[i]] = argv[i + 1];
  }
  if (argc % 2 == 0 || options["--tfc"].empty()) {
    std::fprintf(stderr, "usage: tf_bench --tfc PROGRAM [--json FILE] [--only cold|hot|precision|rhs|compile|parser] [--sources DIR]\n");
    return 2;
  }
  try {
    return measure(options);
  } catch (const std::exception &error) {
    std::fprintf(stderr, "tf_bench: %s\n", error.what());
    return 1;
  }
}
