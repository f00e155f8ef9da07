// Closed forms: particles and balls in gravity, between impacts parabolas.
#include "tests/accuracy/tolerances/references.h"

#include <algorithm>
#include <cmath>

namespace tf::test {

namespace {

const std::vector<std::string> kPlane = {"q[1]", "q[2]", "der(q[1])", "der(q[2])"};

}  // namespace

Reference particleReference() {
  const Number gravity = 10, mu = 0.3L, push = 2, v0 = 1, t1 = std::sqrt(2 / gravity);
  const Number x1 = v0 * t1 + push * t1 * t1 / 2, v1 = v0 + push * t1 - mu * gravity * t1, a = push - mu * gravity, stop = t1 - v1 / a;
  Reference reference{.variables = kPlane};
  for (const double t : uniformTimes(4, 43)) {
    const Number s = std::min<Number>(t, stop) - t1;
    if (t < t1)
      reference.add(t, v0 * t + push * t * t / 2, 1 - gravity * t * t / 2, v0 + push * t, -gravity * t);
    else
      reference.add(t, x1 + v1 * s + a * s * s / 2, 0, t < stop ? v1 + a * s : 0, 0);
  }
  reference.addEvent(t1, TF_EVENT_IMPACT);
  reference.addEvent(stop, TF_EVENT_STICK);
  return reference;
}

Reference liftedParticleReference() {
  const Number mu = 0.6L, push = 7, t1 = std::sqrt(2 / g), lift = 1.5L;
  const Number x1 = push * t1 * t1 / 2, v1 = push * t1 - mu * g * t1, a = push - mu * g;
  // From 1 s on friction falls as mu (g − 2 g (t − 1)).
  const auto slide = [&](Number t) {
    const Number s = t - t1, r = std::max<Number>(0, t - 1);
    return std::pair<Number, Number>{x1 + v1 * s + a * s * s / 2 + mu * g * r * r * r / 3, v1 + a * s + mu * g * r * r};
  };
  const auto [xLift, vLift] = slide(lift);
  Reference reference{.variables = kPlane};
  for (const double t : uniformTimes(3, 30)) {
    const Number s = t - lift;
    if (t < t1)
      reference.add(t, push * t * t / 2, 1 - g * t * t / 2, push * t, -g * t);
    else if (t < lift)
      reference.add(t, slide(t).first, 0, slide(t).second, 0);
    else
      reference.add(t, xLift + vLift * s + push * s * s / 2, g * s * s * s / 3, vLift + push * s, g * s * s);
  }
  reference.addEvent(t1, TF_EVENT_IMPACT);
  reference.addEvent(lift, TF_EVENT_OPENING);
  return reference;
}

namespace {

Reference blockOnSlope(Number mu) {
  const Number slope = kPi / 6, up = g * (std::sin(slope) + mu * std::cos(slope)),
               down = std::max<Number>(0, g * (std::sin(slope) - mu * std::cos(slope))), stop = 2 / up;
  Reference reference{.variables = {"s", "n", "der(s)", "der(n)"}};
  for (const double t : uniformTimes(2, 20)) {
    const Number back = t - stop;
    if (t < stop)
      reference.add(t, 2 * t - up * t * t / 2, 0, 2 - up * t, 0);
    else
      reference.add(t, stop - down * back * back / 2, 0, -down * back, 0);
  }
  reference.addEvent(stop, down > 0 ? TF_EVENT_SLIP_REVERSAL : TF_EVENT_STICK);
  return reference;
}

}  // namespace

Reference inclineReference() { return blockOnSlope(0.3L); }
Reference stayingInclineReference() { return blockOnSlope(0.7L); }

Reference cornerReference() {
  const Number floor = (std::sqrt(Number(11)) - 1) / 10, wall = Number(8) / 15;
  Reference reference{.variables = {"r[1]", "r[2]", "der(r[1])", "der(r[2])"}};
  for (const double t : uniformTimes(1.5, 30)) {
    const bool isFlying = t < floor, isSliding = t < wall;
    reference.add(t, isSliding ? Number(0.8L) - 1.5L * t : 0, isFlying ? 0.5L - t - 5 * Number(t) * t : 0, isSliding ? -1.5L : 0,
                  isFlying ? -1 - 10 * Number(t) : 0);
  }
  reference.addEvent(floor, TF_EVENT_IMPACT);
  reference.addEvent(wall, TF_EVENT_IMPACT);
  return reference;
}

Reference cartsReference() {
  const Number hit = 0.25L, w = std::sqrt(Number(3)), open = hit + kPi / w;
  Reference reference{.variables = {"x[1]", "x[2]", "der(x[1])", "der(x[2])"}};
  for (const double t : uniformTimes(3, 30)) {
    const Number together = t - hit, apart = t - open;
    if (t < hit)
      reference.add(t, 2 * t, 1, 2, 0);
    else if (t < open)
      reference.add(t, 0.5L + 0.5L / w * std::sin(w * together), 1 + 0.5L / w * std::sin(w * together), 0.5L * std::cos(w * together),
                    0.5L * std::cos(w * together));
    else
      reference.add(t, 0.5L - 0.5L * apart, 1 - 0.25L * std::sin(2 * apart), -0.5L, -0.5L * std::cos(2 * apart));
  }
  reference.addEvent(hit, TF_EVENT_IMPACT);
  reference.addEvent(open, TF_EVENT_OPENING);
  return reference;
}

namespace {

// A flight after a bounce.
struct Flight {
  Number start, x, y, vx, vy, angle, spin;
};

}  // namespace

Reference bouncingBallReference() {
  const Number e = 0.8L, first = std::sqrt(2 / g), rest = first * (1 + e) / (1 - e);
  std::vector<Flight> flights = {{.start = 0, .x = 0, .y = 1, .vx = 0, .vy = 0, .angle = 0, .spin = 0}};
  Reference reference{.variables = {"y", "der(y)"}};
  Number time = first;
  for (Number speed = g * first * e; speed > 1e-15L; time += 2 * speed / g, speed *= e) {
    reference.addEvent(time, TF_EVENT_IMPACT, speed > 0.5L);
    flights.push_back({.start = time, .x = 0, .y = 0, .vx = 0, .vy = speed, .angle = 0, .spin = 0});
  }
  reference.addEvent(rest, TF_EVENT_REST);
  for (const double t : uniformTimes(5, 50)) {
    const auto next = std::ranges::find_if(flights, [&](const Flight &flight) { return flight.start > t; });
    const Number s = t - std::prev(next)->start, v = std::prev(next)->vy;
    if (t < rest)
      reference.add(t, std::prev(next)->y + v * s - g * s * s / 2, v - g * s);
    else
      reference.add(t, 0, 0);
  }
  return reference;
}

Reference twoWallsReference() {
  Reference reference{.variables = {"x", "der(x)"}};
  const std::vector<double> times = uniformTimes(10, 41);
  Number start = 0, from = 0.5L, v = 2;
  std::size_t next = 0;
  while (next < times.size()) {
    const Number end = start + ((v > 0 ? 1 : 0) - from) / v;
    for (; next < times.size() && times[next] < end; ++next)
      reference.add(times[next], from + v * (times[next] - start), v);
    if (end < times.back())
      reference.addEvent(end, TF_EVENT_IMPACT);
    start = end;
    from = v > 0 ? 1 : 0;
    v *= v > 0 ? -0.7L : -0.9L;
  }
  return reference;
}

Reference superballReference() {
  const Number R = 0.025L, mu = 0.6L, e = 0.85L;
  Flight flight{.start = 0, .x = 0, .y = 0.5L - R, .vx = 0.5L, .vy = 0, .angle = 0, .spin = 90};
  Number time = std::sqrt(2 * flight.y / g), speed = g * time;
  std::vector<Flight> flights = {flight};
  Reference reference{.variables = {"r[1]", "r[2]", "phi", "der(r[1])", "der(r[2])", "der(phi)"}};
  while (speed > 1e-15L) {
    reference.addEvent(time, TF_EVENT_IMPACT, speed > 0.5L);
    // Friction takes the slip with 7/2 of its impulse, as long as it lasts.
    const Number slip = flight.vx + R * flight.spin, impulse = std::copysign(std::min(mu * (1 + e) * speed, std::abs(slip) / 3.5L), slip);
    speed *= e;
    flight.x += flight.vx * (time - flight.start);
    flight.angle += flight.spin * (time - flight.start);
    flight.start = time;
    flight.y = 0;
    flight.vx -= impulse;
    flight.spin -= impulse / (0.4L * R);
    flight.vy = speed;
    flights.push_back(flight);
    time += 2 * speed / g;
  }
  reference.addEvent(time, TF_EVENT_REST);
  for (const double t : uniformTimes(5, 50)) {
    const auto after = std::ranges::find_if(flights, [&](const Flight &other) { return other.start > t; });
    const Flight &last = *std::prev(after);
    const Number s = t - last.start;
    const bool isFlying = t < time;
    reference.add(t, last.x + last.vx * s, R + (isFlying ? last.y + last.vy * s - g * s * s / 2 : 0), last.angle + last.spin * s, last.vx,
                  isFlying ? last.vy - g * s : 0, last.spin);
  }
  return reference;
}

Reference movingGroundReference() {
  const Number A = 0.1L, w = 12, angle = std::asin(g / (A * w * w));
  const auto table = [&](Number t) { return A * std::sin(w * t); };
  Reference reference{.variables = {"y", "der(y)"}};
  const std::vector<double> times = uniformTimes(1.5, 30);
  std::size_t next = 0;
  const auto record = [&](Number end, const auto &y, const auto &v) {
    for (; next < times.size() && times[next] < end; ++next)
      reference.add(times[next], y(times[next]), v(times[next]));
  };
  Number time = 0;
  while (time < 1.5L) {
    // Lift-off where the table's downward acceleration exceeds gravity: at once, or at the next time.
    const Number phase = std::fmod(w * time, 2 * kPi);
    const bool isAtOnce = phase > angle && phase < kPi - angle;
    const Number lift = isAtOnce ? time : time + (phase <= angle ? angle - phase : angle - phase + 2 * kPi) / w;
    record(lift, table, [&](Number t) { return A * w * std::cos(w * t); });
    const Number y0 = table(lift), v0 = A * w * std::cos(w * lift);
    const auto y = [&](Number t) { return y0 + v0 * (t - lift) - g * (t - lift) * (t - lift) / 2; };
    Number after = lift + 0.02L;
    while (y(after) > table(after))
      after += 1e-3L;
    time = zero([&](Number t) { return y(t) - table(t); }, after - 1e-3L, after);
    record(time, y, [&](Number t) { return v0 - g * (t - lift); });
    if (lift < 1.5L)
      reference.addEvent(lift, TF_EVENT_OPENING);
    if (time < 1.5L)
      reference.addEvent(time, TF_EVENT_IMPACT);
  }
  record(2, table, [&](Number t) { return A * w * std::cos(w * t); });
  return reference;
}

// The wind W pulls along x against friction R = 2W: the speed at the angle ψ to x is w = C tan²(ψ/2)/sin ψ, so that with u = tan(ψ/2)
// time and place are polynomials in u.
Reference particle3dReference() {
  const Number W = 1, fall = 0.1L, x1 = 2 * fall + W * fall * fall / 2, y1 = 2 * fall, vx = 2 + W * fall, vy = 2;
  const Number slip = std::hypot(vx, vy) - 0.2L * 10 * fall, angle = std::atan2(vy, vx), u1 = std::tan(angle / 2);
  const Number C = slip * std::sin(angle) / (u1 * u1);
  const auto time = [&](Number u) { return fall + C / (2 * W) * (u1 + u1 * u1 * u1 / 3 - u - u * u * u / 3); };
  const auto x = [&](Number u) {
    const auto part = [](Number s) { return s * s / 2 - std::pow(s, Number(6)) / 6; };
    return x1 + C * C / (4 * W) * (part(u1) - part(u));
  };
  const auto y = [&](Number u) {
    const auto part = [](Number s) { return s * s * s / 3 + std::pow(s, Number(5)) / 5; };
    return y1 + C * C / (2 * W) * (part(u1) - part(u));
  };
  Reference reference{.variables = {"q[1]", "q[2]", "q[3]", "der(q[1])", "der(q[2])", "der(q[3])"}};
  for (const double t : uniformTimes(4, 39)) {
    if (t < fall) {
      reference.add(t, 2 * t + W * t * t / 2, 2 * t, 0.05L - 5 * Number(t) * t, 2 + W * t, 2, -10 * Number(t));
      continue;
    }
    const Number u = t < time(0) ? zero([&](Number s) { return time(s) - t; }, 0, u1) : 0, w = C * u * (1 + u * u) / 2;
    reference.add(t, x(u), y(u), 0, w * (1 - u * u) / (1 + u * u), w * 2 * u / (1 + u * u), 0);
  }
  reference.addEvent(fall, TF_EVENT_IMPACT);
  reference.addEvent(time(0), TF_EVENT_STICK);
  return reference;
}

namespace {

// Balls above each other: parabolas between impacts.
struct Column {
  std::vector<Number> y, v;
  Number time = 0;

