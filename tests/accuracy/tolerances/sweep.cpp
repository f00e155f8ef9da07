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

namespace {

// Events that coincide in one run have times of their own in another.
bool parts(const std::vector<Event> &together, const std::vector<Event> &apart) {
  for (std::size_t i = 0; i + 1 < together.size(); ++i)
    if (std::abs(together[i + 1].time - together[i].time) < 1e-12 && std::abs(apart[i + 1].time - apart[i].time) > 1e-10)
      return true;
  return false;
}

}  // namespace

std::string sensitivityMismatch(const SweepCase &sweepCase, const Reference &reference) {
  constexpr double kChange = 1e-6;
  const Run base = simulate(sweepCase, reference, kFine, TF_AUTO);
  const auto isAtJump = [&](const Sample &sample) {
    return std::any_of(reference.events.begin(), reference.events.end(),
                       [&](const ReferenceEvent &event) { return std::abs(event.time - sample.time) < 1e-3; });
  };
  std::ostringstream mismatch;
  for (const Start &start : startsOf(sweepCase)) {
    const double change = kChange * scale(start.value);
    const std::optional<Run> plus = changedRun(sweepCase, reference, base, start, change),
                             minus = changedRun(sweepCase, reference, base, start, -change);
    if (!plus || !minus || plus->events.size() != base.events.size() || minus->events.size() != base.events.size() ||
        parts(base.events, plus->events))
      continue;
    CompiledModel model(sweepCase.file, sweepCase.settings);
    if (sweepCase.setUp)
      sweepCase.setUp(model);
    const char *name = start.name.c_str();
    if (tf_set_sensitivities(model.simulation(), &name, 1) != TF_OK)
      continue;
    try {
      model.tolerance(kFine).initialise();
      std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
      for (std::size_t s = 0; s < reference.samples.size(); ++s) {
        model.advance(reference.samples[s].time);
        if (isAtJump(reference.samples[s]))
          continue;
        if (tf_get_sensitivity(model.simulation(), 0, all.data()) != TF_OK)
          throw std::runtime_error(tf_error_text(model.simulation()));
        for (std::size_t i = 0; i < reference.variables.size(); ++i) {
          const int32_t index = tf_find(model.simulation(), reference.variables[i].c_str());
          const double expected = (plus->states[s][i] - minus->states[s][i]) / (2 * change), found = all[static_cast<std::size_t>(index)];
          if (!(std::abs(found - expected) <= 1e-2 * scale(expected))) {
            mismatch << "d(" << reference.variables[i] << ")/d(" << start.name << ") at " << reference.samples[s].time << ": " << found
                     << " instead of " << expected << '\n';
            s = reference.samples.size();
            break;
          }
        }
      }
    } catch (const std::exception &) {
    }
  }
  return mismatch.str();
}

namespace {

// One run against the reference.
class Comparison {
public:
  Comparison(const Reference &reference, const Sensitivity &sensitivity, double tolerance, const Run &run)
      : reference_(reference), sensitivity_(sensitivity), tolerance_(tolerance), run_(run) {}

  SweepResult result() {
    compareEvents();
    findUnknownEvents();
    compareStates();
    return std::move(result_);
  }

private:
  [[nodiscard]] double bound(double kappa) const { return 10 * tolerance_ * std::max(1.0, kappa) + reference_.error; }
  [[nodiscard]] static std::string describe(const std::string &what, double time, double error) {
    std::ostringstream text;
    text << what << " at " << time << " by " << error;
    return text.str();
  }
  // Whether an event of the reference lies within the bound that belongs to its kappa, or `least`.
  [[nodiscard]] bool isNearEvent(double time, const std::vector<double> &kappas, double least) const {
    for (std::size_t e = 0; e < reference_.events.size(); ++e)
      if (std::abs(reference_.events[e].time - time) <= std::max(least, bound(kappas[e])))
        return true;
    return false;
  }

  void compareEvents() {
    for (std::size_t e = 0; e < reference_.events.size(); ++e) {
      const ReferenceEvent &event = reference_.events[e];
      const Event *found = nearest(run_.events, event.kind, event.time);
      const double error = found ? std::abs(found->time - event.time) : INFINITY, ratio = error / bound(sensitivity_.events[e]);
      if (event.isRequired && !(ratio <= result_.eventRatio)) {
        result_.eventRatio = ratio;
        result_.event = describe("event", event.time, error);
      }
    }
  }
  void findUnknownEvents() {
    for (const Event &event : run_.events)
      if (event.kind != TF_EVENT_TIME && event.time > 0 && event.time < reference_.eventsUntil &&
          !isNearEvent(event.time, sensitivity_.events, 0))
        result_.failure = describe("an event of kind " + std::to_string(event.kind) + " that the reference does not have,", event.time, 0);
  }
  void compareStates() {
    for (std::size_t s = 0; s < reference_.samples.size(); ++s) {
      const Sample &sample = reference_.samples[s];
      // Across a jump a state cannot be compared.
      if (isNearEvent(sample.time, sensitivity_.eventTimes, kJump))
        continue;
      for (std::size_t i = 0; i < reference_.variables.size(); ++i) {
        const double error = std::abs(run_.states[s][i] - sample.values[i]) / scale(sample.values[i]);
        const double ratio = error / bound(sensitivity_.states[s]);
        if (!(ratio <= result_.stateRatio)) {
          result_.stateRatio = ratio;
          result_.state = describe(reference_.variables[i], sample.time, error);
        }
      }
    }
  }

  const Reference &reference_;
  const Sensitivity &sensitivity_;
  double tolerance_;
  const Run &run_;
  SweepResult result_;
};

}  // namespace

SweepResult compare(const SweepCase &sweepCase, const Reference &reference, const Sensitivity &sensitivity, double tolerance,
                    tf_integrator integrator) {
  try {
    const Run run = simulate(sweepCase, reference, tolerance, integrator);
    return Comparison(reference, sensitivity, tolerance, run).result();
  } catch (const std::exception &error) {
    SweepResult result;
    result.failure = error.what();
    return result;
  }
}

}  // namespace tf::test
