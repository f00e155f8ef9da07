#include "tests/accuracy/tolerances/sweep.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <sstream>

namespace tf::test {

namespace {

struct Run {
  std::vector<std::vector<double>> states;  // per sample
  std::vector<Event> events;
  std::vector<double> closed;  // contacts, at the start
  std::size_t eventsAtStart = 0;
};

Run simulate(const SweepCase &sweepCase, const Reference &reference, double tolerance, tf_integrator integrator,
             const Settings &changes = {}) {
  Settings settings = sweepCase.settings;
  settings.insert(settings.end(), changes.begin(), changes.end());
  CompiledModel model(sweepCase.file, settings);
  if (sweepCase.setUp)
    sweepCase.setUp(model);
  model.tolerance(tolerance).integrator(integrator).initialise();
  Run run;
  run.closed = model.valuesOf(TF_KIND_CLOSED);
  run.eventsAtStart = model.events().size();
  for (const Sample &sample : reference.samples) {
    model.advance(sample.time);
    std::vector<double> &values = run.states.emplace_back();
    for (const std::string &name : reference.variables)
      values.push_back(model[name]);
  }
  run.events = model.events();
  return run;
}

// The event of a kind nearest to a time, if there is one.
const Event *nearest(const std::vector<Event> &events, tf_event_kind kind, double time) {
  const Event *best = nullptr;
  for (const Event &event : events)
    if ((kind == TF_EVENT_COUNT || event.kind == kind) && (!best || std::abs(event.time - time) < std::abs(best->time - time)))
      best = &event;
  return best;
}

double scale(double value) { return std::max(1.0, std::abs(value)); }

constexpr double kFine = 1e-10;  // tolerance of the runs that are subtracted
// Samples as near as this to a jump are not compared, whatever the tolerance.
constexpr double kJump = 1e-5;

struct Start {
  std::string name;
  double value;
};

// Starts, with their values: those of the settings, else what the model begins with.
std::vector<Start> startsOf(const SweepCase &sweepCase) {
  CompiledModel model(sweepCase.file, sweepCase.settings);
  if (sweepCase.setUp)
    sweepCase.setUp(model);
  model.initialise();
  std::vector<Start> starts;
  for (const std::string &name : sweepCase.parameters)
    starts.push_back({name, model[name]});
  for (int32_t i = 0; i < model.model().variable_count; ++i) {
    const tf_variable &variable = model.model().variables[i];
    if (variable.kind != TF_KIND_COORDINATE && variable.kind != TF_KIND_VELOCITY && variable.kind != TF_KIND_STATE)
      continue;
    Start start{variable.name, model[variable.name]};
    for (const auto &[name, value] : sweepCase.settings)
      if (name == start.name)
        start.value = value;
    starts.push_back(start);
  }
  return starts;
}

// A run from a changed start; nothing where such a start is not possible (inside a contact, off a constraint) or leaves the contacts.
std::optional<Run> changedRun(const SweepCase &sweepCase, const Reference &reference, const Run &base, const Start &start, double change) {
  try {
    Run run = simulate(sweepCase, reference, kFine, TF_AUTO, {{start.name, start.value + change}});
    if (run.closed == base.closed && run.eventsAtStart == base.eventsAtStart)
      return run;
  } catch (const std::exception &) {
  }
  return std::nullopt;
}

}  // namespace

Sensitivity sensitivityOf(const SweepCase &sweepCase, const Reference &reference) {
  constexpr double kChange = 1e-7;
  const Run base = simulate(sweepCase, reference, kFine, TF_AUTO);
  Sensitivity result{std::vector<double>(reference.samples.size(), 0), std::vector<double>(reference.events.size(), 0), {}};
  std::vector<std::vector<double>> rows(reference.samples.size(), std::vector<double>(reference.variables.size(), 0));
  const auto isAtJump = [&](const Sample &sample) {
    return std::any_of(reference.events.begin(), reference.events.end(),
                       [&](const ReferenceEvent &event) { return std::abs(event.time - sample.time) < kJump; });
  };
  for (const Start &start : startsOf(sweepCase)) {
    const double change = kChange * scale(start.value);
    const std::optional<Run> plus = changedRun(sweepCase, reference, base, start, change),
                             minus = changedRun(sweepCase, reference, base, start, -change);
    if (!plus && !minus)
      continue;
    const Run &high = plus ? *plus : base, &low = minus ? *minus : base;
    const double difference = (plus ? kChange : 0) + (minus ? kChange : 0);  // of the scaled start
    for (std::size_t s = 0; s < rows.size(); ++s)
      for (std::size_t i = 0; !isAtJump(reference.samples[s]) && i < rows[s].size(); ++i)
        rows[s][i] += std::abs(high.states[s][i] - low.states[s][i]) / difference / scale(base.states[s][i]);
    for (std::size_t e = 0; e < reference.events.size(); ++e) {
      const ReferenceEvent &event = reference.events[e];
      const Event *after = nearest(high.events, event.kind, event.time), *before = nearest(low.events, event.kind, event.time);
      if (after && before)
        result.events[e] += std::abs(after->time - before->time) / difference;
    }
  }
  double largest = 0;
  for (std::size_t s = 0; s < rows.size(); ++s)
    result.states[s] = largest = std::max(largest, *std::max_element(rows[s].begin(), rows[s].end()));
  result.eventTimes = result.events;
  for (std::size_t e = 0; e < reference.events.size(); ++e)
    for (std::size_t s = 0; s < rows.size() && reference.samples[s].time < reference.events[e].time; ++s)
      result.events[e] = std::max(result.events[e], result.states[s]);
  return result;
}

SweepResult compare(const SweepCase &sweepCase, const Reference &reference, const Sensitivity &sensitivity, double tolerance,
                    tf_integrator integrator) {
  SweepResult result;
  const auto bound = [&](double kappa) { return 10 * tolerance * std::max(1.0, kappa) + reference.error; };
  const auto describe = [](const std::string &what, double time, double error) {
    std::ostringstream text;
    text << what << " at " << time << " by " << error;
    return text.str();
  };
  std::optional<Run> run;
  try {
    run = simulate(sweepCase, reference, tolerance, integrator);
  } catch (const std::exception &error) {
    result.failure = error.what();
    return result;
  }
  for (std::size_t e = 0; e < reference.events.size(); ++e) {
    const ReferenceEvent &event = reference.events[e];
    const Event *found = nearest(run->events, event.kind, event.time);
    const double error = found ? std::abs(found->time - event.time) : INFINITY, ratio = error / bound(sensitivity.events[e]);
    if (event.isRequired && !(ratio <= result.eventRatio)) {
      result.eventRatio = ratio;
      result.event = describe("event", event.time, error);
    }
  }
  for (const Event &event : run->events) {
    const auto isNear = [&](const ReferenceEvent &other) {
      const auto e = static_cast<std::size_t>(&other - reference.events.data());
      return std::abs(other.time - event.time) <= bound(sensitivity.events[e]);
    };
    if (event.kind != TF_EVENT_TIME && event.time > 0 && event.time < reference.eventsUntil &&
        std::none_of(reference.events.begin(), reference.events.end(), isNear))
      result.failure = describe("an event of kind " + std::to_string(event.kind) + " that the reference does not have,", event.time, 0);
  }
  for (std::size_t s = 0; s < reference.samples.size(); ++s) {
    const Sample &sample = reference.samples[s];
    // Across a jump a state cannot be compared.
    const auto isNear = [&](const ReferenceEvent &event) {
      const auto e = static_cast<std::size_t>(&event - reference.events.data());
      return std::abs(event.time - sample.time) <= std::max(kJump, bound(sensitivity.eventTimes[e]));
    };
    if (std::any_of(reference.events.begin(), reference.events.end(), isNear))
      continue;
    for (std::size_t i = 0; i < reference.variables.size(); ++i) {
      const double error = std::abs(run->states[s][i] - sample.values[i]) / scale(sample.values[i]),
                   ratio = error / bound(sensitivity.states[s]);
      if (!(ratio <= result.stateRatio)) {
        result.stateRatio = ratio;
        result.state = describe(reference.variables[i], sample.time, error);
      }
    }
  }
  return result;
}

}  // namespace tf::test
