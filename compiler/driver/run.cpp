#include "compiler/driver/run.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/input_settings.h"
#include "compiler/driver/invariant_report.h"
#include "compiler/driver/selected_variables.h"
#include "compiler/driver/summary.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

namespace tf::driver {

namespace {

constexpr double kMostRows = 1e8;
// Neighbouring numbers, at the largest time of a run, are at most this part of its length apart.
constexpr double kCoarsest = 1e-8;
constexpr int kDefaultIntervals = 500;
constexpr double kDefaultTolerance = 1e-6;

// Points of time at which the result has rows.
struct Grid {
  TimeSpan span;
  double interval = 0;  // 0: `count` equal ones
  long long count = 0;  // intervals, the last one perhaps shorter

  [[nodiscard]] double point(long long k) const {
    if (k >= count)
      return span.stop;
    return interval > 0 ? span.start + static_cast<double>(k) * interval
                        : span.start + (span.stop - span.start) * (static_cast<double>(k) / static_cast<double>(count));
  }
};

std::optional<double> given(double value) { return std::isnan(value) ? std::nullopt : std::optional(value); }

Grid gridOf(const RunOptions &options, const tf_model &model, Session &session) {
  Grid grid;
  grid.span.start = options.startTime.value_or(given(model.start_time).value_or(0));
  const double defaultStop = given(model.stop_time).value_or(1);
  grid.span.stop = options.stopTime.value_or(defaultStop);
  const double length = grid.span.stop - grid.span.start;
  if (length < 0)
    session.diagnostics.report(diag::EmptyTimeSpan, {}, number(grid.span.stop), number(grid.span.start));
  const double latest = std::max(std::abs(grid.span.start), std::abs(grid.span.stop));
  const double apart = std::numeric_limits<double>::epsilon() * latest;
  if (length > 0 && apart > kCoarsest * length)
    session.diagnostics.report(diag::CoarseTimes, {}, number(latest), apart, number(length));
  grid.interval = options.interval.value_or(given(model.interval).value_or(0));
  if (grid.interval <= 0) {
    grid.interval = 0;
    grid.count = length > 0 ? kDefaultIntervals : 0;
    return grid;
  }
  const double intervals = std::ceil(length / grid.interval * (1 - 1e-12) - 1e-9);
  if (intervals > kMostRows)
    session.diagnostics.report(diag::TooManyRows, {}, number(grid.interval), number(grid.span.start), number(grid.span.stop), intervals,
                               kMostRows);
  else
    grid.count = static_cast<long long>(std::max(intervals, length > 0 ? 1.0 : 0.0));
  return grid;
}

void checkSuffix(const std::string &path, std::initializer_list<std::string_view> suffixes, Session &session) {
  std::string lower = path;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool isKnown = std::any_of(suffixes.begin(), suffixes.end(), [&](std::string_view suffix) { return lower.ends_with(suffix); });
  if (!path.empty() && !isKnown)
    session.diagnostics.report(diag::UnknownSuffix, {}, path, fmt::format("{}", fmt::join(suffixes, " or ")));
}

double toleranceOf(const RunOptions &options, const tf_model &model) {
  return options.tolerance.value_or(given(model.tolerance).value_or(kDefaultTolerance));
}

// Sets what the command line says about the integration.
void configure(tf_simulation *simulation, const RunOptions &options, const tf_model &model) {
  tf_set_tolerance(simulation, toleranceOf(options, model));
  tf_set_integrator(simulation,
                    options.integrator == TF_AUTO && (options.stages > 0 || options.fixedStep > 0) ? TF_STEP : options.integrator);
  tf_set_step_options(simulation, options.stages, options.fixedStep);
  tf_set_longest_step(simulation, options.longestStep);
  // Without variables that are named only coordinates, velocities and states are shown.
  const bool mayShowEnergies = !options.output.empty() || !options.variables.empty();
  tf_set_energy_balance(simulation, options.checkInvariants || mayShowEnergies ? 1 : 0);
}

void setSensitivities(tf_simulation *simulation, const std::vector<std::string> &names) {
  std::vector<const char *> texts;
  texts.reserve(names.size());
  for (const std::string &name : names)
    texts.push_back(name.c_str());
  tf_set_sensitivities(simulation, texts.data(), texts.size());
}

// Each pattern is to select something, and sensitivities something that they are of.
void checkVariables(const tf_model &model, const RunOptions &options, Session &session) {
  if (options.variables.empty())
    return;
  std::vector<std::string> names;
  bool anyDifferentiated = false;
  for (const runtime::ResultColumn &column : runtime::visibleColumns(model)) {
    names.emplace_back(column.name);
    anyDifferentiated = anyDifferentiated || (isDifferentiated(model, column) && isSelected(options.variables, column.name));
  }
  bool anyUnknown = false;
  for (const std::string &pattern : options.variables) {
    if (std::any_of(names.begin(), names.end(), [&](const std::string &name) { return matches(pattern, name); }))
      continue;
    anyUnknown = true;
    session.diagnostics.report(diag::NothingSelected, {}, pattern, model.name).suggest(pattern, names);
  }
  if (!options.sensitivities.empty() && !anyDifferentiated && !anyUnknown)
    session.diagnostics.report(diag::OptionNeedsOption, {}, "--sensitivity",
                               "where --variables selects no coordinate, velocity, state or output: derivatives are theirs");
}

class Run {
public:
  Run(PreparedModel &prepared, const RunOptions &options, const Grid &grid, ResultRows &rows, Session &session)
      : simulation_(prepared.simulation.get()), grid_(grid), rows_(rows), session_(session), isQuiet_(options.quiet) {
    report_.simulation = simulation_;
    report_.startTime = grid.span.start;
    report_.origin = prepared.origin;
    report_.isVerbose = options.verbose;
    tf_set_event_callback(simulation_, [](void *data, const tf_event *event) { static_cast<ResultRows *>(data)->event(*event); }, &rows);
    tf_set_note_callback(simulation_, [](void *data, const tf_note *note) { static_cast<ResultRows *>(data)->note(*note); }, &rows);
  }

