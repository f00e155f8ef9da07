// A mode of the Step representation: which step variables are 0, 1 or fractional (theory.md section 6). Within a mode the system is smooth.
#pragma once

#include <cstdint>
#include <vector>

namespace tf::runtime {

// Tangential rows of closed contacts and of friction elements. None: the row takes no part (contact open, or without friction).
enum class Tangent : std::int8_t { SlipNegative = -1, Stick = 0, SlipPositive = 1, None = 2 };

enum class Switch : std::uint8_t { Zero = 0, One = 1, Sliding = 2 };

struct Mode {
  std::vector<std::uint8_t> closed;  // nc: gap and gap rate are held at 0 (alpha_1, alpha_2 fractional)
  std::vector<Tangent> tangent;      // nt: alpha_3 = 0, fractional (stick), 1
  std::vector<Switch> switches;      // ns

  bool operator==(const Mode &) const = default;
};

}  // namespace tf::runtime
