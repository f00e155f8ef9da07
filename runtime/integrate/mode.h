// A mode of the Step representation: which step variables are 0, 1 or fractional (theory.md section 6). Within a mode the system is smooth.
#pragma once

#include <cstdint>
#include <vector>

namespace tf::runtime {

// Tangential rows of closed contacts and of friction elements. None: the row takes no part (contact open, or without friction). Both rows
// of a slip with two components have the same: Stick, or SlipPositive (along the slip's own direction).
enum class Tangent : std::int8_t { SlipNegative = -1, Stick = 0, SlipPositive = 1, None = 2 };

enum class Switch : std::uint8_t { Zero = 0, One = 1, Sliding = 2 };

struct Mode {
  std::vector<std::uint8_t> closed;  // nc: gap and gap rate are held at 0 (alpha_1, alpha_2 fractional)
  std::vector<Tangent> tangent;      // nt: alpha_3 = 0, fractional (stick), 1
  std::vector<Switch> switches;      // ns
  // nt: of slips with two components that slip, the unit vector that the slip has where it is zero (its limit at the start of slipping).
  std::vector<double> direction = {};
  // ns, or empty: the condition is zero and what contacts, friction and constraints hold keeps it there, as a velocity relative to the
  // ground that a body rests on: between the ends of steps it is the error of their interpolants.
  std::vector<std::uint8_t> held = {};

  bool operator==(const Mode &other) const { return closed == other.closed && tangent == other.tangent && switches == other.switches; }
};

}  // namespace tf::runtime
