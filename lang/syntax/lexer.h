// From text to tokens. Errors are reported and repaired here: every text has a token sequence, which ends with EndOfFile.
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/syntax/token.h"

#include <vector>

namespace tf::syntax {

struct LexedText {
  std::vector<Token> tokens;
  std::vector<Span> comments;  // `//` and `/* */`, in order
  // From here on tokens mean nothing (an unterminated string or comment, a text that is not UTF-8): errors after it would be cascades.
  std::uint32_t unreliableFrom = UINT32_MAX;
};

[[nodiscard]] LexedText lex(const SourceManager &sources, FileId file, Diagnostics &diagnostics);

}  // namespace tf::syntax
