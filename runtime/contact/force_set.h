// All forces of one contact mode, a convex set: A x = rhs on the active rows, λ_n ≥ 0 and ‖λ_t‖ ≤ limit. More than one point where
// contacts are redundant (D singular on the active rows); its representative is the least-norm force (theory.md section 6). It is a
// polyhedron unless slips with two components stick (isConic).
#pragma once

#include "runtime/contact/conic_forces.h"
#include "runtime/contact/contact_problem.h"
#include "runtime/contact/equal_shares.h"
#include "runtime/contact/least_norm.h"
#include "runtime/contact/matrix_parts.h"
#include "runtime/contact/mode_equations.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace tf::runtime {

// How that changes what decides on the share of redundant rows (ForceSet::shareMultipliers), beside what changes forces of any rows.
struct ShareRates {
  const double *multiplierAcceleration = nullptr;  // n + m: derivative of D z with z fixed
  const double *friction = nullptr;                // m: of μ
};

class ForceSet {
public:
  // Begins a mode: which rows are active and which limits they have.
  void setMode(const ContactProblem &problem, const ContactMode &mode);
  // It has been begun in this mode and not been forgotten since.
  [[nodiscard]] bool hasMode(const ContactProblem &problem, const ContactMode &mode) const;
  void forget() { hasMode_ = false; }
  // The same problem is at another place now.
  void move(const ContactProblem &problem) { view(problem); }
  [[nodiscard]] const ModeEquations &equations() const { return equations_; }
  [[nodiscard]] const std::vector<ForceLimit> &limits() const { return limits_; }
  [[nodiscard]] int activeCount() const { return equations_.activeCount(); }

  // Whether the active rows are redundant at the problem's D.
  bool singular(const ContactProblem &problem);
  // It was so in the last call of `singular`.
  [[nodiscard]] bool isSingular() const { return singular_; }
  // The last solveLeastNorm in this mode has found forces within this tolerance.
  [[nodiscard]] bool hasLeastNorm(double tolerance) const { return leastNormTolerance_ <= tolerance; }

  // Whether the motion depends on the share of the load that redundant rows have: friction on sliding contacts goes with it.
  [[nodiscard]] bool sharesMove(const ContactProblem &problem);

  // The unique force; false where the matrix is singular. Results in forces(), accelerations().
  bool solveRegular(const ContactProblem &problem);
  // The matrix of the last solveRegular.
  [[nodiscard]] const LuFactor &factor() const { return factor_; }
  // Directional derivative after solveRegular, or after solveLeastNorm or solveActive, see ModeForces::forceRates.
  void forceRates(const ContactProblem &problem, const double *accelerationRate, const double *limitRate, double *forceRate);
  // `shares` (may be null: at fixed D and μ) after shareMultipliers.
  void leastNormRates(const ContactProblem &problem, const double *accelerationRate, const double *limitRate, const ShareRates *shares,
                      double *forceRate);
  // See ModeForces::sharesAreSmooth; after solveLeastNorm or solveActive.
  [[nodiscard]] bool sharesAreSmooth() const { return !conic_ || inside_; }
  // z (n + m, 0 on rows that are not active): ½‖λ‖² has the gradient Aᵀ z along x but for the multipliers of saturated limits.
  const std::vector<double> &shareMultipliers(const ContactProblem &problem);

  // The least-norm force. Tolerances are relative to the force scale of the problem.
  LeastNorm::Status solveLeastNorm(const ContactProblem &problem, double tolerance) {
    hasEqualShares_ = isTaken_ = false;
    const LeastNorm::Status status = conic_ ? solveConic(problem, tolerance) : solvePolyhedron(problem, tolerance);
    leastNormTolerance_ = status == LeastNorm::Status::Solved ? tolerance : std::numeric_limits<double>::infinity();
    return status;
  }
  // Where there is no least-norm force, of rows of a polyhedron that nearly depend on one another, as those of a wedge that is nearly flat:
  // the unique force if there is one within the limits, to `tolerance` of the largest force (the rows are not singular from then on); else
  // the one nearest to `known` (n + m, may be null: none), forces of the same problem that have been found otherwise. False: neither.
  bool solveNearlyDependent(const ContactProblem &problem, const std::vector<double> *known, double tolerance);
  // The rows of the equations that the representative obeys, and the limits that it saturates. False: more than these give it, as where it
  // is that of a cone. After `singular`, solveLeastNorm, activate or release.
  bool listEquations(std::vector<int> &rows, std::vector<ForceLimit> &saturated) const;
  // Forces (n + m) that others have found by them; of the other rows (n + m) what is left of their accelerations, and of those with
  // saturated limits the force of an equal row without one.
  void take(const ContactProblem &problem, const std::vector<double> &forces, const std::vector<double> &rest,
            const std::vector<double> &shares);
  // The least-norm force on the equations and limits that were active in the last solveLeastNorm, activate or release.
  bool solveActive(const ContactProblem &problem);
  // After solveLeastNorm of the same problem: leaves in `fixed` those of its limits (indices into limits()) whose largest slack in the set
  // is no more than `tolerance`, relative to the force scale.
  void keepFixed(const ContactProblem &problem, std::vector<int> &fixed, double tolerance);

