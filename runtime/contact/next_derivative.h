// Decisions on the next derivative: rows for which forces and accelerations leave two modes open follow the first-order problem
// ẇ = D λ̇ + accelerationRate, in which the other rows keep their equations (theory.md section 6).
#pragma once

#include "runtime/contact/cone_friction.h"
#include "runtime/contact/contact_solver.h"
#include "runtime/contact/planar_friction.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

class NextDerivative {
public:
  // Pairs of rows that leave stick must lie along their force (ContactSolver turns them), but for those without any limit yet.
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
  bool solvePlanar(const PlanarFrictionMode *preferred, double feasibility);
  bool solveConic(double feasibility);
  void label(const ContactProblem &problem, double degeneracy, ContactSolution &solution) const;
  [[nodiscard]] bool labelNormal(int i, double zero, ContactSolution &solution) const;
  [[nodiscard]] bool labelTangent(int n, int j, double zero, ContactSolution &solution) const;
  [[nodiscard]] bool labelPair(int n, int j, double zero, ContactSolution &solution) const;

  PlanarFrictionSolver solver_;
  ConeFrictionSolver cone_;  // its problem is the one that is posed; `solver_` takes over where it has no pairs
  PlanarFrictionSolution found_;
  std::vector<double> metric_;
  PlanarFrictionMode previous_;
  std::vector<std::uint8_t> degenerate_;  // rows
  bool redundant_ = false;
  std::vector<double> forceRates_, remaining_;
  std::vector<int> bilateral_;
  DenseMatrix gram_;
};

}  // namespace tf::runtime
