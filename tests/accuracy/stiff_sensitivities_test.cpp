// Sensitivities of stiff motions, off the slow manifold and on it, where the state's own steps are far longer than the transients that its
// derivatives go through.
#include "tests/accuracy/each_integrator.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

constexpr double sensitivityTolerances[] = {1e-4, 1e-6, 1e-8, 1e-10};

// A variable's derivatives at the end by all parameters.
struct Expected {
  const char *variable;
  std::vector<double> values;
};

// Each to the tolerance relative to its own magnitude or, where that is smaller, to that of its column on the way there.
void expectNear(CompiledModel &model, const std::vector<Expected> &rows, const std::vector<double> &columns, double tolerance) {
  for (const Expected &row : rows)
    for (std::size_t column = 0; column < row.values.size(); ++column) {
      EXPECT_NEAR(sensitivity(model, row.variable, column), row.values[column],
                  10 * tolerance * std::max(std::abs(row.values[column]), columns[column]))
          << row.variable << ", column " << column << ", tolerance " << tolerance;
    }
}

// x'' = −k x − d x', with roots r1 (slow) and r2 (fast): x = A e^{r1 t} + B e^{r2 t}; derivatives by differences of order 4 in long double.
struct Damped {
  using Real = long double;
  Real k, d, x, v;

  [[nodiscard]] std::pair<Real, Real> at(Real time) const {
    const Real root = std::sqrt(d * d / 4 - k), fast = -d / 2 - root, slow = k / fast;
    const Real b = (v - slow * x) / (fast - slow), a = x - b;
    const Real slowly = a * std::exp(slow * time), quickly = b * std::exp(fast * time);
    return {slowly + quickly, slow * slowly + fast * quickly};
  }
};

std::pair<double, double> derivative(const Damped &at, Damped::Real Damped::*parameter, double time) {
  using Real = Damped::Real;
  const Real h = 1e-4L * std::max(Real{1}, std::abs(at.*parameter));
  const auto shifted = [&](int n) {
    Damped other = at;
    other.*parameter += n * h;
    return other.at(time);
  };
  const auto [x1, v1] = shifted(-2);
  const auto [x2, v2] = shifted(-1);
  const auto [x3, v3] = shifted(1);
  const auto [x4, v4] = shifted(2);
  return {static_cast<double>((x1 - 8 * x2 + 8 * x3 - x4) / (12 * h)), static_cast<double>((v1 - 8 * v2 + 8 * v3 - v4) / (12 * h))};
}

TEST(StiffSensitivities, OfADampedMassAreThoseOfTheClosedForm) {
  const std::string file = sourceFile("damped_mass.tf", R"(
model DampedMass
  parameter Real k = 10, d = 1e5, x0 = 1, v0 = 3;
  coordinate Real x(start = x0, der(start = v0));
  body b(mass = 1, position = x);
  force f(value = -k*x - d*der(x), at = x);
end DampedMass;
)");
  const double end = 0.25;
  for (const double damping : {1e4, 2e5})
    for (const double start : {3.0, -10 / damping})
      for (const double tolerance : sensitivityTolerances)
        withEachIntegrator(
            file, tolerance, end,
            [&](CompiledModel &model) {
              SCOPED_TRACE("damping " + std::to_string(damping) + ", start " + std::to_string(start));
              const Damped reference{10, damping, 1, start};
              std::vector<Expected> rows = {{"x", {}}, {"der(x)", {}}};
              for (const auto parameter : {&Damped::x, &Damped::v, &Damped::k, &Damped::d}) {
                const auto [position, velocity] = derivative(reference, parameter, end);
                rows[0].values.push_back(position);
                rows[1].values.push_back(velocity);
              }
              // A velocity of 1, which the tolerance is relative to, has them.
              expectNear(model, rows, {1, 0.1, 1 / damping, 1 / damping}, tolerance);
            },
            {{"d", damping}, {"v0", start}}, [](CompiledModel &model) { differentiateBy(model, {"x0", "v0", "k", "d"}); });
}

// x' = −λ (x − sin(w t)): x = C e^{−λ t} + λ (λ sin(w t) − w cos(w t))/(λ² + w²), C = x0 + λ w/(λ² + w²).
TEST(StiffSensitivities, OfALagAreThoseOfTheClosedForm) {
  const std::string file = sourceFile("stiff_lag.tf", R"(
model StiffLag
  parameter Real lambda = 1e5, w = 2, x0 = 2;
  Real x(start = x0);
equation
  der(x) = -lambda*(x - sin(w*time));
end StiffLag;
)");
  const double w = 2, t = 0.4, s = std::sin(w * t), c = std::cos(w * t);
  for (const double lambda : {1e3, 1e5})
    for (const double start : {2.0, -w / lambda})
      for (const double tolerance : sensitivityTolerances)
        withEachIntegrator(
            file, tolerance, t,
            [&](CompiledModel &model) {
              SCOPED_TRACE("lambda " + std::to_string(lambda) + ", start " + std::to_string(start));
              const double sum = lambda * lambda + w * w, top = lambda * (lambda * s - w * c);
              const double byLambda = (2 * lambda * s - w * c) / sum - 2 * lambda * top / sum / sum;
              const double byW = lambda * (lambda * t * c - c + w * t * s) / sum - 2 * w * top / sum / sum;
              // The tolerance is relative to the start.
              expectNear(model, {{"x", {0, byLambda, byW}}}, {1, 2 / lambda, 1}, tolerance);
            },
            {{"lambda", lambda}, {"x0", start}}, [](CompiledModel &model) { differentiateBy(model, {"x0", "lambda", "w"}); });
}