  // True if the run reached its end or was ended by the model.
  bool simulate() {
    report_.times.compile = cpuTime();
    const tf_status started = tf_initialise(simulation_, grid_.span.start);
    const double initialised = cpuTime();
    report_.times.initialise = initialised - report_.times.compile;
    if (started != TF_OK && started != TF_TERMINATED) {
      reportNotes();
      session_.diagnostics.report(diag::InitialisationFailed, {}, tf_error_text(simulation_));
      return false;
    }
    hasStarted_ = true;
    rows_.point();
    const tf_status status = started == TF_OK ? advance() : started;
    const std::string failure = tf_error_text(simulation_);
    rows_.finish();
    report_.isTerminated = status == TF_TERMINATED;
    report_.times.simulate = cpuTime() - initialised;
    reportNotes();
    if (status != TF_OK && status != TF_TERMINATED)
      session_.diagnostics.report(diag::RunFailed, {}, failure);
    if (!rows_.error().empty())
      session_.diagnostics.report(diag::WritingFailed, {}, number(tf_time(simulation_)), rows_.error());
    return !session_.diagnostics.hasErrors();
  }

  // Whether there is anything to summarise.
  [[nodiscard]] bool hasStarted() const { return hasStarted_; }
  [[nodiscard]] const SummaryInput &report() const { return report_; }

private:
  void reportNotes() {
    for (const RunNote &note : rows_.notes())
      if (note.kind == TF_NOTE_REDUNDANT)
        session_.diagnostics.report(diag::RedundantConstraint, {}, note.text, number(note.time));
  }

  tf_status advance() {
    if (grid_.count == 0)
      return TF_OK;
    progress_.emplace(!isQuiet_, grid_.span.start, grid_.span.stop);
    const auto sample = [](void *run, double time) { return static_cast<Run *>(run)->sample(time); };
    const tf_status status = tf_run(simulation_, grid_.span.stop, grid_.point(++row_), sample, this);
    rows_.point();  // the end, or the last good point
    progress_.reset();
    return rows_.error().empty() ? status : TF_OK;
  }

  // Gives the time of the next row. Where no row can be written any more the run ends.
  double sample(double time) {
    rows_.point();
    progress_->at(time);
    return rows_.error().empty() ? grid_.point(++row_) : std::numeric_limits<double>::quiet_NaN();
  }

  tf_simulation *simulation_;
  const Grid &grid_;
  ResultRows &rows_;
  Session &session_;
  SummaryInput report_;
  std::optional<Progress> progress_;
  long long row_ = 0;
  bool isQuiet_ = false, hasStarted_ = false;
};

}  // namespace

int runCommand(const RunOptions &options, Session &session) {
  const std::vector<Setting> settings = parseSettings(options, session);
  checkSuffix(options.output, {".csv", ".json"}, session);
  checkSuffix(options.eventLog, {".csv"}, session);
  if (session.diagnostics.hasErrors())
    return session.exitCode();
  std::optional<PreparedModel> prepared = prepareModel(options, settings, session);
  if (!prepared)
    return session.exitCode();
  const tf_model &model = prepared->model();
  const Grid grid = gridOf(options, model, session);
  const InputExpressions expressions = applySettings(*prepared, options, settings, grid.span, session);
  if (session.diagnostics.hasErrors())
    return session.exitCode();
  configure(prepared->simulation.get(), options, model);
  for (const std::string &name : options.sensitivities)
    if (const char *text = name.c_str(); tf_set_sensitivities(prepared->simulation.get(), &text, 1) != TF_OK)
      session.diagnostics.report(diag::NoSensitivity, {}, name, tf_error_text(prepared->simulation.get()));
  checkVariables(model, options, session);
  if (session.diagnostics.hasErrors())
    return session.exitCode();
  setSensitivities(prepared->simulation.get(), options.sensitivities);
  auto rows = ResultRows::create(prepared->simulation.get(), options);
  if (!rows) {
    session.diagnostics.report(diag::CannotWrite, {}, rows.error());
    return session.exitCode();
  }
  Run run(*prepared, options, grid, *rows.value(), session);
  const bool isDone = run.simulate();
  if (!options.quiet && run.hasStarted()) {
    const std::string text = summary(run.report(), *rows.value());
    std::fwrite(text.data(), 1, text.size(), stderr);
  }
  if (options.checkInvariants && run.hasStarted())
    reportInvariants(prepared->simulation.get(), toleranceOf(options, model), session);
  if (isDone && options.output.empty())
    printOut(finalValues(prepared->simulation.get(), options.variables), session);
  return session.exitCode();
}

}  // namespace tf::driver
