// Contacts that share a load in many ways, on boundaries that move in time: the margins of their forces stay at zero for a time, or are
// those of rounding, where a search for their zeros must end all the same.
#include "tests/accuracy/support/compiled_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace tf::test {
namespace {

// How far a body goes that slides on a boundary of this speed.
double wayOfABody(double friction, const std::string &speed, double end) {
  CompiledModel body(sourceFile("sliding_body_" + std::to_string(friction) + ".tf",
                                "model SlidingBody\n  parameter Real mu = " + std::to_string(friction) +
                                    ";\n  coordinate Real x;\n  body b(mass = 1, position = x);\n  friction f(slip = der(x) - " + speed +
                                    ", bound = mu*9.81);\nend SlidingBody;\n"));
  body.tolerance(1e-10).run(end);
  return body["x"];
}

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
  const double moved = wayOfABody(0.5, "0.02*18.85*cos(18.85*time)", 0.7);
  for (const double tolerance : {1e-4, 1e-7}) {
    CompiledModel both(boxes);
    both.tolerance(tolerance).run(0.7);
    EXPECT_NEAR(both["p[1,1]"], moved, 10 * tolerance) << tolerance;
    EXPECT_NEAR(both["p[2,1]"], moved, 10 * tolerance) << tolerance;
  }
}

// A wall of bricks, heavier ones above, on a belt that shakes: all joints are at their limit of friction, and what the many shares of the
// load contradict one another by is rounding. The wall slides as one body does, in a few steps.
TEST(SharedLoads, AWallOnAShakingBeltSlidesAsOneBody) {
  const std::string wall = sourceFile("wall.tf", R"(
model Wall
  constant Integer n = 10, m = 12;
  constant Integer under[m] = {1, 2, 2, 3, 4, 4, 5, 5, 6, 7, 7, 8}, over[m] = {4, 4, 5, 5, 6, 7, 7, 8, 9, 9, 10, 10};
  parameter Real a = 0.2, b = 0.1, mu = 0.4, space = 0.42, belt = 2, om = 8;
  parameter Real place[n, 2] = {{0, 0}, {1, 0}, {2, 0}, {0.5, 1}, {1.5, 1}, {0, 2}, {1, 2}, {2, 2}, {0.5, 3}, {1.5, 3}};
  parameter Real mass[n] = {10^(place[i, 2] - 1) for i in 1:n};
  parameter Real side[m] = {if place[over[k], 1] > place[under[k], 1] then 1 else -1 for k in 1:m};
  coordinate Real r[n, 2](start = {{space*place[i, 1], b + 2*b*place[i, 2]} for i in 1:n});
  coordinate Real phi[n];
  body brick[n](mass = mass, position = r, angle = phi, inertia = mass*(a^2 + b^2)/3);
  gravity weight(acceleration = {0, -9.81});
  Real x[n, 2] = {{cos(phi[i]), sin(phi[i])} for i in 1:n}, y[n, 2] = {{-sin(phi[i]), cos(phi[i])} for i in 1:n};
  Real foot[6, 2] = {r[div(k + 1, 2), :] + (if mod(k, 2) == 0 then a else -a)*x[div(k + 1, 2), :] - b*y[div(k + 1, 2), :] for k in 1:6};
  contact floor[6](gap = foot[:, 2], slip = {der(foot[k, 1]) - belt*sin(om*time) for k in 1:6}, each friction = mu);
  Real low[m, 2] = {r[over[k], :] - side[k]*a*x[over[k], :] - b*y[over[k], :] - r[under[k], :] for k in 1:m};
  Real high[m, 2] = {r[under[k], :] + side[k]*a*x[under[k], :] + b*y[under[k], :] - r[over[k], :] for k in 1:m};
  Real onTop[m, 2] = {{low[k, :]*x[under[k], :], low[k, :]*y[under[k], :]} for k in 1:m};
  Real below[m, 2] = {{high[k, :]*x[over[k], :], high[k, :]*y[over[k], :]} for k in 1:m};
  contact joint[m, 2](gap = {{onTop[k, 2] - b, -below[k, 2] - b} for k in 1:m},
    slip = {{der(onTop[k, 1]), -der(below[k, 1])} for k in 1:m}, each friction = mu);
end Wall;
)");
  const double moved = wayOfABody(0.4, "2*sin(8*time)", 0.5);
  for (const double tolerance : {1e-5, 1e-9}) {
    CompiledModel bricks(wall);
    bricks.tolerance(tolerance).run(0.5);
    EXPECT_NEAR(bricks["r[1,1]"], moved, 10 * tolerance) << tolerance;
    EXPECT_NEAR(bricks["r[10,1]"], 1.5 * 0.42 + moved, 10 * tolerance) << tolerance;
    EXPECT_LT(tf_get_statistics(bricks.simulation())->evaluations, 4000) << tolerance;
  }
}

