// A box whose corners slip on a rough floor, event-driven in long double: the slipping corners' normal forces hold their gaps'
// accelerations at zero; in an impact the velocities follow the pushes of the approaching corners, whose friction turns with the slip,
// while time stands still. It goes as far as no corner sticks and no corner is held by the pushes of others: until the box falls on its
// face.
#include "tests/accuracy/tolerances/references.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace tf::test {

namespace {

using Vector3 = Eigen::Matrix<Number, 3, 1>;
using Velocity = Eigen::Matrix<Number, 6, 1>;  // of the centre; angular, in the box
using Quaternion = Eigen::Quaternion<Number>;
using BoxState = State<13>;  // position, quaternion, velocity

class TumblingBox {
public:
  explicit TumblingBox(std::vector<double> grid) : grid_(std::move(grid)) {
    Quaternion q(0.9L, 0.2L, -0.3L, 0.1L);
    q.normalize();
    y_ = {0, 0, 0.8L, q.w(), q.x(), q.y(), q.z(), 8, 0.3L, 0, 0.5L, 10, 2};
  }

  Reference run() {
    const auto rhs = [&](Number, const BoxState &y) { return slope(y); };
    const auto stop = [&](Number, const BoxState &y) { return distance(y); };
    for (const double time : grid_) {
      while (gaussUntil<13>(rhs, stop, t_, y_, static_cast<Number>(time), 0.002L))
        passEvent();
      reference_.samples.push_back({time, std::vector<double>(y_.begin(), y_.end())});
    }
    return std::move(reference_);
  }

private:
  static constexpr Number g = 9.81L, mu = 0.3L, kZero = 1e-10L;
  static constexpr int kCorners = 8;

  [[nodiscard]] static Quaternion orientation(const BoxState &y) { return {y[3], y[4], y[5], y[6]}; }
  [[nodiscard]] static Velocity velocity(const BoxState &y) {
    Velocity u;
    u << y[7], y[8], y[9], y[10], y[11], y[12];
    return u;
  }
  [[nodiscard]] static Vector3 corner(int i) {
    const Number x = i % 4 == 0 || i % 4 == 3 ? -0.3L : 0.3L, y = i % 4 < 2 ? -0.2L : 0.2L, z = i < 4 ? -0.15L : 0.15L;
    return {x, y, z};
  }
  [[nodiscard]] static Vector3 arm(int i, const BoxState &y) { return orientation(y) * corner(i); }
  [[nodiscard]] static Number gap(int i, const BoxState &y) { return y[2] + arm(i, y)[2]; }
  // The corner's velocity in a direction is row·u.
  [[nodiscard]] static Velocity row(int i, const BoxState &y, const Vector3 &direction) {
    Velocity result;
    result << direction, orientation(y).inverse() * arm(i, y).cross(direction);
    return result;
  }
  [[nodiscard]] static Number rate(int i, const BoxState &y, const Velocity &u) { return row(i, y, Vector3::UnitZ()).dot(u); }
  [[nodiscard]] Velocity divideByMass(const Velocity &force) const { return force.cwiseQuotient(mass_); }
  // Force per unit of normal force, with friction against the slip.
  [[nodiscard]] static Velocity push(int i, const BoxState &y, const Velocity &u) {
    const Vector3 slip(row(i, y, Vector3::UnitX()).dot(u), row(i, y, Vector3::UnitY()).dot(u), 0);
    if (slip.norm() < 1e-3L)
      throw std::runtime_error("a corner of the box stops");
    return row(i, y, Vector3::UnitZ() - mu * slip.normalized());
  }
  [[nodiscard]] Velocity freeAcceleration(const BoxState &y) const {
    const Vector3 w(y[10], y[11], y[12]), J = mass_.tail<3>();
    Velocity a;
    a << 0, 0, -g, -w.cross(J.cwiseProduct(w)).cwiseQuotient(J);
    return a;
  }
  // Acceleration of the gap with these accelerations.
  [[nodiscard]] static Number gapAcceleration(int i, const BoxState &y, const Velocity &a) {
    const Vector3 w = orientation(y) * Vector3(y[10], y[11], y[12]);
    return rate(i, y, a) + w.cross(w.cross(arm(i, y)))[2];
  }

  struct Motion {
    Velocity acceleration;
    std::vector<Number> forces;  // of the slipping corners
  };
  [[nodiscard]] Motion motion(const BoxState &y, const std::vector<int> &slipping) const {
    const auto n = static_cast<Eigen::Index>(slipping.size());
    Motion result{freeAcceleration(y), {}};
    Eigen::Matrix<Number, 6, Eigen::Dynamic> effects(6, n);
    Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic> system(n, n);
    Eigen::Matrix<Number, Eigen::Dynamic, 1> right(n);
    for (Eigen::Index k = 0; k < n; ++k)
      effects.col(k) = divideByMass(push(slipping[static_cast<std::size_t>(k)], y, velocity(y)));
    for (Eigen::Index k = 0; k < n; ++k) {
      const int i = slipping[static_cast<std::size_t>(k)];
      right[k] = -gapAcceleration(i, y, result.acceleration);
      for (Eigen::Index l = 0; l < n; ++l)
        system(k, l) = rate(i, y, effects.col(l));
    }
    if (n > 0) {
      const Eigen::Matrix<Number, Eigen::Dynamic, 1> forces = system.partialPivLu().solve(right);
      result.acceleration += effects * forces;
      result.forces.assign(forces.begin(), forces.end());
    }
    return result;
  }

