// Piles: many bodies with restitution and friction fall between walls, with accumulations of impacts of many contacts at once and with
// redundant contacts, and come to rest. At rest the walls carry the weight.
#include "tests/accuracy/support/compiled_model.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace tf::test {
namespace {

constexpr double gravity = 9.81;

// The bodies of each pair.
struct Pairs {
  std::string first, second;
  int count = 0;

  explicit Pairs(int bodies) {
    for (int i = 1; i <= bodies; ++i)
      for (int k = i + 1; k <= bodies; ++k, ++count) {
        first += fmt::format("{}{}", count == 0 ? "" : ", ", i);
        second += fmt::format("{}{}", count == 0 ? "" : ", ", k);
      }
  }
};

// The slip of a pair in a frame across its line of centres n, turned from {x, y} the short way.
const std::string roughPairs = R"(  Real s[m] = {sqrt(d[k, :]*d[k, :]) for k in 1:m};
  Real n_[m, 3] = {d[k, :]/s[k] for k in 1:m};
  Real v[m, 3] = {der(c[a[k], :]) - der(c[b[k], :]) + cross(R*omega[a[k], :] + R*omega[b[k], :], n_[k, :]) for k in 1:m};
  contact pair[m](gap = s - fill(2*R, m), each friction = mu, each restitution = e,
    slip = {{v[k, 1] - n_[k, 1]*(n_[k, :]*v[k, :]) - n_[k, 1]*(v[k, 3] - n_[k, 3]*(n_[k, :]*v[k, :]))/(1 + n_[k, 3]),
      v[k, 2] - n_[k, 2]*(n_[k, :]*v[k, :]) - n_[k, 2]*(v[k, 3] - n_[k, 3]*(n_[k, :]*v[k, :]))/(1 + n_[k, 3])} for k in 1:m});
)";

const std::string smoothPairs = R"(  contact pair[m](gap = {sqrt(d[k, :]*d[k, :]) - 2*R for k in 1:m}, each restitution = e);
)";

std::string pileOfSpheres(int count, const std::string &pairContacts = smoothPairs) {
  const Pairs pairs(count);
  return fmt::format(R"(model Spheres "spheres of mass 1 fall on a floor between walls"
  constant Integer n = {}, m = {};
  constant Integer a[m] = {{{}}}, b[m] = {{{}}};
  parameter Real R = 0.1, w = 0.25, mu = 0.4, e = 0.3;
  coordinate Real c[n, 3](start = {{{{0.12*(-1)^k, 0.1*(-1)^div(k, 2), 0.12 + 0.22*k}} for k in 1:n}});
  coordinate Rotation Q[n];
  Real omega[n, 3] = {{Q[k]*Q[k].w for k in 1:n}};
  body ball[n](each mass = 1, position = c, orientation = Q, each inertia = 0.4*R^2*identity(3));
  gravity g(acceleration = {{0, 0, -9.81}});
  contact floor[n](gap = c[:, 3] - fill(R, n), each friction = mu, each restitution = e,
    slip = {{{{der(c[k, 1]) - R*omega[k, 2], der(c[k, 2]) + R*omega[k, 1]}} for k in 1:n}});
  contact right[n](gap = fill(w - R, n) - c[:, 1], each friction = mu, each restitution = e,
    slip = {{{{der(c[k, 2]) + R*omega[k, 3], der(c[k, 3]) - R*omega[k, 2]}} for k in 1:n}});
  contact left[n](gap = fill(w - R, n) + c[:, 1], each friction = mu, each restitution = e,
    slip = {{{{der(c[k, 2]) - R*omega[k, 3], der(c[k, 3]) + R*omega[k, 2]}} for k in 1:n}});
  contact back[n](gap = fill(w - R, n) - c[:, 2], each friction = mu, each restitution = e,
    slip = {{{{der(c[k, 1]) - R*omega[k, 3], der(c[k, 3]) + R*omega[k, 1]}} for k in 1:n}});
  contact front[n](gap = fill(w - R, n) + c[:, 2], each friction = mu, each restitution = e,
    slip = {{{{der(c[k, 1]) + R*omega[k, 3], der(c[k, 3]) - R*omega[k, 1]}} for k in 1:n}});
  Real d[m, 3] = {{c[b[k], :] - c[a[k], :] for k in 1:m}};
{}  output Real height = sum(c[:, 3]);
  output Real lift = sum(floor.normalForce)
    + sum(right.frictionForce[:, 2] + left.frictionForce[:, 2] + back.frictionForce[:, 2] + front.frictionForce[:, 2]);
end Spheres;
)",
                     count, pairs.count, pairs.first, pairs.second, pairContacts);
}

