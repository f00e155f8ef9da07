// Strings of the source text.
#pragma once

#include "lang/syntax/ast.h"

#include <string>
#include <string_view>

namespace tf::semantics {

// The characters of a string literal: without quotes, escapes resolved (MLS 2.4.5).
[[nodiscard]] std::string unquote(std::string_view literal);
// `"a" + "b"` of a description.
[[nodiscard]] std::string descriptionOf(const ast::Comment &comment);

}  // namespace tf::semantics
