// The kinds of diagnostics of ordinary equations (TF05xx).
#pragma once

#include "lang/base/diagnostics.h"

namespace tf::equations::diag {

#define TF_DIAGNOSTIC(name, code, severity, format) inline constexpr DiagnosticKind name{code, Severity::severity, #name, format};
#include "compiler/equations/diagnostics.def"
#undef TF_DIAGNOSTIC

// Every registered kind, in the order of the codes.
inline constexpr const DiagnosticKind *kAll[] = {
#define TF_DIAGNOSTIC(name, code, severity, format) &name,
#include "compiler/equations/diagnostics.def"
#undef TF_DIAGNOSTIC
};

}  // namespace tf::equations::diag
