// What contacts do on one piece of a frozen phase with slips of two components, and their forces there as a function of the velocities: the
// direction of friction of pairs turns with their slip (spatial_frozen_phase.h).
#ifndef TF_RUNTIME_CONTACT_FROZEN_MODE_H
#define TF_RUNTIME_CONTACT_FROZEN_MODE_H

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
  // it is below `rest`. Redundant rows: the least-norm forces. False where they are not finite.
  bool forces(const FrozenProblem &problem, const std::vector<double> &velocity, double rest, std::vector<double> &force);

private:
  void align(const FrozenProblem &problem, const std::vector<double> &velocity, double rest);

  std::vector<double> current_;  // m: directions of the frames
  DenseMatrix turned_;
  ModeEquations equations_;
  LuFactor factor_;
  std::vector<std::uint8_t> active_;
  std::vector<std::int8_t> slip_;
  std::vector<double> friction_, offset_, bias_, fixed_, unknown_, acceleration_;
};

}  // namespace tf::runtime

#endif
