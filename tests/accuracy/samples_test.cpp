// Samples lie inside steps (tf_run): they are as exact as the ends of steps, and take no part in the choice of steps.
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

namespace tf::test {
namespace {

constexpr int sampleCount = 97;  // of samples, and one more at the end
constexpr int partCount = 14;    // of them: so many are between the ends of few steps

// Calls `read` at `sampleCount` equal parts of the run.
void sample(CompiledModel &model, double end, const std::function<void()> &read) {
  struct Samples {
    const std::function<void()> &read;
    double end;
    int taken = 0;
    [[nodiscard]] double next() const { return end * (taken + 1) / (sampleCount + 1); }
  } samples{read, end};
  const auto take = [](void *data, double time) {
    auto &own = *static_cast<Samples *>(data);
    EXPECT_EQ(time, own.next());
    own.read();
    ++own.taken;
    return own.taken < sampleCount ? own.next() : std::numeric_limits<double>::infinity();
  };
  ASSERT_EQ(tf_run(model.simulation(), end, samples.next(), take, &samples), TF_OK) << tf_error_text(model.simulation());
  EXPECT_EQ(samples.taken, sampleCount);
  read();
}

// The same, where steps end at each of them.
void stepThrough(CompiledModel &model, double end, const std::function<void()> &read) {
  for (int k = 1; k <= sampleCount + 1; ++k) {
    model.advance(k <= sampleCount ? end * k / (sampleCount + 1) : end);
    read();
  }
}

void stepFar(CompiledModel &model, double end, const std::function<void()> &read) {
  for (int k = partCount; k <= sampleCount + 1; k += partCount) {
    model.advance(end * k / (sampleCount + 1));
    read();
  }
}

struct SampledCase {
  const char *file;
  double end;
  std::vector<const char *> variables;
};

const SampledCase sampledCases[] = {
    {"double_pendulum.tf", 1.2, {"phi[1]", "phi[2]", "der(phi[1])", "der(phi[2])"}},
    {"falling_box.tf", 1.2, {"r[1]", "r[2]", "phi", "der(phi)"}},
    {"four_bar.tf", 1.5, {"phi[1]", "phi[2]", "phi[3]", "der(phi[1])"}},
    {"tumbling_box.tf", 0.6, {"p[1]", "p[2]", "p[3]"}},
    {"chain.tf", 0.7, {"r[1]", "r[2]", "phi[1]", "phi[2]", "phi[3]"}},
    {"stickslip.tf", 4, {"x", "der(x)"}},
};

class Samples : public testing::TestWithParam<std::tuple<std::size_t, tf_integrator, double>> {
protected:
  using Rows = std::vector<std::vector<double>>;
  using Through = void (*)(CompiledModel &, double, const std::function<void()> &);

  // Values of the case's variables and the losses, at all samples and the end.
  static Rows rowsOf(const SampledCase &one, tf_integrator integrator, double tolerance, Through through) {
    CompiledModel model(example(one.file));
    tf_set_energy_balance(model.simulation(), 1);
    model.tolerance(tolerance).integrator(integrator).initialise();
    Rows rows;
    through(model, one.end, [&] {
      std::vector<double> &row = rows.emplace_back();
      for (const char *variable : one.variables)
        row.push_back(model[variable]);
      row.push_back(model["energy.work"]);
      row.push_back(model["energy.frictionLoss"]);
    });
    return rows;
  }

