// Examples with restitution and infinitely many impacts (Zeno) against closed forms and independent references.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr std::array<tf_integrator, 3> kIntegrators = {TF_STEP, TF_EXPLICIT, TF_CVODE};

TEST(Impacts, BouncingBallRestsWhereItsBouncesAccumulate) {
  for (const tf_integrator integrator : kIntegrators)
    for (const double e : {0.3, 0.8, 0.95}) {
      CompiledModel model(example("bouncing_ball.tf"), {{"e", e}});
      model.tolerance(1e-9).integrator(integrator).initialise();
      const double first = std::sqrt(2 / g), speed = g * first, end = first * (1 + e) / (1 - e);
      const double tolerance = integrator == TF_CVODE ? 1e-6 : 1e-8;
      // In the third flight.
      const double landing = first + 2 * e * speed * (1 + e) / g, flight = e * e * speed * e / g;
      model.advance(landing + flight);
      EXPECT_NEAR(model["y"], std::pow(e, 6), tolerance);
      EXPECT_NEAR(model["der(y)"], 0, tolerance);
      model.advance(end + 1);
      EXPECT_NEAR(model.eventTime(TF_EVENT_REST), end, tolerance * end);
      EXPECT_EQ(model.count(TF_EVENT_REST), 1);
      EXPECT_LT(model.count(TF_EVENT_IMPACT), 6 + std::log(1e-4) / std::log(e));
      EXPECT_NEAR(model["y"], 0, 1e-12);
      EXPECT_EQ(model["der(y)"], 0.0);
      EXPECT_NEAR(model["floor.normalForce"], 0.5 * g, 1e-12);
      // Impulses of all impacts, and the numerical time that they took: rate = m g.
      const double impulse = 0.5 * speed * (1 + e) / (1 - e);
      EXPECT_NEAR(model["floor.impulse"], impulse, 10 * tolerance);
      EXPECT_NEAR(model["tau"], end + impulse / (0.5 * g) + 2, 10 * tolerance * end);
    }
}

// Forces that change with the sign of the velocity change in each bounce, up to infinitely often. The fall lasts 1/2, the ball arrives with
// 4; each flight loses speed by the ratio e sqrt(2/3).
TEST(Impacts, BouncesAccumulateThroughSwitchesOfTheVelocity) {
  const std::string file = sourceFile("dragged_ball.tf", R"(model Dragged "a ball in air that drags with a constant force"
  parameter Real e = 0.8;
  coordinate Real y(start = 1);
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -10});
  force drag(value = if der(y) > 0 then -2 else 2, at = y);
  contact f(gap = y, restitution = e);
  Real up(start = 0);
equation
  der(up) = if der(y) > 0 then 1 else 0;
end Dragged;
)");
  for (const tf_integrator integrator : kIntegrators)
    for (const double e : {0.3, 0.8, 0.95})
      for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
        const double ratio = e * std::sqrt(2.0 / 3), up = 4 * e / 12 / (1 - ratio), down = 4 * e / std::sqrt(96) / (1 - ratio);
        CompiledModel model(file, {{"e", e}});
        model.tolerance(tolerance).integrator(integrator).initialise();
        model.advance(20);
        const double accepted = integrator == TF_CVODE ? 10 * tolerance * 20 : tolerance * 1e-3;
        EXPECT_NEAR(model.eventTime(TF_EVENT_REST), 0.5 + up + down, accepted) << integrator << " " << e << " " << tolerance;
        EXPECT_NEAR(model["up"], up, accepted) << integrator << " " << e << " " << tolerance;
        EXPECT_EQ(model["y"], 0.0);
      }
}

// At the top of a hop of 45 pm nothing moves, and at an event there the contact is still open.
TEST(Impacts, LowestHopsAreNoRestAtTheEventsOfOthers) {
  const std::string file = sourceFile("low_hop.tf", R"(model Hop
  coordinate Real y(start = 0);
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -10});
  contact f(gap = y);
  Real up(start = 0);
equation
  der(up) = if der(y) > 0 then 1 else 0;
end Hop;
)");
  for (const tf_integrator integrator : {TF_STEP, TF_EXPLICIT, TF_AUTO}) {
    CompiledModel model(file, {{"der(y)", 3e-5}});
    model.tolerance(1e-10).integrator(integrator).initialise();
    model.advance(1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), 6e-6, 1e-10) << integrator;
    EXPECT_NEAR(model["up"], 3e-6, 1e-10) << integrator;
  }
}

