// What contacts do on one piece of a frozen phase with slips of two components, and their forces there as a function of the velocities: the
// direction of friction of pairs turns with their slip (spatial_frozen_phase.h).
#ifndef TF_RUNTIME_CONTACT_FROZEN_MODE_H
#define TF_RUNTIME_CONTACT_FROZEN_MODE_H

#include "runtime/contact/conic_forces.h"
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/mode_equations.h"

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

class FrozenMode {
public:
  enum class Normal : std::uint8_t { Off, Held, Push };     // λ_n = 0, w_n = 0, λ_n = rate
  enum class Tangent : std::uint8_t { None, Slip, Stick };  // λ_t = 0, −μ λ_n s, w_t = 0

  std::vector<Normal> normal;     // n
  std::vector<Tangent> tangent;   // m; both rows of a pair the same
  std::vector<int> sign;          // m: of slips of one component
  std::vector<double> direction;  // m: of pairs, the reference direction; (1, 0) where never set

  void resize(const FrozenProblem &problem);
  void setTangent(const FrozenProblem &problem, int j, Tangent kind, int slipSign);
  // Of the pair that begins with j, unless the vector is zero.
  void setDirection(int j, double x, double y);

  // D with the pairs that slip turned into their directions; forces from these frames back.
  void turn(const FrozenProblem &problem, DenseMatrix &delassus) const;
  void turnBack(const FrozenProblem &problem, std::vector<double> &forces) const;

  // λ (n + m) at the velocities (n + m). The direction of friction is v_t/‖v_t‖ continued through zero along the reference direction, which
  // it is below `rest`. Redundant rows: the forces nearest to those of `refer`. False where they are not finite.
  bool forces(const FrozenProblem &problem, const std::vector<double> &velocity, double rest, std::vector<double> &force);
  // Forces (n + m) of the mode, of which those of redundant rows stay near.
  void refer(const std::vector<double> &force) { reference_ = force; }
  // Of the latest `forces`.
  [[nodiscard]] bool isRedundant() const { return redundant_; }
  // After `forces` with redundant rows: the forces with the largest common margin to their limits, 0 ≤ λ_n ≤ rate and ‖λ_t‖ ≤ μ λ_n, are
  // those to stay near. False, and nothing changes, where there is no margin; `leaving` (n + m, else 0) are then the rows without one, −1
  // at λ_n = 0 and 1 at the other limits.
  bool center(const FrozenProblem &problem, std::vector<int> &leaving);

private:
  void align(const FrozenProblem &problem, const std::vector<double> &velocity, double rest);
  int poseLimits(const FrozenProblem &problem);

  std::vector<double> current_;  // m: directions of the frames
  DenseMatrix turned_;
  ModeEquations equations_;
  LuFactor factor_;
  std::vector<std::uint8_t> active_;
  std::vector<std::int8_t> slip_;
  std::vector<double> friction_, offset_, bias_, fixed_, unknown_, acceleration_, reference_;
  bool redundant_ = false;
  ConicForces admissible_;
};

}  // namespace tf::runtime

#endif
