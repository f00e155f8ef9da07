// Many bodies and contacts: chains of different lengths, bodies apart in one model.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

namespace tf::test {
namespace {

std::string chainOf(int links) {
  std::ifstream file(example("chain.tf"));
  std::stringstream text;
  text << file.rdbuf();
  std::string source = text.str();
  const std::string number = "n(min = 1) = 3";
  const auto place = source.find(number);
  EXPECT_NE(place, std::string::npos);
  source.replace(place, number.size(), "n(min = 1) = " + std::to_string(links));
  return sourceFile("chain" + std::to_string(links) + ".tf", source);
}

class Chain : public testing::TestWithParam<int> {};

// Falls, and lies on the floor with all of its weight: no penetration, no energy out of nothing on the way.
TEST_P(Chain, ComesToRestOnTheFloor) {
  CompiledModel model(chainOf(GetParam()));
  model.tolerance(1e-6).initialise();
  double energy = model.energy();
  for (int i = 1; i <= 300; ++i) {
    model.advance(0.01 * i);
    for (const double gap : model.valuesOf(TF_KIND_GAP))
      ASSERT_GE(gap, -1e-9) << "t = " << model.time();
    ASSERT_LE(model.energy(), energy + 1e-5) << "t = " << model.time();
    energy = std::min(energy, model.energy());
  }
  double carried = 0;
  for (const double force : model.valuesOf(TF_KIND_NORMAL_FORCE))
    carried += force;
  EXPECT_NEAR(carried, 9.81, 1e-4);
  for (const double speed : model.valuesOf(TF_KIND_VELOCITY))
    EXPECT_NEAR(speed, 0, 1e-6);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_LT(statistics.worst_residual, 1e-8);
  EXPECT_LT(statistics.worst_impact_residual, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Links, Chain, testing::Values(2, 3, 5, 10, 20), testing::PrintToStringParamName());

// Of ten light rods the rate's rounding errors are many times those of the terms that it is the sum of, and their differences by a damping
// that has no effect yet are nothing else: they are no jumps.
TEST(ChainOfTen, HasSensitivitiesThatRoundingErrorsDoNotDivide) {
  const std::string file = chainOf(10);
  const auto derivative = [&file](double tolerance, long long &evaluations) {
    CompiledModel model(file);
    differentiateBy(model, {"d"});
    model.tolerance(tolerance).initialise();
    for (int k = 1; k <= 500; ++k)
      model.advance(0.0003 * k);
    evaluations = tf_get_statistics(model.simulation())->evaluations;
    return sensitivity(model, "phi[5]", 0);
  };
  long long evaluations = 0;
  const double exact = derivative(1e-11, evaluations);
  for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    EXPECT_NEAR(derivative(tolerance, evaluations), exact, 10 * std::max(tolerance, 1e-7)) << tolerance;
    EXPECT_LT(evaluations, 100000) << tolerance;
  }
}

class ShortChain : public testing::TestWithParam<int> {};

// Two integrators at two tolerances: the last hundredth of the energy is lost in many small impacts, so only the way down is compared.
TEST_P(ShortChain, IsTheSameWithOtherIntegrators) {
  CompiledModel model(chainOf(GetParam()));
  model.tolerance(1e-10).integrator(TF_EXPLICIT).run(0.3);
  const std::vector<double> expected = model.valuesOf(TF_KIND_COORDINATE);
  for (const tf_integrator integrator : {TF_EXPLICIT, TF_STEP}) {
    model.tolerance(1e-7).integrator(integrator).run(0.3);
    const std::vector<double> found = model.valuesOf(TF_KIND_COORDINATE);
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], expected[k], 1e-5) << "integrator " << integrator << ", coordinate " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Links, ShortChain, testing::Values(2, 3, 5, 10), testing::PrintToStringParamName());

// A straight piece of chain lies on the floor, its ends stick, and a node between them rises: its two rods pull at both ends along one
// line, so that who holds them is open there, and one end must slip from the next instant on. Whoever misses that takes energy out.
TEST(LongChain, KeepsItsBalanceWhereAStraightPieceIsBent) {
  CompiledModel model(chainOf(20), {{"r[2]", 1}});
  model.tolerance(1e-9);
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.run(0.62);
  EXPECT_LT(tf_get_statistics(model.simulation())->worst_energy_error, 1e-9);
}

// At 0.712 s friction of nodes that nearly lie flat is at its limit, which it exceeds by less than what passes for zero in accelerations.
TEST(ChainOfEighty, GoesOnWhereFrictionIsAtItsLimit) {
  CompiledModel model(chainOf(80));
  model.tolerance(2e-8).run(0.75);
  for (const double gap : model.valuesOf(TF_KIND_GAP))
    EXPECT_GE(gap, -1e-9);
  EXPECT_LT(tf_get_statistics(model.simulation())->worst_residual, 1e-8);
}

// Impacts run through the chain as ever fainter ones. Those far below the tolerance are not followed as hops that no number resolves, and
// what they leave out is not seen in the result.
TEST(LongChain, FaintImpactsEndAtOnce) {
  CompiledModel model(chainOf(50));
  model.tolerance(1e-7).initialise();
  model.advance(0.5);
  const std::vector<double> expected = model.valuesOf(TF_KIND_COORDINATE);
  const long long hops = tf_get_statistics(model.simulation())->frozen_phases;
  model.tolerance(1e-4).initialise();
  model.advance(0.5);
  EXPECT_LT(2 * tf_get_statistics(model.simulation())->frozen_phases, hops);
  const std::vector<double> found = model.valuesOf(TF_KIND_COORDINATE);
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_NEAR(found[k], expected[k], 1e-4) << "coordinate " << k;
}

// Events that are expected need no second step to end at them: thirteen evaluations for each choice of a mode, fifteen otherwise.
TEST(LongChain, StepsEndWhereEventsAreExpected) {
  CompiledModel model(chainOf(20));
  model.tolerance(1e-4).run(1);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GT(statistics.contact_solves, 200);
  EXPECT_LT(static_cast<double>(statistics.evaluations), 14.0 * static_cast<double>(statistics.contact_solves));
}

// Rods that are described by one end, so that each has a full block of the mass matrix; they fall on the floor far from one another.
std::string rods(int first, int count) {
  return "model Rods\n  parameter Integer first = " + std::to_string(first) + ";\n  parameter Integer n = " + std::to_string(count) + R"(;
  coordinate Real r[n, 2](start = {{0, 0.6 + 0.01*(first + i)} for i in 1:n});
  coordinate Real phi[n](start = {0.3 + 0.02*(first + i) for i in 1:n}, der(start = {0.1*(first + i) for i in 1:n}));
  Real tip[n, 2] = {{r[i, 1] + cos(phi[i]), r[i, 2] + sin(phi[i])} for i in 1:n};
  body rod[n](each mass = 1, position = (r + tip)/2, angle = phi, each inertia = 1/12);
  gravity weight(acceleration = {0, -9.81});
  contact low[n](gap = r[:, 2], slip = der(r[:, 1]), each friction = 0.4);
  contact high[n](gap = tip[:, 2], slip = der(tip[:, 1]), each friction = 0.4);
end Rods;
)";
}

