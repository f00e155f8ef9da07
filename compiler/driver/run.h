// `tfc run`.
#pragma once

#include "compiler/driver/options.h"
#include "compiler/driver/session.h"

namespace tf::driver {

// Exit code. Diagnostics are left in the session.
int runCommand(const RunOptions &options, Session &session);

}  // namespace tf::driver
