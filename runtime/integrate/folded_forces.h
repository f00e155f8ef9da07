// The contact forces of a mode with independent active rows, straight from the rows: the friction of slipping contacts is folded into the
// columns of their normal forces (λ_t = −s μ λ_n), so that W is applied once for each unknown force and D is needed between active rows
// only. The same equations as ModeForces, which also serves redundant rows, derivatives, and systems that are not small, where RowSystem
// makes use of the zeros.
#pragma once

#include "runtime/contact/lu_factor.h"
#include "runtime/contact/mode_forces.h"
#include "runtime/integrate/row_system.h"
#include "runtime/integrate/small_system.h"

#include <span>
#include <vector>

namespace tf::runtime {

class FoldedForces {
public:
  // Begins a mode in which all normal rows of `rows` are closed, with the forces and margins of `start`; both may be without rows. The
  // model has been evaluated.
  void choose(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, const ContactMode &mode,
              const ModeForces &start);

  // Forces and accelerations [nv] at the evaluation's point; `rows` have been gathered there. Allocates nothing. False: singular.
  bool evaluate(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, double *acceleration);

  // As well, straight from the model's functions, where `isSmall`: only the limits of `problem` have been gathered, and no mass matrix need
  // be factorised. False: singular.
  bool evaluateSmall(const ModelEvaluation &at, const ContactRows &problem, double *acceleration);
  // rate = (v, v') [2 nv] at the evaluation's point, where `isSmall` and q' = v. False: a value is not finite.
  bool giveRates(const ModelEvaluation &at, double *rate) const { return small_.giveRates(at.velocities(), at.acceleration.data(), rate); }
  // change += M⁻¹ Jᵀ (J M⁻¹ Jᵀ)⁻¹ residual over the rows that take part [rows], where `isSmall`: all normal rows, or all active ones.
  // False: other rows.
  bool correct(const ModelEvaluation &at, const std::uint8_t *takesPart, const double *residual, double *change) const;
  [[nodiscard]] bool isSmall() const { return isSmall_; }

  [[nodiscard]] std::span<const double> forces() const { return forces_; }        // n + m
  [[nodiscard]] std::span<const double> marginValues() const { return values_; }  // slack of each margin

private:
  // A tangential row that slips: its number, the unknown of its contact (−1: a friction element), and the sign of its slip.
  struct Slipping {
    int row = 0, unknown = -1;
    double sign = 1;
  };

  bool chooseSmall(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem);
  void foldColumns(const RowSystem &rows, const ContactRows &problem);
  void freeForce(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem);
  void expand(const ContactRows &problem);
  [[nodiscard]] double relativeDeterminant() const;

  std::vector<int> active_;  // rows: all normal ones, then the tangential ones that stick
  std::vector<Slipping> slipping_;
  std::vector<ModeMargin> margins_;
  SmallSystem small_;
  bool isSmall_ = false;
  LuFactor factor_;
  double determinant_ = 1;  // of the small system's last solution
  PressingMargin pressing_;
  double inverseDeterminant_ = 1;            // of its product
  std::vector<double> columns_, responses_;  // folded columns of Jᵀ and W times them, nv for each active row
  std::vector<double> force_, unknowns_, forces_, values_;
};

}  // namespace tf::runtime
