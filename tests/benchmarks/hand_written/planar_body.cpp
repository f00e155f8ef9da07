#include "tests/benchmarks/hand_written/planar_body.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace tf::hand_written {

namespace {

constexpr double kTiny = 1e-12;

// A corner relative to the centre of mass, in the world's frame.
struct Arm {
  double x = 0, y = 0;
};

class Simulation {
public:
  Simulation(const PlanarBody &body, double tolerance, std::span<const double> grid, std::vector<Vector<6>> *samples)
      : body_(body), tolerance_(tolerance), grid_(grid), samples_(samples) {
    for (int i = 0; i < 3; ++i) {
      y_[i] = body.position[i];
      y_[3 + i] = body.velocity[i];
    }
  }

  BodyResult run() {
    while (time_ < body_.end) {
      switch (closedCount_) {
      case 0:
        fly();
        break;
      case 1:
        slideOnCorner();
        break;
      default:
        slideOnFace();
      }
    }
    sample(body_.end, [&](double) { return y_; });
    result_.state = y_;
    return result_;
  }

private:
  [[nodiscard]] Arm arm(int corner, double phi) const {
    const double c = std::cos(phi), s = std::sin(phi);
    const Corner &p = body_.corners[corner];
    return {c * p.x - s * p.y, s * p.x + c * p.y};
  }

  // Samples what the grid has up to `until`; the state at a time is given by `state`.
  template <class State> void sample(double until, State state) {
    while (samples_ != nullptr && next_ < grid_.size() && (grid_[next_] < until || (until >= body_.end && grid_[next_] <= until))) {
      samples_->push_back(state(grid_[next_++]));
    }
  }

  void record(int corner) {
    if (result_.eventCount < static_cast<int>(result_.events.size())) {
      result_.events[result_.eventCount++] = {time_, corner, y_};
    }
  }

  // Of the corners that are open, the first one that touches the floor in the solver's last step.
  template <class Solver, class State> std::optional<std::pair<int, double>> firstTouch(const Solver &solver, State state) const {
    std::optional<std::pair<int, double>> first;
    const double start = solver.dense().start, end = solver.time();
    for (int corner = 0; corner < static_cast<int>(body_.corners.size()); ++corner) {
      if (isClosed(corner)) {
        continue;
      }
      const auto gap = [&](double t) {
        const Vector<6> y = state(solver.dense().at(t));
        return y[1] + arm(corner, y[2]).y;
      };
      // The steps are short against a turn of the body: a gap has one minimum at most in a half step.
      double low = start, atLow = std::max(gap(start), 0.0);
      for (int part = 1; part <= 2; ++part) {
        const double high = part == 2 ? end : (start + end) / 2, atHigh = gap(high);
        if (atHigh < 0 && (!first || low < first->second)) {
          const double t = atLow <= 0 ? low : root(gap, low, high, atLow, atHigh);
          if (!first || t < first->second) {
            first = {corner, t};
          }
          break;
        }
        low = high;
        atLow = atHigh;
      }
    }
    return first;
  }

  [[nodiscard]] bool isClosed(int corner) const {
    return (closedCount_ > 0 && closed_[0] == corner) || (closedCount_ > 1 && closed_[1] == corner);
  }

  // Refines an event's time with the full order of the method: Newton steps on the function's value at re-computed steps.
  template <class Solver, class Value> double refine(const Solver &solver, double time, Value value) const {
    const double start = solver.dense().start;
    for (int iteration = 0; iteration < 2; ++iteration) {
      const auto [f, df] = value(solver.restep(time - start));
      time -= f / df;
    }
    return time;
  }

  [[nodiscard]] double longestStep() const { return 0.4 / std::max(std::abs(y_[5]), 0.5); }

  void fly() {
    const auto rhs = [&](const Vector<6> &s) { return Vector<6>{s[3], s[4], s[5], 0, -body_.g, 0}; };
    DormandPrince<6, decltype(rhs)> solver(rhs, time_, y_, 0.1, tolerance_);
    const double longest = longestStep();
    const auto full = [](const Vector<6> &s) { return s; };
    while (solver.time() < body_.end) {
      solver.advance(body_.end, longest);
      if (const auto touch = firstTouch(solver, full)) {
        const double start = solver.dense().start;
        time_ = refine(solver, touch->second, [&](const Vector<6> &s) {
          const Arm r = arm(touch->first, s[2]);
          return std::pair(s[1] + r.y, s[4] + s[5] * r.x);
        });
        sample(time_, [&](double t) { return solver.dense().at(t); });
        y_ = solver.restep(time_ - start);
        impact(touch->first);
        return;
      }
      sample(solver.time(), [&](double t) { return solver.dense().at(t); });
    }
    time_ = body_.end;
    y_ = solver.state();
  }

