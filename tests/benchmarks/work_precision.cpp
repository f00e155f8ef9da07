// Work against precision: CPU time of one simulation in this process against the error of its result, over a range of tolerances, for
// models compiled by tfc, for the event-driven program written by hand for the same problem (Dormand-Prince 5(4), dense output, root
// finding) and, where their packages are installed, for time stepping by Siconos (Moreau-Jean) and for MuJoCo (soft contact).
#include "tests/benchmarks/compiled_run.h"
#include "tests/benchmarks/hand_written/ball.h"
#include "tests/benchmarks/hand_written/planar_body.h"
#include "tests/benchmarks/hand_written/slider_crank.h"
#include "tests/benchmarks/measurement.h"
#include "tests/benchmarks/peers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <initializer_list>
#include <numeric>
#include <stdexcept>

namespace tf::bench {

namespace {

constexpr std::array kTolerances = {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
constexpr std::array kSteps = {1e-3, 1e-4};
// The accuracy at which the ratio to the hand-written program is taken.
constexpr double kAccuracy = 1e-8;

struct Point {
  std::string program, setting;
  double seconds = 0, error = 0;
};

struct Case {
  std::string name;
  std::string file;
  CompiledRun::Settings settings;
  double end = 0;
  std::vector<const char *> variables;
  std::vector<double> expected;                                  // their values at the end
  std::function<std::vector<double>(double)> byHand;             // the same values at a tolerance
  double barByHand = 0;                                          // most CPU relative to the hand-written program
  double barSiconos = std::numeric_limits<double>::quiet_NaN();  // least factor to Siconos at h = 1e-4
  double restTime = std::numeric_limits<double>::quiet_NaN();    // instead of the values: the time of rest
};

double difference(const std::vector<double> &values, const std::vector<double> &expected) {
  double worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    worst = std::max(worst, i < values.size() ? std::abs(values[i] - expected[i]) : std::numeric_limits<double>::infinity());
  }
  return worst;
}

// A setting of which the error is known and the CPU time is still to be measured.
struct Setting {
  Point point;
  std::function<void()> simulate;
};

std::vector<Setting> settingsOf(CompiledRun &run, const Case &problem) {
  std::vector<Setting> settings;
  for (const double tolerance : kTolerances) {
    run.simulate(tolerance);
    std::vector<double> values;
    for (const char *variable : problem.variables) {
      values.push_back(run.value(variable));
    }
    double error = difference(values, problem.expected);
    if (!std::isnan(problem.restTime)) {
      error = std::abs(run.timeOfRest(tolerance) - problem.restTime);
    }
    settings.push_back({{"tfc", fmt::format("tol {:.0e}", tolerance), 0, error}, [&run, tolerance] { run.simulate(tolerance); }});
  }
  return settings;
}

std::vector<Setting> settingsByHand(const Case &problem) {
  std::vector<Setting> settings;
  const std::vector<double> expected = std::isnan(problem.restTime) ? problem.expected : std::vector<double>{problem.restTime};
  for (const double tolerance : kTolerances) {
    const double error = difference(problem.byHand(tolerance), expected);
    settings.push_back(
        {{"by hand", fmt::format("tol {:.0e}", tolerance), 0, error}, [&problem, tolerance] { (void)problem.byHand(tolerance); }});
  }
  return settings;
}

// All settings in turns, which is what makes the ratios of their times figures.
void measureTimes(std::initializer_list<std::vector<Setting> *> groups) {
  std::vector<Setting *> settings;
  std::vector<std::function<void()>> calls;
  for (std::vector<Setting> *group : groups) {
    for (Setting &setting : *group) {
      settings.push_back(&setting);
      calls.push_back(setting.simulate);
    }
  }
  const std::vector<double> seconds = cpuPerCall(calls);
  for (std::size_t k = 0; k < settings.size(); ++k) {
    settings[k]->point.seconds = seconds[k];
  }
}

std::vector<Point> pointsOf(const std::vector<Setting> &settings) {
  std::vector<Point> points;
  points.reserve(settings.size());
  for (const Setting &setting : settings) {
    points.push_back(setting.point);
  }
  return points;
}

std::vector<Point> sweepPeer(const Setup &setup, const Case &problem, const char *label, const char *program) {
  std::vector<Point> points;
  const std::string path = (std::filesystem::path(setup.tfc).parent_path() / program).string();
  for (const double step : kSteps) {
    if (const auto run = runPeer(path, problem.name, step)) {
      points.push_back({label, fmt::format("h {:.0e}", step), run->seconds, difference(run->values, problem.expected)});
    }
  }
  return points;
}

// The cheapest run whose error is small enough; null where there is none.
const Point *cheapest(const std::vector<Point> &points, double error) {
  const Point *best = nullptr;
  for (const Point &point : points) {
    if (point.error <= error && (best == nullptr || point.seconds < best->seconds)) {
      best = &point;
    }
  }
  return best;
}

void print(const std::string &name, const std::vector<Point> &ours, const std::vector<Point> &byHand, const std::vector<Point> &peers) {
  for (const std::vector<Point> *points : {&byHand, &ours, &peers}) {
    for (const Point &point : *points) {
      // CPU relative to the cheapest hand-written run that is not less accurate than this one, as far as there is one.
      const Point *yardstick = cheapest(byHand, std::max(point.error, 1e-14));
      fmt::print("{:<14} {:<8} {:<10} {:>12.2f} µs {:>10.1e} {:>10}\n", name, point.program, point.setting, 1e6 * point.seconds,
                 point.error, yardstick != nullptr ? fmt::format("{:.2f}", point.seconds / yardstick->seconds) : "-");
    }
  }
  std::fflush(stdout);
}

void measureCase(const Setup &setup, const Case &problem, std::vector<Measurement> &out) {
  CompiledRun run(compileModel(setup, problem.file), problem.name, problem.settings, problem.end);
  std::vector<Setting> oursToMeasure = settingsOf(run, problem), byHandToMeasure = settingsByHand(problem);
  measureTimes({&oursToMeasure, &byHandToMeasure});
  const std::vector<Point> byHand = pointsOf(byHandToMeasure), ours = pointsOf(oursToMeasure);
  std::vector<Point> siconos;
  std::vector<Point> peers;
  if (std::isnan(problem.restTime)) {
    siconos = sweepPeer(setup, problem, "Siconos", "tf_peer_siconos");
    peers = sweepPeer(setup, problem, "MuJoCo", "tf_peer_mujoco");
    peers.insert(peers.begin(), siconos.begin(), siconos.end());
  }
  print(problem.name, ours, byHand, peers);
  const Point *hand = cheapest(byHand, std::isnan(problem.restTime) ? kAccuracy : 1e-6);
  const Point *mine = hand != nullptr ? cheapest(ours, std::max(hand->error, 1e-13)) : nullptr;
  if (mine != nullptr) {
    out.push_back({.name = problem.name + ": CPU to the program written by hand",
                   .unit = "ratio",
                   .value = mine->seconds / hand->seconds,
                   .bar = problem.barByHand,
                   .note = fmt::format("{:.2f} µs at {:.1e} to {:.2f} µs at {:.1e}", 1e6 * mine->seconds, mine->error, 1e6 * hand->seconds,
                                       hand->error)});
  }
  for (const Point &point : siconos) {
    const Point *match = cheapest(ours, point.error);
    if (match != nullptr) {
      out.push_back({.name = fmt::format("{}: Siconos, {}, to tfc", problem.name, point.setting),
                     .unit = "ratio",
                     .value = point.seconds / match->seconds,
                     .bar = point.setting == "h 1e-04" ? problem.barSiconos : std::numeric_limits<double>::quiet_NaN(),
                     .atLeast = true,
                     .note = fmt::format("error {:.1e} to {:.1e}", point.error, match->error)});
    }
  }
}

// Height at the end of the bounces by the closed form: each flight lasts 2 v / g.
double ballHeight(const hand_written::Ball &ball) {
  double time = std::sqrt(2 * ball.height / ball.g), v = ball.restitution * ball.g * time;
  while (time + 2 * v / ball.g < ball.end) {
    time += 2 * v / ball.g;
    v *= ball.restitution;
  }
  const double t = ball.end - time;
  return v * t - ball.g / 2 * t * t;
}

double ballRest(const hand_written::Ball &ball) {
  const double first = std::sqrt(2 * ball.height / ball.g);
  return first + 2 * ball.restitution * first / (1 - ball.restitution);
}

std::vector<double> bodyAt(const hand_written::PlanarBody &body, double tolerance) {
  const auto state = hand_written::simulate(body, tolerance).state;
  return {state[0], state[1], state[2]};
}

void measureBalls(const Setup &setup, std::vector<Measurement> &out) {
  const std::string file = TF_SOURCE_DIR "/examples/bouncing_ball.tf";
  const hand_written::Ball ball{};
  measureCase(setup,
              {.name = "ball",
               .file = file,
               .settings = {},
               .end = ball.end,
               .variables = {"y"},
               .expected = {ballHeight(ball)},
               .byHand = [&](double tolerance) { return std::vector<double>{hand_written::simulate(ball, tolerance).y}; },
               .barByHand = 2,
               .barSiconos = 2000},
              out);
  const hand_written::Ball zeno{.end = 5};
  measureCase(setup,
              {.name = "ball-zeno",
               .file = file,
               .settings = {},
               .end = zeno.end,
               .variables = {"y"},
               .expected = {0},
               .byHand = [&](double tolerance) { return std::vector<double>{hand_written::simulate(zeno, tolerance).rest}; },
               .barByHand = 2,
               .restTime = ballRest(zeno)},
              out);
}

void measureBodies(const Setup &setup, std::vector<Measurement> &out) {
  const std::string examples = TF_SOURCE_DIR "/examples/";
  // Final states out of the reference trajectories.
  const auto rod = hand_written::fallingRod();
  measureCase(setup,
              {.name = "rod",
               .file = examples + "falling_rod.tf",
               .settings = {},
               .end = rod.end,
               .variables = {"r[1]", "r[2]", "phi"},
               .expected = {0.99319628269525095, 0, 0},
               .byHand = [&](double tolerance) { return bodyAt(rod, tolerance); },
               .barByHand = 2},
              out);
  const auto box = hand_written::fallingBox();
  measureCase(setup,
              {.name = "box",
               .file = examples + "falling_box.tf",
               .settings = {},
               .end = box.end,
               .variables = {"r[1]", "r[2]", "phi"},
               .expected = {2.3935779816513785, 0.5, std::acos(-1.0) / 2},
               .byHand = [&](double tolerance) { return bodyAt(box, tolerance); },
               .barByHand = 2,
               .barSiconos = 2000},
              out);
  const hand_written::SliderCrank crank{};
  const auto angles = [&](double tolerance) {
    const auto state = hand_written::simulate(crank, tolerance).state;
    return std::vector<double>{state[0], state[1], state[2]};
  };
  measureCase(setup,
              {.name = "slider-crank",
               .file = examples + "slider_crank.tf",
               .settings = {},
               .end = crank.end,
               .variables = {"phi[1]", "phi[2]", "phi[3]"},
               .expected = {8.9950107056964228, -0.21320927472428841, 0},
               .byHand = angles,
               .barByHand = 2,
               .barSiconos = 300},
              out);
}

// Nodes of a chain out of its first node and the angles of its links.
std::vector<std::array<double, 2>> nodesOf(double x, double y, const std::vector<double> &angles) {
  const double length = 1 / static_cast<double>(angles.size());
  std::vector<std::array<double, 2>> nodes = {{x, y}};
  for (const double angle : angles) {
    const auto [lastX, lastY] = nodes.back();
    nodes.push_back({lastX + length * std::cos(angle), lastY + length * std::sin(angle)});
  }
  return nodes;
}

double farthest(const std::vector<std::array<double, 2>> &nodes, const std::vector<std::array<double, 2>> &expected) {
  double worst = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    worst = std::max(worst, std::hypot(nodes[k][0] - expected[k][0], nodes[k][1] - expected[k][1]));
  }
  return worst;
}

// A chain of 50 links falls on the floor. There is no program by hand; the yardstick is MuJoCo at h = 1e-3 against our cheapest tolerance
// that is not less accurate. Errors are distances of nodes at the end from a run of ours at a small tolerance.
void measureChain(const Setup &setup, std::vector<Measurement> &out) {
  constexpr int links = 50;
  constexpr std::array tolerances = {1e-1, 1e-2, 1e-3};
  constexpr double reference = 1e-9;
  const std::string program = (std::filesystem::path(setup.tfc).parent_path() / "tf_peer_mujoco").string();
  CompiledRun run(compileModel(setup, TF_SOURCE_DIR "/examples/chain.tf", {"--set", fmt::format("n={}", links)}), "chain of 50", {}, 1);
  const auto nodesAt = [&run](double tolerance) {
    run.simulate(tolerance);
    std::vector<double> angles;
    for (int i = 1; i <= links; ++i) {
      angles.push_back(run.value(fmt::format("phi[{}]", i).c_str()));
    }
    return nodesOf(run.value("r[1]"), run.value("r[2]"), angles);
  };
  const auto expected = nodesAt(reference);
  std::vector<Setting> settings;
  for (const double tolerance : tolerances) {
    const double error = farthest(nodesAt(tolerance), expected);
    settings.push_back({{"tfc", fmt::format("tol {:.0e}", tolerance), 0, error}, [&run, tolerance] { run.simulate(tolerance); }});
  }
  measureTimes({&settings});
  const std::vector<Point> ours = pointsOf(settings);
  std::vector<Point> peers;
  // Joint angles are relative to the link before.
  if (const auto peer = runPeer(program, "chain", 1e-3); peer && peer->values.size() == links + 2) {
    std::vector<double> angles(links);
    std::partial_sum(peer->values.begin() + 2, peer->values.end(), angles.begin());
    const double error = farthest(nodesOf(peer->values[0], peer->values[1], angles), expected);
    peers.push_back({"MuJoCo", "h 1e-03", peer->seconds, error});
  }
  print("chain of 50", ours, {}, peers);
  const Point *mine = peers.empty() ? nullptr : cheapest(ours, peers.front().error);
  if (mine != nullptr) {
    out.push_back({.name = "chain of 50: CPU to MuJoCo at h = 1e-3",
                   .unit = "ratio",
                   .value = mine->seconds / peers.front().seconds,
                   .bar = 1,
                   .note = fmt::format("{}, error {:.1e} to {:.1e}", mine->setting, mine->error, peers.front().error)});
  }
}

}  // namespace

std::vector<Measurement> workPrecision(const Setup &setup) {
  fmt::print("{:<14} {:<8} {:<10} {:>15} {:>10} {:>10}\n", "case", "program", "setting", "CPU", "error", "to by hand");
  std::vector<Measurement> out;
  measureBalls(setup, out);
  measureBodies(setup, out);
  measureChain(setup, out);
  fmt::print("\n");
  return out;
}

}  // namespace tf::bench
