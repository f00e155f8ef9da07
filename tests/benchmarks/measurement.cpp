#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tf::bench {

namespace {

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

[[noreturn]] void becomeProgram(std::vector<char *> &arguments, const std::string &cache) {
  unsetenv("TFC_CACHE_DIR");
  setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  const int nowhere = open("/dev/null", O_RDWR);
  dup2(nowhere, STDIN_FILENO);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  execv(arguments[0], arguments.data());
  _exit(127);
}

}  // namespace

double wallSeconds() { return seconds(CLOCK_MONOTONIC); }
double cpuSeconds() { return seconds(CLOCK_PROCESS_CPUTIME_ID); }

std::vector<double> cpuPerCall(const std::vector<std::function<void()>> &calls) {
  constexpr double batchSeconds = 1e-3, turnsSeconds = 0.2;  // of one call: of a batch, of all of its turns
  constexpr int fewestTurns = 5;
  struct Timing {
    int batch = 1;                                          // calls in a row
    double best = std::numeric_limits<double>::infinity();  // seconds of a call
  };
  const auto measureBatch = [](const std::function<void()> &call, Timing &timing) {
    const double start = cpuSeconds();
    for (int i = 0; i < timing.batch; ++i) {
      call();
    }
    timing.best = std::min(timing.best, (cpuSeconds() - start) / timing.batch);
  };
  std::vector<Timing> timings(calls.size());
  double batches = 0;  // seconds of one batch of each
  for (std::size_t k = 0; k < calls.size(); ++k) {
    calls[k]();
    measureBatch(calls[k], timings[k]);
    timings[k].batch = std::clamp(static_cast<int>(batchSeconds / std::max(timings[k].best, 1e-8)), 1, 100000);
    batches += timings[k].batch * timings[k].best;
  }
  const double turns = turnsSeconds * static_cast<double>(calls.size()) / std::max(batches, 1e-8);
  for (int turn = 0; turn < std::max(fewestTurns, static_cast<int>(turns)); ++turn) {
    for (std::size_t k = 0; k < calls.size(); ++k) {
      measureBatch(calls[k], timings[k]);
    }
  }
  std::vector<double> seconds;
  seconds.reserve(timings.size());
  for (const Timing &timing : timings) {
    seconds.push_back(timing.best);
  }
  return seconds;
}

double cpuPerCall(const std::function<void()> &call) { return cpuPerCall(std::vector{call}).front(); }

ProgramTime runProgram(const std::vector<std::string> &arguments, const std::string &cache) {
  std::vector<std::string> copies = arguments;
  std::vector<char *> pointers;
  for (std::string &argument : copies) {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  const double start = wallSeconds();
  const pid_t child = fork();
  if (child < 0) {
    throw std::runtime_error("cannot start a process");
  }
  if (child == 0) {
    becomeProgram(pointers, cache);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  const double elapsed = wallSeconds() - start;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error(fmt::format("'{}' failed", fmt::join(arguments, " ")));
  }
  const auto cpu = [](const timeval &time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return {elapsed, cpu(usage.ru_utime) + cpu(usage.ru_stime)};
}

std::string compileModel(const Setup &setup, const std::string &file, const std::vector<std::string> &options) {
  const std::string library = setup.work + "/" + std::filesystem::path(file).stem().string() + ".so";
  std::vector<std::string> arguments = {setup.tfc, "compile", file, "-o", library};
  arguments.insert(arguments.end(), options.begin(), options.end());
  runProgram(arguments, setup.work + "/cache");
  return library;
}

std::string table(const std::vector<Measurement> &measurements) {
  std::string out = fmt::format("{:<58} {:>12} {:<10} {:>10}\n", "figure", "measured", "unit", "bar");
  for (const Measurement &m : measurements) {
    const std::string bar = m.hasBar() ? fmt::format("{}{:.4g}", m.atLeast ? "≥ " : "≤ ", m.bar) : "";
    out += fmt::format("{:<58} {:>12.4g} {:<10} {:>10} {}{}\n", m.name, m.value, m.unit, bar,
                       !m.hasBar()  ? ""
                       : m.passes() ? "ok "
                                    : "MISSED ",
                       m.note);
  }
  return out;
}

std::string json(const std::vector<Measurement> &measurements) {
  nlohmann::json list = nlohmann::json::array();
  for (const Measurement &m : measurements) {
    nlohmann::json entry = {{"name", m.name}, {"unit", m.unit}, {"value", m.value}};
    if (m.hasBar()) {
      entry["bar"] = m.bar;
      entry["passes"] = m.passes();
    }
    if (!m.note.empty()) {
      entry["note"] = m.note;
    }
    list.push_back(std::move(entry));
  }
  return list.dump(1) + "\n";
}

}  // namespace tf::bench
