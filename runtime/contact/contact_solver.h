// Which mode the contacts take, and their forces: the frictional contact problem at acceleration level and, where it is degenerate, at the
// level of the next derivative (theory.md section 6).
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/force_set.h"

#include <memory>

namespace tf::runtime {

// Derivatives by physical time at the instant of the decision, along the motion with the accelerations found.
struct ContactRates {
  std::vector<double> accelerationRate;  // n + m: d/dt of w = D λ + φ with λ held fixed
  std::vector<double> frictionRate;      // m: dμ/dt
  std::vector<double> boundRate;         // m: dbound/dt

  void resize(int normals, int tangents);  // all zero
};

class ContactSolver {
public:
  // Equality of forces and accelerations with zero, relative to the problem's scale.
  struct Settings {
    double feasibility = 1e-10;   // accepted violation of a condition
    double nearby = 1e-8;         // of slips of two components as well, where no method comes nearer
    double degeneracy = 1e-9;     // below: the row is decided by its next derivative
    bool listsDegenerate = true;  // false: nobody asks which rows these are
  };
  struct Statistics {
    long solves = 0, direct = 0, previousModeKept = 0, enumerated = 0, activeSet = 0, pivoted = 0, pivots = 0, redundant = 0, resolved = 0;
    long conic = 0, newtonIterations = 0;  // problems with slips of two components that are zero
    double worstViolation = 0;
  };

  ContactSolver();
  explicit ContactSolver(const Settings &settings);
  ~ContactSolver();
  ContactSolver(ContactSolver &&) noexcept;
  ContactSolver &operator=(ContactSolver &&) noexcept;

  // Solves the problem. `previous` (may be null; its shape must be the problem's) is preferred where several modes are consistent with the
  // same accelerations. `guess` (n + m, may be null): forces nearby, a start for slips of two components that are zero; several solutions
  // with different accelerations are not searched for with such slips. The reference is valid until the next call.
  const ContactSolution &solve(const ContactProblem &problem, const ContactMode *previous = nullptr, const double *guess = nullptr);

  // Decides the degenerate rows of `solution` (of `solve` on the same problem) by the first-order problem in λ̇, ẇ = D λ̇ + accelerationRate:
  // rows with λ_n = 0 = w_n, and rows with zero slip, w_t = 0 and |λ_t| = limit (of a pair the first row, ‖λ_t‖ = limit). The mode returned
  // holds right after the instant. Rows that this derivative leaves open too stay in `degenerate` and keep the previous mode, else the
  // lowest index closes first. Forces and accelerations are unchanged.
  const ContactSolution &resolve(const ContactProblem &problem, const ContactSolution &solution, const ContactRates &rates,
                                 const ContactMode *previous = nullptr);
  // λ̇ of the last `resolve`: n + m.
  [[nodiscard]] const std::vector<double> &forceRates() const;

  // What has been found of the forces of the last problem in one of its modes, for ModeForces::start.
  [[nodiscard]] std::unique_ptr<ForceSet> &forceSet();

  [[nodiscard]] const Statistics &statistics() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace tf::runtime