std::string pileOfDiscs(int count) {
  const Pairs pairs(count);
  return fmt::format(R"(model Pile "discs of mass 1 fall into a box"
  constant Integer n = {}, m = {};
  constant Integer a[m] = {{{}}}, b[m] = {{{}}};
  parameter Real R = 0.1, w = 0.5, mu = 0.4, e = 0.3;
  coordinate Real c[n, 2](start = {{{{-0.3 + 0.22*mod(k - 1, 3) + 0.01*div(k - 1, 3), 0.15 + 0.25*div(k - 1, 3)}} for k in 1:n}});
  coordinate Real psi[n];
  body disc[n](each mass = 1, position = c, angle = psi, each inertia = 0.5*R^2);
  gravity g(acceleration = {{0, -9.81}});
  contact floor[n](gap = c[:, 2] - fill(R, n), slip = der(c[:, 1]) + R*der(psi), each friction = mu, each restitution = e);
  contact left[n](gap = c[:, 1] + fill(w - R, n), slip = der(c[:, 2]) - R*der(psi), each friction = mu, each restitution = e);
  contact right[n](gap = fill(w - R, n) - c[:, 1], slip = der(c[:, 2]) + R*der(psi), each friction = mu, each restitution = e);
  Real d[m, 2] = {{c[b[k], :] - c[a[k], :] for k in 1:m}};
  Real s[m] = {{sqrt(d[k, :]*d[k, :]) for k in 1:m}};
  contact pair[m](gap = s - fill(2*R, m),
    slip = {{(d[k, 2]*(der(c[a[k], 1]) - der(c[b[k], 1])) - d[k, 1]*(der(c[a[k], 2]) - der(c[b[k], 2])))/s[k]
            - R*(der(psi[a[k]]) + der(psi[b[k]])) for k in 1:m}}, each friction = mu, each restitution = e);
  output Real height = sum(c[:, 2]);
  output Real lift = sum(floor.normalForce) + sum(left.frictionForce + right.frictionForce);
end Pile;
)",
                     count, pairs.count, pairs.first, pairs.second);
}

// The same discs, which fall one above the other, by turns at the middle and at the right.
std::string columnsOfDiscs(int count) {
  std::string text = pileOfDiscs(count);
  const std::string starts = "start = ", end = "for k in 1:n}";
  const std::size_t begin = text.find(starts) + starts.size();
  text.replace(begin, text.find(end) - begin, "{{-0.2 + 0.2*w*mod(k - 1, 2) + 0.01*div(k - 1, 2), 0.15 + 0.25*(k - 1)} ");
  return text;
}

double fastest(const CompiledModel &model) {
  double speed = 0;
  for (const double v : model.valuesOf(TF_KIND_VELOCITY))
    speed = std::max(speed, std::abs(v));
  return speed;
}

// The pile falls for so many fifths of a second, never gains energy, keeps the invariants and rests at the end, with all weight on the
// floor and the walls. Where an impact and the end of a contact come in one order or another by the tolerance, normal forces may be
// negative by as little.
void expectRest(CompiledModel &model, int bodies, int fifths, double tolerance, double energyError, double forceError = 1e-7) {
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.tolerance(tolerance).initialise();
  double energy = model.energy();
  for (int k = 1; k <= fifths; ++k) {
    model.advance(0.2 * k);
    EXPECT_LE(model.energy(), energy + 0.1 * tolerance) << model.time();
    energy = model.energy();
  }
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GE(statistics.worst_gap, -1e-9);
  EXPECT_GE(statistics.worst_normal_force, -forceError * statistics.largest_normal_force);
  EXPECT_LT(statistics.worst_energy_error, energyError);
  EXPECT_LT(fastest(model), 1e-9);
  EXPECT_NEAR(energy, gravity * model["height"], 1e-9);
  EXPECT_NEAR(model["lift"], bodies * gravity, 1e-7);
}

TEST(Piles, TenSpheresComeToRest) {
  CompiledModel model(sourceFile("ten_spheres.tf", pileOfSpheres(10)));
  expectRest(model, 10, 14, 1e-5, 1e-7);
}

