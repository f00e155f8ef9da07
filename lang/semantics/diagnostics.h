// The kinds of diagnostics of names and modification (TF02xx), mechanical elements (TF03xx) and types, arrays, units (TF04xx).
#pragma once

#include "lang/base/diagnostics.h"

namespace tf::semantics::diag {

#define TF_DIAGNOSTIC(name, code, severity, format) inline constexpr DiagnosticKind name{code, Severity::severity, #name, format};
#include "lang/semantics/diagnostics.def"
#undef TF_DIAGNOSTIC

// Every registered kind, in the order of the codes.
inline constexpr const DiagnosticKind *kAll[] = {
#define TF_DIAGNOSTIC(name, code, severity, format) &name,
#include "lang/semantics/diagnostics.def"
#undef TF_DIAGNOSTIC
};

}  // namespace tf::semantics::diag