TEST(BodiesApart, MoveAsAlone) {
  constexpr int count = 20;
  CompiledModel together(sourceFile("rods.tf", rods(0, count)));
  const tf_model &model = together.model();
  ASSERT_EQ(model.nv, 3 * count);
  ASSERT_NE(model.mass_rows, nullptr);
  EXPECT_EQ(model.mass_rows[model.nv], 2 * count);  // the places of an end do not move each other, its angle moves both
  together.tolerance(1e-10).run(0.8);
  for (const int number : {1, 7, count}) {
    const std::string index = std::to_string(number);
    CompiledModel alone(sourceFile("rod" + index + ".tf", rods(number - 1, 1)));
    alone.tolerance(1e-10).run(0.8);
    EXPECT_NEAR(together["r[" + index + ",1]"], alone["r[1,1]"], 1e-7) << number;
    EXPECT_NEAR(together["r[" + index + ",2]"], alone["r[1,2]"], 1e-7) << number;
    EXPECT_NEAR(together["phi[" + index + "]"], alone["phi[1]"], 1e-7) << number;
  }
}

// Smooth spheres between four walls, all of which may touch one another.
std::string spheresOf(int count) {
  std::string first, second;
  int pairs = 0;
  for (int i = 1; i <= count; ++i)
    for (int j = i + 1; j <= count; ++j, ++pairs) {
      first += (pairs > 0 ? "," : "") + std::to_string(i);
      second += (pairs > 0 ? "," : "") + std::to_string(j);
    }
  return sourceFile("spheres.tf", "model Spheres\n  constant Integer n = " + std::to_string(count) + ", m = " + std::to_string(pairs) +
                                      ";\n  constant Integer a[m] = {" + first + "}, b[m] = {" + second + R"(};
  parameter Real R = 0.1, w = 0.25, e = 0.3;
  coordinate Real c[n, 3](start = {{0.12*(-1)^k, 0.1*(-1)^div(k, 2), 0.12 + 0.22*k} for k in 1:n});
  Real d[m, 3] = {c[b[k], :] - c[a[k], :] for k in 1:m};
  body ball[n](each mass = 1, position = c);
  gravity g(acceleration = {0, 0, -9.81});
  contact floor[n](gap = c[:, 3] - fill(R, n), each restitution = e);
  contact right[n](gap = fill(w - R, n) - c[:, 1], each restitution = e);
  contact left[n](gap = fill(w - R, n) + c[:, 1], each restitution = e);
  contact back[n](gap = fill(w - R, n) - c[:, 2], each restitution = e);
  contact front[n](gap = fill(w - R, n) + c[:, 2], each restitution = e);
  contact pair[m](gap = {sqrt(d[k, :]*d[k, :]) - 2*R for k in 1:m}, each restitution = e);
end Spheres;
)");
}

