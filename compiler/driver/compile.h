// `tfc compile`.
#pragma once

#include "compiler/driver/options.h"
#include "compiler/driver/session.h"

namespace tf::driver {

int compileCommand(const CompileOptions &options, Session &session);

}  // namespace tf::driver