  // On one corner the state is (x, phi, vx, w); height and its rate follow from the contact.
  [[nodiscard]] Vector<6> onCorner(int corner, const Vector<4> &s) const {
    const Arm r = arm(corner, s[1]);
    return {s[0], -r.y, s[1], s[2], -r.x * s[3], s[3]};
  }

  // Normal force of the sliding corner: gap'' = 0, that is normal (1/m + rx (rx + mu s ry) / J) = g + w^2 ry.
  [[nodiscard]] double cornerForce(int corner, double phi, double w, double direction) const {
    const Arm r = arm(corner, phi);
    return (body_.g + w * w * r.y) / (1 / body_.mass + r.x * (r.x + body_.mu * direction * r.y) / body_.inertia);
  }

  void slideOnCorner() {
    const int corner = closed_[0];
    const double slip = y_[3] - arm(corner, y_[2]).y * y_[5];
    const double direction = slip > 0 ? 1 : -1;
    const auto rhs = [&](const Vector<4> &s) {
      const Arm r = arm(corner, s[1]);
      const double normal = cornerForce(corner, s[1], s[3], direction), friction = -body_.mu * direction * normal;
      return Vector<4>{s[2], s[3], friction / body_.mass, (r.x * normal - r.y * friction) / body_.inertia};
    };
    DormandPrince<4, decltype(rhs)> solver(rhs, time_, {y_[0], y_[2], y_[3], y_[5]}, 0.02, tolerance_);
    const auto full = [&](const Vector<4> &s) { return onCorner(corner, s); };
    while (solver.time() < body_.end) {
      solver.advance(body_.end, longestStep());
      const Vector<4> &s = solver.state();
      assert((s[2] - arm(corner, s[1]).y * s[3]) * direction > 0 && cornerForce(corner, s[1], s[3], direction) > 0);
      if (const auto touch = firstTouch(solver, full)) {
        const double start = solver.dense().start;
        time_ = refine(solver, touch->second, [&](const Vector<4> &at) {
          const Vector<6> y = full(at);
          const Arm r = arm(touch->first, y[2]);
          return std::pair(y[1] + r.y, y[4] + y[5] * r.x);
        });
        sample(time_, [&](double t) { return full(solver.dense().at(t)); });
        y_ = full(solver.restep(time_ - start));
        impact(touch->first);
        return;
      }
      sample(solver.time(), [&](double t) { return full(solver.dense().at(t)); });
      y_ = full(s);
    }
    time_ = body_.end;
  }

  // On a face: x'' = -mu g s until the body stops; it then rests.
  void slideOnFace() {
    const double direction = y_[3] > 0 ? 1 : -1;
    const auto rhs = [&](const Vector<2> &s) { return Vector<2>{s[1], -body_.mu * body_.g * direction}; };
    DormandPrince<2, decltype(rhs)> solver(rhs, time_, {y_[0], y_[3]}, 0.1, tolerance_);
    const auto full = [&](const Vector<2> &s) { return Vector<6>{s[0], y_[1], y_[2], s[1], 0, 0}; };
    while (solver.time() < body_.end) {
      solver.advance(body_.end, body_.end);
      if (solver.state()[1] * direction < 0) {
        const auto velocity = [&](double t) { return solver.dense().at(t)[1]; };
        time_ = root(velocity, solver.dense().start, solver.time(), solver.stepStart()[1], solver.state()[1]);
        sample(time_, [&](double t) { return full(solver.dense().at(t)); });
        y_ = full(solver.restep(time_ - solver.dense().start));
        y_[3] = 0;
        record(-1);
        time_ = body_.end;
        return;
      }
      sample(solver.time(), [&](double t) { return full(solver.dense().at(t)); });
    }
    y_ = full(solver.state());
    time_ = body_.end;
  }