  explicit Column(int n) : v(static_cast<std::size_t>(n), 0) {
    for (int i = 1; i <= n; ++i)
      y.push_back(0.2L + (2 * i - 1) * 0.05L + 0.01L * i * i);
  }
  // Time to the next impact and its contact: 0 is the floor's.
  [[nodiscard]] std::pair<Number, std::size_t> next() const {
    Number wait = (v[0] + std::sqrt(v[0] * v[0] + 2 * g * std::max<Number>(y[0] - 0.05L, 0))) / g;
    std::size_t contact = 0;
    for (std::size_t i = 1; i < y.size(); ++i) {
      const Number approach = v[i - 1] - v[i], space = std::max<Number>(y[i] - y[i - 1] - 0.1L, 0);
      if (approach > 0 && space / approach < wait) {
        wait = space / approach;
        contact = i;
      }
    }
    return {wait, contact};
  }
  void fly(Number wait) {
    time += wait;
    for (std::size_t i = 0; i < y.size(); ++i) {
      y[i] += v[i] * wait - g * wait * wait / 2;
      v[i] -= g * wait;
    }
  }
  void collide(std::size_t contact, Number e) {
    if (contact == 0) {
      v[0] *= -e;
      return;
    }
    const Number mean = (v[contact] + v[contact - 1]) / 2, half = e * (v[contact] - v[contact - 1]) / 2;
    v[contact - 1] = mean + half;
    v[contact] = mean - half;
  }
};

}  // namespace

// Until the impacts accumulate for the first time, and at rest.
Reference columnReference() {
  Reference reference{.variables = {"y[1]", "y[2]", "y[3]", "y[4]", "der(y[1])", "der(y[2])", "der(y[3])", "der(y[4])"}};
  const auto record = [&](const Column &column) {
    reference.add(column.time, column.y[0], column.y[1], column.y[2], column.y[3], column.v[0], column.v[1], column.v[2], column.v[3]);
  };
  Column column(4);
  for (int k = 0; k < 400; ++k) {
    const auto [wait, contact] = column.next();
    if (k < 40) {
      Column middle = column;
      middle.fly(static_cast<double>(column.time + wait / 2) - column.time);
      record(middle);
    }
    column.fly(wait);
    column.collide(contact, 0.6L);
    if (k < 40)
      reference.addEvent(column.time, TF_EVENT_IMPACT);
    if (k == 39)
      reference.eventsUntil = static_cast<double>(column.time);
  }
  reference.addEvent(column.time, TF_EVENT_REST);
  reference.add(4, 0.05L, 0.15L, 0.25L, 0.35L, 0, 0, 0, 0);
  return reference;
}

}  // namespace tf::test
