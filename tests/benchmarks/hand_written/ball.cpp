#include "tests/benchmarks/hand_written/ball.h"

#include "tests/benchmarks/hand_written/dormand_prince.h"

namespace tf::hand_written {

namespace {

// Flight to the floor or to the end; true if there is an impact.
bool fly(const Ball &ball, double tolerance, double &time, Vector<2> &y, double &step) {
  const auto rhs = [&](const Vector<2> &s) { return Vector<2>{s[1], -ball.g}; };
  DormandPrince<2, decltype(rhs)> solver(rhs, time, y, step, tolerance);
  while (solver.time() < ball.end) {
    solver.advance(ball.end, ball.end);
    if (solver.state()[0] < 0) {
      const auto &dense = solver.dense();
      step = solver.time() - dense.start;
      // The ball starts from the floor: the other zero of the step is wanted, on whose left it is high.
      const auto height = [&](double t) { return dense.at(t)[0]; };
      double low = dense.start;
      for (double share = 0.5; height(low) <= 0; share *= 0.5) {
        low = dense.start + share * step;
      }
      time = root(height, low, solver.time(), height(low), solver.state()[0]);
      y = solver.restep(time - dense.start);
      return true;
    }
  }
  time = solver.time();
  y = solver.state();
  return false;
}

}  // namespace

BallResult simulate(const Ball &ball, double tolerance) {
  BallResult result;
  double time = 0, first = 0, step = 0.1;
  Vector<2> y{ball.height, 0};
  while (time < ball.end && fly(ball, tolerance, time, y, step)) {
    ++result.impacts;
    first = std::max(first, -y[1]);
    y = {0, -ball.restitution * y[1]};
    if (y[1] <= tolerance * first) {
      y[1] = 0;
      result.rest = time;
      break;
    }
  }
  result.y = y[0];
  result.v = y[1];
  return result;
}

}  // namespace tf::hand_written
