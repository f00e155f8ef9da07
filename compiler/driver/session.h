// What one invocation of the program works with: the texts that were read and the diagnostics that were found.
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/base/source.h"

#include <string_view>

namespace tf::driver {

// language.md section 6.
enum ExitCode : int { kDone = 0, kModelWrong = 1, kCommandLineWrong = 2, kRunFailed = 3 };

// Texts of `--set NAME=…` have the path "--set NAME".
inline constexpr const char *kSettingPrefix = "--set ";

struct Session {
  SourceManager sources;
  Diagnostics diagnostics;

  // The diagnostic is about the command line: TF08xx; about a run: TF09xx; otherwise about the model. 0 without errors.
  [[nodiscard]] int exitCode() const;
  // Writes all diagnostics to the standard error.
  void print() const;

private:
  [[nodiscard]] bool isOfCommandLine(const Diagnostic &diagnostic) const;
};

// Writes to the standard output, errors of which (a closed pipe, a full disk) are reported; false then.
bool printOut(std::string_view text, Session &session);

// "-5.25e-05": the shortest text that is read back as the same number.
[[nodiscard]] std::string number(double value);

}  // namespace tf::driver
