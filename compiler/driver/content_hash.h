// 128 bits of hash over texts and numbers, for names of cached files. Not cryptographic.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tf::driver {

class ContentHash {
public:
  // Each text counts with its length, so that {"ab", "c"} differs from {"a", "bc"}.
  ContentHash &add(std::string_view text);
  ContentHash &add(std::uint64_t word);
  // 32 hexadecimal digits.
  [[nodiscard]] std::string hex() const;

private:
  std::array<std::uint64_t, 2> state_ = {0x9E3779B97F4A7C15U, 0xC2B2AE3D27D4EB4FU};
};

}  // namespace tf::driver
