#include "lang/base/trigonometry.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tf {

// Every operation is that of the generated code (compiler/codegen/trigonometry_emitter.cpp).
SineAndCosine sineAndCosine(double angle) {
  if (!(std::fabs(angle) < largestReducedAngle))
    return {std::sin(angle), std::cos(angle)};
  const double shifted = std::fma(angle, twoOverPi, integerShift), k = shifted - integerShift;
  const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
  const double *p = partsOfHalfPi, *s = sineCoefficients, *c = cosineCoefficients;
  const double rest = std::fma(-k, p[0], angle), x = std::fma(-k, p[1], rest);
  const double y = std::fma(-k, p[2], std::fma(-k, p[1], rest - x));

  const double z = x * x, square = z * z, half = 0.5 * z;
  const double high = std::fma(square, std::fma(square, s[5], std::fma(z, s[4], s[3])), std::fma(z, s[2], s[1]));
  double sine = x - std::fma(z * x, std::fma(-z, high, -s[0]), half * y - y);
  const double even = std::fma(square, std::fma(square, std::fma(z, c[5], c[4]), std::fma(z, c[3], c[2])), std::fma(z, c[1], c[0]));
  const double most = 1 - half;
  double cosine = most + std::fma(square, even, ((1 - most) - half) - x * y);
  if ((quadrant & 1U) != 0)
    std::swap(sine, cosine);
  return {(quadrant & 2U) != 0 ? -sine : sine, ((quadrant + 1) & 2U) != 0 ? -cosine : cosine};
}

}  // namespace tf
