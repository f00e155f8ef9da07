#include "runtime/results/event_log.h"

#include "runtime/results/result_writer.h"

#include <array>

namespace tf::runtime {

namespace {

// The state's variables in the order of tf_event::before: q, v, z. Variables that the model does not list have a name all the same.
std::vector<std::string> stateNames(const tf_model &model) {
  std::vector<std::string> names;
  const struct {
    std::int32_t kind, count;
    const char *name;
  } kinds[] = {{TF_KIND_COORDINATE, model.nq, "coordinate"}, {TF_KIND_VELOCITY, model.nv, "velocity"}, {TF_KIND_STATE, model.nz, "state"}};
  for (const auto &kind : kinds) {
    const std::size_t first = names.size();
    for (std::int32_t i = 0; i < kind.count; ++i)
      names.push_back(std::string(kind.name).append(" ").append(std::to_string(i + 1)));
    for (std::int32_t i = model.variable_count - 1; i >= 0; --i)  // the first of several wins
      if (model.variables[i].kind == kind.kind)
        names[first + static_cast<std::size_t>(model.variables[i].index)] = model.variables[i].name;
  }
  return names;
}

}  // namespace

std::string_view eventKindName(tf_event_kind kind) {
  constexpr std::array<std::string_view, TF_EVENT_COUNT> names{"impact",  "opening", "closing",  "stick", "slip",  "slip reversal",
                                                               "sliding", "rest",    "painleve", "time",  "state", "terminate"};
  return kind >= 0 && kind < TF_EVENT_COUNT ? names[static_cast<std::size_t>(kind)] : std::string_view("unknown");
}

std::string_view eventElementName(const tf_model &model, std::int32_t element) {
  if (element < 0)
    return {};
  if (element < model.nc)
    return model.contacts[element].name;
  if (element < model.nc + model.nf)
    return model.frictions[element - model.nc].name;
  if (element < model.nc + model.nf + model.ns)
    return model.switches[element - model.nc - model.nf].text;
  return {};
}

Outcome<std::unique_ptr<EventLog>> EventLog::create(const std::string &path, const tf_model &model) {
  auto file = OutputFile::create(path);
  if (!file)
    return Failure{file.error()};
  std::unique_ptr<EventLog> log(new EventLog(std::move(file.value()), model));
  std::string header = "time,tau,kind,element";
  for (const std::string &name : stateNames(model))
    for (const char side : {'-', '+'}) {
      header += ',';
      appendCsvField(header, name + side);
    }
  static_cast<void>(log->file_.write(header + "\r\n"));  // an error stays with the file: the next write reports it
  return log;
}

Outcome<void> EventLog::write(const tf_event &event) {
  return write(event.time, event.tau, eventKindName(static_cast<tf_event_kind>(event.kind)), eventElementName(*model_, event.element),
               event.before, event.after);
}

Outcome<void> EventLog::write(const tf_note &note) {
  return write(note.time, note.tau, note.kind == TF_NOTE_INTEGRATOR ? "integrator" : "redundancy", note.text, note.state, note.state);
}

Outcome<void> EventLog::write(double time, double tau, std::string_view kind, std::string_view element, const double *before,
                              const double *after) {
  line_.clear();
  appendNumber(line_, time);
  line_ += ',';
  appendNumber(line_, tau);
  line_ += ',';
  line_ += kind;
  line_ += ',';
  appendCsvField(line_, element);
  const std::int32_t size = model_->nq + model_->nv + model_->nz;
  for (std::int32_t i = 0; i < size; ++i)
    for (const double *side : {before, after}) {
      line_ += ',';
      appendNumber(line_, side[i]);
    }
  line_ += "\r\n";
  return file_.write(line_);
}

Outcome<void> EventLog::finish() { return file_.close(); }

}  // namespace tf::runtime