  [[nodiscard]] BoxState slope(const BoxState &y) const {
    const Velocity a = motion(y, slipping_).acceleration;
    const Quaternion rate = orientation(y) * Quaternion(0, y[10] / 2, y[11] / 2, y[12] / 2);
    return {y[7], y[8], y[9], rate.w(), rate.x(), rate.y(), rate.z(), a[0], a[1], a[2], a[3], a[4], a[5]};
  }

  [[nodiscard]] bool isSlipping(int i) const { return std::ranges::find(slipping_, i) != slipping_.end(); }

  // Least distance to an event, negative after one.
  [[nodiscard]] Number distance(const BoxState &y) const {
    Number least = 1;
    for (int i = 0; i < kCorners; ++i)
      if (!isSlipping(i) && (gap(i, y) > 0 || rate(i, y, velocity(y)) < 0))
        least = std::min(least, gap(i, y));
    for (const Number force : motion(y, slipping_).forces)
      least = std::min(least, force);
    return least;
  }

  void passEvent() {
    reference_.addEvent(t_, TF_EVENT_COUNT);
    std::vector<int> touching;
    for (int i = 0; i < kCorners; ++i)
      if (gap(i, y_) < kZero)
        touching.push_back(i);
    collide(touching);
    std::erase_if(touching, [&](int i) { return rate(i, y_, velocity(y_)) > kZero; });
    choose(touching);
  }

  // Approaching corners push until none approaches. State<6>: the velocity over numerical time.
  void collide(const std::vector<int> &touching) {
    const auto velocityOf = [](const State<6> &s) { return Velocity(Eigen::Map<const Velocity>(s.data())); };
    State<6> s{y_[7], y_[8], y_[9], y_[10], y_[11], y_[12]};
    for (int phase = 0; phase < 20; ++phase) {
      std::vector<int> pushing, others;
      for (const int i : touching)
        (rate(i, y_, velocityOf(s)) < -kZero ? pushing : others).push_back(i);
      if (pushing.empty())
        break;
      const auto rhs = [&](Number, const State<6> &state) {
        Velocity change = Velocity::Zero();
        for (const int i : pushing)
          change += divideByMass(push(i, y_, velocityOf(state)));
        State<6> slope;
        std::copy_n(change.data(), 6, slope.begin());
        return slope;
      };
      const State<6> start = rhs(0, s);
      for (const int i : others)
        if (rate(i, y_, velocityOf(s)) < kZero && rate(i, y_, velocityOf(start)) <= 0)
          throw std::runtime_error("a corner of the box is held by the pushes of others");
      const auto stop = [&](Number, const State<6> &state) {
        Number least = 1;
        for (const int i : pushing)
          least = std::min(least, -rate(i, y_, velocityOf(state)));
        for (const int i : others)
          if (rate(i, y_, velocityOf(s)) > kZero)
            least = std::min(least, rate(i, y_, velocityOf(state)) + kZero);
        return least;
      };
      Number tau = 0;
      if (!gaussUntil<6>(rhs, stop, tau, s, 100, 0.01L))
        throw std::runtime_error("an impact of the box does not end");
    }
    std::copy_n(s.begin(), 6, y_.begin() + 7);
  }

  // Of the corners that may close, those whose forces are positive while the others open.
  void choose(const std::vector<int> &closing) {
    std::optional<std::vector<int>> found;
    for (unsigned subset = 0; subset < 1u << closing.size(); ++subset) {
      std::vector<int> held, open;
      for (std::size_t k = 0; k < closing.size(); ++k)
        (subset >> k & 1 ? held : open).push_back(closing[k]);
      const Motion candidate = motion(y_, held);
      if (std::ranges::any_of(candidate.forces, [](Number force) { return force <= kZero; }) ||
          std::ranges::any_of(open, [&](int i) { return gapAcceleration(i, y_, candidate.acceleration) < 0; }))
        continue;
      if (found)
        throw std::runtime_error("the motion of the box is not unique");
      found = held;
    }
    if (!found)
      throw std::runtime_error("the box has no motion");
    slipping_ = *found;
  }

  std::vector<double> grid_;
  const Velocity mass_{{1, 1, 1, (0.04L + 0.0225L) / 3, (0.09L + 0.0225L) / 3, (0.09L + 0.04L) / 3}};
  Number t_ = 0;
  BoxState y_{};
  std::vector<int> slipping_;
  Reference reference_{.variables = {"p[1]", "p[2]", "p[3]", "Q.q[1]", "Q.q[2]", "Q.q[3]", "Q.q[4]", "der(p[1])", "der(p[2])", "der(p[3])",
                                     "Q.w[1]", "Q.w[2]", "Q.w[3]"}};
};

}  // namespace

Reference tumblingBoxReference() { return TumblingBox(uniformTimes(1.166, 58)).run(); }

}  // namespace tf::test
