// The event log: one CSV row per event.
//
// Columns: time, tau, kind, element, then for every coordinate, velocity and state NAME two columns `NAME-` and `NAME+`: its value before
// and after the event. kind: as language.md section 6 spells it ("impact", "slip reversal", ...). element: name of the contact or friction
// element, text of the switch's condition, or empty.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/model/outcome.h"
#include "runtime/results/output_file.h"
#include "runtime/tf.h"

#include <memory>
#include <string>
#include <string_view>

namespace tf::runtime {

// The kind's name in the event log and in summaries.
std::string_view eventKindName(tf_event_kind kind);
// Name of the event's element (numbering of tf_event::element): a contact, a friction element, a switch's condition as written; "" for -1.
std::string_view eventElementName(const tf_model &model, std::int32_t element);

class EventLog {
public:
  // Creates the file and writes the header row.
  static Outcome<std::unique_ptr<EventLog>> create(const std::string &path, const tf_model &model);
  // The row is with the operating system on return.
  Outcome<void> write(const tf_event &event);
  // Kinds "integrator" and "redundancy"; the note's text stands for the element, the state is the same before and after.
  Outcome<void> write(const tf_note &note);
  Outcome<void> finish();

private:
  EventLog(OutputFile file, const tf_model &model) : file_(std::move(file)), model_(&model) {}

  Outcome<void> write(double time, double tau, std::string_view kind, std::string_view element, const double *before, const double *after);

  OutputFile file_;
  const tf_model *model_;
  std::string line_;
};

}  // namespace tf::runtime
