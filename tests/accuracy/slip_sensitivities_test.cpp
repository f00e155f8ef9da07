// Sensitivities where slips of two components stop, or depend on one another.
#include "tests/accuracy/run_differences.h"

namespace tf::test {
namespace {

class SlipDifferences : public testing::TestWithParam<DifferenceCase> {};

TEST_P(SlipDifferences, Agree) { expectDifferences(GetParam()); }

// The slip turns up to its very end, as a small power of what is left of it; there the contact opens, which has pressed until then.
constexpr const char *kPushedBall = R"(model PushedBall "a cart pushes a sliding ball and falls behind as it begins to roll"
  parameter Real m = 1, bound = 4, vx = 1, vy = 0.3;
  coordinate Real x[2](start = {0, 0}, der(start = {vx, vy}));
  coordinate Real turn[2] "radius times angle", y(start = 0, der(start = vx));
  body ball(mass = m, position = x);
  body spin(mass = 0.4*m, position = turn);
  body cart(mass = 1, position = y);
  friction floor(slip = der(x) - der(turn), bound = bound);
  friction axle(slip = der(y), bound = 1);
  contact push(gap = x[1] - y);
end PushedBall;
)";

// The slips of two feet of a rigid body have three components of their own.
constexpr const char *kTwoFeet = R"(model TwoFeet "a body on two feet on a belt tips about the line through them"
  parameter Real vb = -0.2, mu = 0.4;
  constant Real P[2, 3] = {{-0.24, 0, -0.2}, {0.3, 0, -0.2}};
  coordinate Real p[3](start = {0, 0, 0.2}, der(start = {-0.9, 0.9, 0}));
  coordinate Rotation Q(w(start = {0, 0, -1.4}));
  Real r[2, 3] = {p + Q*P[i, :] for i in 1:2};
  body b(mass = 1.7, position = p, orientation = Q, inertia = diagonal({0.08, 0.096, 0.09}));
  gravity g(acceleration = {0, 0, -9.81});
  contact floor[2](gap = r[:, 3], slip = {{der(r[i, 1]) - vb, der(r[i, 2])} for i in 1:2}, each friction = mu);
end TwoFeet;
)";

INSTANTIATE_TEST_SUITE_P(Stops, SlipDifferences,
                         testing::Values(DifferenceCase{kPushedBall, 0.4, "vx", 1}, DifferenceCase{kPushedBall, 0.4, "bound", 4},
                                         DifferenceCase{kPushedBall, 0.4, "m", 1}, DifferenceCase{kPushedBall, 0.4, "vy", 0.3}));
INSTANTIATE_TEST_SUITE_P(Feet, SlipDifferences,
                         testing::Values(DifferenceCase{kTwoFeet, 0.2, "vb", -0.2, 1e-8}, DifferenceCase{kTwoFeet, 0.2, "mu", 0.4, 1e-8}));

}  // namespace
}  // namespace tf::test
