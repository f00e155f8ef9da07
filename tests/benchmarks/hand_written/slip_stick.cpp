#include "tests/benchmarks/hand_written/slip_stick.h"

#include "tests/benchmarks/hand_written/dormand_prince.h"

#include <cmath>

namespace tf::hand_written {

namespace {

// Free flight to the floor; the state (x, y, vx, vy) at the impact or at the end. True if there is an impact.
bool fly(const SlipStick &problem, double tolerance, double &time, Vector<4> &y) {
  const auto rhs = [&](const Vector<4> &s) { return Vector<4>{s[2], s[3], problem.force, -problem.g}; };
  DormandPrince<4, decltype(rhs)> solver(rhs, time, y, 0.1, tolerance);
  while (solver.time() < problem.end) {
    solver.advance(problem.end, problem.end);
    if (solver.state()[1] < 0) {
      const auto &dense = solver.dense();
      time = root([&](double t) { return dense.at(t)[1]; }, dense.start, solver.time(), solver.stepStart()[1], solver.state()[1]);
      y = solver.restep(time - dense.start);
      return true;
    }
  }
  time = solver.time();
  y = solver.state();
  return false;
}

// Sliding along the floor until the slip velocity changes its sign. True if it does before the end.
bool slide(const SlipStick &problem, double tolerance, double &time, Vector<4> &y) {
  const double direction = y[2] > 0 ? 1 : -1;
  const auto rhs = [&](const Vector<2> &s) { return Vector<2>{s[1], problem.force - direction * problem.mu * problem.g}; };
  DormandPrince<2, decltype(rhs)> solver(rhs, time, {y[0], y[2]}, 0.1, tolerance);
  while (solver.time() < problem.end) {
    solver.advance(problem.end, problem.end);
    if (solver.state()[1] * direction < 0) {
      const auto &dense = solver.dense();
      time = root([&](double t) { return dense.at(t)[1]; }, dense.start, solver.time(), solver.stepStart()[1], solver.state()[1]);
      y[0] = solver.restep(time - dense.start)[0];
      y[2] = 0;
      return true;
    }
  }
  time = solver.time();
  y[0] = solver.state()[0];
  y[2] = solver.state()[1];
  return false;
}

}  // namespace

SlipStickResult simulate(const SlipStick &problem, double tolerance) {
  SlipStickResult result;
  double time = 0;
  Vector<4> y{0, problem.height, problem.velocity, 0};
  if (fly(problem, tolerance, time, y)) {
    result.impact = time;
    const double friction = -problem.mu * y[3];  // the impulse that slip would transmit
    y[2] = std::abs(y[2]) <= friction ? 0 : y[2] - std::copysign(friction, y[2]);
    y[1] = y[3] = 0;
    while (time < problem.end) {
      const bool sticks = y[2] == 0 && std::abs(problem.force) <= problem.mu * problem.g;
      if (sticks) {
        result.stick = time;
        break;
      }
      y[2] = y[2] == 0 ? std::copysign(1e-300, problem.force) : y[2];
      if (!slide(problem, tolerance, time, y)) {
        break;
      }
    }
  }
  result.x = y[0];
  result.y = y[1];
  result.vx = y[2];
  result.vy = y[3];
  return result;
}

}  // namespace tf::hand_written
