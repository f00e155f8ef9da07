// The worst violations of what must hold at every point of a run: gaps and normal forces are not negative, constraints hold, the energy
// balance closes.
#pragma once

#include "runtime/integrate/mode_dynamics.h"

namespace tf::runtime {

// The worst value so far, where and when.
struct Extreme {
  double value = 0, time = 0;
  int element = -1;  // contact or constraint element
};

class Invariants {
public:
  void start();
  // At the dynamics' last evaluation; constraint residuals are evaluated here, and the gaps of contacts that are awake (GapScreen), unless
  // all gaps have been.
  void observe(ModeDynamics &dynamics, bool hasAllGaps);
  // At a result between the ends of steps, where all gaps have been evaluated: they are zero there only as nearly as the interpolant is
  // exact, which `error` bounds, in parts of their scales.
  void observeInside(const ModelEvaluation &model, double error);
  void observeEnergy(double error, double time);

  [[nodiscard]] const Extreme &gap() const { return gap_; }                  // least
  [[nodiscard]] const Extreme &normalForce() const { return normalForce_; }  // least, before errors below zero are cut off
  [[nodiscard]] double largestNormalForce() const { return largestNormalForce_; }
  [[nodiscard]] const Extreme &constraint() const { return constraint_; }  // largest residual or rate
  [[nodiscard]] const Extreme &energy() const { return energy_; }          // largest relative error

private:
  Extreme gap_, normalForce_, constraint_, energy_;
  double largestNormalForce_ = 0;
};

}  // namespace tf::runtime
