// `tfc check`.
#pragma once

#include "compiler/driver/options.h"
#include "compiler/driver/session.h"

namespace tf::driver {

// Reports what is wrong with the files' models: the one named, else all that could be run. Prints a line for each model that is right.
int checkCommand(const CheckOptions &options, Session &session);

}  // namespace tf::driver
