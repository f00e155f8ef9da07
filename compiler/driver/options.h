// The command line of tfc as data.
#pragma once

#include "lang/base/diagnostics.h"
#include "runtime/tf.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace tf::driver {

// What all commands that read a model have in common.
struct ModelOptions {
  std::vector<std::string> files;
  std::string model;                   // --model
  std::vector<std::string> libraries;  // -L
  std::vector<std::string> settings;   // --set, as written: "name=value"
};

enum class Emit : std::uint8_t { Ast, Flat, Cls, Pss, Stewart, Step, LlvmIr, Assembly, Object, Shared, Header };

struct CheckOptions : ModelOptions {};

struct CompileOptions : ModelOptions {
  std::string output;  // -o; "-" is the standard output; empty: by form
  Emit emit = Emit::Shared;
  int optimization = 2;  // -O
};

enum class EventRows : std::uint8_t { Both, After };

struct RunOptions : ModelOptions {
  std::string inputTable;  // --input
  bool linearInput = false;
  std::optional<double> startTime, stopTime, tolerance, interval;
  tf_integrator integrator = TF_AUTO;
  int stages = 0;
  double fixedStep = 0;
  double longestStep = std::numeric_limits<double>::infinity();
  EventRows events = EventRows::Both;
  std::string output, eventLog;
  bool quiet = false, verbose = false, noCache = false;
  bool checkInvariants = false;
  std::vector<std::string> sensitivities;  // --sensitivity, as written, each once
  std::vector<std::string> variables;      // --variables, patterns as written
};

enum class Command : std::uint8_t { Nothing, Check, Compile, Run };

struct CommandLine {
  Command command = Command::Nothing;  // Nothing: `text` is to be printed and that is all
  std::string text;                    // of --help, --version
  CheckOptions check;
  CompileOptions compile;
  RunOptions run;
};

// Nothing if the command line is wrong (reported).
[[nodiscard]] std::optional<CommandLine> parseCommandLine(int argc, const char *const *argv, Diagnostics &diagnostics);

}  // namespace tf::driver
