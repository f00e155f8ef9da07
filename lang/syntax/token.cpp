#include "lang/syntax/token.h"

#include <array>
#include <cstddef>

namespace tf::syntax {

namespace {

constexpr std::string_view spellings[] = {
#define TF_TOKEN(name, spelling) spelling,
#define TF_KEYWORD(name, spelling) spelling,
#include "lang/syntax/tokens.def"
};

constexpr std::size_t kindCount = std::size(spellings);
constexpr auto firstKeyword = static_cast<std::size_t>(TokenKind::Algorithm);

// Open addressing over the keywords; the load is low enough that most words that are none need one look.
constexpr std::size_t tableSize = 256;

constexpr std::size_t hash(std::string_view word) {
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(word[i])); };
  return (at(0) * 31 + at(word.size() - 1) * 7 + at(word.size() / 2) * 3 + word.size()) % tableSize;
}

constexpr std::array<std::uint8_t, tableSize> makeTable() {
  std::array<std::uint8_t, tableSize> table{};
  for (std::size_t kind = firstKeyword; kind < kindCount; ++kind) {
    std::size_t slot = hash(spellings[kind]);
    while (table[slot] != 0)
      slot = (slot + 1) % tableSize;
    table[slot] = static_cast<std::uint8_t>(kind);
  }
  return table;
}

constexpr std::array<std::uint8_t, tableSize> table = makeTable();

}  // namespace

std::string_view spelling(TokenKind kind) { return spellings[static_cast<std::size_t>(kind)]; }

bool isKeyword(TokenKind kind) { return static_cast<std::size_t>(kind) >= firstKeyword; }

TokenKind keyword(std::string_view word) {
  if (word.size() < 2)
    return TokenKind::Identifier;
  for (std::size_t slot = hash(word); table[slot] != 0; slot = (slot + 1) % tableSize) {
    if (spellings[table[slot]] == word)
      return static_cast<TokenKind>(table[slot]);
  }
  return TokenKind::Identifier;
}

}  // namespace tf::syntax