// A sphere that slides down between a wall and another one at nearly its height is a wedge: its contacts nearly depend on one another, and
// cannot stop together while it slides.
TEST(Piles, TenSpheresThatWedgeOneAnotherComeToRest) {
  CompiledModel model(sourceFile("wedged_spheres.tf", pileOfSpheres(10)));
  ASSERT_EQ(tf_set(model.simulation(), "mu", 0.1), TF_OK);
  expectRest(model, 10, 15, 1e-4, 1e-7, 1e-5);
  EXPECT_LT(tf_get_statistics(model.simulation())->frozen_phases, 2000);
}

// In an impact of wedged spheres with friction breakpoints may crowd together again and again.
TEST(Piles, FifteenRoughSpheresCollapse) {
  CompiledModel model(sourceFile("rough_spheres.tf", pileOfSpheres(15, roughPairs)), {{"mu", 0.8}, {"e", 0.5}});
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.tolerance(1e-6).initialise();
  for (int k = 1; k <= 20; ++k)
    model.advance(0.1 * k);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GE(statistics.worst_gap, -1e-9);
  EXPECT_LT(statistics.worst_energy_error, 1e-8);
}

// One above the other, at most `width` from the middle of the box.
void dropSpheres(CompiledModel &model, int count, double width, unsigned seed) {
  std::mt19937 generator(seed);
  const auto place = [&generator, width] { return width * (2 * static_cast<double>(generator()) / std::mt19937::max() - 1); };
  for (int k = 1; k <= count; ++k) {
    ASSERT_EQ(tf_set(model.simulation(), fmt::format("c[{},1]", k).c_str(), place()), TF_OK);
    ASSERT_EQ(tf_set(model.simulation(), fmt::format("c[{},2]", k).c_str(), place()), TF_OK);
    ASSERT_EQ(tf_set(model.simulation(), fmt::format("c[{},3]", k).c_str(), 0.22 * k - 0.07), TF_OK);
  }
}

// Friction of slow slips of two components turns within instants that no step sees: forces that it makes negative end the mode there, and
// contacts that jam with redundant ones get their frictional impulses.
TEST(Piles, RoughSpheresNeverPullOneAnother) {
  constexpr int spheres = 5;
  constexpr double tolerance = 1e-6, width = 0.1485;
  CompiledModel model(sourceFile("five_rough_spheres.tf", pileOfSpheres(spheres, roughPairs)));
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  for (const unsigned seed : {5U, 12U, 24U, 28U}) {
    dropSpheres(model, spheres, width, seed);
    model.tolerance(tolerance).initialise();
    model.advance(1.2);
    const tf_statistics &statistics = *tf_get_statistics(model.simulation());
    EXPECT_GE(statistics.worst_gap, -1e-9) << seed;
    EXPECT_GE(statistics.worst_normal_force, -tolerance * statistics.largest_normal_force) << seed;
    EXPECT_LT(statistics.worst_energy_error, 1e-7) << seed;
  }
}

// A box that a sphere and a half fit into side by side: most of the spheres touch three others or walls. The contact problem of their
// impact has a solution that lies where many pieces of its equations meet.
TEST(Piles, RoughSpheresInANarrowBoxPushOneAnotherOn) {
  constexpr int spheres = 7;
  CompiledModel model(sourceFile("seven_rough_spheres.tf", pileOfSpheres(spheres, roughPairs)), {{"w", 0.15}});
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  dropSpheres(model, spheres, 0.0485, 2);
  ASSERT_NO_THROW(model.tolerance(1e-6).run(0.26));
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GE(statistics.worst_gap, -1e-9);
  EXPECT_GE(statistics.worst_normal_force, -1e-6 * statistics.largest_normal_force);
  EXPECT_LT(statistics.worst_energy_error, 1e-7);
  EXPECT_LT(statistics.worst_impact_residual, 1e-8);
}

// Slips that press each other in leave the contact problem without a solution; no single contact starts the impulse that ends them.
TEST(Piles, TenDiscsComeToRest) {
  CompiledModel model(sourceFile("ten_discs.tf", pileOfDiscs(10)));
  expectRest(model, 10, 10, 1e-6, 1e-7);
}

