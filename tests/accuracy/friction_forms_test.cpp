// Polyhedral friction of slips of two components: against the exact solution of the polygon's law, and its convergence to Coulomb's disk.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/tumbling_box.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace tf::test {
namespace {

using Vector = std::complex<double>;

// A slip under the friction of a regular polygon with 2N sides and vertices of length 1, of which the one that dissipates most is against
// it: velocity and place after `amount` = ∫ limit/mass dt. Between two normals of sides the force is constant; on a normal it is the side's
// middle, and the slip stays on it.
struct PolygonSlip {
  int directions;
  Vector velocity, place = 0;

  void advance(double amount) {
    const double side = pi / directions, offset = pi / 2;
    while (amount > 0 && std::abs(velocity) > 0) {
      const double turn = (std::arg(velocity) - offset) / side;
      const bool isOnNormal = std::abs(turn - std::round(turn)) < 1e-9;
      const double middle = offset + side * (isOnNormal ? std::round(turn) : std::floor(turn) + 0.5);
      const Vector axis = std::polar(1.0, middle), local = velocity / axis;
      const double strength = isOnNormal ? std::cos(side / 2) : 1;
      const double end = isOnNormal ? local.real() : local.real() - std::abs(local.imag()) / std::tan(side / 2);
      const double duration = std::min(amount, end / strength);
      place += velocity * duration - 0.5 * strength * duration * duration * axis;
      velocity -= strength * duration * axis;
      if (duration < amount)
        velocity = isOnNormal ? 0 : std::polar(std::abs(velocity), middle + std::copysign(side / 2, local.imag()));
      amount -= duration;
    }
  }
};

std::string puck(int directions) {
  const std::string form = directions > 0 ? "Polyhedral" : "Exact", number = std::to_string(std::max(directions, 2));
  return sourceFile("puck" + number + ".tf", R"(
model Puck
  parameter Real mu = 0.3, speed = 2, angle = 0.4, height = 0, fall = 0, e = 0, pull[2] = {0, 0};
  coordinate Real q[3](start = {0, 0, height}, der(start = {speed*cos(angle), speed*sin(angle), -fall}));
  body puck(mass = 2, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = pull, at = q[1:2]);
  contact table(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = mu, restitution = e, frictionForm = FrictionForm.)" +
                                                 form + R"(,
                directions = )" + number + R"();
end Puck;
)");
}

TEST(PolyhedralFriction, PuckFollowsThePolygonsLaw) {
  for (const int directions : {2, 3, 4, 7, 8, 16})
    for (const double angle : {0.4, 1.1, -2.5, 0.0})
      for (const tf_integrator integrator : {TF_STEP, TF_EXPLICIT, TF_CVODE}) {
        CompiledModel model(puck(directions), {{"angle", angle}});
        model.tolerance(1e-10).integrator(integrator).initialise();
        PolygonSlip slip{directions, std::polar(2.0, angle)};
        const double tolerance = integrator == TF_CVODE ? 1e-6 : 1e-9;
        for (const double time : {0.3, 1.5}) {
          model.advance(time);
          slip.advance(0.3 * g * (time == 0.3 ? 0.3 : 1.2));
          EXPECT_NEAR(model["q[1]"], slip.place.real() / (0.3 * g), tolerance) << directions << " at " << angle;
          EXPECT_NEAR(model["q[2]"], slip.place.imag() / (0.3 * g), tolerance) << directions << " at " << angle;
          EXPECT_NEAR(model["table.slip[1]"], slip.velocity.real(), tolerance);
          EXPECT_NEAR(model["table.slip[2]"], slip.velocity.imag(), tolerance);
        }
        EXPECT_EQ(model["table.sticking"], 1);
        EXPECT_LE(std::hypot(model["table.frictionForce[1]"], model["table.frictionForce[2]"]), 1e-12);
      }
}

// While time is frozen the normal impulse m (1 + e) v takes the part of mass·time.
TEST(PolyhedralFriction, ImpactFollowsThePolygonsLaw) {
  for (const int directions : {2, 5, 8})
    for (const double angle : {0.4, 1.3, 2.9})
      for (const double fall : {1.0, 4.0}) {
        CompiledModel model(puck(directions), {{"angle", angle}, {"fall", fall}, {"e", 0.5}});
        model.tolerance(1e-10).initialise();
        PolygonSlip slip{directions, std::polar(2.0, angle)};
        slip.advance(0.3 * 1.5 * fall);
        EXPECT_NEAR(model["der(q[1])"], slip.velocity.real(), 1e-12);
        EXPECT_NEAR(model["der(q[2])"], slip.velocity.imag(), 1e-12);
        EXPECT_NEAR(model["der(q[3])"], 0.5 * fall, 1e-12);
      }
}

