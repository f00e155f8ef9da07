// Sine and cosine of one argument, as generated code evaluates them: together, and with the same bits on every processor.
//
// The argument less the nearest multiple k of π/2, by fused multiplications with three parts of π/2 (Cody and Waite, Software Manual for
// the Elementary Functions, 1980), as a head and a tail; then the minimax polynomials of degree 13 and 14 on [−π/4, π/4] of fdlibm (Sun
// Microsystems, 1993), their terms in pairs, since each waits for the one before. The error is below one unit in the last place.
#pragma once

namespace tf {

struct SineAndCosine {
  double sine, cosine;
};

// Beyond, parts of π/2 are too few.
constexpr double largestReducedAngle = 1e6;
constexpr double twoOverPi = 0x1.45f306dc9c883p-1;
// Added to a number below 2^51 and subtracted again, it leaves the nearest integer, whose last bits are those of the sum.
constexpr double integerShift = 0x1.8p52;
// The second one has 33 bits: k times it is exact.
constexpr double partsOfHalfPi[] = {0x1.921fb54442d18p+0, 0x1.1a626331p-54, 0x1.1701b839a2520p-88};
constexpr double sineCoefficients[] = {-0x1.5555555555549p-3, 0x1.111111110f8a6p-7,   -0x1.a01a019c161d5p-13,
                                       0x1.71de357b1fe7dp-19, -0x1.ae5e68a2b9cebp-26, 0x1.5d93a5acfd57cp-33};
constexpr double cosineCoefficients[] = {0x1.555555555554cp-5,   -0x1.6c16c16c15177p-10, 0x1.a01a019cb159p-16,
                                         -0x1.27e4f809c52adp-22, 0x1.1ee9ebdb4b1c4p-29,  -0x1.8fae9be8838d4p-37};

// Of an angle in rad. Of angles of 1e6 and more they are the C library's.
[[nodiscard]] SineAndCosine sineAndCosine(double angle);

}  // namespace tf
