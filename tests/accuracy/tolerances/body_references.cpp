// Rigid bodies in the plane: event-driven in long double.
#include "tests/accuracy/support/planar_reference.h"
#include "tests/accuracy/tolerances/references.h"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

namespace tf::test {

namespace {

const std::vector<std::string> kBody = {"r[1]", "r[2]", "phi", "der(r[1])", "der(r[2])", "der(phi)"};

Reference solved(const FloorBody &body, double end, int count) {
  const std::vector<double> times = uniformTimes(end, count);
  const FloorSolution solution = solve(body, times);
  if (solution.validUntil < end)
    throw std::runtime_error("the reference solution ends early");
  Reference reference{.variables = kBody};
  for (std::size_t i = 0; i < times.size(); ++i) {
    const State<6> &y = solution.samples[i];
    reference.add(times[i], y[0], y[1], y[2], y[3], y[4], y[5]);
  }
  for (const Number time : solution.eventTimes)
    reference.addEvent(time, TF_EVENT_COUNT);
  return reference;
}

}  // namespace

Reference fallingRodReference() {
  FloorBody rod{.mass = 1, .inertia = 1 / Number(12), .mu = 0.3L, .corners = {{-0.5L, 0}, {0.5L, 0}}};
  rod.start = {0, std::sin(kPi / 4) / 2 + 0.5L, kPi / 4, 2, 0, 0};
  return solved(rod, 1.5, 50);
}

Reference fallingBoxReference() {
  const std::vector<std::pair<Number, Number>> corners = {{-0.5L, -0.3L}, {0.5L, -0.3L}, {0.5L, 0.3L}, {-0.5L, 0.3L}};
  FloorBody box{.mass = 1, .inertia = 1.36L / 12, .mu = 0.2L, .corners = corners};
  box.start = {0, 1, 0.9L, 3, 0, 4};
  return solved(box, 2, 50);
}

// The frictional impulse takes the slip first, then the approach while the end sticks (theory: "Painlevé"); free flight follows.
Reference painleveRodReference() {
  const Number c = std::cos(kPi / 3) / 2, s = std::sin(kPi / 3) / 2, J = Number(1) / 32;
  const Number Dnn = 1 + c * c / J, Dnt = -c * s / J, Dtt = 1 + s * s / J;
  const Number first = 10 / (Dtt + Dnt), second = -(Dnn + Dnt) * first / (Dnn - Dnt * Dnt / Dtt);
  const Number normal = first + second, tangential = first - Dnt / Dtt * second;
  const Number vx = -10 + tangential, vy = normal, spin = (-c * normal + s * tangential) / J;
  Reference reference{.variables = kBody};
  for (const double t : uniformTimes(0.2, 10))
    reference.add(t, vx * t, s + vy * t - g * t * t / 2, kPi / 3 + spin * t, vx, vy - g * t, spin);
  reference.addEvent(0, TF_EVENT_PAINLEVE);
  return reference;
}

// Housner: the block turns about the corner that carries it, and each impact takes the same share of the spin. The last ones follow each
// other in the times 2 ω/(k sin α), to the order ω².
Reference rockingBlockReference() {
  const Number b = 0.2L, h = 0.6L, square = b * b + h * h, rate = 3 * g / (4 * square);
  const Number share = (square / 3 + h * h - b * b) / (4 * square / 3);
  Number side = 1;  // of the corner that carries the block
  Reference reference{.variables = kBody};
  const auto record = [&](Number t, const State<2> &y) {
    const Number cosine = std::cos(y[0]), sine = std::sin(y[0]), x = side * b - side * b * cosine - h * sine,
                 height = -side * b * sine + h * cosine;
    reference.add(t, x, height, y[0], -y[1] * height, y[1] * (x - side * b), y[1]);
  };
  Recorder<2, decltype(record)> run(uniformTimes(5, 50), record);
  run.state = {-0.2L, 0};
  const auto rhs = [&](Number, const State<2> &y) { return State<2>{y[1], rate * (side * b * std::cos(y[0]) + h * std::sin(y[0]))}; };
  const auto stop = [&](Number, const State<2> &y) { return -side * y[0]; };
  while (run.advance(rhs, stop, 0.005L) && std::abs(run.state[1]) > 1e-5L) {
    reference.addEvent(run.time, TF_EVENT_IMPACT, std::abs(run.state[1]) > 0.1L);
    run.state = {0, share * run.state[1]};
    side = -side;
  }
  const Number rest = run.time + 2 * share * std::abs(run.state[1]) / (rate * b) / (1 - share);
  reference.addEvent(rest, TF_EVENT_REST);
  for (const double t : uniformTimes(5, 50))
    if (t > rest)
      reference.add(t, 0, h, 0, 0, 0, 0);
  return reference;
}

// On a spoke the wheel is a pendulum on its head. Over the next foot the speed of the hub is turned by the angle between two spokes; its
// part across the new spoke stays.
Reference rimlessWheelReference() {
  const Number l = 0.5L, m = 2, J = 0.1L, slope = 0.12L, half = kPi / 8, about = J + m * l * l;
  const Number share = (J + m * l * l * std::cos(2 * half)) / about;
  int steps = 0;
  Reference reference{.variables = kBody};
  const auto record = [&](Number t, const State<2> &y) {
    const Number across = l * std::cos(y[0]), along = l * std::sin(y[0]);
    reference.add(t, 2 * steps * l * std::sin(half) + along, across, y[0] + 2 * steps * half, across * y[1], -along * y[1], y[1]);
  };
  Recorder<2, decltype(record)> run(uniformTimes(6, 60), record);
  run.state = {0, 0.8L};
  const auto rhs = [&](Number, const State<2> &y) { return State<2>{y[1], m * g * l * std::sin(y[0] + slope) / about}; };
  const auto stop = [&](Number, const State<2> &y) { return half - y[0]; };
  while (run.advance(rhs, stop)) {
    reference.addEvent(run.time, TF_EVENT_IMPACT);
    reference.addEvent(run.time, TF_EVENT_OPENING);
    run.state = {-half, share * run.state[1]};
    ++steps;
  }
  return reference;
}

Reference pendulumWallReference() {
  const Number d = 0.05L, wall = -0.3L, angle = std::asin(wall);
  const auto torque = [&](Number t, Number phi, Number w) { return -g * std::sin(phi) - d * w + 4 * std::sin(2 * t) * std::cos(phi); };
  Reference reference{.variables = {"phi", "der(phi)"}};
  const auto record = [&](Number t, const State<2> &y) { reference.add(t, y[0], y[1]); };
  Recorder<2, decltype(record)> run(uniformTimes(5, 50), record);
  run.state = {-1.2L, 0};
  const auto flight = [&](Number t, const State<2> &y) { return State<2>{y[1], torque(t, y[0], y[1])}; };
  const auto gap = [&](Number, const State<2> &y) { return y[1] > 0 ? wall - std::sin(y[0]) : Number(1); };
  const auto rest = [](Number, const State<2> &) { return State<2>{0, 0}; };
  const auto pressed = [&](Number t, const State<2> &) { return torque(t, angle, 0); };
  while (run.advance(flight, gap)) {
    reference.addEvent(run.time, TF_EVENT_IMPACT);
    run.state = {angle, 0};
    if (!run.advance(rest, pressed))
      break;
    reference.addEvent(run.time, TF_EVENT_OPENING);
  }
  return reference;
}

namespace {

// Pendulums in a row with equal strings; gap of neighbours i, i + 1 and the derivatives by their angles.
struct Cradle {
  static constexpr int n = 5;
  static constexpr Number R = 0.02L, l = 0.3L, space = 1e-6L;
  struct Gap {
    Number value, left, right;
  };
  [[nodiscard]] static Gap gap(int i, const State<2 * n> &y) {
    const Number a = y[i], b = y[i + 1], dx = 2 * R + space + l * (std::sin(b) - std::sin(a)), dy = -l * (std::cos(b) - std::cos(a));
    const Number length = std::hypot(dx, dy);
    return {length - 2 * R, -l * (dx * std::cos(a) + dy * std::sin(a)) / length, l * (dx * std::cos(b) + dy * std::sin(b)) / length};
  }
  [[nodiscard]] static Number rate(int i, const State<2 * n> &y) {
    const Gap gapNow = gap(i, y);
    return gapNow.left * y[n + i] + gapNow.right * y[n + i + 1];
  }
  // Of the pairs that approach, the one that has come nearest.
  [[nodiscard]] static std::pair<Number, int> nearest(const State<2 * n> &y) {
    std::pair<Number, int> best{1, -1};
    for (int i = 0; i + 1 < n; ++i)
      if (rate(i, y) < 0 && gap(i, y).value < best.first)
        best = {gap(i, y).value, i};
    return best;
  }
};

}  // namespace

Reference newtonsCradleReference() {
  constexpr int n = Cradle::n;
  Reference reference;
  for (const char *const format : {"phi[", "der(phi["})
    for (int i = 1; i <= n; ++i)
      reference.variables.push_back(format + std::to_string(i) + (format[0] == 'd' ? "])" : "]"));
  const auto record = [&](Number t, const State<2 * n> &y) {
    reference.samples.push_back({static_cast<double>(t), std::vector<double>(y.begin(), y.end())});
  };
  Recorder<2 * n, decltype(record)> run(uniformTimes(3, 15), record);
  run.state[0] = -0.4L;
  const auto rhs = [](Number, const State<2 * n> &y) {
    State<2 * n> slope{};
    for (int i = 0; i < n; ++i) {
      slope[i] = y[n + i];
      slope[n + i] = -g / Cradle::l * std::sin(y[i]);
    }
    return slope;
  };
  const auto stop = [](Number, const State<2 * n> &y) { return Cradle::nearest(y).first; };
  while (run.advance(rhs, stop)) {
    reference.addEvent(run.time, TF_EVENT_IMPACT);
    const int i = Cradle::nearest(run.state).second;
    const Cradle::Gap gap = Cradle::gap(i, run.state);
    const Number impulse = -2 * Cradle::rate(i, run.state) / (gap.left * gap.left + gap.right * gap.right);
    run.state[n + i] += gap.left * impulse;
    run.state[n + i + 1] += gap.right * impulse;
  }
  return reference;
}

// Three angles and the two multipliers of the loop, solved for in every evaluation; over the run nothing drifts in this precision.
Reference fourBarReference() {
  using Matrix = Eigen::Matrix<Number, 5, 5>;
  using Column = Eigen::Matrix<Number, 5, 1>;
  const Number l1 = 0.3L, l2 = 0.8L, l3 = 0.5L, d = 0.7L, rho = 2, m1 = rho * l1, m2 = rho * l2, m3 = rho * l3;
  State<6> start{0.5L, 0.6L, 1.4L, 0, 0, 0};
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Number x = l1 * std::cos(start[0]) + l2 * std::cos(start[1]) - d - l3 * std::cos(start[2]),
                 y = l1 * std::sin(start[0]) + l2 * std::sin(start[1]) - l3 * std::sin(start[2]);
    const Number a = -l2 * std::sin(start[1]), b = l3 * std::sin(start[2]), c = l2 * std::cos(start[1]), e = -l3 * std::cos(start[2]);
    start[1] -= (e * x - b * y) / (a * e - b * c);
    start[2] -= (a * y - c * x) / (a * e - b * c);
  }
  const auto rhs = [&](Number, const State<6> &y) {
    std::array<Number, 3> C{}, S{};
    for (int i = 0; i < 3; ++i) {
      C[i] = std::cos(y[i]);
      S[i] = std::sin(y[i]);
    }
    const Number coupling = m2 * l1 * l2 / 2 * std::cos(y[0] - y[1]), twist = m2 * l1 * l2 / 2 * std::sin(y[0] - y[1]);
    Matrix system = Matrix::Zero();
    system(0, 0) = m1 * l1 * l1 / 3 + m2 * l1 * l1;
    system(1, 1) = m2 * l2 * l2 / 3;
    system(2, 2) = m3 * l3 * l3 / 3;
    system(0, 1) = system(1, 0) = coupling;
    const Number rows[2][3] = {{-l1 * S[0], -l2 * S[1], l3 * S[2]}, {l1 * C[0], l2 * C[1], -l3 * C[2]}};
    for (int r = 0; r < 2; ++r)
      for (int i = 0; i < 3; ++i)
        system(i, 3 + r) = system(3 + r, i) = rows[r][i];
    const Number w0 = y[3] * y[3], w1 = y[4] * y[4], w2 = y[5] * y[5];
    Column right;
    right << -twist * w1 - g * C[0] * l1 * (m1 / 2 + m2), twist * w0 - g * C[1] * l2 * m2 / 2, -g * C[2] * l3 * m3 / 2,
        l1 * C[0] * w0 + l2 * C[1] * w1 - l3 * C[2] * w2, l1 * S[0] * w0 + l2 * S[1] * w1 - l3 * S[2] * w2;
    const Column a = system.partialPivLu().solve(right);
    return State<6>{y[3], y[4], y[5], a[0], a[1], a[2]};
  };
  Reference reference{.variables = {"phi[1]", "phi[2]", "phi[3]", "der(phi[1])", "der(phi[2])", "der(phi[3])"}};
  const auto record = [&](Number t, const State<6> &y) { reference.add(t, y[0], y[1], y[2], y[3], y[4], y[5]); };
  Recorder<6, decltype(record)> run(uniformTimes(3, 30), record);
  run.state = start;
  run.advance(rhs, [](Number, const State<6> &) { return Number(1); });
  return reference;
}

}  // namespace tf::test
