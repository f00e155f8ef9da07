// Tokens of the language. Contextual words (`coordinate`, `optimization`, `constraint`) are identifiers here.
#pragma once

#include <cstdint>
#include <string_view>

namespace tf::syntax {

enum class TokenKind : std::uint8_t {
#define TF_TOKEN(name, spelling) name,
#define TF_KEYWORD(name, spelling) name,
#include "lang/syntax/tokens.def"
};

struct Token {
  TokenKind kind = TokenKind::EndOfFile;
  bool startsLine = false;    // the first token of its line
  bool followsError = false;  // characters before it were reported and skipped
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

// The spelling of punctuation and keywords, a description of the other kinds ("identifier").
[[nodiscard]] std::string_view spelling(TokenKind kind);
[[nodiscard]] bool isKeyword(TokenKind kind);
// The keyword with this spelling, `Identifier` if there is none.
[[nodiscard]] TokenKind keyword(std::string_view word);

}  // namespace tf::syntax
