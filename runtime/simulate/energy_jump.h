#pragma once

#include "runtime/integrate/model_evaluation.h"

#include <vector>

namespace tf::runtime {

// What a switch that turns over does to the energies at one point, where coordinates and velocities go on as they are. A kinetic energy
// that jumps says that positions of bodies move at once with another velocity, which only an impulse could do.
class EnergyJump {
public:
  explicit EnergyJump(ModelEvaluation &at) : at_(at), probe_(at.stateSize()) {}

  // With the step variables that are set, before and after; only q and z of the state are read.
  void begin(double time, const double *state) { before_ = evaluate(time, state); }
  void end(double time, const double *state) { after_ = evaluate(time, state); }

  [[nodiscard]] double ofPotential() const { return after_.potential - before_.potential; }
  // Whether one is more than what is left of continuous functions where a switch is found.
  [[nodiscard]] bool potentialJumps() const;
  [[nodiscard]] bool kineticJumps() const;

private:
  struct Energies {
    double potential = 0;
    double kinetic = 0, atRest = 0;  // at one velocity of all coordinates, and without any
  };
  Energies evaluate(double time, const double *state);

  ModelEvaluation &at_;
  std::vector<double> probe_;
  Energies before_, after_;
};

}  // namespace tf::runtime
