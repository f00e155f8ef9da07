// The kinds of diagnostics of mechanical elements and the derived system (TF06xx).
#pragma once

#include "lang/base/diagnostics.h"

namespace tf::mechanics::diag {

#define TF_DIAGNOSTIC(name, code, severity, format) inline constexpr DiagnosticKind name{code, Severity::severity, #name, format};
#include "compiler/mechanics/diagnostics.def"
#undef TF_DIAGNOSTIC

// Every registered kind, in the order of the codes.
inline constexpr const DiagnosticKind *kAll[] = {
#define TF_DIAGNOSTIC(name, code, severity, format) &name,
#include "compiler/mechanics/diagnostics.def"
#undef TF_DIAGNOSTIC
};

}  // namespace tf::mechanics::diag
