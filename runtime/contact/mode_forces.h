// Contact forces as a smooth function of D, φ, μ and bounds within one mode: w = 0 on the active rows (closed normals, sticking tangents),
// λ_t = −s·limit on the slipping ones. Where D is singular on the active rows: the least-norm λ, on the limits that its mode saturates
// (theory.md section 6).
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/force_set.h"

#include <memory>
#include <span>
#include <vector>

namespace tf::runtime {

// An inequality that holds in the mode; it ends, or its representative changes, where the value falls to zero.
struct ModeMargin {
  // Rows of limits that are not one row's: the largest common slack of all limits; what redundant rows may still contradict one another
  // by; how far slips are from pressing their contacts in: the determinant of the forces' matrix, relative to the begin of the mode, or
  // what redundant rows have instead.
  static constexpr int commonSlack = -1, contradiction = -2, pressing = -3;
  ForceLimit limit;
  bool multiplier = false;  // the limit is saturated: the value is its multiplier, and zero means that the representative leaves it
};

enum class MarginOutcome : std::uint8_t {
  ModeEnds,  // no force of the mode remains admissible: find the successor with ContactSolver
  Rechosen   // the mode goes on with another least-norm representative (the margins have changed)
};

// Of slips that may press their contacts in: how far the matrix of the forces is from being singular.
struct PressingMargin {
  // The mode ends where the determinant has just changed its sign: at the zero itself forces are not defined. Slips of two components turn
  // there, without bound, and the determinant with them, perhaps back: they end just before.
  static constexpr double behind = -1e-6, before = 1e-6;
  std::vector<double> inverseDeterminant;  // of the matrix at the begin of the mode, as a product (LuFactor)
  double scale = 0;                        // the largest force there
  double end = behind;

  // Of the determinant relative to that of the begin.
  [[nodiscard]] double value(double determinant) const { return scale * (determinant - end); }
};

// The problem passed to `start` or `evaluate` last must exist while the results are used.
class ModeForces {
public:
  ModeForces();
  ~ModeForces();
  ModeForces(ModeForces &&) noexcept;
  ModeForces &operator=(ModeForces &&) noexcept;

  // Starts the mode at `problem`. Finds out whether the active rows are redundant, and then the least-norm representative. False: no
  // force of the mode is admissible there (or the active rows contradict one another). What `found` knows of the same problem in this mode
  // is taken from it (exchanged with a set that knows nothing). `known` (n + m): forces of the problem that may be those of the mode.
  bool start(const ContactProblem &problem, const ContactMode &mode, std::unique_ptr<ForceSet> *found = nullptr,
             const std::vector<double> *known = nullptr);

  // Whether the motion depends on how redundant rows share their load (theory.md section 6), at the last evaluation's problem.
  [[nodiscard]] bool sharesMove() const;

  // λ and w at another state of the same mode: only D, φ, μ, bound of `problem` may differ from `start`. Allocates nothing. False: the
  // matrix has become singular (of a mode that is not redundant), or an entry is not finite.
  bool evaluate(const ContactProblem &problem);

  // As `evaluate`, with forces that others have found (ForceSet::take), and the determinant of the forces' matrix relative to the begin of
  // the mode (where there is such a margin). Of `problem` D and φ are not read.
  void take(const ContactProblem &problem, const std::vector<double> &forces, const std::vector<double> &rest,
            const std::vector<double> &shares, double relativeDeterminant);
  // See ForceSet::listEquations.
  bool listEquations(std::vector<int> &rows, std::vector<ForceLimit> &saturated) const;

  [[nodiscard]] std::span<const double> forces() const;         // n + m, after start, evaluate or take
  [[nodiscard]] std::span<const double> accelerations() const;  // n + m: exactly 0 on the active rows
  [[nodiscard]] bool redundant() const;

  // The inequalities of the mode, a smooth function each, and their values at the last evaluation (forces' unit).
  [[nodiscard]] std::span<const ModeMargin> margins() const;
  [[nodiscard]] std::span<const double> marginValues() const;
  // The last margin is that of `pressing`.
  [[nodiscard]] bool mayPress() const;
  // Of that margin.
  [[nodiscard]] const PressingMargin &pressing() const;

  // The mode's start has been moved by what it was off by, to the point of the last evaluation: what redundant rows contradict one another
  // by there is no reason to end it.
  void acceptContradiction();

  // The margin has reached zero at the last evaluation and would become negative: can the mode go on with another representative?
  MarginOutcome cross(int margin);

  // Directional derivative of the forces at the last evaluation: accelerationRate = derivative of D λ + φ with λ fixed (n + m),
  // limitRate = derivative of the limits with λ fixed (m). Out: forceRate (n + m). In a redundant mode a change of D or μ moves the shares
  // of redundant contacts too: only with `shares`, which need shareMultipliers at this evaluation and sharesAreSmooth. Without them it is
  // the least-norm rate.
  void forceRates(std::span<const double> accelerationRate, std::span<const double> limitRate, std::span<double> forceRate,
                  const ShareRates *shares = nullptr) const;
  // Of a redundant mode at the last evaluation: its forces have a derivative that is known. Those that limits of slips of two components
  // hold have none: limits come and go among them without a margin.
  [[nodiscard]] bool sharesAreSmooth() const;
  // Of it the multipliers z (n + m) of the rows in the least-norm problem (ForceSet::shareMultipliers).
  [[nodiscard]] std::span<const double> shareMultipliers() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace tf::runtime
