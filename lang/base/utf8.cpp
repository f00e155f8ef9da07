#include "lang/base/utf8.h"

#include <cstring>

namespace tf {

namespace {

// Eight bytes at once: most source text is ASCII.
std::size_t skipAscii(std::string_view text, std::size_t from) {
  constexpr std::uint64_t highBits = 0x8080808080808080U;
  std::uint64_t word = 0;
  while (from + sizeof word <= text.size()) {
    std::memcpy(&word, text.data() + from, sizeof word);
    if ((word & highBits) != 0)
      break;
    from += sizeof word;
  }
  while (from < text.size() && static_cast<unsigned char>(text[from]) < 0x80)
    ++from;
  return from;
}

}  // namespace

CodePoint decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80)
    return {lead, 1};
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || length > text.size())
    return {};
  std::uint32_t value = lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U)
      return {};
    value = value << 6U | (byte(i) & 0x3FU);
  }
  const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
  const bool surrogate = value >= 0xD800 && value < 0xE000;
  if (overlong || surrogate || value > 0x10FFFF)
    return {};
  return {value, length};
}

std::size_t findInvalid(std::string_view text, std::size_t from) {
  while ((from = skipAscii(text, from)) < text.size()) {
    const CodePoint point = decode(text.substr(from));
    if (point.length == 0)
      return from;
    from += point.length;
  }
  return text.size();
}

}  // namespace tf
