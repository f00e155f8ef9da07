// Examples with restitution and infinitely many impacts (Zeno) against closed forms and independent references.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/pushed_table.h"
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

// Impacts with slips of two components are followed to 1e-10 of velocities: slower ones than 1e-9 do not bounce, at any tolerance, which
// would go on for ever by what they are wrong by.
TEST(Impacts, WithTurningSlipsDoNotBounceByTheirErrors) {
  for (const double tolerance : {1e-6, 1e-9, 1e-11})
    for (const double speed : {2e-10, 8e-10, 1e-7, 1e-3}) {
      CompiledModel model(sourceFile("slow_impact.tf", R"(
model SlowImpact
  parameter Real speed = 1, e = 0.6;
  coordinate Real q[3](start = {0, 0, 0}, der(start = {0.7, 0.2, -speed}));
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = der(q[1:2]), friction = 0.5, restitution = e);
end SlowImpact;
)"),
                          {{"speed", speed}});
      model.tolerance(tolerance).initialise();
      const bool bounces = speed > std::max(1e-9, 0.05 * tolerance);
      EXPECT_NEAR(model["der(q[3])"], bounces ? 0.6 * speed : 0, 1e-10 + 1e-9 * speed) << tolerance << ' ' << speed;
    }
}

// What slides slowly, with or without friction, is not what an impact elsewhere has shaken, whatever the tolerance is.
TEST(Impacts, LeaveSlowSlipsAsTheyAre) {
  const std::string file = sourceFile("creepers.tf", R"(
model Creepers
  parameter Real v = 1e-6;
  coordinate Real x[2](each start = 0, each der(start = v));
  coordinate Real y[3](start = {0, 0, 1});
  body creeper[2](each mass = 1, position = {{x[1], y[1]}, {x[2], y[2]}});
  body ball(mass = 1, position = {-1, y[3]});
  gravity weight(acceleration = {0, -9.81});
  force pull(value = 0.4*9.81, at = x[2]);
  contact floor[2](gap = y[1:2], slip = der(x), friction = {0, 0.4});
  contact ground(gap = y[3]);
end Creepers;
)");
  for (const double tolerance : {1e-1, 1e-2, 1e-4})
    for (const tf_integrator integrator : kIntegrators) {
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).run(1);
      EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1);
      EXPECT_NEAR(model["x[1]"], 1e-6, 1e-15) << tolerance;
      EXPECT_NEAR(model["x[2]"], 1e-6, 1e-15) << tolerance;
      EXPECT_NEAR(model["der(x[1])"], 1e-6, 1e-15) << tolerance;
      EXPECT_EQ(model.count(TF_EVENT_STICK), 0) << tolerance;
    }
}

std::string longChain() {
  return sourceFile("long_chain.tf", R"(
model LongChain
  parameter Integer n = 50;
  parameter Real l = 1/n;
  coordinate Real r[2](start = {0, 0.3}, der(start = {0.5, 0}));
  coordinate Real phi[n](start = {0.9 - 0.25*(i - 1) for i in 1:n});
  Real node[n + 1, 2];
  body rod[n](each mass = 1/n, position = (node[1:n, :] + node[2:n + 1, :])/2, angle = phi, each inertia = l^2/n/12);
  gravity weight(acceleration = {0, -9.81});
  force damper[n - 1](value = -0.002*(der(phi[2:n]) - der(phi[1:n - 1])), at = phi[2:n] - phi[1:n - 1]);
  contact floor[n + 1](gap = node[:, 2], slip = der(node[:, 1]), each friction = 0.5);
equation
  node[1, :] = r;
  for i in 1:n loop
    node[i + 1, :] = node[i, :] + l*{cos(phi[i]), sin(phi[i])};
  end for;
end LongChain;
)");
}

// A chain with stiff joint dampers, rods of which creep while others fall onto the floor: no fewer impacts with a smaller tolerance.
// And no contact pulls, at any tolerance.
TEST(Impacts, OfAChainAreNotMoreAtLargerTolerances) {
  const std::string file = longChain();
  const auto impacts = [&](double tolerance) {
    CompiledModel model(file);
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).integrator(TF_AUTO).run(0.45);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_normal_force, -1e-8 * statistics.largest_normal_force) << tolerance;
    return model.count(TF_EVENT_IMPACT);
  };
  const int fine = impacts(1e-3);
  for (const double tolerance : {1e-1, 1e-2})
    EXPECT_LE(impacts(tolerance), fine) << tolerance;
}

