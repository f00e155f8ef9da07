// A model compiled by the program and simulated by libtf, as the tests see it. Every failure of tfc or libtf ends the test with its
// message.
#pragma once

#include "runtime/tf.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tf::test {

struct Event {
  double time = 0, tau = 0;
  tf_event_kind kind = TF_EVENT_COUNT;
  int element = -1;
};

inline constexpr tf_integrator integrators[] = {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE};

using Settings = std::vector<std::pair<std::string, double>>;

// Path of examples/NAME.
[[nodiscard]] std::string example(const std::string &name);
// A model's text in a file of the tests' folder; its path.
[[nodiscard]] std::string sourceFile(const std::string &name, const std::string &text);

class CompiledModel {
public:
  // Compiles the file (once per process) and applies the settings. Throws std::runtime_error with the program's diagnostics.
  explicit CompiledModel(const std::string &file, const Settings &settings = {});

  CompiledModel &tolerance(double value);
  CompiledModel &integrator(tf_integrator value);
  CompiledModel &stepOptions(int stages, double fixedStep);

  // Throws with libtf's error text if it fails.
  void initialise(double startTime = 0);
  void advance(double time);
  // Both: from 0 to the end.
  void run(double end);

  [[nodiscard]] double operator[](const std::string &name) const;
  [[nodiscard]] double time() const { return tf_time(simulation_.get()); }
  // The variables of a kind, in the order of their index.
  [[nodiscard]] std::vector<double> valuesOf(tf_kind kind) const;
  // Kinetic plus potential energy of the current state.
  [[nodiscard]] double energy() const;

  [[nodiscard]] const std::vector<Event> &events() const { return *events_; }
  [[nodiscard]] int count(tf_event_kind kind) const;
  // Time of the number-th event of a kind (from 0), NaN if there is none.
  [[nodiscard]] double eventTime(tf_event_kind kind, int number = 0) const;
  [[nodiscard]] tf_simulation *simulation() const { return simulation_.get(); }
  [[nodiscard]] const tf_model &model() const { return *tf_get_model(simulation_.get()); }

private:
  struct Free {
    void operator()(tf_simulation *simulation) const { tf_free(simulation); }
  };
  void check(tf_status status) const;

  std::unique_ptr<std::vector<Event>> events_ = std::make_unique<std::vector<Event>>();
  std::unique_ptr<tf_simulation, Free> simulation_;
};

// libtf's error text of a run from 0 to the end, empty where there is no error.
[[nodiscard]] std::string errorOfRun(CompiledModel &model, double end);

// From the next initialise on, derivatives by these variables are computed. Both throw with libtf's error text if they fail.
void differentiateBy(CompiledModel &model, const std::vector<const char *> &names);
// Of a variable by the column-th of these names, at the current time.
[[nodiscard]] double sensitivity(const CompiledModel &model, const std::string &variable, std::size_t column);

// Columns of a CSV file with a header row, by name; text cells are NaN.
class CsvTable {
public:
  explicit CsvTable(const std::string &path);
  [[nodiscard]] const std::vector<double> &operator[](const std::string &column) const;
  [[nodiscard]] std::size_t rows() const { return columns_.front().second.size(); }

private:
  std::vector<std::pair<std::string, std::vector<double>>> columns_;
};

}  // namespace tf::test
