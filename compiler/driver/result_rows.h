// Rows of a run: on the grid of --interval and at events, to the result file and the event log.
#pragma once

#include "compiler/driver/options.h"
#include "runtime/model/outcome.h"
#include "runtime/results/event_log.h"
#include "runtime/results/result_writer.h"
#include "runtime/tf.h"

#include <memory>
#include <string>
#include <vector>

namespace tf::driver {

// One event for the summary of --verbose.
struct EventNote {
  double time, tau;
  std::int32_t kind, element;
};

// One note of the run.
struct RunNote {
  double time;
  std::int32_t kind;
  std::string text;
};

class ResultRows {
public:
  // Creates the files that `options` names.
  static runtime::Outcome<std::unique_ptr<ResultRows>> create(tf_simulation *simulation, const RunOptions &options);

  // The row of the current point. At an event's time the row after the event counts; a row equal to the one before it is left out.
  void point();
  // The event's rows. Called from the simulation.
  void event(const tf_event &event);
  void note(const tf_note &note);
  // Writes what is pending and closes the files.
  void finish();

  // Of the first file that could not be written; empty if all is well.
  [[nodiscard]] const std::string &error() const { return error_; }
  [[nodiscard]] long long rowCount() const { return rowCount_; }
  [[nodiscard]] const std::vector<EventNote> &events() const { return events_; }
  // All that concern the model; of changes of the integrator the first ones, with --verbose.
  [[nodiscard]] const std::vector<RunNote> &notes() const { return notes_; }

private:
  ResultRows(tf_simulation *simulation, const RunOptions &options);

  void addSensitivityColumns(const RunOptions &options, std::vector<runtime::ResultColumn> &columns);
  void readPoint(std::vector<double> &row, bool before);
  void write(const std::vector<double> &row);
  void keep(const runtime::Outcome<void> &outcome);

  tf_simulation *simulation_;
  EventRows policy_;
  bool noteEvents_;
  std::unique_ptr<runtime::ResultWriter> results_;
  std::unique_ptr<runtime::EventLog> log_;
  std::vector<std::string> sensitivityNames_;  // of columns, "d(x)/d(mu)"
  std::vector<std::int32_t> differentiated_;   // variables
  std::size_t sensitivityCount_ = 0;           // of parameters, starts and inputs
  std::vector<double> derivatives_;            // of all variables by one of them
  std::vector<double> row_, before_, lastRow_;
  std::vector<double> eventBefore_, eventAfter_;  // rows of the latest event: several events of one impact have the same
  std::vector<double> pending_;                   // after an event (--events after), until time goes on
  bool isPending_ = false;
  std::vector<EventNote> events_;
  std::vector<RunNote> notes_;
  long long rowCount_ = 0;
  std::string error_;
};

}  // namespace tf::driver