  // Of some of the rows `exact`, at equal distances.
  static double difference(const Rows &rows, const Rows &exact) {
    const std::size_t distance = exact.size() / rows.size();
    double largest = 0;
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t j = 0; j < rows[k].size(); ++j)
        largest = std::max(largest, std::abs(rows[k][j] - exact[(k + 1) * distance - 1][j]));
    return largest;
  }
};

TEST_P(Samples, AreAsExactAsTheEndsOfSteps) {
  const auto &[number, integrator, tolerance] = GetParam();
  const SampledCase &one = sampledCases[number];
  const Rows exact = rowsOf(one, TF_AUTO, 1e-11, stepThrough);
  ASSERT_EQ(exact.size(), sampleCount + 1U);
  const Rows sampled = rowsOf(one, integrator, tolerance, sample);
  ASSERT_EQ(sampled.size(), exact.size());
  const double ofSteps = difference(rowsOf(one, integrator, tolerance, stepFar), exact);
  EXPECT_LE(difference(sampled, exact), 10 * std::max(tolerance, ofSteps));
}

std::string nameOf(const testing::TestParamInfo<Samples::ParamType> &one) {
  constexpr const char *names[] = {"auto", "step", "cvode", "explicit"};
  const std::string file = sampledCases[std::get<0>(one.param)].file;
  const int digits = static_cast<int>(std::lround(-std::log10(std::get<2>(one.param))));
  return file.substr(0, file.find('.')) + "_" + names[std::get<1>(one.param)] + "_" + std::to_string(digits);
}

INSTANTIATE_TEST_SUITE_P(Cases, Samples,
                         testing::Combine(testing::Range(std::size_t{0}, std::size(sampledCases)), testing::ValuesIn(integrators),
                                          testing::Values(1e-3, 1e-6, 1e-9)),
                         nameOf);

TEST(Sampling, HasNoPartInTheChoiceOfSteps) {
  const auto stepsOf = [](bool isSampled) {
    CompiledModel model(example("falling_box.tf"));
    model.tolerance(1e-8).initialise();
    if (isSampled)
      sample(model, 2, [] {});
    else
      model.advance(2);
    return tf_get_statistics(model.simulation())->steps;
  };
  EXPECT_EQ(stepsOf(true), stepsOf(false));
}

// What closed contacts and constraints hold at zero is so at samples as well, to rounding.
TEST(Sampling, KeepsWhatTheModeHolds) {
  CompiledModel model(example("falling_rod.tf"));
  model.tolerance(1e-4).initialise();
  double largest = 0;
  sample(model, 1.2, [&] {
    const std::vector<double> gaps = model.valuesOf(TF_KIND_GAP), closed = model.valuesOf(TF_KIND_CLOSED);
    for (std::size_t i = 0; i < gaps.size(); ++i)
      largest = std::max(largest, closed[i] != 0 ? std::abs(gaps[i]) : 0);
  });
  EXPECT_LT(largest, 1e-13);
}

TEST(Sampling, HasSensitivities) {
  const auto derivatives = [](void (*through)(CompiledModel &, double, const std::function<void()> &), double tolerance) {
    CompiledModel model(example("falling_box.tf"));
    model.tolerance(tolerance);
    differentiateBy(model, {"mu"});
    model.initialise();
    std::vector<double> values;
    through(model, 1.2, [&] { values.push_back(sensitivity(model, "r[1]", 0)); });
    return values;
  };
  const std::vector<double> exact = derivatives(stepThrough, 1e-10), sampled = derivatives(sample, 1e-6);
  for (std::size_t k = 0; k < exact.size(); ++k)
    EXPECT_NEAR(sampled[k], exact[k], 1e-5) << k;
}

// x'' = −c (x' + x): stability limits explicit steps long before the slow component does, so that samples are far inside them.
TEST(Sampling, OfDampedMotionIsAsExactAsTheSteps) {
  const std::string file = sourceFile("damped_return.tf", R"(
model DampedReturn
  parameter Real c = 30;
  coordinate Real x(start = 1);
  body a(mass = 1, position = x);
  force damper(value = -c*(der(x) + x), at = x);
end DampedReturn;
)");
  const double end = 4;
  for (const double c : {10, 20, 30, 50, 100, 1000})
    for (const double tolerance : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10})
      for (const tf_integrator integrator : {TF_AUTO, TF_EXPLICIT}) {
        const double root = std::sqrt(c * c / 4 - c), fast = -c / 2 - root, slow = c / fast;
        double worst = 0;
        CompiledModel model(file, {{"c", c}});
        model.tolerance(tolerance).integrator(integrator).initialise();
        sample(model, end, [&] {
          const double a = std::exp(slow * model["time"]), b = std::exp(fast * model["time"]);
          worst = std::max({worst, std::abs(model["x"] - (fast * a - slow * b) / (fast - slow)),
                            std::abs(model["der(x)"] - c * (a - b) / (fast - slow))});
        });
        EXPECT_LE(worst, 20 * tolerance) << c << ", " << tolerance << ", integrator " << integrator;
      }
}

// A state that follows a target which jumps: transients behind the jump are not leapt over, and after them, in steps of many times its time
// constant, samples are at the target.
TEST(Sampling, BehindAJumpIsAsExactAsTheSteps) {
  const std::string file = sourceFile("actuator.tf", R"(
model Actuator
  parameter Real rate = 1000, target = 2;
  Real F(start = 1);
equation
  der(F) = -rate*(F - (if time < 1 then 1 else target));
end Actuator;
)");
  for (const double rate : {100, 142, 215, 464, 1000, 1546, 2154, 4642, 10000})
    for (const double target : {-2.7, -0.019, 0.2, 1.5, 2.02, 3.2})
      for (const double tolerance : {1e-3, 6e-4, 1e-4, 1e-5, 1e-6, 1e-7}) {
        double worst = 0;
        CompiledModel model(file, {{"rate", rate}, {"target", target}});
        model.tolerance(tolerance).initialise();
        sample(model, 2, [&] {
          const double t = model["time"];
          const double expected = t < 1 ? 1 : target + (1 - target) * std::exp(-rate * (t - 1));
          worst = std::max(worst, std::abs(t == 1 ? 0 : model["F"] - expected));
        });
        EXPECT_LE(worst, 20 * tolerance) << rate << ", " << target << ", " << tolerance;
      }
}

}  // namespace
}  // namespace tf::test