TEST(Impacts, RestIsKnownWhateverTheOutputIs) {
  const double end = std::sqrt(2 / g) * 1.8 / 0.2;
  for (const double interval : {10.0, 0.3, 0.01, 1e-3}) {
    CompiledModel model(example("bouncing_ball.tf"));
    model.tolerance(1e-9).initialise();
    for (int k = 1; k * interval < 5; ++k)
      model.advance(k * interval);
    model.advance(5);
    EXPECT_NEAR(model.eventTime(TF_EVENT_REST), end, 1e-8) << interval;
  }
}

TEST(Impacts, PuckGoesToAndFroBetweenTwoWalls) {
  CompiledModel model(example("two_walls.tf"));
  model.tolerance(1e-9).initialise();
  double time = 0.25, speed = 2;
  int impacts = 0;
  for (const double e : {0.7, 0.9, 0.7, 0.9, 0.7, 0.9}) {
    speed *= e;
    const double direction = impacts % 2 == 0 ? -1 : 1;
    model.advance(time + 0.25 / speed);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, impacts), time, 1e-9 * (1 + time));
    EXPECT_NEAR(model["der(x)"], direction * speed, 1e-9);
    EXPECT_NEAR(model["x"], 0.5 - direction * 0.25, 1e-8);
    time += 1 / speed;
    ++impacts;
  }
}

// Each bounce takes slip as long as friction lasts; gripped, it rolls while it bounces on.
TEST(Impacts, SuperballTurnsBack) {
  for (const tf_integrator integrator : kIntegrators)
    for (const double spin : {90.0, 0.0}) {
      CompiledModel model(example("superball.tf"), {{"der(phi)", spin}});
      model.tolerance(1e-9).integrator(integrator).initialise();
      const double R = 0.025, mu = 0.6, e = 0.85;
      double time = std::sqrt(2 * (0.5 - R) / g), speed = g * time, v = 0.5, w = spin;
      const double end = time + 2 * e * speed / (g * (1 - e));
      for (int bounce = 0; bounce < 12; ++bounce) {
        const double slip = v + R * w;
        const double impulse = std::copysign(std::min(mu * (1 + e) * speed, std::abs(slip) / 3.5), slip);
        v -= impulse;
        w -= impulse / (0.4 * R);
        speed *= e;
        model.advance(time + speed / g);
        EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, bounce), time, 1e-6);
        EXPECT_NEAR(model["der(r[1])"], v, 1e-7);
        EXPECT_NEAR(model["der(phi)"], w, 1e-5);
        time += 2 * speed / g;
      }
      EXPECT_LT(v, spin > 0 ? 0 : 0.5);
      EXPECT_NEAR(v + R * w, 0, 1e-12);
      model.advance(end + 0.5);
      EXPECT_NEAR(model.eventTime(TF_EVENT_REST), end, 1e-6);
      EXPECT_NEAR(model["der(r[1])"], v, 1e-7);
      EXPECT_EQ(model["floor.sticking"], 1.0);
    }
}

// Housner (1963): between impacts the block turns about a corner, an inverted pendulum; each impact takes the same share of the spin.
class HousnerBlock {
public:
  // Angle to which the block rises from the spin w, and back: time 2 ∫ dφ/ω(φ).
  [[nodiscard]] double swing(double w) const { return 2 * fall(slenderness_ - std::acos(std::cos(slenderness_) + w * w / (2 * k_))); }
  // From rest at the tilt. With φ = tilt (1 − s²) the integrand is smooth.
  [[nodiscard]] double fall(double tilt) const {
    const int panels = 400;
    double sum = 0;
    for (int i = 0; i < panels; ++i)
      for (const double node : {0.5 - std::sqrt(15) / 10, 0.5, 0.5 + std::sqrt(15) / 10}) {
        const double s = (i + node) / panels, half = tilt * s * s / 2;
        const double weight = node == 0.5 ? 4.0 / 9 : 5.0 / 18;
        sum += weight / panels * 2 * tilt * s / std::sqrt(4 * k_ * std::sin(slenderness_ - tilt + half) * std::sin(half));
      }
    return sum;
  }
  [[nodiscard]] double spinAfterFall(double tilt) const {
    return std::sqrt(2 * k_ * (std::cos(slenderness_ - tilt) - std::cos(slenderness_)));
  }
  // Time of the end of all impacts.
  [[nodiscard]] double rest(double tilt) const {
    double time = fall(tilt), w = share_ * spinAfterFall(tilt);
    for (; w > 1e-6; w *= share_)
      time += swing(w);
    return time + 2 * w / (k_ * std::sin(slenderness_)) / (1 - share_);
  }

private:
  static constexpr double b_ = 0.2, h_ = 0.6;
  const double radius_ = std::hypot(b_, h_), slenderness_ = std::atan2(b_, h_), inertia_ = 4.0 / 3 * radius_ * radius_;
  const double k_ = g * radius_ / inertia_;
  const double share_ = (radius_ * radius_ / 3 + h_ * h_ - b_ * b_) / inertia_;
};