// The polygon's vertices are on Coulomb's circle: what the middle of a side, shorter by cos(π/(2N)), cannot hold, a vertex can.
TEST(PolyhedralFriction, SticksAsLongAsThePolygonHoldsTheLoad) {
  for (const int directions : {2, 3, 4, 8}) {
    const double apothem = std::cos(pi / (2 * directions)), limit = 0.3 * 2 * g, normal = pi / 2, vertex = normal + pi / (2 * directions);
    const auto moves = [&](double force, double direction) {
      CompiledModel model(puck(directions),
                          {{"speed", 0}, {"pull[1]", force * std::cos(direction)}, {"pull[2]", force * std::sin(direction)}});
      model.tolerance(1e-9).run(1);
      if (model["table.sticking"] != 0) {
        EXPECT_NEAR(model["table.frictionForce[1]"], -force * std::cos(direction), 1e-9);
        EXPECT_NEAR(model["table.frictionForce[2]"], -force * std::sin(direction), 1e-9);
      }
      return std::hypot(model["q[1]"], model["q[2]"]) > 1e-12;
    };
    EXPECT_FALSE(moves(0.999 * apothem * limit, normal)) << directions;
    EXPECT_TRUE(moves(1.001 * apothem * limit, normal)) << directions;
    EXPECT_FALSE(moves(0.999 * limit, vertex)) << directions;
    EXPECT_TRUE(moves(1.001 * limit, vertex)) << directions;
  }
}

// The force's direction is off by up to half a side's angle, so that the way is of first order in 1/N; its strength is of second order.
TEST(PolyhedralFriction, ConvergesToTheDisk) {
  const double way = 2 * 2 / (2 * 0.3 * g);
  for (const int directions : {2, 4, 8, 16, 32, 64}) {
    const double halfSide = pi / (2 * directions);
    double worst = 0;
    for (const double angle : {0.1, 0.25, 0.4, 0.7, 1.2, 1.5}) {
      CompiledModel model(puck(directions), {{"angle", angle}});
      model.tolerance(1e-9).run(4);
      worst = std::max(worst, std::abs(Vector(model["q[1]"], model["q[2]"]) - std::polar(way, angle)) / way);
    }
    EXPECT_LT(worst, 0.5 * halfSide + 2 * (1 / std::cos(halfSide) - 1)) << directions;
  }
}

TEST(PolyhedralFriction, EventsAreThoseOfTheContact) {
  CompiledModel model(puck(4));
  model.tolerance(1e-9).run(2);
  EXPECT_EQ(model.count(TF_EVENT_STICK), 1);
  EXPECT_EQ(model.count(TF_EVENT_SLIDING), 1);
  EXPECT_EQ(model.events().size(), 2U);
}

