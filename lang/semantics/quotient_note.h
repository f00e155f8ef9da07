// What to write where a quotient of Integers, which is a Real, is given for an Integer.
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/semantics/flat_model.h"
#include "lang/syntax/ast.h"

namespace tf::semantics {

// Adds a note to the diagnostic about `written`, whose typed form is `value`, if that is the reason.
void noteQuotient(Diagnostic &diagnostic, const ast::Expr &written, const flat::Expr &value);

}  // namespace tf::semantics
