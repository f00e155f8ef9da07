#include "tests/accuracy/support/compiled_model.h"
#include "compiler/driver/compile.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace tf::test {

namespace {

// Files of one test process; removed at its end.
class WorkFolder {
public:
  WorkFolder() : path_(std::filesystem::temp_directory_path() / ("tf-accuracy-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~WorkFolder() { std::filesystem::remove_all(path_); }
  WorkFolder(const WorkFolder &) = delete;
  WorkFolder &operator=(const WorkFolder &) = delete;
  [[nodiscard]] std::string file(const std::string &name) const { return (path_ / name).string(); }

private:
  std::filesystem::path path_;
};

const WorkFolder &workFolder() {
  static const WorkFolder folder;
  return folder;
}

std::string readText(const std::string &path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// As the program compiles, but in the test's own process: to start another one takes longer than to compile what most tests do.
void compile(const std::string &file, const std::string &out) {
  setenv("TFC_STDLIB", TF_SOURCE_DIR "/stdlib", 1);
  driver::CompileOptions options;
  options.files = {file};
  options.output = out;
  driver::Session session;
  if (driver::compileCommand(options, session) != driver::kDone) {
    throw std::runtime_error("tfc compile " + file + " failed:\n" + render(session.diagnostics, session.sources));
  }
}

// The compiled library of a source file, which other tests of the process may have written before with other text.
const std::string &compiled(const std::string &file) {
  static std::map<std::pair<std::string, std::string>, std::string> libraries;
  std::string &library = libraries[{file, readText(file)}];
  if (library.empty()) {
    const std::string out = workFolder().file("model" + std::to_string(libraries.size()) + ".so");
    compile(file, out);
    library = out;
  }
  return library;
}

void append(void *data, const tf_event *event) {
  static_cast<std::vector<Event> *>(data)->push_back({event->time, event->tau, static_cast<tf_event_kind>(event->kind), event->element});
}

}  // namespace

std::string example(const std::string &name) { return TF_SOURCE_DIR "/examples/" + name; }

std::string sourceFile(const std::string &name, const std::string &text) {
  std::string path = workFolder().file(name);
  std::ofstream(path) << text;
  return path;
}

CompiledModel::CompiledModel(const std::string &file, const Settings &settings) {
  tf_simulation *raw = nullptr;
  const tf_status status = tf_load(compiled(file).c_str(), &raw);
  simulation_.reset(raw);
  check(status);
  for (const auto &[name, value] : settings) {
    check(tf_set(raw, name.c_str(), value));
  }
  check(tf_set_event_callback(raw, append, events_.get()));
}

void CompiledModel::check(tf_status status) const {
  if (status == TF_BAD_ARGUMENT || status == TF_FAILED) {
    throw std::runtime_error(tf_error_text(simulation_.get()));
  }
}

CompiledModel &CompiledModel::tolerance(double value) {
  check(tf_set_tolerance(simulation_.get(), value));
  return *this;
}

CompiledModel &CompiledModel::integrator(tf_integrator value) {
  check(tf_set_integrator(simulation_.get(), value));
  return *this;
}

CompiledModel &CompiledModel::stepOptions(int stages, double fixedStep) {
  check(tf_set_step_options(simulation_.get(), stages, fixedStep));
  return *this;
}

void CompiledModel::initialise(double startTime) {
  events_->clear();
  check(tf_initialise(simulation_.get(), startTime));
}

void CompiledModel::advance(double time) { check(tf_step(simulation_.get(), time)); }

void CompiledModel::run(double end) {
  initialise();
  advance(end);
}

double CompiledModel::operator[](const std::string &name) const {
  double value = std::numeric_limits<double>::quiet_NaN();
  check(tf_get_named(simulation_.get(), name.c_str(), &value));
  return value;
}

std::vector<double> CompiledModel::valuesOf(tf_kind kind) const {
  std::vector<double> values;
  for (int32_t i = 0; i < model().variable_count; ++i) {
    const tf_variable &variable = model().variables[i];
    if (variable.kind == kind) {
      values.resize(std::max(values.size(), static_cast<std::size_t>(variable.index) + 1));
      values[static_cast<std::size_t>(variable.index)] = tf_get(simulation_.get(), i);
    }
  }
  return values;
}

double CompiledModel::energy() const {
  const double now = time();
  const std::vector<double> q = valuesOf(TF_KIND_COORDINATE), v = valuesOf(TF_KIND_VELOCITY), z = valuesOf(TF_KIND_STATE),
                            u = valuesOf(TF_KIND_INPUT), p = valuesOf(TF_KIND_PARAMETER);
  const double *in[TF_IN_COUNT] = {};
  in[TF_IN_TIME] = &now;
  in[TF_IN_Q] = q.data();
  in[TF_IN_V] = v.data();
  in[TF_IN_Z] = z.data();
  in[TF_IN_U] = u.data();
  in[TF_IN_P] = p.data();
  double kinetic = 0, potential = 0, power = 0;
  double *out[] = {&kinetic, &potential, &power};
  model().energies(in, out, nullptr);
  return kinetic + potential;
}

int CompiledModel::count(tf_event_kind kind) const {
  return static_cast<int>(std::ranges::count_if(*events_, [kind](const Event &event) { return event.kind == kind; }));
}

double CompiledModel::eventTime(tf_event_kind kind, int number) const {
  for (const Event &event : *events_) {
    if (event.kind == kind && number-- == 0) {
      return event.time;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string errorOfRun(CompiledModel &model, double end) {
  try {
    model.run(end);
  } catch (const std::runtime_error &error) {
    return error.what();
  }
  return {};
}

void differentiateBy(CompiledModel &model, const std::vector<const char *> &names) {
  if (tf_set_sensitivities(model.simulation(), names.data(), names.size()) != TF_OK) {
    throw std::runtime_error(tf_error_text(model.simulation()));
  }
}

double sensitivity(const CompiledModel &model, const std::string &variable, std::size_t column) {
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  if (tf_get_sensitivity(model.simulation(), column, all.data()) != TF_OK) {
    throw std::runtime_error(tf_error_text(model.simulation()));
  }
  return all.at(static_cast<std::size_t>(tf_find(model.simulation(), variable.c_str())));
}

CsvTable::CsvTable(const std::string &path) {
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) {
    throw std::runtime_error("cannot read " + path);
  }
  for (std::istringstream header(line); std::getline(header, cell, ',');) {
    columns_.emplace_back(cell, std::vector<double>());
  }
  while (std::getline(file, line)) {
    std::istringstream row(line);
    for (auto &[name, values] : columns_) {
      std::getline(row, cell, ',');
      char *end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      values.push_back(end != cell.c_str() && *end == '\0' ? value : std::numeric_limits<double>::quiet_NaN());
    }
  }
}

const std::vector<double> &CsvTable::operator[](const std::string &column) const {
  for (const auto &[name, values] : columns_) {
    if (name == column) {
      return values;
    }
  }
  throw std::runtime_error("no column " + column);
}

}  // namespace tf::test
