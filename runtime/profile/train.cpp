// Runs compiled models as the runtime's users do, for gcc to count how often its code runs: tf_train LIST, a file with a line for each
// model, LIBRARY END. Each takes about the same time, whatever its size: what is hot in a small model counts as much as in a large one.
#include "runtime/tf.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>

namespace {

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

bool simulate(tf_simulation *simulation, double tolerance, double end) {
  return tf_set_tolerance(simulation, tolerance) == TF_OK && tf_initialise(simulation, 0) == TF_OK && tf_step(simulation, end) == TF_OK;
}

bool train(const std::string &library, double end) {
  constexpr double tolerances[] = {1e-2, 1e-4, 1e-6, 1e-8};
  constexpr double seconds = 0.2;  // for each tolerance
  constexpr int mostRuns = 5000;
  tf_simulation *simulation = nullptr;
  bool good = tf_load(library.c_str(), &simulation) == TF_OK;
  for (const double tolerance : tolerances) {
    const double start = cpuSeconds();
    good = good && simulate(simulation, tolerance, end);
    const int runs = std::min(static_cast<int>(seconds / std::max(cpuSeconds() - start, 1e-6)), mostRuns);
    for (int run = 0; run < runs && good; ++run)
      good = simulate(simulation, tolerance, end);
  }
  if (!good)
    std::fprintf(stderr, "%s: %s\n", library.c_str(), tf_error_text(simulation));
  tf_free(simulation);
  return good;
}

}  // namespace

int main(int argc, char **argv) {
  std::ifstream list(argc == 2 ? argv[1] : "");
  std::string library;
  double end = 0;
  int models = 0;
  for (; list >> library >> end; ++models)
    if (!train(library, end))
      return 1;
  return models > 0 ? 0 : 2;
}
