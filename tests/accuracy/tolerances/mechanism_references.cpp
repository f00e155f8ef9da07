// Mechanisms with planar contacts: every mode tried after every event (ContactReference), and closed forms.
#include "tests/accuracy/support/contact_reference.h"
#include "tests/accuracy/tolerances/references.h"

#include <cmath>
#include <stdexcept>

namespace tf::test {

namespace {

template <class System>
Reference solved(const System &system, const State<2 * System::size> &start, double end, int count, Number step,
                 std::vector<std::string> variables) {
  const std::vector<double> times = uniformTimes(end, count);
  const auto solution = ContactReference<System>(system, start, times, 60, step).run();
  if (solution.validUntil < end)
    throw std::runtime_error("the reference solution ends at " + std::to_string(static_cast<double>(solution.validUntil)));
  Reference reference{.variables = std::move(variables)};
  for (std::size_t i = 0; i < times.size(); ++i)
    reference.samples.push_back({times[i], std::vector<double>(solution.samples[i].begin(), solution.samples[i].end())});
  for (const Number time : solution.eventTimes)
    reference.addEvent(time, TF_EVENT_COUNT);
  return reference;
}

// Angles from the vertical; both joints may touch a wall on the right.
class DoublePendulum {
public:
  static constexpr int size = 2;
  using Vector = Eigen::Matrix<Number, 2, 1>;

  [[nodiscard]] int count() const { return 2; }
  [[nodiscard]] Eigen::Matrix<Number, 2, 2> mass(const State<4> &y) const {
    const Number coupling = kCoupling * std::cos(y[0] - y[1]);
    Eigen::Matrix<Number, 2, 2> M;
    M << m1 * l1 * l1 / 3 + m2 * l1 * l1, coupling, coupling, m2 * l2 * l2 / 3;
    return M;
  }
  [[nodiscard]] Vector force(const State<4> &y) const {
    const Number twist = kCoupling * std::sin(y[0] - y[1]);
    return {-twist * y[3] * y[3] - g * std::sin(y[0]) * l1 * (m1 / 2 + m2), twist * y[2] * y[2] - g * std::sin(y[1]) * l2 * m2 / 2};
  }
  [[nodiscard]] Number gap(int i, const State<4> &y) const { return 0.4L - l1 * std::sin(y[0]) - (i > 0 ? l2 * std::sin(y[1]) : 0); }
  [[nodiscard]] Vector normalRow(int i, const State<4> &y) const { return {-l1 * std::cos(y[0]), i > 0 ? -l2 * std::cos(y[1]) : 0}; }
  [[nodiscard]] Vector tangentRow(int i, const State<4> &y) const { return {l1 * std::sin(y[0]), i > 0 ? l2 * std::sin(y[1]) : 0}; }
  [[nodiscard]] Number normalBias(int i, const State<4> &y) const {
    return l1 * std::sin(y[0]) * y[2] * y[2] + (i > 0 ? l2 * std::sin(y[1]) * y[3] * y[3] : 0);
  }
  [[nodiscard]] Number tangentBias(int i, const State<4> &y) const {
    return l1 * std::cos(y[0]) * y[2] * y[2] + (i > 0 ? l2 * std::cos(y[1]) * y[3] * y[3] : 0);
  }
  [[nodiscard]] Number friction(int) const { return 0.2L; }
  [[nodiscard]] Number restitution(int) const { return 0; }

private:
  static constexpr Number m1 = 1, m2 = 0.6L, l1 = 1, l2 = 0.8L, kCoupling = m2 * l1 * l2 / 2;
};

// Height of the sleeve, angles of sleeve and woodpecker; contacts: beak, lower and upper edge of the sleeve.
class Woodpecker {
public:
  static constexpr int size = 3;
  using Vector = Eigen::Matrix<Number, 3, 1>;

  [[nodiscard]] int count() const { return 3; }
  [[nodiscard]] Eigen::Matrix<Number, 3, 3> mass(const State<6> &) const {
    Eigen::Matrix<Number, 3, 3> M;
    M << mS + mM, mS * lM, mS * lG, mS * lM, JM + mS * lM * lM, mS * lM * lG, mS * lG, mS * lM * lG, JS + mS * lG * lG;
    return M;
  }
  [[nodiscard]] Vector force(const State<6> &y) const {
    const Number torque = c * (y[2] - y[1]);
    return {-(mS + mM) * g, torque - mS * g * lM, -torque - mS * g * lG};
  }
  [[nodiscard]] Number gap(int i, const State<6> &y) const {
    return i == 0 ? lM + lG - lS - r0 - hS * y[2] : rM - r0 + (i == 1 ? hM : -hM) * y[1];
  }
  [[nodiscard]] Vector normalRow(int i, const State<6> &) const { return i == 0 ? Vector(0, 0, -hS) : Vector(0, i == 1 ? hM : -hM, 0); }
  [[nodiscard]] Vector tangentRow(int i, const State<6> &) const { return i == 0 ? Vector(1, lM, lG - lS) : Vector(1, rM, 0); }
  [[nodiscard]] Number normalBias(int, const State<6> &) const { return 0; }
  [[nodiscard]] Number tangentBias(int, const State<6> &) const { return 0; }
  [[nodiscard]] Number friction(int) const { return 0.3L; }
  [[nodiscard]] Number restitution(int i) const { return i == 0 ? 0.5L : 0; }

