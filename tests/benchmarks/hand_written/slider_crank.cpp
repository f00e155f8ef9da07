#include "tests/benchmarks/hand_written/slider_crank.h"

#include <cassert>
#include <cmath>
#include <optional>

namespace tf::hand_written {

namespace {

using Row = std::array<double, 3>;

// One corner: gap, its rate, slip, the rows J_n and J_t, and the velocity terms of gap'' and slip'.
struct CornerTerms {
  double gap, gapRate, slip;
  Row normal, tangent;
  double bias;
};

// What all functions of the positions are made of.
struct Pose {
  double s1, c1, s2, c2, s3, c3;
};

struct Zero {
  double time;
  int guard;
};

class Simulation {
public:
  Simulation(const SliderCrank &crank, double tolerance) : crank_(crank), tolerance_(tolerance), y_(crank.start) {
    const SliderCrank &k = crank;
    m11_ = k.j1 + k.m1 * k.l1 * k.l1 / 4 + (k.m2 + k.m3) * k.l1 * k.l1;
    m22_ = k.j2 + k.m2 * k.l2 * k.l2 / 4 + k.m3 * k.l2 * k.l2;
    coupling_ = (k.m2 / 2 + k.m3) * k.l1 * k.l2;
    weight1_ = k.g * k.l1 * (k.m1 / 2 + k.m2 + k.m3);
    weight2_ = k.g * k.l2 * (k.m2 / 2 + k.m3);
  }

  SliderCrankResult run() {
    while (time_ < crank_.end) {
      move();
    }
    return {y_, events_};
  }

private:
  static Pose pose(const Vector<6> &y) {
    return {std::sin(y[0]), std::cos(y[0]), std::sin(y[1]), std::cos(y[1]), std::sin(y[2]), std::cos(y[2])};
  }

  // wall: 1 the upper, -1 the lower; side: -1 the left corner, 1 the right one.
  [[nodiscard]] CornerTerms corner(const Pose &p, const Vector<6> &y, int wall, int side) const {
    const double a = side * crank_.a, b = wall * crank_.b, l1 = crank_.l1, l2 = crank_.l2;
    const double w1 = y[3], w2 = y[4], w3 = y[5];
    const Row up = {l1 * p.c1, l2 * p.c2, a * p.c3 - b * p.s3};
    const Row along = {-l1 * p.s1, -l2 * p.s2, -a * p.s3 - b * p.c3};
    const double height = l1 * p.s1 + l2 * p.s2 + a * p.s3 + b * p.c3;
    const double rise = up[0] * w1 + up[1] * w2 + up[2] * w3;
    const double centripetal = -(l1 * p.s1 * w1 * w1 + l2 * p.s2 * w2 * w2 + (a * p.s3 + b * p.c3) * w3 * w3);
    return {crank_.d - wall * height,
            -wall * rise,
            along[0] * w1 + along[1] * w2 + along[2] * w3,
            {-wall * up[0], -wall * up[1], -wall * up[2]},
            along,
            -wall * centripetal};
  }

  // M^-1 f
  [[nodiscard]] Row solve(double m12, const Row &f) const {
    const double determinant = m11_ * m22_ - m12 * m12;
    return {(m22_ * f[0] - m12 * f[1]) / determinant, (m11_ * f[1] - m12 * f[0]) / determinant, f[2] / crank_.j3};
  }

