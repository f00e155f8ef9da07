// The `tfc` program.
#include "compiler/driver/check.h"
#include "compiler/driver/compile.h"
#include "compiler/driver/options.h"
#include "compiler/driver/run.h"
#include "compiler/driver/session.h"

namespace {

int execute(const tf::driver::CommandLine &line, tf::driver::Session &session) {
  using tf::driver::Command;
  switch (line.command) {
  case Command::Check:
    return checkCommand(line.check, session);
  case Command::Compile:
    return compileCommand(line.compile, session);
  case Command::Run:
    return runCommand(line.run, session);
  case Command::Nothing:
    break;
  }
  printOut(line.text, session);
  return session.exitCode();
}

}  // namespace

int main(int argc, char **argv) {
  tf::driver::Session session;
  const auto line = tf::driver::parseCommandLine(argc, argv, session.diagnostics);
  const int code = line ? execute(*line, session) : session.exitCode();
  session.print();
  return code;
}
