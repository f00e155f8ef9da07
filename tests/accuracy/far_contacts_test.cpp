// Models with many contacts, of which few are near at any time: none that closes may be overlooked.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/each_integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tf::test {
namespace {

// Equal balls in a row: each impact passes the whole velocity on.
TEST(FarContacts, AnImpactTravelsAlongARow) {
  const std::string file = sourceFile("row_of_balls.tf", R"(
model Row
  constant Integer n = 20;
  coordinate Real x[n](start = {2.0*k for k in 1:n}, der(start = {if k == 1 then 1.0 else 0.0 for k in 1:n}));
  body ball[n](each mass = 1, position = x);
  contact pair[n - 1](gap = {x[k + 1] - x[k] - 1 for k in 1:n - 1}, each restitution = 1);
end Row;
)");
  withEachIntegrator(file, 1e-9, 18.5, [](CompiledModel &model) {
    ASSERT_EQ(model.count(TF_EVENT_IMPACT), 18);
    for (int k = 0; k < 18; ++k)
      EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT, k), k + 1, 1e-9) << k;
    EXPECT_NEAR(model["x[19]"], 2 * 19 + 0.5, 1e-8);
  });
}

// One post of forty stands in the way.
TEST(FarContacts, OnePostIsHit) {
  const std::string file = sourceFile("posts.tf", R"(
model Posts
  constant Integer n = 40;
  coordinate Real r[2](start = {0, 0}, der(start = {1, 0}));
  body ball(mass = 1, position = r);
  contact post[n](gap = {sqrt((r[1] - k)^2 + (r[2] - (if k == 33 then 0.0 else 0.5))^2) - 0.2 for k in 1:n}, each restitution = 1);
end Posts;
)");
  withEachIntegrator(file, 1e-9, 60, [](CompiledModel &model) {
    ASSERT_EQ(model.count(TF_EVENT_IMPACT), 1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), 32.8, 1e-9);
    EXPECT_NEAR(model["r[1]"], 2 * 32.8 - 60, 1e-8);
  });
}

// The tip of a bar that spins fast, in steps of any length, hits the one post that is near its circle.
TEST(FarContacts, SpinningBarHitsAPost) {
  const std::string file = sourceFile("spinning_bar.tf", R"(
model Spinning
  constant Integer n = 12;
  constant Real pi = 3.14159265358979323846;
  coordinate Real phi(der(start = 50));
  body bar(angle = phi, inertia = 1);
  contact post[n](gap = {sqrt((cos(phi) - (if k == 7 then 1 else 1.5)*cos(2*pi*k/n))^2 + (sin(phi) - (if k == 7 then 1 else 1.5)*sin(2*pi*k/n))^2) - 0.1 for k in 1:n}, each restitution = 1);
end Spinning;
)");
  const double first = (2 * pi * 7 / 12 - 2 * std::asin(0.05)) / 50;
  withEachIntegrator(file, 1e-9, 0.1, [&](CompiledModel &model) {
    ASSERT_GE(model.count(TF_EVENT_IMPACT), 1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), first, 1e-9);
    EXPECT_EQ(model.events()[0].element, 6);
  });
}

// Walls that only time moves: one of them, which is far at first, catches a body at rest.
TEST(FarContacts, AWallComesNearByItself) {
  const std::string file = sourceFile("walls_that_come.tf", R"(
model Walls
  constant Integer n = 10;
  coordinate Real x;
  body b(mass = 1, position = x);
  contact wall[n](gap = {x + 5 + k - (if k == 4 then 3*time else sin(100*time)) for k in 1:n}, each restitution = 0);
end Walls;
)");
  withEachIntegrator(file, 1e-9, 4, [](CompiledModel &model) {
    ASSERT_EQ(model.count(TF_EVENT_IMPACT), 1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), 3, 1e-9);
    EXPECT_NEAR(model["x"], 3, 1e-8);
  });
}

// A floor that shakes, and a ceiling of which nothing is near.
TEST(FarContacts, FloorThatShakesUnderACeiling) {
  const auto gap = [](double t) { return 1 - 0.5 * 9.81 * t * t - 0.01 * std::sin(1000 * t); };
  double low = 0.4;
  while (gap(low + 1e-6) > 0)
    low += 1e-6;
  const std::string file = sourceFile("shaking_floor_and_ceiling.tf", R"(
model Shaking
  constant Integer n = 12;
  coordinate Real y(start = 1);
  body b(mass = 1, position = y);
  force weight(value = -9.81, at = y);
  contact c(gap = y - 0.01*sin(1000*time), restitution = 1);
  contact ceiling[n](gap = {10 + k - y + 0.1*sin(k*time) for k in 1:n});
end Shaking;
)");
  withEachIntegrator(file, 1e-9, 0.46, [&](CompiledModel &model) {
    ASSERT_FALSE(model.events().empty());
    EXPECT_NEAR(model.events()[0].time, low, 2e-6);
    EXPECT_EQ(model.events()[0].element, 0);
  });
}

