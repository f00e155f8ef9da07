// The complementarity problem of planar Coulomb friction behind all decisions: accelerations, their next derivatives, and frozen phases
// differ in the kinds of their rows only. w = D λ + φ with, for normal rows,
//   Prescribed  λ = upper                        Bilateral  w = 0
//   Unilateral  0 ≤ λ ≤ upper, λ < upper ⇒ w ≥ 0, λ > 0 ⇒ w ≤ 0   (upper may be infinite)
// and for tangential rows, with limit = friction λ_owner + offset,
//   None  λ = 0        Slip  λ = −sign·limit        Bilateral  w = 0
//   TwoSided  |λ| ≤ limit with w = 0, or λ = −limit·sign(w)
//   OneSided  (limit − sign·λ) ≥ 0 ⟂ −sign·w ≥ 0: the force is at sign·limit and may leave it
#pragma once

#include "runtime/contact/lcp.h"
#include "runtime/contact/mode_equations.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

enum class NormalKind : std::uint8_t { Prescribed, Bilateral, Unilateral };
enum class TangentKind : std::uint8_t { None, Slip, Bilateral, TwoSided, OneSided };

struct PlanarFrictionProblem {
  int normalCount = 0, tangentCount = 0;
  DenseMatrix delassus;
  std::vector<double> bias;
  std::vector<NormalKind> normalKind;
  std::vector<double> upper;
  std::vector<TangentKind> tangentKind;
  std::vector<std::int8_t> sign;
  std::vector<int> owner;
  std::vector<double> friction, offset;

  // Unilateral rows without upper bound, tangential rows None; D and φ are zero.
  void resize(int normals, int tangents);
  // Of φ_r in the scale that tells what is small. Where w_r may have any size, as that of a body which falls along a wall, nothing depends
  // on it but what rounding makes of it elsewhere; friction that does is no larger than its normal force.
  [[nodiscard]] double weight(int row) const {
    const bool isBound =
        row < normalCount ? normalKind[row] != NormalKind::Prescribed : tangentKind[row - normalCount] == TangentKind::Bilateral;
    return isBound ? 1 : freeWeight;
  }
  static constexpr double freeWeight = 1e-3;
};

enum class NormalState : std::uint8_t { Off, Active, Upper };  // λ = 0 (or prescribed), w = 0, λ = upper

struct PlanarFrictionMode {
  std::vector<NormalState> normal;
  std::vector<std::int8_t> slip;  // 0 stick (or no force), ±1
  bool operator==(const PlanarFrictionMode &) const = default;
};

struct PlanarFrictionSolution {
  enum class Status : std::uint8_t { Solved, Several, None, Unsettled };  // Several: other solutions have other accelerations
  Status status = Status::None;
  PlanarFrictionMode mode;
  std::vector<double> force, acceleration;
  double violation = 0;  // relative to the size of the data in the metric of D: φ_r / √D_rr, upper_r √D_rr
  // Of forces and accelerations that matter, in the metric of D: λ_r √D_rr and w_r / √D_rr are small compared with it, or not.
  double scale = 0;
};

// No scale is finer than a solution with this violation of data of this size is exact.
[[nodiscard]] inline double finestScale(double violation, double size) { return 1e10 * violation * size; }

class PlanarFrictionSolver {
public:
  PlanarFrictionProblem &problem() { return problem_; }
  [[nodiscard]] const PlanarFrictionProblem &problem() const { return problem_; }

  // What is asked for: the accelerations, with any forces that have them, or forces as near to the previous mode as may be.
  enum class Wanted : std::uint8_t { Forces, Accelerations };
  // Among several solutions: `previous` (may be null) unless it is unstable, else the one with the fewest contacts pushing, else that
  // where the lowest index does. `tolerance`: accepted violation.
  const PlanarFrictionSolution &solve(const PlanarFrictionMode *previous, double tolerance, Wanted wanted = Wanted::Forces);
  // Of the last problem.
  [[nodiscard]] const PlanarFrictionSolution &solution() const { return solution_; }
  // √D_rr, or 1 where it is zero: forces times it and accelerations over it are comparable between rows.
  [[nodiscard]] const std::vector<double> &metric() const { return metric_; }
  // Violation of the last problem's conditions by other forces and accelerations, relative to the size of the data.
  double certificate(const std::vector<double> &force, const std::vector<double> &acceleration);
  [[nodiscard]] int pivots() const { return pivots_; }
  // How the last solution was found: the previous mode holds, all modes were tried, by an active set, by pivoting.
  enum class Path : std::uint8_t { Previous, Enumeration, ActiveSet, Pivoting };
  [[nodiscard]] Path path() const { return path_; }

private:
  struct Candidate {
    PlanarFrictionMode mode;
    std::vector<double> force, acceleration;
    double violation = 0;
    int pushing = 0, changes = 0;
  };

