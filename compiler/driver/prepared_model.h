// From what `tfc run` was given to a simulation: a compiled model is loaded, a source is compiled or found in the cache.
#pragma once

#include "compiler/codegen/codegen.h"
#include "compiler/driver/options.h"
#include "compiler/driver/session.h"
#include "compiler/driver/source_model.h"
#include "runtime/tf.h"

#include <memory>
#include <optional>
#include <string>

namespace tf::driver {

struct FreeSimulation {
  void operator()(tf_simulation *simulation) const { tf_free(simulation); }
};
using SimulationHandle = std::unique_ptr<tf_simulation, FreeSimulation>;

struct PreparedModel {
  std::unique_ptr<CompiledInMemory> code;  // of a model that is in no file
  SimulationHandle simulation;
  bool isSource = false;
  std::string origin;  // "compiled", "cached", "loaded": for the summary

  [[nodiscard]] const tf_model &model() const { return *tf_get_model(simulation.get()); }
};

// Nothing if the model is wrong or cannot be loaded (reported).
[[nodiscard]] std::optional<PreparedModel> prepareModel(const RunOptions &options, const std::vector<Setting> &settings, Session &session);

}  // namespace tf::driver