TEST(Impacts, RockingBlockRestsWhereItsImpactsAccumulate) {
  const HousnerBlock block;
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(example("rocking_block.tf"));
    model.tolerance(1e-9).integrator(integrator).run(5);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), block.fall(0.2), 1e-7);
    EXPECT_EQ(model.count(TF_EVENT_REST), 2);
    EXPECT_NEAR(model.eventTime(TF_EVENT_REST), block.rest(0.2), integrator == TF_CVODE ? 2e-6 : 1e-7);
    EXPECT_NEAR(model["phi"], 0, 1e-12);
    EXPECT_NEAR(model["der(phi)"], 0, 1e-15);
    EXPECT_NEAR(model["floor[1].normalForce"] + model["floor[2].normalForce"], g, 1e-10);
  }
}

// The impacts of the reference trajectory, which has cut the tail off.
TEST(Impacts, RockingBlockHasTheImpactsOfTheReference) {
  const CsvTable events(TF_SOURCE_DIR "/tests/accuracy/reference/S12_rocking_events.csv");
  CompiledModel model(example("rocking_block.tf"));
  model.tolerance(1e-10).run(5);
  for (int k = 0; k < 30; ++k)
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, k), events["t"][static_cast<std::size_t>(k) + 1], 1e-8) << k;
}

// Equal masses without loss: the speed of the first ball passes to the last.
TEST(Impacts, CradleHandsTheMotionThrough) {
  CompiledModel model(example("newtons_cradle.tf"));
  model.tolerance(1e-10).initialise();
  const double energy = model.energy();
  model.advance(0.29);
  double speed = -model["der(phi[1])"];
  EXPECT_EQ(model.count(TF_EVENT_IMPACT), 4);
  EXPECT_NEAR(speed, 0, 1e-4);
  for (int i = 2; i <= 4; ++i)
    EXPECT_NEAR(model["phi[" + std::to_string(i) + "]"], 0, 1e-4);
  EXPECT_GT(model["der(phi[5])"], 1);
  double highest = 0;
  for (double time = 0.3; time < 1; time += 1e-3) {
    model.advance(time);
    highest = std::max(highest, model["phi[5]"]);
  }
  EXPECT_NEAR(highest, 0.4, 1e-5);
  EXPECT_NEAR(model.energy(), energy, 1e-9);
}

// Balls above each other, exactly: parabolas between impacts, in long double.
struct ColumnReference {
  std::vector<long double> y, v;
  long double time = 0;

  explicit ColumnReference(int n) : v(n, 0) {
    for (int i = 1; i <= n; ++i)
      y.push_back(0.2L + (2 * i - 1) * 0.05L + 0.01L * i * i);
  }
  void nextImpact(long double e) {
    const auto n = y.size();
    const long double gravity = 9.81L, gap = y[0] - 0.05L;
    long double wait = (v[0] + std::sqrt(v[0] * v[0] + 2 * gravity * std::max(gap, 0.0L))) / gravity;
    std::size_t contact = 0;
    for (std::size_t i = 1; i < n; ++i) {
      const long double approach = v[i - 1] - v[i], space = std::max(y[i] - y[i - 1] - 0.1L, 0.0L);
      if (approach > 0 && space / approach < wait) {
        wait = space / approach;
        contact = i;
      }
    }
    time += wait;
    for (std::size_t i = 0; i < n; ++i) {
      y[i] += v[i] * wait - gravity * wait * wait / 2;
      v[i] -= gravity * wait;
    }
    if (contact == 0) {
      v[0] *= -e;
      return;
    }
    const long double mean = (v[contact] + v[contact - 1]) / 2, half = e * (v[contact] - v[contact - 1]) / 2;
    v[contact - 1] = mean + half;
    v[contact] = mean - half;
  }
};