  // Change of the velocity per unit of normal impulse at a corner whose friction is `friction` per unit.
  [[nodiscard]] std::array<double, 3> response(const Arm &r, double friction) const {
    return {friction / body_.mass, 1 / body_.mass, (r.x - r.y * friction) / body_.inertia};
  }

  // Friction per unit of normal impulse: slip, or what keeps the corner from slipping, as far as the cone allows.
  [[nodiscard]] double impulseRatio(const Arm &r, double slip) const {
    if (std::abs(slip) > kTiny) {
      return slip > 0 ? -body_.mu : body_.mu;
    }
    const double tangential = 1 / body_.mass + r.y * r.y / body_.inertia, coupling = -r.x * r.y / body_.inertia;
    return std::clamp(-coupling / tangential, -body_.mu, body_.mu);
  }

  [[nodiscard]] double approach(const Arm &r) const { return y_[4] + y_[5] * r.x; }
  [[nodiscard]] double slip(const Arm &r) const { return y_[3] - y_[5] * r.y; }

  // Corner `hit` and the corner that is closed already: a piecewise linear path of the velocity until no corner approaches the floor.
  void impact(int hit) {
    const int other = closedCount_ > 0 ? closed_[0] : -1;
    const Arm a = arm(hit, y_[2]), b = other >= 0 ? arm(other, y_[2]) : Arm{};
    bool held = false;
    while (approach(a) < -kTiny) {
      const double slipA = slip(a), slipB = slip(b);
      std::array<double, 3> change = response(a, impulseRatio(a, slipA));
      held = false;
      if (other >= 0 && approach(b) < kTiny) {
        const std::array<double, 3> reaction = response(b, impulseRatio(b, slipB));
        const double approachRate = change[1] + change[2] * b.x, push = -approachRate / (reaction[1] + reaction[2] * b.x);
        if (push > 0) {
          assert(push < 1);  // it would be pressed in again otherwise
          held = true;
          for (int i = 0; i < 3; ++i) {
            change[i] += push * reaction[i];
          }
        }
      }
      double impulse = -approach(a) / (change[1] + change[2] * a.x);
      assert(impulse > 0);
      const double rateA = change[0] - change[2] * a.y;
      if (std::abs(slipA) > kTiny && rateA * slipA < 0) {
        impulse = std::min(impulse, -slipA / rateA);
      }
      for (int i = 0; i < 3; ++i) {
        y_[3 + i] += impulse * change[i];
      }
    }
    closedCount_ = 0;
    if (other >= 0 && held) {
      closed_[closedCount_++] = other;
      y_[4] = y_[5] = 0;
    }
    if (staysClosed(hit, a)) {
      closed_[closedCount_++] = hit;
    }
    record(hit);
  }

  // Whether the corner just hit carries load (a second one on the same face always does here).
  [[nodiscard]] bool staysClosed(int corner, const Arm &a) const {
    return closedCount_ > 0 || cornerForce(corner, y_[2], y_[5], slip(a) > 0 ? 1 : -1) > 0;
  }

  const PlanarBody &body_;
  double tolerance_, time_ = 0;
  Vector<6> y_{};
  std::array<int, 2> closed_{};
  int closedCount_ = 0;
  BodyResult result_;
  std::span<const double> grid_;
  std::vector<Vector<6>> *samples_;
  std::size_t next_ = 0;
};

}  // namespace

PlanarBody fallingRod() {
  PlanarBody rod{.mass = 1, .inertia = 1.0 / 12, .mu = 0.3, .corners = {{-0.5, 0}, {0.5, 0}}, .end = 1.5};
  const double quarter = std::acos(-1.0) / 4;
  rod.position = {0, 0.5 * std::sin(quarter) + 0.5, quarter};
  rod.velocity = {2, 0, 0};
  return rod;
}

PlanarBody fallingBox() {
  PlanarBody box{.mass = 1, .inertia = 1.36 / 12, .mu = 0.2, .corners = {{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}}, .end = 2};
  box.position = {0, 1, 0.9};
  box.velocity = {3, 0, 4};
  return box;
}

BodyResult simulate(const PlanarBody &body, double tolerance, std::span<const double> grid, std::vector<Vector<6>> *samples) {
  return Simulation(body, tolerance, grid, samples).run();
}

}  // namespace tf::hand_written
