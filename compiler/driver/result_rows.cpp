#include "compiler/driver/result_rows.h"

#include <cstring>

namespace tf::driver {

using runtime::Failure;
using runtime::Outcome;

namespace {

// Equal as numbers in a file: NaN equals NaN.
bool sameRow(const std::vector<double> &a, const std::vector<double> &b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

constexpr std::size_t kTime = 0;  // column of every model's table

}  // namespace

ResultRows::ResultRows(tf_simulation *simulation, const RunOptions &options)
    : simulation_(simulation), policy_(options.events), noteEvents_(options.verbose),
      row_(static_cast<std::size_t>(tf_get_model(simulation)->variable_count)), before_(row_.size()) {}

Outcome<std::unique_ptr<ResultRows>> ResultRows::create(tf_simulation *simulation, const RunOptions &options) {
  std::unique_ptr<ResultRows> rows(new ResultRows(simulation, options));
  const tf_model &model = *tf_get_model(simulation);
  if (!options.output.empty()) {
    auto writer = runtime::ResultWriter::create(options.output, model, runtime::visibleColumns(model));
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
  tf_get_all(simulation_, row_.data());
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
    tf_get_all_before(simulation_, before_.data());
    tf_get_all(simulation_, row_.data());
    if (sameRow(before_, eventBefore_) && sameRow(row_, eventAfter_))
      return;
    eventBefore_ = before_;
    eventAfter_ = row_;
    write(before_);
    write(row_);
    return;
  }
  tf_get_all(simulation_, row_.data());
  if (isPending_ && pending_[kTime] != row_[kTime])
    write(pending_);
  pending_ = row_;
  isPending_ = true;
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
