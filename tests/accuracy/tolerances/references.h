// The examples' solutions: closed forms, else event-driven integration in long double (Gauss–Legendre, order 16).
#pragma once

#include "tests/accuracy/tolerances/reference.h"

#include <numbers>

namespace tf::test {

inline constexpr Number g = 9.81L;  // m/s2, where an example does not say otherwise
inline constexpr Number kPi = std::numbers::pi_v<Number>;

[[nodiscard]] Reference particleReference();        // mu = 0.3, g = 10, u[1] = 2, der(q[1]) = 1
[[nodiscard]] Reference liftedParticleReference();  // mu = 0.6, u = (7, 0 to 1 s, then 2 g (t − 1))
[[nodiscard]] Reference inclineReference();
[[nodiscard]] Reference stayingInclineReference();  // mu = 0.7
[[nodiscard]] Reference cornerReference();
[[nodiscard]] Reference cartsReference();
[[nodiscard]] Reference bouncingBallReference();
[[nodiscard]] Reference twoWallsReference();
[[nodiscard]] Reference superballReference();
[[nodiscard]] Reference movingGroundReference();
[[nodiscard]] Reference particle3dReference();
[[nodiscard]] Reference columnReference();

[[nodiscard]] Reference relayReference();
[[nodiscard]] Reference thermostatReference();
[[nodiscard]] Reference stickSlipReference();  // x = -0.5, der(x) = 0
[[nodiscard]] Reference pushedBlockReference();
[[nodiscard]] Reference denHartogReference();
[[nodiscard]] Reference duffingReference();
[[nodiscard]] Reference draggedTableReference();

[[nodiscard]] Reference fallingRodReference();
[[nodiscard]] Reference fallingBoxReference();
[[nodiscard]] Reference painleveRodReference();
[[nodiscard]] Reference rockingBlockReference();
[[nodiscard]] Reference rimlessWheelReference();
[[nodiscard]] Reference pendulumWallReference();
[[nodiscard]] Reference newtonsCradleReference();
[[nodiscard]] Reference chainReference();
[[nodiscard]] Reference sliderCrankReference();
[[nodiscard]] Reference fourBarReference();
[[nodiscard]] Reference doublePendulumReference();
[[nodiscard]] Reference woodpeckerReference();
[[nodiscard]] Reference threeCartsReference();
[[nodiscard]] Reference spinningTopReference();
[[nodiscard]] Reference backspinBallReference();
[[nodiscard]] Reference tippeTopReference();
[[nodiscard]] Reference tumblingBoxReference();  // until it falls on its face

}  // namespace tf::test