  static constexpr Number r0 = 0.0025L, rM = 0.0031L, hM = 0.0058L;

private:
  static constexpr Number mS = 0.0045L, mM = 0.0003L, JS = 7e-7L, JM = 5e-9L, lM = 0.01L, lG = 0.015L, lS = 0.0201L, hS = 0.02L,
                          c = 0.0056L;
};

}  // namespace

Reference doublePendulumReference() {
  return solved(DoublePendulum(), {-1, -0.3L, 0, 0}, 4, 40, 0.005L, {"phi[1]", "phi[2]", "der(phi[1])", "der(phi[2])"});
}

Reference woodpeckerReference() {
  const State<6> start = {0, -(Woodpecker::rM - Woodpecker::r0) / Woodpecker::hM, -0.2788L, -0.3411L, 0, -7.4583L};
  return solved(Woodpecker(), start, 0.6, 50, 1e-4L, {"y", "phiM", "phiS", "der(y)", "der(phiM)", "der(phiS)"});
}

// Constant forces between the events: 12 N and from 1.5 s on −10 N on the middle cart of 1 kg, friction 2 N on each.
Reference threeCartsReference() {
  struct Cart {
    Number x, v, a;
  };
  struct Phase {
    Number start;
    std::array<Cart, 3> carts;
    [[nodiscard]] Cart at(std::size_t i, Number t) const {
      const auto &[x, v, a] = carts[i];
      return {x + v * (t - start) + a * (t - start) * (t - start) / 2, v + a * (t - start), a};
    }
    // The next phase, with other accelerations.
    [[nodiscard]] Phase next(Number t, const std::array<Number, 3> &accelerations) const {
      Phase phase{t, {at(0, t), at(1, t), at(2, t)}};
      for (std::size_t i = 0; i < 3; ++i)
        phase.carts[i].a = accelerations[i];
      return phase;
    }
    void collide(std::size_t i) { carts[i].v = carts[i + 1].v = (carts[i].v + carts[i + 1].v) / 2; }
  };
  Reference reference{.variables = {"x[1]", "x[2]", "x[3]", "der(x[1])", "der(x[2])", "der(x[3])"}};
  std::vector<Phase> phases = {{0, {{{-3, 0, 0}, {0, 0, 10}, {3, 0, 0}}}}};
  const Number hit = std::sqrt(Number(2) / 10);
  phases.push_back(phases.back().next(hit, {0, 4, 4}));
  phases.back().collide(1);
  phases.push_back(phases.back().next(1.5L, {0, -12, -2}));
  const Number stop = 1.5L + phases.back().carts[2].v / 2, turn = 1.5L + phases.back().carts[1].v / 12;
  phases.push_back(phases.back().next(turn, {0, -8, -2}));
  const Number back = turn + std::sqrt((phases.back().carts[1].x + 1) / 4);
  phases.push_back(phases.back().next(back, {-3, -3, -2}));
  phases.back().collide(0);
  phases.push_back(phases.back().next(stop, {-3, -3, 0}));
  phases.back().carts[2].v = 0;
  for (const double t : uniformTimes(5, 49)) {
    const auto after = std::ranges::find_if(phases, [&](const Phase &phase) { return phase.start > t; });
    const Phase &phase = *std::prev(after);
    reference.add(t, phase.at(0, t).x, phase.at(1, t).x, phase.at(2, t).x, phase.at(0, t).v, phase.at(1, t).v, phase.at(2, t).v);
  }
  reference.addEvent(hit, TF_EVENT_IMPACT);
  reference.addEvent(1.5L, TF_EVENT_OPENING);
  reference.addEvent(turn, TF_EVENT_SLIP_REVERSAL);
  reference.addEvent(back, TF_EVENT_IMPACT);
  reference.addEvent(stop, TF_EVENT_STICK);
  return reference;
}

}  // namespace tf::test
