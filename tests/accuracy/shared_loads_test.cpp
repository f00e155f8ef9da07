// Contacts that share a load in many ways, on boundaries that move in time: the margins of their forces stay at zero for a time, or are
// those of rounding, where a search for their zeros must end all the same.
#include "tests/accuracy/support/compiled_model.h"

#include <gtest/gtest.h>

#include <string>

namespace tf::test {
namespace {

// Two boxes on four feet each, one upon the other, on a plate that shakes so fast that they slide: they move as one body does.
TEST(SharedLoads, BoxesOnAPlateThatShakesMoveAsOneBody) {
  const std::string boxes = sourceFile("boxes_on_a_plate.tf", R"(
model Boxes
  parameter Real a = 0.1, h = 0.05, mu = 0.5, amp = 0.02, om = 18.85;
  parameter Real side[4, 2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  coordinate Real p[2, 3](start = {{0, 0, h}, {0, 0, 3*h}});
  coordinate Rotation Q[2];
  body box[2](each mass = 1, position = p, orientation = Q, each inertia = {{0.004, 0, 0}, {0, 0.004, 0}, {0, 0, 0.006}});
  gravity g(acceleration = {0, 0, -9.81});
  Real foot[2, 4, 3] = {{p[i, :] + Q[i]*{a*side[k, 1], a*side[k, 2], -h} for k in 1:4} for i in 1:2};
  Real onTop[4, 3] = {inverse(Q[1])*(foot[2, k, :] - p[1, :]) for k in 1:4};
  contact plate[4](gap = foot[1, :, 3], each friction = mu,
    slip = {{der(foot[1, k, 1]) - amp*om*cos(om*time), der(foot[1, k, 2])} for k in 1:4});
  contact lid[4](gap = {onTop[k, 3] - h for k in 1:4}, each friction = mu, slip = {{der(onTop[k, 1]), der(onTop[k, 2])} for k in 1:4});
end Boxes;
)");
  const std::string body = sourceFile("body_on_a_plate.tf", R"(
model Body
  parameter Real mu = 0.5, amp = 0.02, om = 18.85;
  coordinate Real x;
  body b(mass = 1, position = x);
  friction f(slip = der(x) - amp*om*cos(om*time), bound = mu*9.81);
end Body;
)");
  CompiledModel one(body);
  one.tolerance(1e-10).run(0.7);
  for (const double tolerance : {1e-4, 1e-7}) {
    CompiledModel both(boxes);
    both.tolerance(tolerance).run(0.7);
    EXPECT_NEAR(both["p[1,1]"], one["x"], 10 * tolerance) << tolerance;
    EXPECT_NEAR(both["p[2,1]"], one["x"], 10 * tolerance) << tolerance;
  }
}

// Six discs in a box that shakes and is just too narrow for four side by side: where they jam, forces are large and hardly determined.
TEST(SharedLoads, DiscsThatJamInABoxThatShakesGoOn) {
  const std::string file = sourceFile("discs_in_a_shaking_box.tf", R"(
model Discs
  constant Integer n = 6, m = 15;
  constant Integer a[m] = {1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 5}, b[m] = {2, 3, 4, 5, 6, 3, 4, 5, 6, 4, 5, 6, 5, 6, 6};
  parameter Real R = 0.1, mu = 0.3, e = 0.2, w = 0.79;
  Real sx = 0.02*sin(20*time), sy = 0.01*sin(20*time);
  coordinate Real x[n](start = {(mod(i - 1, 3) - 1)*0.24 + 0.01*sin(7*i) for i in 1:n});
  coordinate Real y[n](start = {0.12 + div(i - 1, 3)*0.22 + 0.01*cos(3*i) for i in 1:n});
  coordinate Real phi[n];
  body disc[n](each mass = 1, position = {{x[i], y[i]} for i in 1:n}, angle = phi, each inertia = 0.5*R^2);
  gravity g(acceleration = {0, -9.81});
  contact floor[n](gap = {y[i] - R - sy for i in 1:n}, slip = {der(x[i]) + R*der(phi[i]) - der(sx) for i in 1:n}, each friction = mu,
    each restitution = e);
  contact left[n](gap = {x[i] + w/2 - R - sx for i in 1:n}, slip = {der(y[i]) - R*der(phi[i]) - der(sy) for i in 1:n}, each friction = mu,
    each restitution = e);
  contact right[n](gap = {-x[i] + w/2 - R + sx for i in 1:n}, slip = {der(y[i]) + R*der(phi[i]) - der(sy) for i in 1:n},
    each friction = mu, each restitution = e);
  Real dx[m] = x[b] - x[a], dy[m] = y[b] - y[a], s[m] = {sqrt(dx[k]^2 + dy[k]^2) for k in 1:m};
  contact pair[m](gap = s - fill(2*R, m), each friction = mu, each restitution = e,
    slip = {(dx[k]*(der(y[b[k]]) - der(y[a[k]])) - dy[k]*(der(x[b[k]]) - der(x[a[k]])))/s[k] - R*(der(phi[a[k]]) + der(phi[b[k]]))
      for k in 1:m});
end Discs;
)");
  CompiledModel model(file);
  model.tolerance(1e-6).run(2);
  for (const double gap : model.valuesOf(TF_KIND_GAP))
    EXPECT_GE(gap, -1e-9);
  EXPECT_GT(model.count(TF_EVENT_IMPACT), 500);
}

}  // namespace
}  // namespace tf::test
