// A floor that falls away: at the instant at which its acceleration is that of gravity all contact forces of what lies on it vanish
// together, and nothing but their derivatives tells that all contacts open then.
#include "tests/accuracy/support/compiled_model.h"

#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

// Six discs in a box whose floor is at `table`.
std::string pyramid(const std::string &name, const std::string &table) {
  return sourceFile(name, R"(
model Pyramid
  parameter Real R = 0.1, mu = 0.3, width = 0.7, A = 0.005, w = 60;
  coordinate Real r[6, 2](start = {{0.11, 0.11}, {0.32, 0.11}, {0.53, 0.11}, {0.215, 0.3}, {0.425, 0.3}, {0.32, 0.49}});
  coordinate Real phi[6];
  body disc[6](each mass = 0.1, position = r, angle = phi, each inertia = 0.1*R^2/2);
  gravity weight(acceleration = {0, -9.81});
  Real table = )" + table + R"(;
  contact floor[6](gap = {r[i, 2] - R - table for i in 1:6}, slip = {der(r[i, 1]) + R*der(phi[i]) for i in 1:6}, each friction = mu);
  contact left[6](gap = {r[i, 1] - R for i in 1:6}, slip = {der(r[i, 2]) - R*der(phi[i]) for i in 1:6}, each friction = mu);
  contact right[6](gap = {width - r[i, 1] - R for i in 1:6}, slip = {der(r[i, 2]) + R*der(phi[i]) for i in 1:6}, each friction = mu);
  constant Integer one[15] = {1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 5}, two[15] = {2, 3, 4, 5, 6, 3, 4, 5, 6, 4, 5, 6, 5, 6, 6};
  Real d[15, 2] = {r[two[k], :] - r[one[k], :] for k in 1:15};
  Real l[15] = {sqrt(d[k, :]*d[k, :]) for k in 1:15};
  contact pair[15](gap = l - 2*R*ones(15), each friction = mu,
    slip = {(d[k, 1]*der(d[k, 2]) - d[k, 2]*der(d[k, 1]))/l[k] - R*(der(phi[one[k]]) + der(phi[two[k]])) for k in 1:15});
end Pyramid;
)");
}

// The discs settle; from t = 1 on the floor falls by the acceleration 40 (t − 1).
TEST(Weightless, PileLeavesAFallingFloorAtOnce) {
  constexpr double instant = 1 + 9.81 / 40;
  const std::string file = pyramid("weightless_pyramid.tf", "if time < 1 then 0 else -40*(time - 1)^3/6");
  for (const double mu : {0.05, 0.1, 0.2, 0.3, 0.6}) {
    SCOPED_TRACE(mu);
    CompiledModel model(file, {{"mu", mu}});
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(1e-6).run(1.2);
    const int openings = model.count(TF_EVENT_OPENING);
    model.advance(1.5);
    EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING, openings), instant, 1e-8);
    EXPECT_EQ(model["floor[1].normalForce"], 0);
    EXPECT_LT(tf_get_statistics(model.simulation())->worst_energy_error, 1e-7);
  }
}

// Discs that roll slowly lose their loads one after the other within 1e-11 s, while others fall along the walls with all of their weight.
TEST(Weightless, PileOnAShakenTableHasForcesAtAllTimes) {
  struct Shaking {
    double amplitude, frequency, friction, end;
  };
  const std::string file = pyramid("shaken_pyramid.tf", "A*sin(w*time)");
  for (const Shaking &c : {Shaking{0.005, 60, 0.1, 0.6}, Shaking{0.005, 45, 0.05, 0.5}, Shaking{0.002, 90, 0.1, 0.3}}) {
    SCOPED_TRACE(c.frequency);
    CompiledModel model(file, {{"A", c.amplitude}, {"w", c.frequency}, {"mu", c.friction}});
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(1e-6).run(c.end);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_gap, -1e-9);
    EXPECT_LT(statistics.worst_energy_error, 1e-7);
  }
}

}  // namespace
}  // namespace tf::test
