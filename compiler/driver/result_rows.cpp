#include "compiler/driver/result_rows.h"

#include "compiler/driver/selected_variables.h"

#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace tf::driver {

using runtime::Failure;
using runtime::Outcome;

namespace {

// Equal as numbers in a file: NaN equals NaN.
bool sameRow(const std::vector<double> &a, const std::vector<double> &b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

constexpr std::size_t kMostNotes = 100;
constexpr std::size_t kTime = 0;  // column of every model's table

}  // namespace

ResultRows::ResultRows(tf_simulation *simulation, const RunOptions &options)
    : simulation_(simulation), policy_(options.events), noteEvents_(options.verbose),
      row_(static_cast<std::size_t>(tf_get_model(simulation)->variable_count)), before_(row_.size()) {}

Outcome<std::unique_ptr<ResultRows>> ResultRows::create(tf_simulation *simulation, const RunOptions &options) {
  std::unique_ptr<ResultRows> rows(new ResultRows(simulation, options));
  const tf_model &model = *tf_get_model(simulation);
  if (!options.output.empty()) {
    std::vector<runtime::ResultColumn> columns = selectedColumns(model, options.variables);
    rows->addSensitivityColumns(options, columns);
    auto writer = runtime::ResultWriter::create(options.output, model, std::move(columns));
    if (!writer)
      return Failure{writer.error()};
    rows->results_ = std::move(writer.value());
  }
  if (!options.eventLog.empty()) {
    auto log = runtime::EventLog::create(options.eventLog, model);
    if (!log)
      return Failure{log.error()};
    rows->log_ = std::move(log.value());
  }
  return rows;
}

// Of the selected coordinates, velocities, states and outputs by each of the names, behind the variables of a row.
void ResultRows::addSensitivityColumns(const RunOptions &options, std::vector<runtime::ResultColumn> &columns) {
  const std::vector<std::string> &names = options.sensitivities;
  const tf_model &model = *tf_get_model(simulation_);
  sensitivityCount_ = names.size();
  derivatives_.resize(row_.size());
  for (const runtime::ResultColumn &column : columns)
    if (!names.empty() && isDifferentiated(model, column))
      differentiated_.push_back(column.variable);
  for (const std::string &name : names)
    for (const std::int32_t variable : differentiated_)
      sensitivityNames_.push_back(fmt::format("d({})/d({})", model.variables[variable].name, name));
  for (std::size_t k = 0; k < sensitivityNames_.size(); ++k)
    columns.push_back({model.variable_count + static_cast<std::int32_t>(k), 1, sensitivityNames_[k].c_str(), "sensitivity", ""});
  row_.resize(row_.size() + sensitivityNames_.size());
  before_.resize(row_.size());
}

void ResultRows::readPoint(std::vector<double> &row, bool before) {
  if (before)
    tf_get_all_before(simulation_, row.data());
  else
    tf_get_all(simulation_, row.data());
  std::size_t place = derivatives_.size();
  for (std::size_t k = 0; k < sensitivityCount_; ++k) {
    const tf_status status =
        before ? tf_get_sensitivity_before(simulation_, k, derivatives_.data()) : tf_get_sensitivity(simulation_, k, derivatives_.data());
    for (const std::int32_t variable : differentiated_)
      row[place++] = status == TF_OK ? derivatives_[static_cast<std::size_t>(variable)] : std::numeric_limits<double>::quiet_NaN();
  }
}

void ResultRows::keep(const Outcome<void> &outcome) {
  if (!outcome && error_.empty())
    error_ = outcome.error();
}

void ResultRows::write(const std::vector<double> &row) {
  if (sameRow(row, lastRow_))
    return;
  lastRow_ = row;
  ++rowCount_;
  keep(results_->writeRow(row));
}

void ResultRows::point() {
  if (!results_)
    return;
  readPoint(row_, false);
  if (isPending_ && pending_[kTime] != row_[kTime])
    write(pending_);
  isPending_ = false;
  write(row_);
}

void ResultRows::event(const tf_event &event) {
  if (noteEvents_)
    events_.push_back({event.time, event.tau, event.kind, event.element});
  if (log_)
    keep(log_->write(event));
  if (!results_)
    return;
  if (policy_ == EventRows::Both) {
    readPoint(before_, true);
    readPoint(row_, false);
    if (sameRow(before_, eventBefore_) && sameRow(row_, eventAfter_))
      return;
    eventBefore_ = before_;
    eventAfter_ = row_;
    write(before_);
    write(row_);
    return;
  }
  readPoint(row_, false);
  if (isPending_ && pending_[kTime] != row_[kTime])
    write(pending_);
  pending_ = row_;
  isPending_ = true;
}

void ResultRows::note(const tf_note &note) {
  if (log_)
    keep(log_->write(note));
  if (note.kind != TF_NOTE_INTEGRATOR || (noteEvents_ && notes_.size() < kMostNotes))
    notes_.push_back({note.time, note.kind, note.text});
}

void ResultRows::finish() {
  if (results_) {
    if (isPending_)
      write(pending_);
    keep(results_->finish());
  }
  if (log_)
    keep(log_->finish());
}

}  // namespace tf::driver
