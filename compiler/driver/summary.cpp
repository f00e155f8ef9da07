#include "compiler/driver/summary.h"

#include "compiler/driver/selected_variables.h"
#include "compiler/driver/session.h"

#include <cstdio>
#include <ctime>
#include <unistd.h>

namespace tf::driver {

double cpuTime() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Progress::Progress(bool isWanted, double start, double stop)
    : isWanted_(isWanted && stop > start && isatty(STDERR_FILENO) != 0), start_(start), stop_(stop),
      next_(Clock::now() + std::chrono::seconds(1)) {}

Progress::~Progress() {
  if (isShown_)
    std::fputs("\r\x1b[K", stderr);
}

void Progress::at(double time) {
  if (!isWanted_ || Clock::now() < next_)
    return;
  isShown_ = true;
  next_ = Clock::now() + std::chrono::milliseconds(100);
  fmt::print(stderr, "\r\x1b[K{:3.0f} %  time = {:.6g}", 100 * (time - start_) / (stop_ - start_), time);
  std::fflush(stderr);
}

namespace {

// "0.123 ms", "123 ms", "12.3 s"
std::string duration(double seconds) { return seconds < 1 ? fmt::format("{:.3g} ms", 1000 * seconds) : fmt::format("{:.3g} s", seconds); }

std::string eventCounts(const tf_statistics &statistics) {
  long long count = 0;
  std::string kinds;
  for (int kind = 0; kind < TF_EVENT_COUNT; ++kind) {
    if (statistics.events[kind] == 0)
      continue;
    count += statistics.events[kind];
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", statistics.events[kind],
                         runtime::eventKindName(static_cast<tf_event_kind>(kind)));
  }
  return count == 0 ? "no switches" : fmt::format("{} switch{} ({})", count, count == 1 ? "" : "es", kinds);
}

std::string eventList(const ResultRows &rows, const tf_model &model) {
  std::string text;
  for (const EventNote &event : rows.events()) {
    const std::string_view element = runtime::eventElementName(model, event.element);
    text += fmt::format("  time = {}, tau = {}: {}{}{}\n", number(event.time), number(event.tau),
                        runtime::eventKindName(static_cast<tf_event_kind>(event.kind)), element.empty() ? "" : " of ", element);
  }
  return text;
}

// Who covered how much of the time, and when and why others took over.
std::string integrators(const tf_statistics &s, const std::vector<RunNote> &notes) {
  constexpr int mostLines = 10;
  const double all = s.explicit_time + s.step_time + s.cvode_time;
  std::string shares;
  const auto add = [&](const char *name, double time, long long steps) {
    if (steps > 0)
      shares += fmt::format("{}{} {:.3g} % of the time in {} step{}", shares.empty() ? "" : ", ", name, all > 0 ? 100 * time / all : 0,
                            steps, steps == 1 ? "" : "s");
  };
  add("explicit", s.explicit_time, s.explicit_steps);
  if (s.stabilised_steps > 0)
    shares +=
        fmt::format(" ({} of them and {:.3g} % of the time stabilised)", s.stabilised_steps, all > 0 ? 100 * s.stabilised_time / all : 0);
  add("step", s.step_time, s.step_steps);
  add("cvode", s.cvode_time, s.cvode_steps);
  std::string text = shares.empty() ? "" : "  integrators: " + shares + "\n";
  int lines = 0;
  for (const RunNote &note : notes)
    if (note.kind == TF_NOTE_INTEGRATOR && lines++ < mostLines)
      text += fmt::format("    from time = {} on {}\n", number(note.time), note.text);
  if (lines > mostLines)
    text +=
        fmt::format("    and more: {} changes to cvode where the explicit one was limited by stability, {} because of the tolerance, {} to "
                    "step for slips that start, {} for low bounces\n",
                    s.stiff_changes, s.failure_changes, s.launch_changes, s.bounce_changes);
  return text;
}

std::string work(const tf_statistics &s, bool hasContacts) {
  std::string text =
      fmt::format("  {} rejected steps, {} evaluations, {} Jacobians, {} Newton iterations, {} contact solves, {} frozen phases with {} "
                  "breakpoints\n",
                  s.rejected_steps, s.evaluations, s.jacobians, s.newton_iterations, s.contact_solves, s.frozen_phases, s.breakpoints);
  if (hasContacts)
    text += fmt::format("  least gap {}, least normal force {}\n  largest residual of contact problems {}, of impacts {}\n",
                        number(s.worst_gap), number(s.worst_normal_force), number(s.worst_residual), number(s.worst_impact_residual));
  return text;
}

}  // namespace

std::string summary(const SummaryInput &input, const ResultRows &rows) {
  const tf_model &model = *tf_get_model(input.simulation);
  const tf_statistics &statistics = *tf_get_statistics(input.simulation);
  const RunTimes &times = input.times;
  std::string text =
      fmt::format("{}: time {} to {}{}, {} steps, {}\n", model.name, number(input.startTime), number(tf_time(input.simulation)),
                  input.isTerminated ? " (ended by the model)" : "", statistics.steps, eventCounts(statistics));
  text +=
      fmt::format("CPU time {}: compile {} ({}), initialise {}, simulate {}\n", duration(times.compile + times.initialise + times.simulate),
                  duration(times.compile), input.origin, duration(times.initialise), duration(times.simulate));
  if (input.isVerbose)
    text += eventList(rows, model) + integrators(statistics, rows.notes()) + work(statistics, model.nc > 0);
  return text;
}

std::string finalValues(tf_simulation *simulation, const std::vector<std::string> &patterns) {
  const tf_model &model = *tf_get_model(simulation);
  std::string text;
  for (const runtime::ResultColumn &column : selectedColumns(model, patterns)) {
    const tf_variable &variable = model.variables[column.variable];
    const bool isState = variable.kind == TF_KIND_TIME || variable.kind == TF_KIND_COORDINATE || variable.kind == TF_KIND_VELOCITY ||
                         variable.kind == TF_KIND_STATE;
    const bool isOwnName = column.name == variable.name;
    if (patterns.empty() && (!isOwnName || (!isState && (variable.flags & TF_OUTPUT) == 0)))
      continue;
    const bool hasUnit = variable.unit[0] != '\0' && std::string_view(variable.unit) != "1";
    text += fmt::format("{} = {}{}{}\n", column.name, number(column.sign * tf_get(simulation, column.variable)), hasUnit ? " " : "",
                        hasUnit ? variable.unit : "");
  }
  return text;
}

}  // namespace tf::driver
