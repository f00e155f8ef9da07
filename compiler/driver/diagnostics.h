// The kinds of diagnostics of the command line and files (TF08xx) and of runs (TF09xx).
#pragma once

#include "lang/base/diagnostics.h"

namespace tf::driver::diag {

#define TF_DIAGNOSTIC(name, code, severity, format) inline constexpr DiagnosticKind name{code, Severity::severity, #name, format};
#include "compiler/driver/diagnostics.def"
#undef TF_DIAGNOSTIC

}  // namespace tf::driver::diag