// A disc that slides up between another one and a wall pushes that one by v²/(2R), so slowly that the slip which begins seems to be a
// stick: as such it has no forces.
TEST(Piles, ADiscThatSlidesBetweenAWallAndAnArchPassesOn) {
  CompiledModel model(sourceFile("wedge.tf", R"(
model Wedge
  parameter Real R = 0.05, m = 0.1, mu = 0.3, e = 0.4;
  coordinate Real p[4, 2](start = {{-0.11, 0.05}, {0.11, 0.050001}, {0.01, 0.05}, {-0.05, 0.13}}, der(start = {{0, 0}, {0, 1e-3}, {0, 0}, {0, 0}}));
  coordinate Real phi[4];
  constant Integer one[3] = {3, 1, 4}, two[3] = {2, 4, 3};
  Real d[3, 2] = {p[two[k], :] - p[one[k], :] for k in 1:3};
  Real l[3] = {sqrt(d[k, :]*d[k, :]) for k in 1:3};
  body disc[4](each mass = m, position = p, angle = phi, each inertia = m*R^2/2);
  gravity weight(acceleration = {0, -9.81});
  contact floor[4](gap = {p[i, 2] - R for i in 1:4}, slip = {der(p[i, 1]) + R*der(phi[i]) for i in 1:4}, each friction = mu, each restitution = e);
  contact left(gap = p[1, 1] + 0.16 - R, slip = der(p[1, 2]) - R*der(phi[1]), friction = mu, restitution = e);
  contact right(gap = 0.16 - R - p[2, 1], slip = der(p[2, 2]) + R*der(phi[2]), friction = mu, restitution = e);
  contact pair[3](gap = l - 2*R*ones(3), each friction = mu, each restitution = e,
    slip = {(d[k, 1]*der(d[k, 2]) - d[k, 2]*der(d[k, 1]))/l[k] - R*(der(phi[one[k]]) + der(phi[two[k]])) for k in 1:3});
end Wedge;
)"));
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.tolerance(1e-6).run(0.1);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GE(statistics.worst_gap, -1e-9);
  EXPECT_LT(statistics.worst_energy_error, 1e-7);
  EXPECT_LT(fastest(model), 1e-9);
}

// Cascades of impacts within cascades end where the tolerance sees them no longer: the number of impacts stays moderate.
TEST(Piles, FifteenDiscsComeToRestAfterAModerateNumberOfImpacts) {
  CompiledModel model(sourceFile("fifteen_discs.tf", pileOfDiscs(15)));
  expectRest(model, 15, 15, 1e-4, 1e-6);
  EXPECT_LT(tf_get_statistics(model.simulation())->frozen_phases, 5000);
}

// Boxes as wide as three or four discs: a disc that falls into a place that it just fits touches both neighbours all the way down, but for
// rounding, and rows from wall to wall have velocities of approach that no impulse can end.
TEST(Piles, DiscsThatJustFitTheirBoxNeitherJamNorPenetrate) {
  constexpr int discs = 4;
  for (const double halfWidth : {0.3, 0.4})
    for (const double restitution : {0.0, 0.3}) {
      CompiledModel model(sourceFile("fitting_discs.tf", columnsOfDiscs(discs)), {{"w", halfWidth}, {"mu", 0}, {"e", restitution}});
      ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
      ASSERT_NO_THROW(model.tolerance(1e-6).run(2)) << halfWidth << ", restitution " << restitution;
      const tf_statistics &statistics = *tf_get_statistics(model.simulation());
      EXPECT_GE(statistics.worst_gap, -1e-9);
      EXPECT_LT(statistics.worst_energy_error, 1e-7);
    }
}

// A groove that locks the disc by friction: it bounces from side to side, lower and lower, and rests on both of them, R/cos a above the
// edge.
TEST(Piles, ADiscInAGrooveComesToRest) {
  const std::string file = sourceFile("groove.tf", R"(
model Groove
  parameter Real R = 0.05, m = 0.1, mu = 1.5, e = 0.3, a = 1.0, x0 = 0, fall = 0, spin = 0;
  coordinate Real x(start = x0), y(start = 0.2, der(start = -fall)), phi(der(start = spin));
  body d(mass = m, position = {x, y}, angle = phi, inertia = m*R^2/2);
  gravity gr(acceleration = {0, -9.81});
  contact left(gap = x*sin(a) + y*cos(a) - R, slip = der(x)*cos(a) - der(y)*sin(a) + R*der(phi), friction = mu, restitution = e);
  contact right(gap = -x*sin(a) + y*cos(a) - R, slip = der(x)*cos(a) + der(y)*sin(a) + R*der(phi), friction = mu, restitution = e);
end Groove;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-6, 1e-8, 1e-10})
      for (const double x : {-0.005, -0.001, 0.002, 0.01})
        for (const double speed : {0.0, 1.0}) {
          CompiledModel model(file, {{"x0", x}, {"fall", speed}, {"spin", -5 * speed}});
          ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(1.5)) << integrator << ", " << tolerance << ", " << x;
          EXPECT_NEAR(model["y"], 0.05 / std::cos(1.0), 1e-9);
          EXPECT_LT(fastest(model), 1e-9);
          EXPECT_LT(model.events().size(), 1000U);
        }
}