  static double dot(const Row &a, const Row &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  // Forces (or impulses) N of the wall's corners with friction against their slips, such that J_n (free + M^-1 (J_n + friction)^T N) =
  // target; `free` becomes the acceleration (or velocity).
  std::array<double, 2> press(const std::array<CornerTerms, 2> &terms, double m12, const std::array<double, 2> &target, Row &free) const {
    std::array<Row, 2> response;
    for (int i = 0; i < 2; ++i) {
      const double friction = -direction_ * crank_.mu;
      Row f{};
      for (int k = 0; k < 3; ++k) {
        f[k] = terms[i].normal[k] + friction * terms[i].tangent[k];
      }
      response[i] = solve(m12, f);
    }
    const double a = dot(terms[0].normal, response[0]), b = dot(terms[0].normal, response[1]);
    const double c = dot(terms[1].normal, response[0]), d = dot(terms[1].normal, response[1]);
    const double r0 = target[0] - dot(terms[0].normal, free), r1 = target[1] - dot(terms[1].normal, free);
    const double determinant = a * d - b * c;
    const std::array<double, 2> force = {(d * r0 - b * r1) / determinant, (a * r1 - c * r0) / determinant};
    for (int k = 0; k < 3; ++k) {
      free[k] += response[0][k] * force[0] + response[1][k] * force[1];
    }
    return force;
  }

  [[nodiscard]] double m12(const Pose &p) const { return coupling_ * (p.c1 * p.c2 + p.s1 * p.s2); }

  Vector<6> rate(const Vector<6> &y, std::array<double, 2> *force = nullptr) const {
    const Pose p = pose(y);
    const double difference = coupling_ * (p.s1 * p.c2 - p.c1 * p.s2), mass = m12(p);
    Row a = solve(mass, {-difference * y[4] * y[4] - weight1_ * p.c1, difference * y[3] * y[3] - weight2_ * p.c2, 0});
    if (wall_ != 0) {
      const std::array<CornerTerms, 2> terms = {corner(p, y, wall_, -1), corner(p, y, wall_, 1)};
      const auto n = press(terms, mass, {-terms[0].bias, -terms[1].bias}, a);
      if (force != nullptr) {
        *force = n;
      }
    }
    return {y[3], y[4], y[5], a[0], a[1], a[2]};
  }

  // Guards, zero at the end of the mode: in flight the four gaps; on a wall the gaps of the other one, the forces and the slips.
  [[nodiscard]] int guardCount() const { return wall_ == 0 ? 4 : 6; }
  [[nodiscard]] double guard(int k, const Vector<6> &y) const {
    const int side = k % 2 == 0 ? -1 : 1;
    if (wall_ == 0) {
      return corner(pose(y), y, k < 2 ? 1 : -1, side).gap;
    }
    if (k < 2) {
      return corner(pose(y), y, -wall_, side).gap;
    }
    if (k < 4) {
      std::array<double, 2> force{};
      rate(y, &force);
      return force[k - 2];
    }
    return direction_ * corner(pose(y), y, wall_, side).slip;
  }

  // The first zero of a guard in the solver's last step. A gap that has just opened is watched once it is clearly open.
  template <class Solver> std::optional<Zero> firstZero(const Solver &solver) {
    std::optional<Zero> first;
    const double start = solver.dense().start, end = solver.time(), middle = 0.5 * (start + end);
    const Vector<6> atMiddle = solver.dense().at(middle);
    for (int k = 0; k < guardCount(); ++k) {
      double low = start, lowValue = last_[k];
      for (const double high : {middle, end}) {
        const double value = guard(k, high == end ? solver.state() : atMiddle);
        const bool watched = wall_ != 0 || left_ != (k < 2 ? 1 : -1);
        if (watched && value < 0 && lowValue > 0 && (!first || low < first->time)) {
          const double t = root([&](double x) { return guard(k, solver.dense().at(x)); }, low, high, lowValue, value);
          if (!first || t < first->time) {
            first = {t, k};
          }
        }
        if (!watched && high == end && value > 1e-4 * crank_.d) {
          left_ = 0;
        }
        low = high;
        lowValue = value;
      }
      next_[k] = lowValue;
    }
    return first;
  }

  void move() {
    const auto rhs = [this](const Vector<6> &y) { return rate(y); };
    DormandPrince<6, decltype(rhs)> solver(rhs, time_, y_, 1e-4, tolerance_);
    for (int k = 0; k < guardCount(); ++k) {
      last_[k] = guard(k, y_);
    }
    while (solver.time() < crank_.end) {
      solver.advance(crank_.end, 2e-3);
      if (const auto zero = firstZero(solver)) {
        const double start = solver.dense().start;
        double time = zero->time;
        // Newton's method with re-computed steps; the slope is that of the dense output.
        const double h = 1e-6 * (solver.time() - start);
        const double slope = (guard(zero->guard, solver.dense().at(time + h)) - guard(zero->guard, solver.dense().at(time - h))) / (2 * h);
        for (int iteration = 0; iteration < 2; ++iteration) {
          y_ = solver.restep(time - start);
          time -= guard(zero->guard, y_) / slope;
        }
        y_ = solver.restep(time - start);
        time_ = time;
        ++events_;
        change(zero->guard);
        return;
      }
      last_ = next_;
    }
    time_ = crank_.end;
    y_ = solver.state();
  }

  void change(int guard) {
    if (wall_ == 0 || guard < 2) {
      wall_ = wall_ == 0 ? (guard < 2 ? 1 : -1) : -wall_;
      left_ = 0;
      impact();
    } else if (guard < 4) {
      ontoWall();
      left_ = wall_;
      wall_ = 0;
    } else {
      direction_ = -direction_;
    }
  }

  // Both corners hit the wall and stay: their gap rates become zero.
  void impact() {
    const Pose p = pose(y_);
    const std::array<CornerTerms, 2> terms = {corner(p, y_, wall_, -1), corner(p, y_, wall_, 1)};
    direction_ = terms[0].slip > 0 ? 1 : -1;
    Row v = {y_[3], y_[4], y_[5]};
    [[maybe_unused]] const auto impulse = press(terms, m12(p), {0, 0}, v);
    assert(impulse[0] >= 0 && impulse[1] >= 0);
    y_[3] = v[0];
    y_[4] = v[1];
    y_[5] = v[2];
    assert(direction_ * corner(p, y_, wall_, -1).slip > 0);  // friction does not turn inside the impact
  }

  // Takes the drift of the integration out: gaps and their rates are zero.
  void ontoWall() {
    const double friction = direction_;
    direction_ = 0;
    for (const int part : {0, 3}) {
      const Pose p = pose(y_);
      const std::array<CornerTerms, 2> terms = {corner(p, y_, wall_, -1), corner(p, y_, wall_, 1)};
      const bool positions = part == 0;
      Row change{};
      press(terms, m12(p), {-(positions ? terms[0].gap : terms[0].gapRate), -(positions ? terms[1].gap : terms[1].gapRate)}, change);
      for (int k = 0; k < 3; ++k) {
        y_[part + k] += change[k];
      }
    }
    direction_ = friction;
  }

  const SliderCrank &crank_;
  double tolerance_, time_ = 0;
  Vector<6> y_;
  double m11_, m22_, coupling_, weight1_, weight2_;
  int wall_ = 0, left_ = 0;  // the wall that the slider slides on, the wall that it has just left
  double direction_ = 0;     // of the slip
  std::array<double, 6> last_{}, next_{};
  int events_ = 0;
};

}  // namespace

SliderCrankResult simulate(const SliderCrank &crank, double tolerance) { return Simulation(crank, tolerance).run(); }

}  // namespace tf::hand_written