  // Of a mode.
  enum class Equations : std::uint8_t { Unknown, Regular, Singular };

  void scale();
  [[nodiscard]] double limit(int j, const std::vector<double> &force) const;
  [[nodiscard]] bool carriesForce(int j, const PlanarFrictionMode &mode) const;
  void completeMode(PlanarFrictionMode &mode) const;
  bool evaluate(Candidate &candidate);
  [[nodiscard]] double violation(const std::vector<double> &force, const std::vector<double> &acceleration) const;
  [[nodiscard]] bool isUnique(Wanted wanted);
  [[nodiscard]] bool hasUniqueNormals();
  [[nodiscard]] bool hasSmallFriction(bool withForces);
  [[nodiscard]] bool stable(const PlanarFrictionMode &mode) const;
  [[nodiscard]] bool sameMotion(const Candidate &a, const Candidate &b) const;
  [[nodiscard]] double modeCount() const;
  [[nodiscard]] int optionCount(int row, const PlanarFrictionMode &mode) const;
  void setOption(int row, int option, PlanarFrictionMode &mode) const;
  bool nextMode(PlanarFrictionMode &mode);
  int enumerate(const PlanarFrictionMode *previous, bool firstOnly);
  void countChanges(const PlanarFrictionMode *previous);
  [[nodiscard]] bool preferred() const;
  void setEquations(const PlanarFrictionMode &mode);
  bool solveEquations(Candidate &candidate);
  // Whether the equations of a singular mode agree with one another.
  enum class Agreement : std::uint8_t { Agree, Contradict, NotFinite };
  Agreement solveRedundant(Candidate &candidate);
  bool solveLikeBefore(Candidate &candidate, Equations &kind);
  // A row to another normal state, or slip, than the one in which it is off by so much.
  struct Move {
    int row = 0;
    std::int8_t to = 0;
    double by = 0;
  };
  void listMoves(const Candidate &candidate);
  void move(const Move &move, PlanarFrictionMode &mode) const;
  bool accept();
  bool activeSet(const PlanarFrictionMode *start, Equations known);
  bool pivot();
  int assignVariables();
  void buildTransfer();
  void buildComplementarity(int variables);
  void readComplementarity(Candidate &candidate);
  PlanarFrictionSolution::Status search(const PlanarFrictionMode *previous, Wanted wanted);
  void publish(PlanarFrictionSolution::Status status);

  PlanarFrictionProblem problem_, scaled_;
  PlanarFrictionSolution solution_;
  ContactRowData rows_;
  std::vector<double> metric_;
  double magnitude_ = 0, tolerance_ = 0;
  ModeEquations equations_;
  LuFactor factor_;
  LinearComplementarity complementarity_;
  std::vector<std::uint8_t> active_;
  std::vector<std::int8_t> slip_;
  std::vector<double> fixed_, unknown_;
  std::vector<int> option_, firstVariable_, order_;
  // λ = T z + constant, w = D T z + constantResponse: entries of T, and D T.
  struct Entry {
    int row = 0, variable = 0;
    double factor = 0;
  };
  std::vector<Entry> transfer_;
  DenseMatrix response_;
  std::vector<double> constant_, constantResponse_;
  DenseMatrix modeMatrix_, rest_;
  std::vector<double> target_, residual_;
  Candidate trial_, best_;
  PlanarFrictionMode returning_;  // of the active set
  std::vector<Move> moves_;
  int pivots_ = 0;
  Path path_ = Path::Previous;
};

}  // namespace tf::runtime