// Bounces come to rest while others go on next to them: none of them penetrates. The first six do so before the motion is chaotic.
TEST(Spheres, FallIntoABox) {
  CompiledModel model(spheresOf(15));
  model.tolerance(1e-6);
  ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
  model.initialise();
  for (int i = 1; i <= 27; ++i)
    model.advance(0.05 * i);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_NEAR(model.eventTime(TF_EVENT_REST, 5), 0.6512650951, 1e-7);
  EXPECT_GE(statistics.worst_gap, -1e-9);
  EXPECT_GE(statistics.worst_normal_force, -1e-6 * statistics.largest_normal_force);
  EXPECT_LT(statistics.worst_energy_error, 1e-7);
}

// Each rests at its own time, sqrt(2h/g) (1 + e)/(1 − e), while the others bounce on.
TEST(Spheres, RestOneAfterTheOther) {
  constexpr int count = 30;
  constexpr double e = 0.3;
  CompiledModel model(sourceFile("resting_spheres.tf", R"(model RestingSpheres
  constant Integer n = 30;
  coordinate Real c[n, 3](start = {{k, 0, 0.1 + 0.03*k} for k in 1:n});
  body ball[n](each mass = 1, position = c);
  gravity weight(acceleration = {0, 0, -9.81});
  contact floor[n](gap = c[:, 3], each restitution = 0.3);
end RestingSpheres;
)"));
  model.tolerance(1e-8).run(1.5);
  ASSERT_EQ(model.count(TF_EVENT_REST), count);
  for (int k = 1; k <= count; ++k)
    EXPECT_NEAR(model.eventTime(TF_EVENT_REST, k - 1), std::sqrt(2 * (0.1 + 0.03 * k) / g) * (1 + e) / (1 - e), 1e-7);
}

// Bounces of 1e-9 m, on a hard and on a soft floor, with the magnitudes of length and velocity as `nominal`: errors are relative to these.
// The hard floor: fall for t1 = sqrt(2h/g), then y = e g t1 s − g s²/2. The soft one: oscillations, against a tight run.
TEST(SmallMagnitudes, AreThoseThatTheToleranceIsRelativeTo) {
  const std::string head = "  parameter Real h = 1e-9;\n  coordinate Real y(start = h, nominal = 1e-9, der(nominal = 1e-4));\n"
                           "  body b(mass = 1, position = y);\n  force w(value = -9.81, at = y);\n";
  const std::string hard =
      sourceFile("hard_nano.tf", "model HardNano\n" + head + "  contact floor(gap = y, restitution = 0.5);\nend HardNano;\n");
  const std::string soft =
      sourceFile("soft_nano.tf",
                 "model SoftNano\n" + head + "  force floor(value = if y < 0 then -1e12*y - 1e5*der(y) else 0, at = y);\nend SoftNano;\n");
  const double fall = std::sqrt(2e-9 / 9.81), later = 2e-5 - fall, bounced = 0.5 * 9.81 * fall * later - 0.5 * 9.81 * later * later;
  CompiledModel tight(soft);
  tight.tolerance(1e-12).run(2e-5);
  for (const double tolerance : {1e-4, 1e-6, 1e-8})
    for (const tf_integrator integrator : integrators) {
      CompiledModel one(hard), other(soft);
      one.tolerance(tolerance).integrator(integrator).run(2e-5);
      EXPECT_NEAR(one["y"], bounced, 1e-8 * tolerance) << integrator << ", " << tolerance;
      other.tolerance(tolerance).integrator(integrator).run(2e-5);
      EXPECT_NEAR(other["y"], tight["y"], 1e-8 * tolerance) << integrator << ", " << tolerance;
    }
}

// A box that falls onto its corners, with restitution and friction: lengths, times and masses scale with its size, and so do the nominals.
// Neither is a lever of a micrometre that turns fast a fast approach, nor an angle a gap of a metre.
std::string boxOf(double size, const std::string &nominals) {
  std::ostringstream number;
  number.precision(17);
  number << size;
  std::string text = R"(model Box
  parameter Real size = SIZE, speed = sqrt(size), m = size^3, h = 0.1*size, w = 0.2*size;
  parameter Real sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
  coordinate Real x(start = 0, der(start = 0.5*speed)LENGTH);
  coordinate Real y(start = size, der(start = 0)LENGTH);
  coordinate Real phi(start = 0.3, der(start = speed/size)TURN);
  body box(mass = m, position = {x, y}, angle = phi, inertia = m*(h^2 + w^2)/3);
  gravity weight(acceleration = {0, -9.81});
  Real cx[4] = {x + sx[i]*w*cos(phi) - sy[i]*h*sin(phi) for i in 1:4}, cy[4] = {y + sx[i]*w*sin(phi) + sy[i]*h*cos(phi) for i in 1:4};
  contact floor[4](gap = cy, slip = der(cx), each friction = 0.3, each restitution = 0.45);
end Box;
)";
  const auto replace = [&text](const std::string &from, const std::string &to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  };
  replace("SIZE", number.str());
  replace("LENGTH", nominals == "none" ? "" : nominals == "lengths" ? ", nominal = size" : ", nominal = size, der(nominal = speed)");
  replace("TURN", nominals == "all" ? ", der(nominal = speed/size)" : "");
  return sourceFile("box.tf", text);
}

