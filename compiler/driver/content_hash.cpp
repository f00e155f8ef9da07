#include "compiler/driver/content_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace tf::driver {

namespace {

// Multiplication and a fold of the high half into the low one: every bit of the word reaches every bit of the state.
std::uint64_t mix(std::uint64_t state, std::uint64_t word, std::uint64_t factor) {
  state = (state ^ word) * factor;
  return state ^ (state >> 32U);
}

}  // namespace

ContentHash &ContentHash::add(std::uint64_t word) {
  state_[0] = mix(state_[0], word, 0xBF58476D1CE4E5B9U);
  state_[1] = mix(state_[1], word, 0x94D049BB133111EBU);
  return *this;
}

ContentHash &ContentHash::add(std::string_view text) {
  add(static_cast<std::uint64_t>(text.size()));
  while (!text.empty()) {
    std::uint64_t word = 0;
    const std::size_t bytes = std::min(text.size(), sizeof word);
    std::memcpy(&word, text.data(), bytes);
    add(word);
    text.remove_prefix(bytes);
  }
  return *this;
}

std::string ContentHash::hex() const {
  return fmt::format("{:016x}{:016x}", mix(state_[0], state_[1], 0xBF58476D1CE4E5B9U), mix(state_[1], state_[0], 0x94D049BB133111EBU));
}

}  // namespace tf::driver
