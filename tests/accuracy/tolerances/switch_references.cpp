// Relays and dry friction.
#include "tests/accuracy/support/dry_friction_reference.h"
#include "tests/accuracy/tolerances/references.h"

#include <cmath>

namespace tf::test {

namespace {

Reference solved(const DryFriction &problem, double end, int count, const std::string &x, const std::string &v) {
  const std::vector<double> times = uniformTimes(end, count);
  const FrictionSolution solution = solve(problem, times);
  Reference reference{.variables = {x, v}};
  for (std::size_t i = 0; i < times.size(); ++i)
    reference.add(times[i], solution.samples[i][0], solution.samples[i][1]);
  tf_event_kind slips = TF_EVENT_COUNT;
  for (const FrictionSwitch &change : solution.switches) {
    reference.addEvent(change.time, change.sticks ? TF_EVENT_STICK : slips);
    slips = change.sticks ? TF_EVENT_SLIP : TF_EVENT_SLIP_REVERSAL;
  }
  return reference;
}

}  // namespace

Reference relayReference() {
  const auto x = [](Number t) { return 1 - 2 * t + std::sin(t); };
  const Number hit = zero(x, 0.5L, 1.5L);
  Reference reference{.variables = {"x", "z"}};
  for (const double t : uniformTimes(3, 30)) {
    if (t < hit)
      reference.add(t, x(t), t);
    else
      reference.add(t, 0, hit + (std::sin(Number(t)) - std::sin(hit)) / 2);
  }
  reference.addEvent(hit, TF_EVENT_SLIDING);
  return reference;
}

// T' = −(T − 6 + t)/5 + heating; on the set point heating = (14 + t)/5, until it exceeds 6.
Reference thermostatReference() {
  const auto warming = [](Number t) { return 41 - t - 29 * std::exp(-t / 5); };
  const Number hit = zero([&](Number t) { return warming(t) - 20; }, 1, 3), end = 16;
  Reference reference{.variables = {"T", "used"}};
  const auto held = [&](Number t) { return 6 * hit + (14 * (t - hit) + (t * t - hit * hit) / 2) / 5; };
  for (const double t : uniformTimes(24, 24)) {
    if (t < hit)
      reference.add(t, warming(t), 6 * t);
    else if (t < end)
      reference.add(t, 20, held(t));
    else
      reference.add(t, 41 - t - 5 * std::exp((end - t) / 5), held(end) + 6 * (t - end));
  }
  reference.addEvent(hit, TF_EVENT_SLIDING);
  reference.addEvent(end, TF_EVENT_STATE);
  return reference;
}

// Once the mass has left the belt it comes back to the belt's speed just where the friction's bound balances the spring (it grazes): the
// run ends before.
Reference stickSlipReference() {
  DryFriction problem{.mass = 1, .bound = 1, .force = [](Number, Number x, Number) { return -4 * x; }};
  problem.belt = [](Number) { return 0.3L; };
  problem.x = -0.5L;
  return solved(problem, 5, 50, "x", "der(x)");
}

Reference pushedBlockReference() {
  const DryFriction problem{.mass = 1, .bound = 0.4L * 9.81L, .force = [](Number t, Number, Number) { return 6 * std::sin(2 * t); }};
  return solved(problem, 5, 50, "q[1]", "der(q[1])");
}

Reference denHartogReference() {
  const DryFriction problem{.mass = 1, .bound = 0.6L, .force = [](Number t, Number x, Number v) { return std::cos(t / 2) - x - 0.1L * v; }};
  return solved(problem, 30, 60, "x", "der(x)");
}

Reference duffingReference() {
  const Number speed = 0.6L, part = 0.7L;
  DryFriction problem{.mass = 1, .bound = 1, .force = [](Number, Number x, Number) { return -x - x * x * x; }};
  problem.belt = [=](Number t) { return speed * (1 + part * std::sin(2 * t)); };
  problem.beltAcceleration = [=](Number t) { return speed * part * 2 * std::cos(2 * t); };
  problem.x = -0.2L;
  return solved(problem, 6.5, 65, "x", "der(x)");
}

}  // namespace tf::test
