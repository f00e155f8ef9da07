#include "compiler/driver/session.h"
#include "compiler/driver/diagnostics.h"
#include "lang/semantics/diagnostics.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace tf::driver {

// The front end's diagnostics about expressions of `--set` and about a `--model` that is not there.
bool Session::isOfCommandLine(const Diagnostic &diagnostic) const {
  if (diagnostic.span.valid())
    return sources.file(diagnostic.span.file).path().starts_with(kSettingPrefix);
  return diagnostic.kind == &semantics::diag::UnknownModel;
}

int Session::exitCode() const {
  int code = kDone;
  for (const Diagnostic &diagnostic : diagnostics.all()) {
    if (diagnostic.kind->severity != Severity::Error)
      continue;
    const std::string_view family = std::string_view(diagnostic.kind->code).substr(0, 4);
    if (family == "TF09")
      return kRunFailed;
    code = std::max<int>(code, family == "TF08" || isOfCommandLine(diagnostic) ? kCommandLineWrong : kModelWrong);
  }
  return code;
}

void Session::print() const {
  const std::string text = render(diagnostics, sources);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

bool printOut(std::string_view text, Session &session) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
    return true;
  session.diagnostics.report(diag::CannotWrite, {}, fmt::format("cannot write to the standard output: {}", std::strerror(errno)));
  return false;
}

std::string number(double value) { return fmt::format("{}", value == 0 ? 0.0 : value); }

}  // namespace tf::driver