// Results do not depend on contacts that are never near, and those of all gaps are true.
TEST(FarContacts, ChangeNothing) {
  const auto text = [](int n) {
    return sourceFile("far_" + std::to_string(n) + ".tf", R"(
model Far
  constant Integer n = )" + std::to_string(n) + R"(;
  coordinate Real q[2](start = {0, 1}, der(start = {1, 0}));
  coordinate Real phi(start = 0, der(start = 2));
  body ball(mass = 1, position = q, angle = phi, inertia = 0.1);
  gravity g(acceleration = {0, -9.81});
  contact floor(gap = q[2], slip = der(q[1]), friction = 0.3, restitution = 0.5);
  contact far[n](gap = {sqrt((q[1] - 100 - k)^2 + (q[2] - 50)^2) + 0.1*sin(phi + k) - 1 for k in 1:n}, slip = {der(q[1]) + 0.1*der(phi)*k for k in 1:n}, each friction = 0.2);
end Far;
)");
  };
  CompiledModel few(text(1)), many(text(60));
  few.tolerance(1e-8).run(3);
  many.tolerance(1e-8).run(3);
  ASSERT_EQ(few.events().size(), many.events().size());
  for (std::size_t k = 0; k < few.events().size(); ++k)
    EXPECT_NEAR(few.events()[k].time, many.events()[k].time, 1e-12);
  for (const char *name : {"q[1]", "q[2]", "phi", "far[1].gap", "far[1].slip"})
    EXPECT_NEAR(few[name], many[name], 1e-12) << name;
  const double dx = many["q[1]"] - 150, dy = many["q[2]"] - 50;
  EXPECT_NEAR(many["far[50].gap"], std::hypot(dx, dy) + 0.1 * std::sin(many["phi"] + 50) - 1, 1e-11);
}

// A ball whose bounces are nearly over meets one of many thin posts, and would be behind it when they are over.
TEST(FarContacts, APostBeforeTheBouncesAreOver) {
  const std::string file = sourceFile("post_before_rest.tf", R"(
model Bounces
  constant Integer n = 40;
  coordinate Real q[2](start = {0, 1}, der(start = {1, 0}));
  body ball(mass = 1, position = q);
  gravity g(acceleration = {0, -9.81});
  contact floor(gap = q[2], restitution = 0.5);
  contact post[n](gap = {sqrt((q[1] - (if k == 23 then 1.35 else 10 + k))^2 + 1e-8) - sqrt(2e-8) for k in 1:n}, each restitution = 1);
end Bounces;
)");
  const double rest = 3 * std::sqrt(2 / 9.81);
  withEachIntegrator(file, 1e-9, 2, [&](CompiledModel &model) {
    int hits = 0;
    for (const auto &event : model.events())
      if (event.kind == TF_EVENT_IMPACT && event.element != 0) {
        ++hits;
        EXPECT_EQ(event.element, 23);
        EXPECT_NEAR(event.time, 1.3499, 1e-9);
      }
    EXPECT_EQ(hits, 1);
    EXPECT_NEAR(model.eventTime(TF_EVENT_REST), rest, 1e-8);
    EXPECT_NEAR(model["q[1]"], 2 * 1.3499 - 2, 1e-8);
  });
}

// A run that goes on from a saved state is the same to the last bit.
TEST(FarContacts, SavedAndRestored) {
  CompiledModel model(sourceFile("far_saved.tf", R"(
model Posts
  constant Integer n = 30;
  coordinate Real r[2](start = {0, 0}, der(start = {1, 0.1}));
  body ball(mass = 1, position = r);
  contact post[n](gap = {sqrt((r[1] - k)^2 + (r[2] - 0.5*mod(k, 2))^2) - 0.2 for k in 1:n}, each restitution = 0.9);
end Posts;
)"));
  model.tolerance(1e-8).run(1);
  std::vector<unsigned char> saved(tf_state_size(model.simulation()));
  ASSERT_EQ(tf_save_state(model.simulation(), saved.data(), saved.size()), TF_OK);
  model.advance(20);
  const double x = model["r[1]"], y = model["r[2]"];
  ASSERT_EQ(tf_restore_state(model.simulation(), saved.data(), saved.size()), TF_OK);
  model.advance(20);
  EXPECT_EQ(model["r[1]"], x);
  EXPECT_EQ(model["r[2]"], y);
}

}  // namespace
}  // namespace tf::test