TEST(Impacts, ColumnCollapsesBallByBall) {
  CompiledModel model(example("column.tf"));
  model.tolerance(1e-11).run(4);
  ColumnReference reference(4);
  for (int k = 0; k < 60; ++k) {
    reference.nextImpact(0.6L);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, k), static_cast<double>(reference.time), 1e-8) << k;
  }
  for (int k = 60; k < 400; ++k)
    reference.nextImpact(0.6L);
  // All of these accumulate at one point, the first contact to rest.
  EXPECT_NEAR(model.eventTime(TF_EVENT_REST), static_cast<double>(reference.time), 1e-8);
  EXPECT_EQ(model.count(TF_EVENT_REST), 4);
  for (int i = 1; i <= 4; ++i) {
    EXPECT_NEAR(model["y[" + std::to_string(i) + "]"], (2 * i - 1) * 0.05, 1e-12);
    EXPECT_EQ(model["touch[" + std::to_string(std::min(i, 3)) + "].closed"], 1.0);
  }
}

// A ball that bounces down a slope with drag-free flight: slip falls by μ times the normal impulses, which are known at rest.
TEST(Impacts, BallOnASlopeComesToRestInItsNormalDirectionOnly) {
  const std::string file = sourceFile("slope.tf", R"(
model Slope
  parameter Real e = 0.7, mu = 0.2, a = 0.4;
  coordinate Real r[2](start = {0, 0.5}, der(start = {4, 0}));
  body ball(mass = 1, position = r);
  gravity weight(acceleration = 9.81*{sin(a), -cos(a)});
  contact floor(gap = r[2], slip = der(r[1]), friction = mu, restitution = e);
end Slope;
)");
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator).run(3);
    const double down = g * std::sin(0.4), normal = g * std::cos(0.4), first = std::sqrt(1 / normal), end = first * 1.7 / 0.3;
    EXPECT_NEAR(model.eventTime(TF_EVENT_REST), end, 1e-6);
    EXPECT_NEAR(model["der(r[1])"], 4 + down * 3 - 0.2 * normal * 3, 1e-7);
    EXPECT_NEAR(model["r[2]"], 0, 1e-12);
  }
}

// Rod and box, thrown with spin: both ends or a face come to rest, by every integrator at the same time and place.
TEST(Impacts, BouncingRodComesToRest) {
  const std::string file = sourceFile("rod.tf", R"(
model Rod
  parameter Real e = 0.5, mu = 0.3;
  coordinate Real r[2](start = {0, 1}, der(start = {1, 0}));
  coordinate Real phi(start = 0.3, der(start = 0.5));
  Real tip[2, 2] = {r - 0.5*{cos(phi), sin(phi)}, r + 0.5*{cos(phi), sin(phi)}};
  body rod(mass = 1, position = r, angle = phi, inertia = 1/12);
  gravity weight(acceleration = {0, -9.81});
  contact floor[2](gap = tip[:, 2], slip = der(tip[:, 1]), each friction = mu, each restitution = e);
end Rod;
)");
  std::vector<double> ends, places;
  for (const tf_integrator integrator : kIntegrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator).run(5);
    EXPECT_EQ(model.count(TF_EVENT_REST), 2);
    EXPECT_NEAR(model["r[2]"], 0, 1e-10);
    EXPECT_NEAR(model["phi"], 0, 1e-10);
    EXPECT_EQ(model["floor[1].closed"] + model["floor[2].closed"], 2.0);
    ends.push_back(model.eventTime(TF_EVENT_REST, 1));
    places.push_back(model["r[1]"]);
  }
  for (const std::size_t other : {1u, 2u}) {
    EXPECT_NEAR(ends[0], ends[other], 1e-7);
    EXPECT_NEAR(places[0], places[other], 1e-8);
  }
}

