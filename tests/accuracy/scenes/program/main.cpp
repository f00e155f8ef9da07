// random_scenes --show SEED: the model of a scene, and as its first line the command that runs it.
// random_scenes COUNT [FIRST_SEED]: runs so many random scenes, one line for each that does not end well, then a summary. Exit code 1 where
// a scene fails, takes more than ten seconds of CPU time or violates an invariant, or more than 0.5 % of them have no consistent
// continuation.
#include "tests/accuracy/scenes/random_scenes.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <string_view>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using tf::test::Scene;
using tf::test::SceneOutcome;

// What the child process that runs the scenes tells of each.
struct Report {
  SceneOutcome::Kind kind;
  double seconds, penetration, energyError;
};

struct Totals {
  int without = 0, bad = 0;
  double slowest = 0, seconds = 0, penetration = 0, energyError = 0;

  void add(const Report &report) {
    seconds += report.seconds;
    slowest = std::max(slowest, report.seconds);
    if (report.kind == SceneOutcome::Kind::Good) {
      penetration = std::max(penetration, report.penetration);
      energyError = std::max(energyError, report.energyError);
    } else {
      (report.kind == SceneOutcome::Kind::NoContinuation ? without : bad) += 1;
    }
  }
};

void show(std::uint64_t seed) {
  const Scene scene = tf::test::randomScene(seed);
  fmt::print("// tfc run scene.tf --stop-time 2 --tolerance 1e-8");
  for (const auto &[name, value] : scene.settings)
    fmt::print(" --set '{}={}'", name, value);
  fmt::print("\n{}", scene.model);
}

constexpr int timeLimit = 10;  // seconds of CPU time for a scene

// In a process of its own, which the timer or a crash may end.
void runScenes(int first, int end, int out) {
  constexpr itimerval limit = {{0, 0}, {timeLimit, 0}};
  for (int seed = first; seed < end; ++seed) {
    setitimer(ITIMER_PROF, &limit, nullptr);
    const Scene scene = tf::test::randomScene(static_cast<std::uint64_t>(seed));
    const SceneOutcome outcome = tf::test::runScene(scene);
    if (outcome.kind != SceneOutcome::Kind::Good)
      fmt::print("seed {} ({}): {}\n", seed, scene.name, outcome.text);
    std::fflush(stdout);
    const Report report{outcome.kind, outcome.seconds, outcome.penetration, outcome.energyError};
    if (write(out, &report, sizeof report) != sizeof report)
      std::exit(2);
  }
  std::exit(0);
}

// Runs scenes from `first` in a child process; the seed behind the last one that ended.
int runUntilItEnds(int first, int end, Totals &totals) {
  int ends[2];
  if (pipe(ends) != 0)
    std::exit(2);
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    runScenes(first, end, ends[1]);
  }
  close(ends[1]);
  int seed = first;
  Report report{};
  for (; read(ends[0], &report, sizeof report) == sizeof report; ++seed)
    totals.add(report);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (seed < end) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF)
      fmt::print("seed {}: more than {} s\n", seed, timeLimit);
    else
      fmt::print("seed {}: {}\n", seed, WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "the process ended");
    ++totals.bad;
    ++seed;
  }
  return seed;
}

}  // namespace

int main(int argc, char **argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: random_scenes COUNT [FIRST_SEED]\n");
    return 2;
  }
  if (argc == 3 && std::string_view(argv[1]) == "--show") {
    show(static_cast<std::uint64_t>(std::atoll(argv[2])));
    return 0;
  }
  const int count = std::atoi(argv[1]), first = argc > 2 ? std::atoi(argv[2]) : 1;
  Totals totals;
  for (int seed = first; seed < first + count;)
    seed = runUntilItEnds(seed, first + count, totals);
  fmt::print("{} scenes: {} without continuation, {} bad; worst penetration {:.1e}, energy error {:.1e}; CPU {:.1f} s, slowest {:.2f} s\n",
             count, totals.without, totals.bad, totals.penetration, totals.energyError, totals.seconds, totals.slowest);
  return totals.bad > 0 || 200 * totals.without > count ? 1 : 0;
}
