// Simulation of one compiled model: initialisation, smooth modes, events, frozen phases, in physical and numerical time.
// The C API (runtime/tf.h) is a thin layer over this class. No exceptions leave it.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/model/input_signals.h"
#include "runtime/model/model_instance.h"
#include "runtime/tf.h"

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace tf::runtime {

struct SimulationOptions {
  double tolerance = 1e-6;  // relative, and absolute in units of each variable's nominal
  tf_integrator integrator = TF_AUTO;
  int stages = 0;        // Radau IIA stages 1..4; 0: by tolerance
  double fixedStep = 0;  // > 0: no error control (studies of order)
  double longestStep = std::numeric_limits<double>::infinity();
  std::vector<std::int32_t> sensitivities;  // numbers of the variables by which the run is differentiated
  bool energyBalance = false;               // work, losses and the balance's error
};

class Simulation {
public:
  // Both must outlive the simulation.
  Simulation(ModelInstance &instance, InputSignals &inputs);
  ~Simulation();
  Simulation(const Simulation &) = delete;
  Simulation &operator=(const Simulation &) = delete;

  SimulationOptions options;  // read by initialise
  std::function<void(const tf_event &)> onEvent;
  std::function<void(const tf_note &)> onNote;
  // Called at a sample, with the time that was asked for, whose values can be read then; gives the time of the next one, which is later;
  // not a number: the run ends.
  std::function<double(double)> onSample;

  // Evaluates the starts, resolves contacts and an impact at the start time. TF_FAILED: see errorText().
  tf_status initialise(double startTime);
  // To `time` exactly. On failure the state is that of the last good point.
  tf_status advanceTo(double time);
  // As well, with samples from `firstSample` on, all before `time`: inside steps, on their interpolants. Where an event is at the time of a
  // sample this comes after it.
  tf_status advanceTo(double time, double firstSample);

  // From onEvent and onNote: advanceTo ends behind its step with TF_TERMINATED.
  void stop();

  [[nodiscard]] double time() const;
  [[nodiscard]] double tau() const;
  // model->variable_count values in the order of the table of variables.
  void values(double *all);
  // Numbers of the variables by which this run is differentiated.
  [[nodiscard]] std::vector<std::int32_t> differentiatedBy() const;
  // Derivatives of all variables by options.sensitivities[column] (the mode is held). False: they cannot be evaluated here.
  bool sensitivity(int column, double *all);
  // The same just before the latest event; called from onEvent only.
  void sensitivityBeforeEvent(int column, double *all);
  // State just before the latest event, in the same order (--events both); called from onEvent only.
  void valuesBeforeEvent(double *all);
  // Of points at which events have been reported: those reported with the same number are at one point.
  [[nodiscard]] long long reportedPoints() const;
  [[nodiscard]] const std::string &errorText() const;
  [[nodiscard]] const tf_statistics &statistics() const;

  // Everything that continuation depends on.
  [[nodiscard]] std::size_t stateSize() const;
  void save(void *buffer) const;
  void restore(const void *buffer);

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tf::runtime