// A saved run goes on into rest as the one that was not interrupted.
TEST(Impacts, RestAfterASavedState) {
  CompiledModel model(example("bouncing_ball.tf"));
  model.tolerance(1e-9).initialise();
  std::vector<unsigned char> buffer(tf_state_size(model.simulation()));
  for (double time = 0.01; time < 4.5; time += 0.01) {
    model.advance(time);
    ASSERT_EQ(tf_save_state(model.simulation(), buffer.data(), buffer.size()), TF_OK);
    ASSERT_EQ(tf_restore_state(model.simulation(), buffer.data(), buffer.size()), TF_OK);
  }
  EXPECT_NEAR(model.eventTime(TF_EVENT_REST), std::sqrt(2 / g) * 9, 1e-8);
  EXPECT_EQ(model["der(y)"], 0.0);
}

// A wheel with fifteen teeth and a stop: the step that goes on from right before the impact is so long that the tooth would be past the
// stop.
TEST(Impacts, AreNotMissedAfterAStateThatIsSavedRightBefore) {
  const std::string wheel = sourceFile("toothed_wheel.tf", R"(
model ToothedWheel
  parameter Real T = 0.02, e = 0.1;
  coordinate Real phi;
  body wheel(angle = phi, inertia = 1e-5);
  force drive(value = T - 1e-4*der(phi), at = phi);
  contact stop(gap = 0.5 - sin(15*phi), restitution = e);
end ToothedWheel;
)");
  const double rest = std::asin(0.5) / 15;
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE}) {
    CompiledModel first(wheel);
    first.tolerance(1e-6).integrator(integrator).run(0.1);
    const double impact = first.eventTime(TF_EVENT_IMPACT);
    for (const double before : {1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14}) {
      CompiledModel model(wheel);
      model.tolerance(1e-6).integrator(integrator).run(impact - before);
      std::vector<unsigned char> buffer(tf_state_size(model.simulation()));
      ASSERT_EQ(tf_save_state(model.simulation(), buffer.data(), buffer.size()), TF_OK);
      model.advance(0.1);
      EXPECT_NEAR(model["phi"], rest, 1e-5) << integrator << ' ' << before;
    }
  }
}

// What tells rounding from a gap belongs to the state that is saved, not to the past of the simulation that saves it.
void expectSameWhereItIsRestored(const std::string &file) {
  constexpr double end = 1;
  CompiledModel first(file);
  first.tolerance(1e-7).run(end);
  for (int number = 0; number < 5; ++number)
    for (const double offset : {-1e-7, -3e-8, -1e-8, -3e-9, -1e-9, -1e-10, -1e-11, 0.0, 1e-13, 1e-12, 1e-11, 1e-9, 1e-7}) {
      CompiledModel saver(file), restorer(file);
      saver.tolerance(1e-7).run(first.eventTime(TF_EVENT_IMPACT, number) + offset);
      restorer.tolerance(1e-7).initialise();
      std::vector<unsigned char> buffer(tf_state_size(saver.simulation()));
      ASSERT_EQ(tf_save_state(saver.simulation(), buffer.data(), buffer.size()), TF_OK);
      ASSERT_EQ(tf_restore_state(restorer.simulation(), buffer.data(), buffer.size()), TF_OK);
      std::vector<double> saved(static_cast<std::size_t>(saver.model().variable_count)), restored(saved.size());
      for (CompiledModel *model : {&saver, &restorer})
        model->advance(end);
      ASSERT_EQ(tf_get_all(saver.simulation(), saved.data()), TF_OK);
      ASSERT_EQ(tf_get_all(restorer.simulation(), restored.data()), TF_OK);
      for (std::size_t i = 0; i < saved.size(); ++i)
        EXPECT_TRUE(saved[i] == restored[i] || (std::isnan(saved[i]) && std::isnan(restored[i])))
            << saver.model().variables[i].name << ' ' << number << ' ' << offset;
    }
}

