// Masses in a row that dampers (and springs) join, falling on a soft spring that takes hold of the first one: linear on both sides of the
// switch, so that the matrix exponential is the reference, and stiff between events that come often.
#include "tests/accuracy/each_integrator.h"

#include <Eigen/Dense>

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

constexpr int masses = 6;

struct Links {
  double damping, stiffness;
};

std::string source(const Links &links) {
  return "model Row\n  parameter Integer n = " + std::to_string(masses) + ";\n  parameter Real d = " + std::to_string(links.damping) +
         ";\n  parameter Real k = " + std::to_string(links.stiffness) + R"(;
  coordinate Real u[n](start = {0.1 + 0.01*i*i for i in 1:n});
  body mass[n](each mass = 1, position = u);
  force weight[n](value = {-9.81 for i in 1:n}, at = u);
  force link[n - 1](value = -d*(der(u[2:n]) - der(u[1:n - 1])) - k*(u[2:n] - u[1:n - 1]), at = u[2:n] - u[1:n - 1]);
  force ground(value = if u[1] < 0 then -4000*u[1] else 0, at = u[1]);
end Row;
)";
}

// exp(A t) by squaring.
Eigen::MatrixXd exponential(const Eigen::MatrixXd &matrix, double time) {
  const int squarings =
      std::max(0, static_cast<int>(std::ceil(std::log2(matrix.cwiseAbs().rowwise().sum().maxCoeff() * time + 1e-30))) + 4);
  const Eigen::MatrixXd part = matrix * std::ldexp(time, -squarings);
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()), term = result;
  for (int k = 1; k < 14; ++k) {
    term = term * part / k;
    result += term;
  }
  for (int k = 0; k < squarings; ++k)
    result = (result * result).eval();
  return result;
}

// State (u, v, 1) at `end`: from event to event, whose times are found by bisection between samples.
Eigen::VectorXd reference(const Links &links, double end, int &events) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(2 * masses + 1, 2 * masses + 1);
  system.block(0, masses, masses, masses).setIdentity();
  for (int i = 0; i + 1 < masses; ++i)
    for (const auto &[column, value] : {std::pair{0, links.stiffness}, std::pair{masses, links.damping}}) {
      system.block<2, 2>(masses + i, column + i) += value * (Eigen::Matrix2d() << -1, 1, 1, -1).finished();
    }
  system.block(masses, 2 * masses, masses, 1).setConstant(-9.81);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(2 * masses + 1);
  for (int i = 0; i < masses; ++i)
    state[i] = 0.1 + 0.01 * (i + 1) * (i + 1);
  state[2 * masses] = 1;
  constexpr double sample = 1e-3;
  bool pressed = false;
  double time = 0;
  events = 0;
  while (true) {
    system(masses, 0) = -links.stiffness - (pressed ? 4000 : 0);
    const auto crosses = [&](const Eigen::VectorXd &at) { return pressed ? at[0] > 0 : at[0] < 0; };
    const Eigen::MatrixXd step = exponential(system, sample);
    Eigen::VectorXd next = step * state;
    while (!crosses(next) && time + sample < end) {
      state = next;
      time += sample;
      next = step * state;
    }
    double low = 0, high = std::min(sample, end - time);
    if (!crosses(exponential(system, high) * state))
      return exponential(system, high) * state;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (crosses(exponential(system, middle) * state) ? high : low) = middle;
    }
    state = exponential(system, high) * state;
    state[0] = 0;
    time += high;
    pressed = !pressed;
    ++events;
  }
}

// The largest error of coordinates and velocities after two seconds, in units of the tolerance, and who ran.
double errorOf(const Links &links, double tolerance, tf_integrator integrator, tf_statistics &statistics) {
  constexpr double end = 2;
  int events = 0;
  const Eigen::VectorXd expected = reference(links, end, events);
  EXPECT_GE(events, 4);
  CompiledModel model(sourceFile("row_" + std::to_string(links.damping) + "_" + std::to_string(links.stiffness) + ".tf", source(links)));
  model.tolerance(tolerance).integrator(integrator).run(end);
  const std::vector<double> u = model.valuesOf(TF_KIND_COORDINATE), v = model.valuesOf(TF_KIND_VELOCITY);
  double worst = 0;
  for (int i = 0; i < masses; ++i) {
    worst = std::max(worst, std::abs(u[static_cast<std::size_t>(i)] - expected[i]) / std::max(1.0, std::abs(expected[i])));
    worst =
        std::max(worst, std::abs(v[static_cast<std::size_t>(i)] - expected[masses + i]) / std::max(1.0, std::abs(expected[masses + i])));
  }
  statistics = *tf_get_statistics(model.simulation());
  return worst / tolerance;
}

constexpr double dampingTolerances[] = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};