TEST(PolyhedralFriction, FrictionElementsHaveItToo) {
  CompiledModel model(sourceFile("polyhedral_element.tf", R"(
model Damped
  coordinate Real q[2](start = {0, 0}, der(start = {1, 0.6}));
  body puck(mass = 2, position = q);
  friction dry(slip = der(q), bound = 3, frictionForm = FrictionForm.Polyhedral, directions = 5);
end Damped;
)"));
  model.tolerance(1e-10).initialise();
  PolygonSlip slip{5, {1, 0.6}};
  for (const double time : {0.4, 1.2}) {
    model.advance(time);
    slip.advance(1.5 * (time == 0.4 ? 0.4 : 0.8));
    EXPECT_NEAR(model["q[1]"], slip.place.real() / 1.5, 1e-9);
    EXPECT_NEAR(model["q[2]"], slip.place.imag() / 1.5, 1e-9);
  }
  EXPECT_EQ(model["dry.sticking"], 1);
}

std::string ball(int directions) {
  const std::string form = directions > 0 ? "Polyhedral" : "Exact", number = std::to_string(std::max(directions, 2));
  return sourceFile("ball" + number + ".tf", R"(
model Ball "with backspin"
  parameter Real r = 0.1, m = 1, mu = 0.2;
  coordinate Real p[3](start = {0, 0, 0.1}, der(start = {3, 1, 0}));
  coordinate Rotation R(w(start = {5, -60, 10}));
  body ball(mass = m, position = p, orientation = R, inertia = 0.4*m*r^2*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  Real w[3] = R*R.w;
  contact floor(gap = p[3] - r, slip = {der(p[1]) - w[2]*r, der(p[2]) + w[1]*r}, friction = mu, frictionForm = FrictionForm.)" +
                                                 form + R"(,
                directions = )" + number + R"();
end Ball;
)");
}

// Slips start and stop along the polygon's edges and corners as the belt goes to and fro.
TEST(PolyhedralFriction, PuckOnAShakingBelt) {
  for (const int directions : {3, 5, 7}) {
    const std::string number = std::to_string(directions);
    const std::string file = sourceFile("shaken_puck" + number + ".tf", R"(
model Puck
  coordinate Real q[3](start = {0, 0, 0}, der(start = {-0.2264725793271934, -0.05542788192056222, 0}));
  body b(mass = 1, position = q);
  gravity g(acceleration = {0, 0, -10});
  contact c(gap = q[3], slip = {der(q[1]) - 0.2*sin(5*time), der(q[2])}, friction = 0.5, frictionForm = FrictionForm.Polyhedral,
    directions = )" + number + R"();
  force f(value = {4, 2, 0}, at = q);
end Puck;
)");
    CompiledModel best(file);
    best.tolerance(1e-11).initialise(1.2);
    best.advance(3);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-3, 1e-5, 1e-8}) {
        CompiledModel model(file);
        model.tolerance(tolerance).integrator(integrator).initialise(1.2);
        model.advance(3);
        for (const char *name : {"q[1]", "q[2]", "der(q[1])", "der(q[2])"})
          EXPECT_NEAR(model[name], best[name], tolerance) << integrator << ", " << tolerance << ", " << directions << ", " << name;
      }
  }
}

// A ball's slip obeys the puck's law with the amount 7/2 limit/mass, and 2/7 of what friction takes from the slip it takes from the centre.
TEST(PolyhedralFriction, BallWithBackspinFollowsThePolygonsLaw) {
  for (const int directions : {3, 8, 24}) {
    CompiledModel model(ball(directions));
    model.tolerance(1e-10).initialise();
    PolygonSlip slip{directions, {3 + 6, 1 + 0.5}};
    const Vector before = slip.velocity;
    model.advance(0.7);
    slip.advance(3.5 * 0.2 * g * 0.7);
    const Vector velocity = Vector(3, 1) + (slip.velocity - before) * (2.0 / 7);
    EXPECT_NEAR(model["der(p[1])"], velocity.real(), 1e-8) << directions;
    EXPECT_NEAR(model["der(p[2])"], velocity.imag(), 1e-8) << directions;
    model.advance(3);
    const Vector rolling = Vector(3, 1) - before * (2.0 / 7);
    EXPECT_NEAR(model["der(p[1])"], rolling.real(), 1e-8);
    EXPECT_NEAR(model["der(p[2])"], rolling.imag(), 1e-8);
  }
}

std::string box(int directions) {
  const std::string number = std::to_string(directions);
  return tumblingBox("box" + number + ".tf", "", "each frictionForm = FrictionForm.Polyhedral, each directions = " + number);
}

// Faces that slide and turn on their four corners: redundant forces in many directions at once.
TEST(PolyhedralFriction, TumblingBoxesKeepTheirInvariants) {
  std::mt19937 random(5);
  const auto between = [&random](double low, double high) { return low + (high - low) * (static_cast<double>(random()) / 4294967296.0); };
  for (int run = 0; run < 20; ++run) {
    Settings settings = {{"mu", between(0, 2)}, {"e", run % 2 == 0 ? 0 : between(0, 1)}};
    for (const char *name : {"v[1]", "v[2]", "w[1]", "w[2]", "w[3]"})
      settings.emplace_back(name, between(-5, 5));
    CompiledModel model(box(2 + run % 3), settings);
    model.tolerance(1e-8);
    tf_set_energy_balance(model.simulation(), 1);
    model.run(3);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GT(statistics.worst_gap, -1e-9) << run;
    EXPECT_GT(statistics.worst_normal_force, -1e-12) << run;
    EXPECT_LT(statistics.worst_energy_error, 1e-6) << run;
  }
}

}  // namespace
}  // namespace tf::test
