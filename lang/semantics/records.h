// Records as values: a record expression is never typed as a whole, only its fields are (MLS 12.6).
#pragma once

#include "lang/semantics/typing.h"

#include <span>

namespace tf::semantics {

// The part of an expression's value that `projections` name: fields of records, elements of arrays of records.
[[nodiscard]] ExprPtr typeProjected(Context &context, const ast::Expr &expr, const Scope &scope, std::span<const Projection> projections);

// The record class of an expression that stands for a whole record; null if it does not. Nothing is reported.
[[nodiscard]] Class *recordOf(Context &context, const ast::Expr &expr, const Scope &scope);

// The element of an array value that a projection names; the value's leading dimensions must be its sizes. Null: reported.
[[nodiscard]] ExprPtr projectIndex(Context &context, const ExprPtr &value, const Projection &projection);

}  // namespace tf::semantics