TEST(Scale, OfABoxChangesNothing) {
  constexpr double duration = 2;
  CompiledModel reference(boxOf(1, "all"));
  reference.tolerance(1e-10).run(duration);
  for (const double size : {1e-6, 1e-3, 1e3, 1e6})
    for (const std::string nominals : {"all", "lengths"})
      for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
        CompiledModel model(boxOf(size, nominals));
        model.tolerance(tolerance).run(duration * std::sqrt(size));
        const std::string at = nominals + ", " + std::to_string(std::log10(size)) + ", " + std::to_string(tolerance);
        EXPECT_NEAR(model["x"] / size, reference["x"], 0.01 * tolerance) << at;
        EXPECT_NEAR(model["y"] / size, reference["y"], 0.01 * tolerance) << at;
        EXPECT_NEAR(model["phi"], reference["phi"], 0.1 * tolerance) << at;
      }
}

// Which must be known at the start and with it: gaps that the angle alone moves, by its lever.
TEST(Scale, OfAPendulumChangesNothing) {
  const auto pendulum = [](const std::string &length) {
    return sourceFile("pendulum.tf", "model Pendulum\n  parameter Real L = " + length + R"(;
  coordinate Real phi(start = 0.7, der(nominal = 1/sqrt(L)));
  body b(mass = 1, position = {L*sin(phi), -L*cos(phi)});
  gravity weight(acceleration = {0, -9.81});
  contact wall(gap = L*sin(phi) + 0.2*L, restitution = 0.6);
end Pendulum;
)");
  };
  CompiledModel reference(pendulum("1"));
  reference.tolerance(1e-10).run(2);
  for (const double tolerance : {1e-4, 1e-8}) {
    CompiledModel model(pendulum("1e-6"));
    model.tolerance(tolerance).run(2e-3);
    EXPECT_NEAR(model["phi"], reference["phi"], 10 * tolerance);
  }
}

