// The quantities of theory.md section 2 in results: speed of time, numerical time of jumps, multipliers; independence of the rates.
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace tf::test {
namespace {

constexpr double kExact = 1e-10;

double timeSpeed(const CompiledModel &model) { return model.valuesOf(TF_KIND_TIME_SPEED).at(0); }

// An example with `rate` of its contacts multiplied by a parameter `scale`.
std::string withScaledRates(const std::string &name) {
  std::ifstream file(example(name));
  std::ostringstream text;
  text << file.rdbuf();
  std::string source = text.str();
  const auto replace = [&](const std::string &from, const std::string &to) {
    const std::size_t at = source.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    source.replace(at, from.size(), to);
  };
  replace("each friction = mu)", "each friction = mu, each rate = scale)");
  replace("  parameter Real g(", "  parameter Real scale = 1;\n  parameter Real g(");
  return sourceFile("scaled_" + name, source);
}

TEST(TimeFreezing, SpeedOfTimeOfAFrictionlessContact) {
  // beta = D a / (D a - phi) with D = 1/m, phi = u2/m - g.
  for (const double u2 : {0.0, 3.0, 9.0}) {
    CompiledModel model(example("particle.tf"), {{"m", 2}, {"u[2]", u2}, {"q[2]", 0}});
    model.tolerance(1e-9).run(0.5);
    const double m = 2, g = 9.81, a = m * g, D = 1 / m, phi = u2 / m - g;
    EXPECT_NEAR(timeSpeed(model), D * a / (D * a - phi), kExact);
    EXPECT_NEAR(model["floor.normalForce"], -phi / D, kExact * 20);
    EXPECT_NEAR(model["tau"], 0.5 / timeSpeed(model), kExact);
  }
}

TEST(TimeFreezing, SpeedOfTimeOfSeveralContacts) {
  // A beam on two supports: the forces follow from statics, beta is the root of beta = prod (1 - lambda_i beta / a_i).
  const std::string file = sourceFile("beam.tf", R"(model Beam
  parameter Real a[2] = {3, 7};
  coordinate Real y(start = 0), phi(start = 0);
  body beam(mass = 2, position = {0, y}, angle = phi, inertia = 0.3);
  gravity weight(acceleration = {0, -10});
  contact support[2](gap = {y - 0.3*sin(phi), y + 0.5*sin(phi)}, rate = a);
  annotation(experiment(StopTime = 1));
end Beam;
)");
  CompiledModel model(file);
  model.tolerance(1e-9).run(1);
  const double first = 20 * 0.5 / 0.8, second = 20 * 0.3 / 0.8;
  EXPECT_NEAR(model["support[1].normalForce"], first, kExact * 10);
  EXPECT_NEAR(model["support[2].normalForce"], second, kExact * 10);
  // The smaller root of (first second / 21) b^2 - (first/3 + second/7 + 1) b + 1 = 0.
  const double p = first * second / 21, q = first / 3 + second / 7 + 1, beta = 2 / (q + std::sqrt(q * q - 4 * p));
  EXPECT_LT(beta, std::min({1.0, 3 / first, 7 / second}));
  EXPECT_NEAR(timeSpeed(model), beta, kExact);
  EXPECT_NEAR(model["tau"], 1 / beta, kExact * 10);
}

TEST(TimeFreezing, MultipliersInSlipAndStick) {
  // The contact's two frozen modes have the multipliers push alpha_3 and push (1 - alpha_3), push = (1 - alpha_1) (1 - alpha_2), with
  // alpha_1 = 0, alpha_2 = 1 - push, push = lambda beta / a; the free motion has the rest, which is the speed of time. In stick alpha_3
  // makes the friction force: lambda_t = -mu lambda (2 alpha_3 - 1).
  CompiledModel model(example("particle.tf"), {{"mu", 0.3}, {"g", 10}, {"u[1]", 2}, {"der(q[1])", 1}});
  model.tolerance(1e-10).initialise();
  const double beta = 0.5, push = 0.5;
  for (const bool sticks : {false, true}) {
    model.advance(sticks ? 1.5 : 0.7);  // sticks from 1 s on
    const double alpha3 = sticks ? (1 + 2 / (0.3 * 10)) / 2 : 1;
    EXPECT_EQ(model["floor.sticking"], sticks ? 1 : 0);
    EXPECT_NEAR(timeSpeed(model), beta, kExact);
    EXPECT_NEAR(model["floor.frictionForce"], sticks ? -2 : -3, kExact);
    EXPECT_NEAR(model["floor.alpha[1]"], 0, kExact);
    EXPECT_NEAR(model["floor.alpha[2]"], 1 - push, kExact);
    EXPECT_NEAR(model["floor.alpha[3]"], alpha3, kExact);
    EXPECT_NEAR(model["floor.theta[1]"], push * alpha3, kExact);
    EXPECT_NEAR(model["floor.theta[2]"], push * (1 - alpha3), kExact);
  }
}

TEST(TimeFreezing, SlidingContactWithCoupledDirections) {
  // The rod slides on its left end: lambda = -phi / D_s, D_s = D_nn - mu s D_nt, beta = a / (a + lambda).
  CompiledModel model(example("falling_rod.tf"));
  model.tolerance(1e-10).run(0.4);
  const double phiAngle = model["phi"], w = model["der(phi)"], rx = -0.5 * std::cos(phiAngle), ry = -0.5 * std::sin(phiAngle);
  const double mu = 0.3, J = 1.0 / 12, Dnn = 1 + rx * rx / J, Dnt = -rx * ry / J, s = model["floor[1].slip"] > 0 ? 1 : -1;
  const double phi = -9.81 - w * w * ry, lambda = -phi / (Dnn - mu * s * Dnt);
  EXPECT_NEAR(model["floor[1].normalForce"], lambda, kExact * 10);
  EXPECT_NEAR(model["floor[1].frictionForce"], -mu * s * lambda, kExact * 10);
  EXPECT_NEAR(timeSpeed(model), 1 / (1 + lambda), kExact);
}

TEST(TimeFreezing, NumericalTimeOfAFrictionlessImpact) {
  // tau_jump = -c2 / (a D).
  CompiledModel model(example("particle.tf"), {{"m", 2}, {"g", 10}});
  model.tolerance(1e-9).initialise();
  const double hit = std::sqrt(0.2), a = 20;
  model.advance(hit + 0.1);
  const double rest = 0.1 * 2;  // beta = 1/2 after the impact
  EXPECT_NEAR(model["tau"], hit + rest + 10 * hit / (a * 0.5), kExact);
}

TEST(TimeFreezing, NumericalTimeOfAnImpactWithSlip) {
  // tau_jump = -c2 / (a D_s) while slip lasts; the rod opens after the impact, so that tau - t is the frozen time.
  CompiledModel model(example("falling_rod.tf"), {{"der(r[1])", 6}});
  model.tolerance(1e-10).initialise();
  const double fall = 0.5, hit = std::sqrt(2 * fall / 9.81), c = 0.5 * std::cos(std::acos(-1.0) / 4), J = 1.0 / 12;
  const double Dnn = 1 + c * c / J, Dnt = -c * c / J, Ds = Dnn - 0.3 * Dnt;
  model.advance(hit + 1e-3);
  EXPECT_NEAR(model["tau"] - model["time"], 9.81 * hit / Ds, kExact * 10);
  EXPECT_NEAR(model["der(phi)"], -(c + 0.3 * c) / J * 9.81 * hit / Ds, kExact * 100);
}

TEST(TimeFreezing, SlipReversalInsideAnImpact) {
  // Two pieces: slip until it vanishes, then the other direction or stick; tau - t is the impulse divided by a = 1.
  CompiledModel model(example("falling_rod.tf"));
  model.tolerance(1e-10).run(0.33);
  const double impulse = model["der(r[2])"] + 9.81 * 0.33;  // of the floor: m = 1
  EXPECT_NEAR(model["tau"] - model["time"], impulse, kExact * 100);
  EXPECT_NEAR(model["floor[1].impulse"], impulse, kExact * 100);
}

TEST(TimeFreezing, ResultsDoNotDependOnACommonFactorOfTheRates) {
  for (const char *name : {"falling_rod.tf", "falling_box.tf", "chain.tf"}) {
    const std::string file = withScaledRates(name);
    std::vector<std::vector<double>> states;
    for (const double scale : {1.0, 10.0, 1000.0}) {
      CompiledModel model(file, {{"scale", scale}});
      model.tolerance(1e-9).initialise();
      std::vector<double> samples;
      for (int i = 1; i <= 20; ++i) {
        model.advance(model.model().stop_time * i / 20);
        for (const tf_kind kind : {TF_KIND_COORDINATE, TF_KIND_VELOCITY}) {
          const auto values = model.valuesOf(kind);
          samples.insert(samples.end(), values.begin(), values.end());
        }
      }
      states.push_back(samples);
    }
    for (std::size_t run = 1; run < states.size(); ++run) {
      for (std::size_t i = 0; i < states[0].size(); ++i) {
        ASSERT_NEAR(states[run][i], states[0][i], 1e-7) << name << ", run " << run << ", value " << i;
      }
    }
  }
}

}  // namespace
}  // namespace tf::test