TEST(Impacts, NearWhichAStateIsSavedAreTheSameWhereItIsRestored) {
  expectSameWhereItIsRestored(example("woodpecker.tf"));
  expectSameWhereItIsRestored(sourceFile("gears.tf", R"(
model Gears "three wheels with play between their teeth"
  parameter Real play = 1e-3, e = 0.4, r = 0.1;
  coordinate Real phi[3];
  body wheel[3](angle = phi, each inertia = 2e-3);
  force motor(value = 0.5*cos(3*time), at = phi[1]);
  force load(value = -0.02*der(phi[3]), at = phi[3]);
  Real s[2] = {r*(phi[i] + phi[i + 1]) for i in 1:2};
  contact front[2](gap = {play - s[i] for i in 1:2}, each restitution = e);
  contact back[2](gap = s, each restitution = e);
end Gears;
)"));
}

// Hops that begin so low that an integrator which does not start to rounding could not tell where they end.
TEST(Impacts, OfABallThatArrivesVerySlowlyEnd) {
  const std::string ball = sourceFile("slow_ball.tf", R"(
model SlowBall
  parameter Real e = 0.1, d = 0.5;
  coordinate Real y;
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -9.81});
  force drag(value = -d*der(y), at = y);
  contact floor(gap = y, restitution = e);
end SlowBall;
)");
  for (const tf_integrator integrator : kIntegrators)
    for (const double tolerance : {1e-7, 1e-10})
      for (const double speed : {1e-4, 3.8e-7, 1e-8}) {
        CompiledModel model(ball, {{"der(y)", -speed}});
        model.tolerance(tolerance).integrator(integrator).run(0.1);
        EXPECT_NEAR(model["y"], 0, 0.1 * tolerance) << integrator << ' ' << speed;
        EXPECT_LT(model.count(TF_EVENT_IMPACT), 20) << integrator << ' ' << speed;
        EXPECT_NEAR(model["floor.normalForce"], g, 1e-6) << integrator << ' ' << speed;
      }
}

// Bounces until the times between them are near what times are resolved to: the rest at sqrt(2/g) (1 + e)/(1 − e) is carried into all the
// same, as well as it is known.
TEST(AccumulatingImpacts, AreCarriedIntoRestWhereTimesAreResolvedNoBetter) {
  const std::string file = sourceFile("lively_ball.tf", R"(
model LivelyBall
  parameter Real e = 0.9999;
  coordinate Real y(start = 1);
  body b(mass = 1, position = y);
  force w(value = -9.81, at = y);
  contact floor(gap = y, restitution = e);
end LivelyBall;
)");
  for (const double e : {0.999, 0.9999})
    for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT}) {
      CompiledModel model(file, {{"e", e}});
      model.tolerance(1e-12).integrator(integrator).run(1 / (1 - e));
      EXPECT_EQ(model["y"], 0) << integrator;
      const double rest = std::sqrt(2 / 9.81) * (1 + e) / (1 - e);
      EXPECT_NEAR(model.eventTime(TF_EVENT_REST), rest, 1e-9 * rest) << integrator;
    }
}

// A ball bounces down a ramp, ever farther: what its gap is rounded to is far more than near the origin, whatever the tolerance asks for.
TEST(AccumulatingImpacts, FarFromTheOriginAreSummedAsWellAsGapsAreKnown) {
  const std::string ramp = sourceFile("ball_on_a_ramp.tf", R"(
model BallOnARamp
  parameter Real e = 0.97, slope = 0.5;
  coordinate Real x, y(start = 1);
  body b(mass = 1, position = {x, y});
  gravity w(acceleration = {0, -9.81});
  contact c(gap = sin(slope)*x + cos(slope)*y, restitution = e);
end BallOnARamp;
)");
  struct Case {
    double e, slope;
  };
  for (const auto &[e, slope] : {Case{0.97, 0.7}, Case{0.99, 0.3}, Case{0.8, 1.1}})
    for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT})
      for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
        CompiledModel model(ramp, {{"e", e}, {"slope", slope}});
        const double a = 9.81 * std::cos(slope), first = std::sqrt(2 * std::cos(slope) / a), rest = first * (1 + e) / (1 - e);
        model.tolerance(tolerance).integrator(integrator).run(1.2 * rest);
        EXPECT_EQ(model.count(TF_EVENT_REST), 1) << integrator << ' ' << tolerance << ' ' << e;
        EXPECT_NEAR(model.eventTime(TF_EVENT_REST), rest, std::max(tolerance, 1e-8) * rest) << integrator << ' ' << tolerance << ' ' << e;
      }
}

