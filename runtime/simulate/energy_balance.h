// The energy balance of a run: kinetic + potential energy = start + work − losses. Work and the loss by friction are integrals along the
// trajectory; impacts add theirs at once.
#pragma once

#include "runtime/integrate/smooth_integrator.h"

#include <cmath>
#include <limits>
#include <vector>

namespace tf::runtime {

// Of applied forces, inputs, moving boundaries and constraints, and of friction (a loss), at a time.
struct Power {
  double time = std::numeric_limits<double>::quiet_NaN(), work = 0, friction = 0;
};

// In units of energy, since the start of the run.
struct EnergyTotals {
  double frictionLoss = 0;  // −∫ λ_t · slip dt
  double impactLoss = 0;
  double work = 0;   // of applied forces, moving boundaries and time-dependent constraints
  double start = 0;  // kinetic + potential energy at the start
  // Length of the steps with points at which the motion cannot be evaluated: the others stand for these, and nothing where there are none.
  double estimatedTime = 0;
  double largest = 1;  // kinetic or potential energy seen so far
  double passed = 0;   // work that was done either way, and losses
  // At the ends of the last step of the stabilised method, and at the begin of the one before, where the powers went on without a jump.
  Power earlier, begin, end;
};

class EnergyBalance {
public:
  explicit EnergyBalance(ModeDynamics &dynamics) : dynamics_(dynamics), state_(dynamics.size()), rate_(dynamics.size()) {}

  // The run begins at (time, state).
  void start(double time, const double *state);
  // Adds the integrals over a part of the integrator's last step, from where the last part ended; the dynamics is left at a point inside
  // it.
  void addStep(SmoothIntegrator &integrator, double begin, double end);
  // Adds an impact from the velocities in `before` to those in `after`, with the work of moving boundaries on its rows.
  void addImpact(double time, const double *before, const double *after, double boundaryWork);

  // Adds infinitely many impacts between two points, with their loss of energy and the loss by friction between them.
  void addImpacts(double beginTime, const double *begin, double endTime, const double *end, double impactLoss, double frictionLoss);

  [[nodiscard]] const EnergyTotals &totals() const { return totals_; }
  void restore(const EnergyTotals &totals) { totals_ = totals; }
  // Inputs or switches have jumped: what that did to the potential energy.
  void addJump(double potentialChange) {
    totals_.work += potentialChange;
    totals_.passed += std::abs(potentialChange);
  }
  // Kinetic and potential energy, power of applied forces.
  struct Energy {
    double kinetic = 0, potential = 0, power = 0;
    [[nodiscard]] double mechanical() const { return kinetic + potential; }
  };
  Energy energyAt(double time, const double *state);

  // |kinetic + potential − start − work + losses| at (time, state), relative to the largest energy that has been seen, at least 1,
  // or to that which has passed through the system, whichever is more.
  double error(double time, const double *state);

private:
  // What has come together along a part of a trajectory; `known`: the part of its points at which the motion can be evaluated.
  struct Passage {
    double known = 0, frictionLoss = 0, work = 0, passed = 0;
  };

  void note(const Energy &energy);
  bool readPower(double time, const double *state, Power &power);
  bool readEnds(SmoothIntegrator &integrator);
  [[nodiscard]] Passage integrateEnds(double begin, double end) const;
  Energy energyInside(SmoothIntegrator &integrator, double time);
  double reversed(double time, const double *state);
  double inputPower(double potential);
  Passage integrate(SmoothIntegrator &integrator, const Quadrature &rule, double begin, double length);
  Passage refine(SmoothIntegrator &integrator, const Passage &whole, double begin, double length, double accepted, int depth);

  ModeDynamics &dynamics_;
  EnergyTotals totals_;
  std::vector<double> state_, rate_, inputs_;
};

}  // namespace tf::runtime
