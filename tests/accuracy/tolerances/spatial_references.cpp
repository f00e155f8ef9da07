// Bodies in space and friction of two components.
#include "tests/accuracy/tolerances/references.h"

#include <Eigen/Dense>
#include <cmath>
#include <tuple>

namespace tf::test {

namespace {

using Vector3 = Eigen::Matrix<Number, 3, 1>;
using Quaternion = Eigen::Quaternion<Number>;

Quaternion turn(const Vector3 &axis, Number angle) { return Quaternion(Eigen::AngleAxis<Number>(angle, axis)); }

// Of an angular velocity in space.
State<4> quaternionRate(const Vector3 &w, const Quaternion &q) {
  const Quaternion rate = Quaternion(0, w[0] / 2, w[1] / 2, w[2] / 2) * q;
  return {rate.w(), rate.x(), rate.y(), rate.z()};
}

}  // namespace

// The orientation is a turn about the vertical at the precession's rate, the tilt, and a turn about the axis.
Reference spinningTopReference() {
  const Number m = 0.5L, l = 0.06L, J1 = 4e-4L, J3 = 6e-4L, tilt = 0.5L, precession = 8;
  const Number spin = ((J1 + m * l * l) * precession * precession * std::cos(tilt) + m * g * l) / (J3 * precession);
  const Number own = spin - precession * std::cos(tilt);
  Reference reference{.variables = {"R.q[1]", "R.q[2]", "R.q[3]", "R.q[4]", "R.w[1]", "R.w[2]", "R.w[3]"}};
  for (const double t : uniformTimes(5, 20)) {
    const Quaternion q = turn(Vector3::UnitZ(), precession * t) * turn(Vector3::UnitX(), tilt) * turn(Vector3::UnitZ(), own * t);
    // The quaternion that is continuous from the start: both half angles grow.
    const Number half = (precession + own) * t / 2, sign = std::cos(tilt / 2) * std::cos(half) * q.w() < 0 ? -1 : 1;
    reference.add(t, sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z(), precession * std::sin(tilt) * std::sin(own * t),
                  precession * std::sin(tilt) * std::cos(own * t), spin);
  }
  return reference;
}

// A ball of inertia 2/5 m R²: friction along a constant direction takes 7/2 of its impulse from the slip of the lowest point.
Reference backspinBallReference() {
  const Number R = 0.03L, mu = 0.2L, fall = std::sqrt(2 * 0.05L / g);
  struct Phase {
    Number start;
    Vector3 p, v, a, w, turn;  // turn: angular acceleration
    [[nodiscard]] Vector3 position(Number t) const { return p + (t - start) * v + (t - start) * (t - start) / 2 * a; }
    [[nodiscard]] Vector3 velocity(Number t) const { return v + (t - start) * a; }
    [[nodiscard]] Vector3 spin(Number t) const { return w + (t - start) * turn; }
  };
  const auto slip = [&](const Vector3 &v, const Vector3 &w) { return Vector3(v[0] - R * w[1], v[1] + R * w[0], 0); };
  const auto turning = [&](const Vector3 &push) { return Vector3(Vector3(0, 0, -R).cross(push) / (0.4L * R * R)); };
  std::vector<Phase> phases = {{0, {0, 0, R + 0.05L}, {1, 0, 0}, {0, 0, -g}, {40, -100, 20}, {0, 0, 0}}};
  Vector3 p = phases[0].position(fall), v(1, 0, 0), w = phases[0].w;
  p[2] = R;
  const Vector3 direction = slip(v, w).normalized(), impulse = -mu * g * fall * direction;
  v += impulse;
  w += turning(impulse);
  const Number stop = fall + slip(v, w).norm() / (3.5L * mu * g);
  phases.push_back({fall, p, v, -mu * g * direction, w, turning(-mu * g * direction)});
  phases.push_back({stop, phases[1].position(stop), phases[1].velocity(stop), {0, 0, 0}, phases[1].spin(stop), {0, 0, 0}});
  const auto phaseAt = [&](Number t) -> const Phase & { return phases[t < fall ? 0 : t < stop ? 1 : 2]; };
  Reference reference{.variables = {"p[1]", "p[2]", "p[3]", "der(p[1])", "der(p[2])", "der(p[3])", "Q.q[1]", "Q.q[2]", "Q.q[3]", "Q.q[4]",
                                    "Q.w[1]", "Q.w[2]", "Q.w[3]"}};
  const auto record = [&](Number t, const State<4> &y) {
    const Phase &phase = phaseAt(t);
    const Vector3 x = phase.position(t), rate = phase.velocity(t), body = Quaternion(y[0], y[1], y[2], y[3]).inverse() * phase.spin(t);
    reference.add(t, x[0], x[1], x[2], rate[0], rate[1], rate[2], y[0], y[1], y[2], y[3], body[0], body[1], body[2]);
  };
  Recorder<4, decltype(record)> run(uniformTimes(3, 30), record);
  run.state = {1, 0, 0, 0};
  for (const Number end : {fall, stop, Number(4)}) {
    const Phase &phase = phaseAt(run.time);
    const auto rhs = [&](Number t, const State<4> &y) { return quaternionRate(phase.spin(t), Quaternion(y[0], y[1], y[2], y[3])); };
    run.advance(rhs, [&](Number t, const State<4> &) { return end - t; });
  }
  reference.addEvent(fall, TF_EVENT_IMPACT);
  reference.addEvent(stop, TF_EVENT_STICK);
  return reference;
}

// Position of the centre of mass, orientation, velocity, angular velocity in the body; the normal force holds the gap's acceleration at
// zero.
Reference tippeTopReference() {
  const Number m = 0.006L, R = 0.015L, a = 0.003L, mu = 0.3L, patch = 5e-4L, tilt = 0.1L;
  const Vector3 J(8e-7L, 8e-7L, 7e-7L);
  const auto rhs = [&](Number, const State<13> &y) {
    const Quaternion q(y[3], y[4], y[5], y[6]);
    const Vector3 v(y[7], y[8], y[9]), own(y[10], y[11], y[12]), w = q * own, axis = q * Vector3::UnitZ();
    const Vector3 arm = a * axis - R * Vector3::UnitZ(), speed = v + w.cross(arm);
    const Number resistance = mu * m * g / std::sqrt(speed[0] * speed[0] + speed[1] * speed[1] + patch * patch * w[2] * w[2]);
    const auto accelerations = [&](Number normal) {
      const Vector3 force(-resistance * speed[0], -resistance * speed[1], normal);
      const Vector3 turn = (q.inverse() * arm.cross(force) - own.cross(J.cwiseProduct(own))).cwiseQuotient(J);
      const Vector3 acceleration = force / m - g * Vector3::UnitZ();
      const Number gap = acceleration[2] + a * ((q * turn).cross(axis) + w.cross(w.cross(axis)))[2];
      return std::tuple<Vector3, Vector3, Number>(acceleration, turn, gap);
    };
    const Number free = std::get<2>(accelerations(0)), unit = std::get<2>(accelerations(1)) - free;
    const auto [acceleration, turn, gap] = accelerations(-free / unit);
    const State<4> rate = quaternionRate(w, q);
    return State<13>{v[0],    v[1],    v[2],   rate[0], rate[1], rate[2], rate[3], acceleration[0], acceleration[1], acceleration[2],
                     turn[0], turn[1], turn[2]};
  };
  Reference reference{.variables = {"p[1]", "p[2]", "p[3]", "Q.q[1]", "Q.q[2]", "Q.q[3]", "Q.q[4]", "der(p[1])", "der(p[2])", "der(p[3])",
                                    "Q.w[1]", "Q.w[2]", "Q.w[3]", "jellett"}};
  const Number jellett = J[2] * 180 * (R * std::cos(tilt) - a);
  const auto record = [&](Number t, const State<13> &y) {
    Sample &sample = reference.samples.emplace_back();
    sample.time = static_cast<double>(t);
    sample.values.assign(y.begin(), y.end());
    sample.values.push_back(static_cast<double>(jellett));
  };
  Recorder<13, decltype(record)> run(uniformTimes(3, 12), record);
  run.state = {0, 0, R - a * std::cos(tilt), std::cos(tilt / 2), std::sin(tilt / 2), 0, 0, 0, 0, 0, 0, 0, 180};
  run.advance(rhs, [](Number, const State<13> &) { return Number(1); }, 0.001L);
  return reference;
}

namespace {

// The table of four feet: pull and twist grow as t·b, loads as 5 ± t/4 plus any multiple of (1, −1, 1, −1).
struct Table {
  static constexpr Number mu = 0.5L;
  static constexpr Number x[4] = {0.5L, -0.5L, -0.5L, 0.5L}, y[4] = {0.4L, 0.4L, -0.4L, -0.4L}, null[4] = {1, -1, 1, -1};
  const Vector3 b{3, 4, 0.8L}, inertia{2, 2, 0.4L};