  // limits()[k] is saturated by the representative: index among the active constraints, or −1.
  [[nodiscard]] int saturated(int k) const;
  [[nodiscard]] bool isConic() const { return conic_; }
  // A conic set's representative is the least-norm solution of the equations alone while that is within all limits.
  [[nodiscard]] bool isInside() const { return inside_; }
  // Such a solution has left a limit: from now on the representative obeys them all. Empty: there is none.
  LeastNorm::Status confine(const ContactProblem &problem, double tolerance);
  // The largest slack that all limits of a conic set can have at once, while it is not inside: the mode ends where it falls to zero.
  [[nodiscard]] double commonSlack() {
    findInnermost();
    return commonSlack_;
  }

  // How far rows of a polyhedron that depended on others when it was chosen contradict them now, relative to the force scale.
  [[nodiscard]] bool mayContradict() const { return !conic_ && !dependent_.empty(); }
  [[nodiscard]] double contradiction() const;

  // Of limits()[k], saturated, of a polyhedron, in the unit of forces.
  [[nodiscard]] double multiplier(int k) {
    if (isTaken_)
      return takenMultiplier_[k];
    return hasEqualShares_ ? equalShares_.multipliers()[saturated(k)] : polyhedron_.multipliers()[saturated(k)];
  }
  // Slack of limits()[k] at forces().
  [[nodiscard]] double slack(const ContactProblem &problem, int k) const;
  LeastNorm::Status activate(int k);
  // False: what has given the forces has no polyhedron's data, see solveAll.
  [[nodiscard]] bool release(int k);

  [[nodiscard]] const std::vector<double> &forces() const { return forces_; }
  [[nodiscard]] const std::vector<double> &accelerations();
  [[nodiscard]] double forceScale() const { return forceScale_; }
  // The largest of the forces that would hold one active row each, at least what is nothing against the load; the others have no force.
  [[nodiscard]] double largestLoad() const;

private:
  void view(const ContactProblem &problem);
  bool solveUnique(const ContactProblem &problem, double tolerance);
  LeastNorm::Status solveConic(const ContactProblem &problem, double tolerance);
  LeastNorm::Status solvePolyhedron(const ContactProblem &problem, double tolerance);
  void loadPolyhedron();
  bool goFarAlong(const std::vector<int> &limits);
  void findWeights();
  void weighEquations();
  void loadEquation(int r);
  [[nodiscard]] double atReference(const double *normal) const;
  [[nodiscard]] double weightlessForce() const;
  // The normal of a limit among the unknowns (`owner` < 0: one entry) and its bound, divided by the normal's length.
  struct LimitRow {
    int own = 0, owner = -1;
    double ownEntry = 0, ownerEntry = 0, bound = 0, length = 1;
  };
  [[nodiscard]] LimitRow limitRow(int l) const;
  void loadLimit(int l);
  void loadActive();
  bool solveEqualShares();
  bool chooseShares();
  void loadShares();
  bool solveAll();
  void expandPoint(const double *point);
  void loadConic();
  bool prepareConic();
  void confineConic();
  void followConic();
  void findInnermost();
  [[nodiscard]] int conicSaturated(int k) const;
  void findPolyhedronMultipliers(Eigen::VectorXd &equations);
  void shareGradient(const ShareRates &shares);
  void pointRate(const double *limitRate);
  void conicPointRate();

  ContactRowData rows_;
  ModeEquations equations_;
  LuFactor factor_;
  LeastNorm polyhedron_, far_;
  EqualShares equalShares_;
  bool hasEqualShares_ = false;  // which have given the forces: polyhedron_ knows its active set only
  bool isTaken_ = false;         // forces_ are from elsewhere, with what rows contradict one another by
  double takenContradiction_ = 0;
  std::vector<double> takenMultiplier_;  // of limits
  bool hasFar_ = false;                  // far_ has the equations of the last solveLeastNorm
  std::vector<ForceLimit> limits_;
  std::vector<std::uint8_t> active_;
  std::vector<std::int8_t> slip_;
  std::vector<double> reference_;  // of unknowns: what the least norm is that of the difference from; empty: zero
  std::vector<double> offset_, fixed_, unknown_, weight_, inverseWeight_, forces_, accelerations_;
  std::vector<int> dependent_;              // of the equations of a polyhedron: those that depended on others in the last solveLeastNorm
  std::vector<double> length_, boundRate_;  // of constraints: rows before they were made unit, and derivatives of their bounds
  // Of the equations' and the limits' multipliers, see shareMultipliers; row accelerations D z; in y: of unknown forces, the derivative of
  // the gradient at fixed multipliers, and their own.
  std::vector<double> multiplier_, multiplierAcceleration_, limitMultiplier_;
  Eigen::VectorXd gradientRate_, pointRate_, rhsRate_;
  DenseMatrix matrix_;
  MatrixParts partition_;  // of matrix_
  // For equalShares_: unknowns that are sets of their own; of sets, their row of D, and what takes an entry of it into that of a normal; of
  // slipping rows that are loaded, the unknown, the row, and what it adds by.
  std::vector<std::uint8_t> isAlone_;
  std::vector<int> setRow_;
  std::vector<double> setFactor_;
  struct Loaded {
    int unknown = 0, row = 0;
    double factor = 0;
  };
  std::vector<Loaded> loads_;
  double forceScale_ = 0, load_ = 0;
  bool hasMode_ = false, singular_ = false;
  double leastNormTolerance_ = 0;  // infinite: none has been found
  bool conic_ = false, inside_ = true, hasInnermost_ = false;
  double commonSlack_ = 0;
  ConicForces cone_;
};

}  // namespace tf::runtime
