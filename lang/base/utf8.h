// Reading UTF-8 (RFC 3629: no surrogates, no overlong forms, at most U+10FFFF).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tf {

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t length = 0;  // in bytes; 0: the text does not start with a valid sequence
};

// The first code point of a text that is not empty.
[[nodiscard]] CodePoint decode(std::string_view text);

// The offset of the first byte at or after `from` that is not part of a valid sequence, the size of the text if there is none.
[[nodiscard]] std::size_t findInvalid(std::string_view text, std::size_t from = 0);

}  // namespace tf