  [[nodiscard]] static Eigen::Matrix<Number, 2, 3> slipRows(int i) {
    Eigen::Matrix<Number, 2, 3> rows;
    rows << 1, 0, -y[i], 0, 1, x[i];
    return rows;
  }
  [[nodiscard]] static Number load(int i, Number t, Number s) { return 5 + t * x[i] / 2 + s * null[i]; }
  // Generalised friction force against a motion in the direction of the twist.
  [[nodiscard]] static Vector3 friction(Number t, Number s, const Vector3 &twist) {
    Vector3 force = Vector3::Zero();
    for (int i = 0; i < 4; ++i)
      force -= mu * load(i, t, s) * slipRows(i).transpose() * (slipRows(i) * twist).normalized();
    return force;
  }
  [[nodiscard]] Vector3 acceleration(Number t, const Vector3 &twist) const {
    return (t * b + friction(t, 0, twist)).cwiseQuotient(inertia);
  }
};

// Newton's method with differences.
template <int N, class Function> Eigen::Matrix<Number, N, 1> root(const Function &function, Eigen::Matrix<Number, N, 1> x) {
  for (int iteration = 0; iteration < 60; ++iteration) {
    Eigen::Matrix<Number, N, N> jacobian;
    for (int j = 0; j < N; ++j) {
      Eigen::Matrix<Number, N, 1> high = x, low = x;
      high[j] += 1e-6L;
      low[j] -= 1e-6L;
      jacobian.col(j) = (function(high) - function(low)) / 2e-6L;
    }
    Eigen::Matrix<Number, N, 1> step = jacobian.partialPivLu().solve(function(x));
    const Number largest = step.template lpNorm<Eigen::Infinity>();
    x -= step * std::min<Number>(1, Number(0.3L) / largest);
    if (largest < 1e-18L)
      break;
  }
  return x;
}

}  // namespace

// The table stays while any loads hold it: at the limit friction balances the pull in the direction of a twist. The loads that hold longest
// leave nothing on the second foot: with more on it, friction could do less work against the twist. The table starts along an acceleration
// that its own friction, with the least loads, allows.
Reference draggedTableReference() {
  const Table table;
  using Vector5 = Eigen::Matrix<Number, 5, 1>;
  const auto limit = [&](const Vector5 &u) {
    const Vector3 twist = u.head<3>();
    Vector5 residual;
    residual.head<3>() = u[4] * table.b + Table::friction(u[4], u[3], twist);
    residual[3] = Table::load(1, u[4], u[3]);
    residual[4] = table.b.dot(twist) - 1;
    return residual;
  };
  Vector5 guess;
  guess << 0.12L, 0.16L, 0.1L, 4.5L, 2;
  const Vector5 held = root<5>(limit, guess);
  const Number start = held[4];
  const Vector3 first = root<3>([&](const Vector3 &a) -> Vector3 { return a - table.acceleration(start, a); }, Vector3(held.head<3>()));
  Reference reference{.variables = {"q[1]", "q[2]", "psi", "der(q[1])", "der(q[2])", "der(psi)"}};
  reference.addEvent(start, TF_EVENT_SLIP);
  // With v = (t − start) V and s = ln(t − start): dV/ds = a(V) − V, from the equilibrium V = a(V) at s = −∞.
  std::vector<double> times, logarithms;
  for (const double t : uniformTimes(3, 30)) {
    if (t < start) {
      reference.add(t, 0, 0, 0, 0, 0, 0);
    } else {
      times.push_back(t);
      logarithms.push_back(static_cast<double>(std::log(t - start)));
    }
  }
  std::size_t next = 0;
  const auto record = [&](Number s, const State<6> &y) {
    const Number elapsed = std::exp(s);
    reference.add(times[next++], y[3], y[4], y[5], elapsed * y[0], elapsed * y[1], elapsed * y[2]);
  };
  Recorder<6, decltype(record)> run(logarithms, record);
  run.time = -40;
  run.state = {first[0], first[1], first[2], 0, 0, 0};
  const auto rhs = [&](Number s, const State<6> &y) {
    const Vector3 V(y[0], y[1], y[2]), change = table.acceleration(start + std::exp(s), V) - V;
    const Number square = std::exp(2 * s);
    return State<6>{change[0], change[1], change[2], square * y[0], square * y[1], square * y[2]};
  };
  run.advance(rhs, [](Number, const State<6> &) { return Number(1); }, 0.05L);
  return reference;
}

}  // namespace tf::test
