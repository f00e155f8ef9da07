// Units of measurement: the expressions of Modelica's unit attribute (MLS chapter 19) as SI exponents and a scale.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace tf::semantics {

struct Unit {
  // Exponents of m, kg, s, A, K, mol, cd. The radian is 1.
  std::array<double, 7> exponents{};
  double scale = 1;   // of the coherent SI unit
  double offset = 0;  // in that unit: degC

  [[nodiscard]] bool isSame(const Unit &other) const;
};

[[nodiscard]] Unit multiply(const Unit &a, const Unit &b);
[[nodiscard]] Unit divide(const Unit &a, const Unit &b);
[[nodiscard]] Unit power(const Unit &a, double exponent);

// "kg.m2/s2", "1", "m/(s.K)", "mm". Nothing if it is no unit that is known here.
[[nodiscard]] std::optional<Unit> parseUnit(std::string_view text);

// In base units: "kg.m2/s2".
[[nodiscard]] std::string toString(const Unit &unit);

}  // namespace tf::semantics
