// CPU time of a simulation by libtf in one process (initialise and advance to the end, the model being loaded) against the hand-written
// event-driven program for the same problem, both at the loosest tolerance that meets the error asked for; and what contacts cost that are
// far from closing.
#include "tests/benchmarks/compiled_run.h"
#include "tests/benchmarks/hand_written/planar_body.h"
#include "tests/benchmarks/hand_written/slip_stick.h"
#include "tests/benchmarks/measurement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <stdexcept>

namespace tf::bench {

namespace {

constexpr double kError = 1e-8;
constexpr std::array kTolerances = {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};

struct Expected {
  const char *variable;
  double value;
};

struct Problem {
  std::string name;
  std::string file;
  CompiledRun::Settings settings;
  double end = 0;
  std::vector<Expected> expected;                       // at the end
  double bar = 0;                                       // microseconds of CPU
  std::function<double(double tolerance)> handWritten;  // returns its error
};

double errorOf(const CompiledRun &run, const Problem &problem) {
  double worst = 0;
  for (const Expected &expected : problem.expected) {
    worst = std::max(worst, std::abs(run.value(expected.variable) - expected.value));
  }
  return worst;
}

// The loosest tolerance whose error is small enough, and that error.
std::pair<double, double> loosest(const std::string &name, const std::function<double(double)> &errorOf) {
  for (const double tolerance : kTolerances) {
    const double error = errorOf(tolerance);
    if (error <= kError) {
      return {tolerance, error};
    }
  }
  throw std::runtime_error(fmt::format("{}: no tolerance gives an error of {}", name, kError));
}

void measureProblem(const Setup &setup, const Problem &problem, std::vector<Measurement> &out) {
  const auto [handTolerance, handError] = loosest(problem.name + " (hand-written)", problem.handWritten);
  CompiledRun run(compileModel(setup, problem.file), problem.name, problem.settings, problem.end);
  const auto [tolerance, error] = loosest(problem.name, [&](double t) {
    run.simulate(t);
    return errorOf(run, problem);
  });
  const std::vector<double> seconds =
      cpuPerCall({[&, t = tolerance] { run.simulate(t); }, [&, t = handTolerance] { (void)problem.handWritten(t); }});
  const double ours = seconds[0], hand = seconds[1];
  out.push_back({.name = problem.name + ", hand-written program",
                 .unit = "µs",
                 .value = 1e6 * hand,
                 .note = fmt::format("error {:.1e} at tolerance {:.0e}", handError, handTolerance)});
  out.push_back({.name = problem.name + ", libtf",
                 .unit = "µs",
                 .value = 1e6 * ours,
                 .bar = problem.bar,
                 .note = fmt::format("error {:.1e} at tolerance {:.0e}", error, tolerance)});
  out.push_back({.name = problem.name + ", libtf to hand-written", .unit = "ratio", .value = ours / hand});
}

// A disc that bounces and slides to rest, and far posts: contacts that never close should cost next to nothing.
void measureFarContacts(const Setup &setup, std::vector<Measurement> &out) {
  constexpr int many = 200;
  constexpr double bar = 2;
  const auto compileWith = [&setup](int posts) {
    const std::string file = fmt::format("{}/far_{}.tf", setup.work, posts);
    std::ofstream(file) << fmt::format(R"(
model Far
  constant Integer n = {};
  coordinate Real q[2](start = {{0, 1}}, der(start = {{1, 0}}));
  coordinate Real phi(start = 0, der(start = 2));
  body disc(mass = 1, position = q, angle = phi, inertia = 0.1);
  gravity g(acceleration = {{0, -9.81}});
  contact floor(gap = q[2], slip = der(q[1]), friction = 0.3, restitution = 0.5);
  contact far[n](gap = {{sqrt((q[1] - 100 - k)^2 + (q[2] - 50)^2) + 0.1*sin(phi + k) - 1 for k in 1:n}},
    slip = {{der(q[1]) + 0.1*der(phi)*k for k in 1:n}}, each friction = 0.2);
end Far;
)",
                                       posts);
    return CompiledRun(compileModel(setup, file), "far contacts", {}, 3);
  };
  CompiledRun runOfOne = compileWith(1), runOfAll = compileWith(many);
  const std::vector<double> seconds = cpuPerCall({[&] { runOfOne.simulate(1e-6); }, [&] { runOfAll.simulate(1e-6); }});
  const double one = seconds[0], all = seconds[1];
  out.push_back({.name = "disc and 1 far contact, 3 s", .unit = "µs", .value = 1e6 * one});
  out.push_back({.name = fmt::format("disc and {} far contacts, 3 s", many), .unit = "µs", .value = 1e6 * all});
  out.push_back({.name = fmt::format("{} far contacts to 1", many), .unit = "ratio", .value = all / one, .bar = bar});
}

double bodyError(const hand_written::PlanarBody &body, double tolerance, double x, double y, double phi) {
  const auto state = hand_written::simulate(body, tolerance).state;
  return std::max({std::abs(state[0] - x), std::abs(state[1] - y), std::abs(state[2] - phi)});
}

}  // namespace

std::vector<Measurement> hotSimulation(const Setup &setup) {
  const std::string examples = TF_SOURCE_DIR "/examples/";
  const double none = std::numeric_limits<double>::quiet_NaN(), pi = std::acos(-1.0);
  // Final states: closed form of the slip-stick problem, reference trajectories of the bodies.
  const Problem slipStick{.name = "slip-stick mu = 0.3, 2 s",
                          .file = examples + "particle.tf",
                          .settings = {{"mu", 0.3}, {"g", 10}, {"u[1]", 2}, {"der(q[1])", 1}},
                          .end = 2,
                          .expected = {{"q[1]", 0.8}, {"q[2]", 0}, {"der(q[1])", 0}, {"der(q[2])", 0}},
                          .bar = 20,
                          .handWritten = [](double tolerance) {
                            const auto result = hand_written::simulate(hand_written::SlipStick{}, tolerance);
                            return std::max(std::abs(result.x - 0.8), std::abs(result.vx));
                          }};
  const auto rod = hand_written::fallingRod();
  const Problem fallingRod{.name = "falling rod, 1.5 s",
                           .file = examples + "falling_rod.tf",
                           .settings = {},
                           .end = 1.5,
                           .expected = {{"r[1]", 0.99319628269525095}, {"r[2]", 0}, {"phi", 0}},
                           .bar = none,
                           .handWritten = [&](double tolerance) { return bodyError(rod, tolerance, 0.99319628269525095, 0, 0); }};
  const auto box = hand_written::fallingBox();
  const Problem fallingBox{.name = "falling box, 2 s",
                           .file = examples + "falling_box.tf",
                           .settings = {},
                           .end = 2,
                           .expected = {{"r[1]", 2.3935779816513785}, {"r[2]", 0.5}, {"phi", pi / 2}},
                           .bar = 100,
                           .handWritten = [&](double tolerance) { return bodyError(box, tolerance, 2.3935779816513785, 0.5, pi / 2); }};
  std::vector<Measurement> out;
  for (const Problem *problem : {&slipStick, &fallingRod, &fallingBox}) {
    measureProblem(setup, *problem, out);
  }
  measureFarContacts(setup, out);
  return out;
}

}  // namespace tf::bench
