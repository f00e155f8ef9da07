// The diagnostic kinds of this folder's diagnostics.def.
#pragma once

#include "lang/base/diagnostics.h"

namespace tf::syntax {

#define TF_DIAGNOSTIC(name, code, severity, format) inline constexpr DiagnosticKind name{code, Severity::severity, #name, format};
#include "lang/syntax/diagnostics.def"
#undef TF_DIAGNOSTIC

}  // namespace tf::syntax