// Gaps that contain the time, of a plane that moves as far as the ball: rounding of the gap does not end what has just begun to open.
TEST(AccumulatingImpacts, FarFromTheOriginGoOn) {
  const std::string file = sourceFile("ball_on_a_lift.tf", R"(
model BallOnALift
  parameter Real e = 0.99, slope = 1.25, A = 0, v = 0;
  coordinate Real x, y;
  body b(mass = 1, position = {x, y});
  gravity w(acceleration = {0, -9.81});
  contact c(gap = -sin(slope)*x + cos(slope)*y + 1 - v*time - A*time^2/2, restitution = e);
end BallOnALift;
)");
  struct Case {
    double e, slope, A, v;
  };
  for (const auto &[e, slope, A, v] : {Case{0.99, 1.25, 0, 0}, Case{0.98, 0.26, -5, -1}, Case{0.99, 0, 0, 5}})
    for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT})
      for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        CompiledModel model(file, {{"e", e}, {"slope", slope}, {"A", A}, {"v", v}});
        // Relative to the plane: 1 − v t − a t²/2, then hops of 2 e^k w/a.
        const double a = 9.81 * std::cos(slope) + A, w = std::sqrt(v * v + 2 * a), first = (w - v) / a;
        const double rest = first + 2 * e * w / (a * (1 - e));
        model.tolerance(tolerance).integrator(integrator).run(1.2 * rest);
        EXPECT_NEAR(model.eventTime(TF_EVENT_REST), rest, std::max(tolerance, 1e-6) * rest)
            << integrator << ' ' << tolerance << ' ' << slope;
      }
}

// A wheel hops as often as the lever on its axle knocks on the floor; between two hops it rolls. Their accumulation is followed to its end
// by all integrators, among them CVODE, of whose errors hops without end would consist.
TEST(Impacts, HopsWithRollingInBetweenAccumulate) {
  const std::string file = sourceFile("wheel_with_lever.tf", R"(
model WheelWithLever
  coordinate Real x(start = 0, der(start = 1.5)), y(start = 0.3), phi(start = 0, der(start = 5)), psi(start = 0.3);
  parameter Real R = 0.3;
  body wheel(mass = 4, position = {x, y}, angle = phi, inertia = 0.2);
  body lever(mass = 0.5, position = {x + 0.25*cos(psi), y + 0.25*sin(psi)}, angle = psi, inertia = 0.01);
  gravity weight(acceleration = {0, -9.81});
  force damping(value = -0.05*der(psi), at = psi);
  contact ground(gap = y - R, slip = der(x) + R*der(phi), friction = 0.5);
  contact tip(gap = y + 0.5*sin(psi), slip = der(x) - 0.5*sin(psi)*der(psi), friction = 0.3, restitution = 0.1);
end WheelWithLever;
)");
  CompiledModel reference(file);
  reference.tolerance(1e-11).run(0.5);
  ASSERT_EQ(reference.count(TF_EVENT_REST), 2);
  for (const tf_integrator integrator : kIntegrators)
    for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(0.5);
      EXPECT_LT(model.events().size(), 60) << integrator << ' ' << tolerance;
      EXPECT_NEAR(model.eventTime(TF_EVENT_REST), reference.eventTime(TF_EVENT_REST), 10 * tolerance) << integrator << ' ' << tolerance;
      for (const char *variable : {"x", "phi", "psi", "der(x)", "der(psi)"})
        EXPECT_NEAR(model[variable], reference[variable], 10 * tolerance) << integrator << ' ' << tolerance << ' ' << variable;
    }
}