using Parameters = std::vector<std::pair<const char *, double>>;

// By differences of order 4 of runs to 1e-12, by the method whose errors are the smallest in stiff motions.
std::vector<Expected> differencesOfRuns(const std::string &file, const Parameters &parameters, const std::vector<const char *> &variables,
                                        double end) {
  std::vector<Expected> rows;
  rows.reserve(variables.size());
  for (const char *variable : variables)
    rows.push_back({variable, {}});
  for (const auto &[name, value] : parameters) {
    const double h = 1e-3 * value;
    std::vector<double> sums(variables.size());
    for (const auto &[place, weight] : {std::pair{-2, 1.0}, std::pair{-1, -8.0}, std::pair{1, 8.0}, std::pair{2, -1.0}}) {
      CompiledModel model(file, {{name, value + place * h}});
      model.tolerance(1e-12).integrator(TF_STEP).run(end);
      for (std::size_t i = 0; i < variables.size(); ++i)
        sums[i] += weight * model[variables[i]];
    }
    for (std::size_t i = 0; i < variables.size(); ++i)
      rows[i].values.push_back(sums[i] / (12 * h));
  }
  return rows;
}

void differentiateBy(CompiledModel &model, const Parameters &parameters) {
  std::vector<const char *> names;
  names.reserve(parameters.size());
  for (const auto &parameter : parameters)
    names.push_back(parameter.first);
  differentiateBy(model, names);
}

// Two bodies that a stiff damper joins, of which a spring holds the second: the derivative by its mass has the damper's force, the product
// of a large number and of a difference of velocities that is small beside them.
TEST(StiffSensitivities, ByAMassBesideStiffDampingAreThoseOfTheRuns) {
  const std::string file = sourceFile("damped_chain.tf", R"(
model DampedChain
  parameter Real m = 1, k = 1;
  coordinate Real x(der(start = 1));
  coordinate Real y;
  body first(mass = 1, position = x);
  body second(mass = m, position = y);
  force damper(value = 1e4*(der(x) - der(y)), at = y - x);
  force spring(value = -k*y, at = y);
end DampedChain;
)");
  const double end = 3;
  const Parameters parameters = {{"m", 1}, {"k", 1}};
  const std::vector<Expected> rows = differencesOfRuns(file, parameters, {"x", "y", "der(x)", "der(y)"}, end);
  for (const double tolerance : sensitivityTolerances)
    withEachIntegrator(
        file, tolerance, end, [&](CompiledModel &model) { expectNear(model, rows, {0.5, 0.5}, tolerance); }, {},
        [&](CompiledModel &model) { differentiateBy(model, parameters); });
}

// Two bodies that a stiff damper joins, the lower one of which strikes the floor: what they have before and after is momentum shared at
// once.
TEST(StiffSensitivities, ThroughAnImpactAreThoseOfTheRuns) {
  const std::string file = sourceFile("damped_pair.tf", R"(
model DampedPair
  parameter Real d = 1e4, k = 50, e = 0.5, h = 0.5, v = 1, g = 9.81;
  coordinate Real y[2](start = {h, h + 1}, der(start = {v, -v}));
  body lower(mass = 1, position = y[1]);
  body upper(mass = 2, position = y[2]);
  force weight[2](value = {-g, -2*g}, at = y);
  force link(value = -d*(1 + 0.5*sin(y[2]))*(der(y[2]) - der(y[1])) - k*(y[2] - y[1] - 1)^3, at = y[2] - y[1]);
  contact floor(gap = y[1], restitution = e);
end DampedPair;
)");
  const double end = 0.5;
  const Parameters parameters = {{"d", 1e4}, {"k", 50}, {"e", 0.5}, {"h", 0.5}, {"v", 1}};
  const std::vector<Expected> rows = differencesOfRuns(file, parameters, {"y[1]", "y[2]", "der(y[1])", "der(y[2])"}, end);
  for (const double tolerance : {1e-4, 1e-6, 1e-8})
    withEachIntegrator(
        file, tolerance, end,
        [&](CompiledModel &model) {
          EXPECT_GT(model.count(TF_EVENT_IMPACT), 0);
          expectNear(model, rows, {1e-4, 1, 10, 10, 10}, tolerance);
        },
        {}, [&](CompiledModel &model) { differentiateBy(model, parameters); });
}

}  // namespace
}  // namespace tf::test