// Boxes one upon the other, each with another speed: they slide, tilt and bounce on one another, and rest. In flight, in between, boxes
// that touch have no load but what rounding makes of their weight, and redundant contacts to share it.
std::string stackOfBoxes(int count) {
  return fmt::format(R"(model Stack "boxes of mass 1, a decimetre wide"
  constant Integer n = {};
  parameter Real e = 0.3, mu = 0.5, v = 1;
  constant Real s[4, 2] = 0.05*{{{{-1, -1}}, {{1, -1}}, {{1, 1}}, {{-1, 1}}}};
  coordinate Real r[n, 2](start = {{{{0.03*i, 0.11*(i - 1) + 0.06}} for i in 1:n}}, der(start = {{{{v*(1 - 0.2*i), 0}} for i in 1:n}}));
  coordinate Real phi[n];
  body box[n](each mass = 1, position = r, angle = phi, each inertia = 0.01/6);
  gravity g(acceleration = {{0, -9.81}});
  Real c[n, 4, 2] = {{{{r[i] + {{s[k, 1]*cos(phi[i]) - s[k, 2]*sin(phi[i]), s[k, 1]*sin(phi[i]) + s[k, 2]*cos(phi[i])}} for k in 1:4}}
    for i in 1:n}};
  Real d[n - 1, 2, 2] = {{{{c[i + 1, k] - r[i] for k in 1:2}} for i in 1:n - 1}};
  contact floor[2](gap = c[1, 1:2, 2], slip = der(c[1, 1:2, 1]), each friction = mu, each restitution = e);
  contact face[n - 1, 2](gap = {{{{d[i, k, 2]*cos(phi[i]) - d[i, k, 1]*sin(phi[i]) - 0.05 for k in 1:2}} for i in 1:n - 1}},
    slip = {{{{der(d[i, k, 1])*cos(phi[i]) + der(d[i, k, 2])*sin(phi[i])
      + (d[i, k, 1]*sin(phi[i]) - d[i, k, 2]*cos(phi[i]))*der(phi[i]) for k in 1:2}} for i in 1:n - 1}}, each friction = mu,
      each restitution = e);
end Stack;
)",
                     count);
}

TEST(Piles, StacksOfBoxesThatSlideApartRestAtTheSamePlaceWithEveryTolerance) {
  struct Stack {
    int boxes;
    double friction, speed;
  };
  for (const auto &[boxes, friction, speed] : {Stack{5, 0.5, 1}, Stack{5, 0.8, 2}, Stack{4, 0.8, 0.5}}) {
    std::vector<double> first;
    for (const double tolerance : {1e-9, 1e-11}) {
      CompiledModel model(sourceFile(fmt::format("stack_of_{}.tf", boxes), stackOfBoxes(boxes)), {{"mu", friction}, {"v", speed}});
      ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
      ASSERT_NO_THROW(model.tolerance(tolerance).run(2)) << boxes << ", friction " << friction << ", tolerance " << tolerance;
      const tf_statistics &statistics = *tf_get_statistics(model.simulation());
      EXPECT_GE(statistics.worst_gap, -1e-9);
      EXPECT_GE(statistics.worst_normal_force, -1e-9 * statistics.largest_normal_force);
      EXPECT_LT(statistics.worst_energy_error, 1e-8);
      EXPECT_LT(fastest(model), 1e-9);
      const std::vector<double> last = model.valuesOf(TF_KIND_COORDINATE);
      if (first.empty())
        first = last;
      for (std::size_t k = 0; k < last.size(); ++k)
        EXPECT_NEAR(last[k], first[k], 1e-8) << k << ", tolerance " << tolerance;
    }
  }
}

}  // namespace
}  // namespace tf::test