// The upper of two discs in a groove hops on the lower one, and between any two hops the lower one bounces between the walls until it
// rests: the hops go on, ever lower, however many bounces have come to their end in between.
TEST(Impacts, HopsAboveBouncesAccumulate) {
  const std::string file = sourceFile("discs_in_groove.tf", R"(
model DiscsInGroove
  parameter Real m = 1, R = 0.1, g = 9.81, mu = 0.15, e = 0.2, a = 0.9;
  coordinate Real x[2](start = {0.01, -0.02}), y[2](start = {0.25, 0.48}), phi[2];
  Real d = sqrt((x[2] - x[1])^2 + (y[2] - y[1])^2);
  Real nx = (x[2] - x[1])/d, ny = (y[2] - y[1])/d;
  body disc[2](each mass = m, position = {{x[i], y[i]} for i in 1:2}, angle = phi, each inertia = m*R^2/2);
  gravity weight(acceleration = {0, -g});
  contact right[2](gap = {-x[i]*sin(a) + y[i]*cos(a) - R for i in 1:2},
                   slip = {der(x[i])*cos(a) + der(y[i])*sin(a) + R*der(phi[i]) for i in 1:2}, each friction = mu, each restitution = e);
  contact left[2](gap = {x[i]*sin(a) + y[i]*cos(a) - R for i in 1:2},
                  slip = {der(x[i])*cos(a) - der(y[i])*sin(a) + R*der(phi[i]) for i in 1:2}, each friction = mu, each restitution = e);
  contact touch(gap = d - 2*R, slip = -ny*(der(x[2]) - der(x[1])) + nx*(der(y[2]) - der(y[1])) - R*(der(phi[1]) + der(phi[2])),
                friction = mu, restitution = e);
end DiscsInGroove;
)");
  CompiledModel reference(file);
  reference.tolerance(1e-11).run(1.5);
  for (const tf_integrator integrator : kIntegrators)
    for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(1.5);
      EXPECT_LT(model.events().size(), 1200) << integrator << ' ' << tolerance;
      EXPECT_GT(tf_get_statistics(model.simulation())->worst_gap, -1e-9) << integrator << ' ' << tolerance;
      for (const char *variable : {"x[1]", "y[1]", "phi[1]", "x[2]", "y[2]", "phi[2]"})
        EXPECT_NEAR(model[variable], reference[variable], 10 * tolerance) << integrator << ' ' << tolerance << ' ' << variable;
    }
}

// Where a run begins there is no mode yet whose switches an impact of slips with two components could keep: x(0) = 0 with friction that
// stops it, then x'' = ±1 about x = 0.3.
TEST(Impacts, AtTheStartOfAModelWithSwitches) {
  for (const char *friction : {"Exact", "Relaxed"}) {
    CompiledModel model(sourceFile("impact_at_start.tf", fmt::format(R"(
model ImpactAtStart
  coordinate Real q[3](start = {{0, 0, 0}}, der(start = {{0.5, 0, -1}}));
  body b(mass = 1, position = q);
  force f(value = -sign(q[1] - 0.3), at = q[1]);
  contact floor(gap = q[3], slip = der(q[1:2]), friction = 0.5, frictionForm = FrictionForm.{});
end ImpactAtStart;
)",
                                                                     friction)));
    model.tolerance(1e-9).run(1);
    const double reached = std::sqrt(0.6), left = 1 - reached;
    EXPECT_NEAR(model["q[1]"], 0.3 + reached * left - left * left / 2, 1e-8) << friction;
    EXPECT_NEAR(model["der(q[1])"], reached - left, 1e-8) << friction;
    EXPECT_NEAR(model["q[3]"], 0, 1e-12) << friction;
  }
}

// Just before it switches are what they are, though there is no mode yet.
TEST(Impacts, AtTheStartHaveTheSwitchesOfTheStartBefore) {
  CompiledModel model(sourceFile("switch_before_start.tf", R"(
model SwitchBeforeStart
  coordinate Real q[2](der(start = {0.5, -1}));
  body b(mass = 1, position = q);
  output Real side = if time < 5 then 7 else 3;
  contact floor(gap = q[2], slip = der(q[1]), friction = 0.5);
end SwitchBeforeStart;
)"));
  struct Seen {
    tf_simulation *simulation;
    std::size_t side, count;
    double before = 0, after = 0;
  } seen{model.simulation(), static_cast<std::size_t>(tf_find(model.simulation(), "side")),
         static_cast<std::size_t>(model.model().variable_count)};
  const auto observe = [](void *data, const tf_event *) {
    auto &values = *static_cast<Seen *>(data);
    std::vector<double> all(values.count);
    ASSERT_EQ(tf_get_all_before(values.simulation, all.data()), TF_OK);
    values.before = all[values.side];
    ASSERT_EQ(tf_get_all(values.simulation, all.data()), TF_OK);
    values.after = all[values.side];
  };
  ASSERT_EQ(tf_set_event_callback(model.simulation(), observe, &seen), TF_OK);
  ASSERT_EQ(tf_initialise(model.simulation(), 0), TF_OK);
  ASSERT_EQ(tf_set_event_callback(model.simulation(), nullptr, nullptr), TF_OK);
  EXPECT_EQ(seen.before, 7);
  EXPECT_EQ(seen.after, 7);
}

}  // namespace
}  // namespace tf::test
