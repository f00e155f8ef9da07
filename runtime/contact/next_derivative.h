// Decisions on the next derivative: rows for which forces and accelerations leave two modes open follow the first-order problem
// ẇ = D λ̇ + accelerationRate, in which the other rows keep their equations (theory.md section 6).
#ifndef TF_RUNTIME_CONTACT_NEXT_DERIVATIVE_H
#define TF_RUNTIME_CONTACT_NEXT_DERIVATIVE_H

#include "runtime/contact/contact_solver.h"
#include "runtime/contact/planar_friction.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

class NextDerivative {
public:
  // Decides `solution.degenerate` and sets the mode of these rows; the list keeps those that this derivative leaves open too, which take
  // the previous mode (`previous` may be null), else the lowest index closes. No row is decided where the first-order problem has no
  // solution.
  void decide(const ContactProblem &problem, const ContactRates &rates, const ContactMode *previous,
              const ContactSolver::Settings &settings, ContactSolution &solution);
  [[nodiscard]] const std::vector<double> &forceRates() const { return forceRates_; }

private:
  void pose(const ContactProblem &problem, const ContactRates &rates, double degeneracy, const ContactSolution &solution);
  void poseTangent(const ContactProblem &problem, const ContactRates &rates, const ContactSolution &solution, double zeroForce, int j);
  void dropDependent();
  void label(const ContactProblem &problem, double degeneracy, const PlanarFrictionSolution &found, ContactSolution &solution) const;
  [[nodiscard]] bool labelNormal(int i, double zero, const PlanarFrictionSolution &found, ContactSolution &solution) const;
  [[nodiscard]] bool labelTangent(int n, int j, double zero, const PlanarFrictionSolution &found, ContactSolution &solution) const;

  PlanarFrictionSolver solver_;
  PlanarFrictionMode previous_;
  std::vector<std::uint8_t> degenerate_;  // rows
  bool redundant_ = false;
  std::vector<double> forceRates_, remaining_;
  std::vector<int> bilateral_;
  DenseMatrix gram_;
};

}  // namespace tf::runtime

#endif