// Corners of a coin that rolls around its edge are near one another: closed gaps that differ by the accuracy of events tilt it by far more.
TEST(Impacts, OfACoinOfTwelveCornersHaveAContinuation) {
  CompiledModel model(sourceFile("coin.tf", R"(
model Coin
  parameter Integer n = 12;
  parameter Real R = 0.1, h = 0.02, mu = 0.5, e = 0.5, pi = 3.14159265358979;
  parameter Real rim[n, 2] = {{R*cos(2*pi*i/n), R*sin(2*pi*i/n)} for i in 1:n};
  parameter Real corner[2*n, 3] = {if i <= n then {rim[i, 1], rim[i, 2], h/2} else {rim[i - n, 1], rim[i - n, 2], -h/2} for i in 1:2*n};
  coordinate Real p[3](start = {0, 0, 0.3}, der(start = {0.5, 0, 0}));
  coordinate Rotation Q(start = {1, 0.3, 0.2, 0.1});
  body coin(mass = 0.5, position = p, orientation = Q, inertia = diagonal({0.00127, 0.00127, 0.0025}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real c[2*n, 3] = {p + Q*corner[i, :] for i in 1:2*n};
  contact leg[2*n](gap = c[:, 3], slip = der(c[:, 1:2]), each friction = mu, each restitution = e);
end Coin;
)"));
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  for (const double mu : {0.5, 1.0})
    for (const double start : {1.0, 0.7}) {
      ASSERT_EQ(tf_set(model.simulation(), "mu", mu), TF_OK);
      ASSERT_EQ(tf_set(model.simulation(), "Q.q[1]", start), TF_OK);
      ASSERT_EQ(tf_set(model.simulation(), "Q.w[3]", 5), TF_OK);
      model.tolerance(1e-6).run(1);
      const tf_statistics &statistics = *tf_get_statistics(model.simulation());
      EXPECT_GE(statistics.worst_gap, -1e-9);
      EXPECT_LT(statistics.worst_energy_error, 1e-7);
    }
}

// Which foot of a table that slides bears how much is open, and with it the friction: no paradox of a contact.
TEST(Impacts, LoadsThatAreOpenAreNoParadox) {
  CompiledModel model(sourceFile("table_with_polyhedral_friction.tf", pushedTable("Polyhedral")));
  model.tolerance(1e-6).run(1.3);
  EXPECT_GE(model.count(TF_EVENT_SLIP), 4);
  EXPECT_EQ(model.count(TF_EVENT_PAINLEVE), 0);
}

// Damping makes forces of the chain stiff: at a step's end they are quite other ones than on the closed contacts nearby, where the mode
// ends. How the steps fall depends on the tolerance.
TEST(Impacts, OfAChainLeaveForcesThatPressAtLooseTolerances) {
  const std::string file = longChain();
  for (const double tolerance : {0.3, 0.2, 0.15, 0.05, 0.02}) {
    CompiledModel model(file);
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).integrator(TF_AUTO).run(0.45);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_normal_force, -1e-8 * statistics.largest_normal_force) << tolerance;
  }
}

// What its motion would be behind an event has an error that is none of a step up to the event: one attempt shows that.
TEST(Impacts, OfAChainTakeFewAttemptsOfSteps) {
  CompiledModel model(longChain());
  model.tolerance(1e-1).integrator(TF_AUTO).run(0.45);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_LT(statistics.rejected_steps, statistics.steps / 5);
}

// A corner of a cube, turned somehow, hits the top of another one that rests on four feet, whose shares of the impact are not unique.
std::string cubeOntoCube() {
  return sourceFile("cube_onto_cube.tf", R"(
model CubeOntoCube
  parameter Real a = 0.5, b = 0.3, m = 2, M = 4, mu = 0.4, mf = 0.5, e = 0.5, shift = 0;
  coordinate Real p[3](start = {0, 0, a/2});
  coordinate Rotation Q;
  coordinate Rotation R(start = {0.9820881872783486, 0.06357317401828835, 0.011066235248301522, 0.1770276317160605},
    w(start = {1.0001431719304463, 0.04779145392832871, 0.5536829853836617}));
  coordinate Real q[3](start = {0.125 + shift, 0.062, 0.6681847016461915},
    der(start = {0.083399896385126, 0.0250199689155378, -1.2669712521212646}));
  body lower(mass = M, position = p, orientation = Q, inertia = M*a^2/6*identity(3));
  body upper(mass = m, position = q, orientation = R, inertia = m*b^2/6*identity(3));
  parameter Real s[4, 2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  Real foot[4, 3] = {p + Q*{s[i, 1]*a/2, s[i, 2]*a/2, -a/2} for i in 1:4};
  contact floor[4](gap = foot[:, 3], slip = der(foot[:, 1:2]), each friction = mf, each restitution = 0.3);
  Real corner[3] = inverse(Q)*(q + R*{-b/2, -b/2, -b/2} - p);
  contact top(gap = corner[3] - a/2, slip = der(corner[1:2]), friction = mu, restitution = e);
end CubeOntoCube;
)");
}

double impulseOntoCube(double mu, double mf, double e, double shift) {
  CompiledModel model(cubeOntoCube(), {{"mu", mu}, {"mf", mf}, {"e", e}, {"shift", shift}});
  model.tolerance(1e-8).run(1e-6);
  EXPECT_EQ(model.count(TF_EVENT_IMPACT), 1);
  return model["top.impulse"];
}

// By Poisson's law that is e times the impulse of the compression, in whatever way the feet share the load.
TEST(Impacts, OntoABodyOnManyFeetHaveTheirRestitution) {
  const double compression = impulseOntoCube(0.4, 0.5, 0, 0);
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR(impulseOntoCube(0.4, 0.5, 0.5, 1e-13 * k), 1.5 * compression, 1e-7) << k;
}

// While the upper cube slips, friction is as large as all feet together can bear: they neither slip nor have anything left.
TEST(Impacts, OntoFeetThatAreAtTheLimitOfTheirFriction) {
  for (const double mu : {0.3, 0.5}) {
    const double rough = impulseOntoCube(mu, 1.05 * mu, 0.5, 0);
    EXPECT_NEAR(impulseOntoCube(mu, mu, 0.5, 0), rough, 1e-6) << mu;
    EXPECT_NEAR(impulseOntoCube(mu, mu, 0, 0), rough / 1.5, 1e-6) << mu;
  }
}

// A mass slides obliquely under a ceiling that comes down, and is caught: friction holds it while the ceiling has work left to give back,
// or has not reached its target. Impulses of Stronge's law against an integration with friction that is smooth at zero, which is right to
// 1e-5.
TEST(Impacts, WhatCannotPartAWedgeIsLost) {
  const auto wedge = [](const std::string &law) {
    return sourceFile("caught_in_a_wedge_" + law + ".tf", fmt::format(R"(
model Wedge
  parameter Real mu = 0.6, under = 0.4, e = 0.5, below = 0.5, slope = 0.3, side = 2;
  coordinate Real x(der(start = 5)), y(der(start = side)), z;
  body b(mass = 1, position = {{x, y, z}});
  gravity g(acceleration = {{0, 0, -9.81}});
  contact floor(gap = z, slip = {{der(x), der(y)}}, friction = under, restitution = below, law = ImpactLaw.{0});
  contact ceiling(gap = (1 - x)*sin(slope) - z*cos(slope), slip = {{der(x)*cos(slope) - der(z)*sin(slope), der(y)}}, friction = mu,
    restitution = e, law = ImpactLaw.{0});
end Wedge;
)",
                                                                      law));
  };
  const auto expectRest = [](CompiledModel &model) {
    for (const char *velocity : {"der(x)", "der(y)", "der(z)"})
      EXPECT_NEAR(model[velocity], 0, 1e-9) << velocity;
  };
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-8})
      for (const double side : {2.0, -3.0}) {
        CompiledModel model(wedge("Stronge"), {{"side", side}});
        model.tolerance(tolerance).integrator(integrator).run(2);
        const double scale = 10 * tolerance;
        expectRest(model);
        EXPECT_NEAR(model["floor.impulse"], side > 0 ? 3.131527 : 3.60633, 2e-5 + scale);
        EXPECT_NEAR(model["ceiling.impulse"], side > 0 ? 3.910427 : 4.38592, 2e-5 + scale);
      }
  const Settings cases[] = {{{"mu", 1.122}, {"under", 0.268}, {"e", 0.35}, {"below", 0.81}, {"slope", 0.668}, {"side", -0.81}},
                            {{"mu", 0.363}, {"under", 0.503}, {"e", 0.87}, {"below", 0.19}, {"slope", 0.582}, {"side", 2.11}}};
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-8})
      for (const Settings &settings : cases) {
        CompiledModel model(wedge("Poisson"), settings);
        model.tolerance(tolerance).integrator(integrator).run(2);
        expectRest(model);
        EXPECT_LT(model["ceiling.impulse"], 10);
      }
  const std::string planar = sourceFile("caught_in_a_planar_wedge.tf", R"(
model PlanarWedge
  parameter Real mu = 0.6, e = 0.5, slope = 0.4;
  coordinate Real x(der(start = 5)), y;
  body b(mass = 1, position = {x, y});
  gravity g(acceleration = {0, -9.81});
  contact floor(gap = y, slip = der(x), friction = mu);
  contact ceiling(gap = (1 - x)*sin(slope) - y*cos(slope), slip = der(x)*cos(slope) - der(y)*sin(slope), friction = mu, restitution = e,
    law = ImpactLaw.Newton);
end PlanarWedge;
)");
  for (const double friction : {0.3, 0.6, 1.0})
    for (const double restitution : {0.01, 0.5, 1.0}) {
      CompiledModel model(planar, {{"mu", friction}, {"e", restitution}});
      model.tolerance(1e-8).run(1);
      EXPECT_NEAR(model["der(x)"], 0, 1e-12);
      EXPECT_NEAR(model["der(y)"], 0, 1e-12);
      EXPECT_LT(model["ceiling.impulse"], 20);
    }
}

}  // namespace
}  // namespace tf::test
