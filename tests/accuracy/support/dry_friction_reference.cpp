#include "tests/accuracy/support/dry_friction_reference.h"

#include <cmath>

namespace tf::test {

namespace {

enum class Mode { Stick, Forward, Backward };

class Solver {
public:
  explicit Solver(const DryFriction &problem) : problem_(problem), y_{problem.x, problem.v} {
    const Number slip = y_[1] - problem.belt(0);
    mode_ = slip > 0 ? Mode::Forward : slip < 0 ? Mode::Backward : Mode::Stick;
    if (mode_ == Mode::Stick) {
      choose();
    }
  }

  FrictionSolution run(const std::vector<double> &grid) {
    for (const double time : grid) {
      while (advance(time)) {
        choose();
        solution_.switches.push_back({t_, mode_ == Mode::Stick});
      }
      solution_.samples.push_back(y_);
    }
    return solution_;
  }

private:
  // Friction force that keeps the mass on the belt.
  [[nodiscard]] Number holding(Number t, const State<2> &y) const {
    return problem_.mass * problem_.beltAcceleration(t) - problem_.force(t, y[0], y[1]);
  }

  // The mode after the slip became zero, or the holding force reached the bound: then the sign of its growth decides.
  void choose() {
    y_[1] = problem_.belt(t_);
    const Number needed = holding(t_, y_);
    const bool atLimit = std::abs(std::abs(needed) - problem_.bound) < Number(1e-12) && mode_ == Mode::Stick;
    if (std::abs(needed) < problem_.bound && !atLimit) {
      mode_ = Mode::Stick;
    } else {
      mode_ = needed > 0 ? Mode::Backward : Mode::Forward;
    }
  }

  bool advance(Number end) {
    if (mode_ == Mode::Stick) {
      const auto rhs = [&](Number t, const State<2> &) { return State<2>{problem_.belt(t), problem_.beltAcceleration(t)}; };
      const auto stop = [&](Number t, const State<2> &y) { return problem_.bound - std::abs(holding(t, y)); };
      return gaussUntil<2>(rhs, stop, t_, y_, end, problem_.step);
    }
    const Number direction = mode_ == Mode::Forward ? 1 : -1;
    const auto rhs = [&](Number t, const State<2> &y) {
      return State<2>{y[1], (problem_.force(t, y[0], y[1]) - direction * problem_.bound) / problem_.mass};
    };
    const auto stop = [&](Number t, const State<2> &y) { return direction * (y[1] - problem_.belt(t)); };
    return gaussUntil<2>(rhs, stop, t_, y_, end, problem_.step);
  }

  const DryFriction &problem_;
  Mode mode_ = Mode::Stick;
  Number t_ = 0;
  State<2> y_;
  FrictionSolution solution_;
};

}  // namespace

FrictionSolution solve(const DryFriction &problem, const std::vector<double> &grid) { return Solver(problem).run(grid); }

}  // namespace tf::test
