// `tfc run --check-invariants`: what must hold at every point of a run.
#pragma once

#include "compiler/driver/session.h"
#include "runtime/tf.h"

namespace tf::driver {

// Prints the worst values of a run with energy balance to the standard error, and reports those that are too large: penetrations and
// residuals of constraints of more than 1e-9 in units of their nominal, normal forces below -1e-8, and energy errors above 100 times the
// tolerance, but at least 1e-7.
void reportInvariants(tf_simulation *simulation, double tolerance, Session &session);

}  // namespace tf::driver