// Eigenvalues down to −7 500/s, all real: the stabilised method covers most of the time, and CVODE none of it.
TEST(StiffDamping, IsFollowedByTheStabilisedMethod) {
  for (const double tolerance : dampingTolerances)
    for (const tf_integrator integrator : {TF_AUTO, TF_EXPLICIT}) {
      tf_statistics statistics{};
      EXPECT_LE(errorOf({2000, 0}, tolerance, integrator, statistics), 10) << tolerance;
      EXPECT_EQ(statistics.cvode_steps, 0) << tolerance;
      if (tolerance >= 1e-6) {
        EXPECT_GT(statistics.stabilised_time, 1) << tolerance;
      }
    }
}

// What is known of the damping at a saved state is not part of it.
TEST(StiffDamping, IsTheSameAfterASavedState) {
  const std::string file = sourceFile("row_saved.tf", source({2000, 0}));
  CompiledModel first(file), second(file);
  first.tolerance(1e-4).initialise();
  second.tolerance(1e-4).initialise();
  first.advance(1);
  std::vector<unsigned char> saved(tf_state_size(first.simulation()));
  ASSERT_EQ(tf_save_state(first.simulation(), saved.data(), saved.size()), TF_OK);
  ASSERT_EQ(tf_restore_state(second.simulation(), saved.data(), saved.size()), TF_OK);
  first.advance(2);
  second.advance(2);
  EXPECT_GT(tf_get_statistics(second.simulation())->stabilised_steps, 0);
  EXPECT_EQ(first.valuesOf(TF_KIND_VELOCITY), second.valuesOf(TF_KIND_VELOCITY));
}

// Springs beside: damping prevails (real eigenvalues) or is moderate (pairs near the axis, of up to 27 degrees).
TEST(StiffDamping, WithSpringsBesideKeepsTheTolerance) {
  for (const Links &links : {Links{2000, 1e4}, Links{2000, 1e6}, Links{500, 3e5}})
    for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
      tf_statistics statistics{};
      EXPECT_LE(errorOf(links, tolerance, TF_AUTO, statistics), 10) << links.damping << ", " << links.stiffness << ", " << tolerance;
    }
}

// Stiff springs with little damping, whose eigenvalues are near the imaginary axis.
TEST(StiffSprings, AreNotForTheStabilisedMethod) {
  for (const Links &links : {Links{1, 1e6}, Links{50, 1e6}, Links{0, 1e5}})
    for (const double tolerance : {1e-4, 1e-6}) {
      tf_statistics statistics{};
      // Errors of the phase add up over hundreds of oscillations.
      EXPECT_LE(errorOf(links, tolerance, TF_AUTO, statistics), 1000) << links.damping << ", " << links.stiffness << ", " << tolerance;
      EXPECT_LT(statistics.stabilised_time, 0.02) << links.damping << ", " << links.stiffness << ", " << tolerance;
    }
}

// Bodies in a row that all move alike: dampers between them do nothing but limit explicit steps by modes that only rounding errors excite,
// and whose eigenvalues, d/m (2 − 2 cos φ), lie densely up to 4 d/m. An estimate of the largest one that is too small must not hold up the
// run.
TEST(StiffDamping, OfMotionsAlikeCostsNoManySteps) {
  const auto source = [](int bodies) {
    return "model Alike\n  parameter Integer n = " + std::to_string(bodies) + R"(;
  parameter Real d = 2000;
  coordinate Real u[n](start = {0.1*i for i in 1:n});
  body mass[n](each mass = 1, position = u);
  force push[n](value = {-9.81*cos(5*u[i] - 0.5*i) for i in 1:n}, at = u);
  force link[n - 1](value = -d*(der(u[2:n]) - der(u[1:n - 1])), at = u[2:n] - u[1:n - 1]);
end Alike;
)";
  };
  constexpr double end = 2;
  CompiledModel two(sourceFile("alike_2.tf", source(2)), {{"d", 0}});
  two.tolerance(1e-11).run(end);
  const double expected = two.valuesOf(TF_KIND_COORDINATE)[0];
  const std::string file = sourceFile("alike_20.tf", source(20));
  for (const double damping : {2e2, 2e3, 2e4, 2e5})
    for (const double tolerance : {1e-4, 1e-6, 1e-7}) {
      SCOPED_TRACE("d = " + std::to_string(damping) + ", tolerance " + std::to_string(tolerance));
      CompiledModel row(file, {{"d", damping}});
      row.tolerance(tolerance).run(end);
      EXPECT_NEAR(row.valuesOf(TF_KIND_COORDINATE)[0], expected, 100 * tolerance);
      EXPECT_LE(tf_get_statistics(row.simulation())->evaluations, 8000);
    }
}

}  // namespace
}  // namespace tf::test