// A body slides down a dome and leaves it where the contact force falls to zero, at a height of two thirds; however light it is, and
// although a heavy one rests elsewhere.
TEST(Scale, OfMassesChangesNothing) {
  for (const double exponent : {-18.0, -9.0, -6.0, 0.0, 9.0, 18.0})
    for (const bool isBesideHeavy : {false, true}) {
      if (isBesideHeavy && std::abs(exponent) > 6)
        continue;
      CompiledModel model(sourceFile("dome.tf", "model Dome\n  parameter Real m = 10^(" + std::to_string(exponent) + R"();
  coordinate Real p[2](start = {0.6, 0.8}, der(start = {0, 0}));
  body b(mass = m, position = p);
  gravity weight(acceleration = {0, -9.81});
  contact dome(gap = sqrt(p*p) - 1);
)" + (isBesideHeavy ? "  coordinate Real y(start = 0);\n  body block(mass = 1e3, position = {9, y});\n  contact floor(gap = y);\n" : "") +
                                                    "end Dome;\n"));
      model.tolerance(1e-8).run(1);
      const std::string at = std::to_string(exponent) + (isBesideHeavy ? ", beside a block" : "");
      ASSERT_EQ(model.count(TF_EVENT_OPENING), 1) << at;
      const double opening = model.eventTime(TF_EVENT_OPENING);
      model.initialise();
      model.advance(opening);
      EXPECT_NEAR(model["p[2]"], 1.6 / 3, 1e-7) << at;
    }
}

// The light box could be moved far by what lifts the heavy one by rounding: neither of them moves at all, while a pendulum swings beside
// them.
TEST(Scale, OfTheMassesOfBoxesOnEachOtherMovesNoneOfThem) {
  const std::string file = sourceFile("heavy_on_light.tf", R"(
model HeavyOnLight
  parameter Real w = 0.2, h = 0.1, light = 1e-3, heavy = 1;
  parameter Real mass[2] = {light, heavy};
  coordinate Real r[2, 2](start = {{0, h/2}, {0.01, 1.5*h}}), phi[2];
  coordinate Real angle(start = 1);
  body box[2](mass = mass, position = r, angle = phi, inertia = mass*(w^2 + h^2)/12);
  body bob(mass = 1, position = {5 + sin(angle), 1 - cos(angle)});
  gravity g(acceleration = {0, -9.81});
  Real foot[2, 2, 2] = {{r[i, :] + {s*w/2*cos(phi[i]) + h/2*sin(phi[i]), s*w/2*sin(phi[i]) - h/2*cos(phi[i])} for s in {-1, 1}} for i in 1:2};
  Real onTop[2, 2] = {{cos(phi[1])*(foot[2, j, 1] - r[1, 1]) + sin(phi[1])*(foot[2, j, 2] - r[1, 2]),
    -sin(phi[1])*(foot[2, j, 1] - r[1, 1]) + cos(phi[1])*(foot[2, j, 2] - r[1, 2])} for j in 1:2};
  contact floor[2](gap = foot[1, :, 2], slip = der(foot[1, :, 1]), each friction = 0.4);
  contact lid[2](gap = {onTop[j, 2] - h/2 for j in 1:2}, slip = der(onTop[:, 1]), each friction = 0.4);
  force push(value = {if time > 0.1 then 0.1*light else 0, 0}, at = r[2, :]);
end HeavyOnLight;
)");
  constexpr double rounding = 1e-15;
  for (const double ratio : {1e4, 1e6, 1e7})
    for (const double tolerance : {1e-4, 1e-7})
      for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_CVODE}) {
        SCOPED_TRACE(fmt::format("ratio {}, tolerance {}, integrator {}", ratio, tolerance, static_cast<int>(integrator)));
        CompiledModel model(file, {{"heavy", 1e-3 * ratio}});
        ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
        ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(0.3));
        EXPECT_EQ(model.events().size(), 1U);
        EXPECT_GE(tf_get_statistics(model.simulation())->worst_gap, -1e-12);
        for (const char *coordinate : {"r[1,1]", "r[2,1]", "phi[1]", "phi[2]"})
          EXPECT_NEAR(model[coordinate], std::string(coordinate) == "r[2,1]" ? 0.01 : 0, rounding * ratio) << coordinate;
      }
}

}  // namespace
}  // namespace tf::test
