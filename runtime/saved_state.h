// The complete state of a run as bytes: the simulation's state and the inputs' constants, marked with the model and the parameters that
// they belong to. Tables and functions of inputs are not part of it: they are the caller's.
#pragma once

#include "runtime/model/input_signals.h"
#include "runtime/model/model_instance.h"
#include "runtime/model/outcome.h"
#include "runtime/simulate/simulation.h"

#include <cstddef>

namespace tf::runtime {

// Bytes that saveState writes.
std::size_t savedStateSize(const InputSignals &inputs, const Simulation &simulation);
// buffer: savedStateSize bytes of any alignment.
void saveState(const ModelInstance &instance, const InputSignals &inputs, const Simulation &simulation, void *buffer);
// Refuses bytes that saveState did not write for this model with these parameters; then nothing is changed.
Outcome<void> restoreState(const ModelInstance &instance, InputSignals &inputs, Simulation &simulation, const void *buffer,
                           std::size_t size);

}  // namespace tf::runtime