// A force that grows tips a box whose corners have several contacts each: the load of a corner falls to zero in all of its contacts at
// once, and the box tips where it does with one.
TEST(SharedLoads, CornersWithSeveralContactsOpenInTime) {
  const std::string file = sourceFile("tipped_box.tf", R"(
model TippedBox
  constant Integer n = 6;
  parameter Real a = 0.2, h = 0.5, push = 10, g = 9.81;
  coordinate Real r[2](start = {0, h});
  coordinate Real phi;
  body box(mass = 1, position = r, angle = phi, inertia = 0.1);
  gravity weight(acceleration = {0, -g});
  force pull(value = push*time, at = r[1]);
  Real corner[2*n, 2] = {r + {cos(phi)*s[k] + sin(phi)*h, sin(phi)*s[k] - cos(phi)*h} for k in 1:2*n};
  parameter Real s[2*n] = {if k > n then a else -a for k in 1:2*n};
  contact feet[2*n](gap = corner[:, 2], slip = der(corner[:, 1]), each friction = 2);
end TippedBox;
)");
  for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
    CompiledModel box(file);
    box.tolerance(tolerance).run(0.6);
    ASSERT_EQ(box.count(TF_EVENT_OPENING), 6);
    const double tips = 9.81 * 0.2 / (10 * 0.5);
    EXPECT_NEAR(box.eventTime(TF_EVENT_OPENING), tips, 1e-12);
    EXPECT_NEAR(box.eventTime(TF_EVENT_OPENING, 5), tips, 1e-12);
    EXPECT_GE(tf_get_statistics(box.simulation())->worst_normal_force, -1e-11);
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

// A pyramid of ten discs that are held by friction alone stands as long as any forces hold it, whether the coefficient falls slowly or all
// at once; the least of these forces may need more friction than others.
TEST(SharedLoads, APyramidStandsAsLongAsAnyForcesHoldIt) {
  const std::string file = sourceFile("pyramid.tf", R"(
model Pyramid
  constant Integer n = 10, m = 12;
  constant Integer row[n] = {0, 0, 0, 0, 1, 1, 1, 2, 2, 3}, column[n] = {0, 1, 2, 3, 0, 1, 2, 0, 1, 0};
  constant Integer a[m] = {1, 2, 2, 3, 3, 4, 5, 6, 6, 7, 8, 9}, b[m] = {5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10};
  parameter Real R = 0.5, d = 1.02, rate = 0, later = 0.9;
  coordinate Real c[n, 2](start = {{d*(column[k] + row[k]/2), R + row[k]*sqrt(4*R^2 - d^2/4)} for k in 1:n});
  coordinate Real phi[n];
  Real mu = if time < 0.1 then 0.9 else later - rate*(time - 0.1);
  body disc[n](each mass = 1, position = c, angle = phi, each inertia = 0.5*R^2);
  gravity g(acceleration = {0, -9.81});
  contact floor[4](gap = {c[k, 2] - R for k in 1:4}, slip = {der(c[k, 1]) + R*der(phi[k]) for k in 1:4}, each friction = mu);
  Real w[m, 2] = {c[b[k], :] - c[a[k], :] for k in 1:m}, s[m] = {sqrt(w[k, :]*w[k, :]) for k in 1:m};
  Real v[m, 2] = {der(c[b[k], :]) - der(c[a[k], :]) for k in 1:m};
  contact pair[m](gap = s - fill(2*R, m), each friction = mu,
    slip = {(w[k, 1]*v[k, 2] - w[k, 2]*v[k, 1])/s[k] - R*(der(phi[a[k]]) + der(phi[b[k]])) for k in 1:m});
end Pyramid;
)");
  CompiledModel model(file, {{"rate", 1}});
  model.tolerance(1e-8).run(0.7);
  double limit = 0;
  for (const Event &event : model.events())
    if (event.kind == TF_EVENT_SLIP || event.kind == TF_EVENT_OPENING) {
      limit = 0.9 - (event.time - 0.1);
      break;
    }
  EXPECT_GT(limit, 0.4);
  const double height = 0.5 + 3 * std::sqrt(1 - 1.02 * 1.02 / 4);
  for (const double later : {limit - 1e-3, limit + 1e-3, 0.5, 0.52, 0.54, 0.56, 0.58, 0.6, 0.7, 0.8}) {
    CompiledModel other(file, {{"later", later}});
    other.tolerance(1e-8).run(0.3);
    if (later < limit)
      EXPECT_LT(other["c[10,2]"], height - 1e-3) << later;
    else
      EXPECT_NEAR(other["c[10,2]"], height, 1e-9) << later;
  }
}

// A block between a wall and a plate that is pressed on it by N, with a load off its centre: friction on both sides holds it as long as
// 2 μ N is its weight, when the corners' normal forces are shared so that their friction has no moment left. The least of the forces is
// beyond the cones before.
TEST(SharedLoads, AClampHoldsAsLongAsAnyForcesHoldIt) {
  const std::string file = sourceFile("clamp.tf", R"(
model Clamp
  parameter Real later = 0.9, rate = 0, N = 60;
  parameter Real c[4, 2] = {{-0.2, -0.2}, {-0.2, 0.2}, {0.2, -0.2}, {0.2, 0.2}};
  Real mu = if time < 0.1 then 0.9 else later - rate*(time - 0.1);
  coordinate Real p[3], s;
  coordinate Rotation Q;
  body block(mass = 2, position = p, orientation = Q, inertia = diagonal({0.02, 0.03, 0.04}));
  body plate(mass = 1, position = {s, 0, 0});
  gravity g(acceleration = {0, 0, -9.81});
  force press(value = -N, at = s);
  force load(value = {0, 0, -10}, at = p + Q*{0.05, 0.15, 0});
  Real L[4, 3] = {p + Q*{-0.1, c[k, 1], c[k, 2]} for k in 1:4}, R[4, 3] = {p + Q*{0.1, c[k, 1], c[k, 2]} for k in 1:4};
  contact left[4](gap = L[:, 1] + fill(0.1, 4), slip = der(L[:, 2:3]), each friction = mu);
  contact right[4](gap = fill(s + 0.1, 4) - R[:, 1], slip = der(R[:, 2:3]), each friction = mu);
end Clamp;
)");
  const double limit = (2 * 9.81 + 10) / (2 * 60);
  CompiledModel ramp(file, {{"rate", 1}});
  ramp.tolerance(1e-8).run(1);
  EXPECT_NEAR(ramp.eventTime(TF_EVENT_SLIP), 0.1 + 0.9 - limit, 1e-7);
  for (const double later : {limit - 1e-3, limit + 1e-4, limit + 1e-3, 0.25, 0.26, 0.3, 0.5}) {
    CompiledModel model(file, {{"later", later}});
    model.tolerance(1e-8).run(0.3);
    if (later < limit)
      EXPECT_LT(model["p[3]"], -1e-5) << later;
    else
      EXPECT_NEAR(model["p[3]"], 0, 1e-9) << later;
  }
}

}  // namespace
}  // namespace tf::test
