// Projection of a state onto what its mode holds at zero: gaps, gap rates and slips of the active rows, and the constraints, in the metric
// of the mass matrix.
#pragma once

#include "runtime/contact/semidefinite_factor.h"
#include "runtime/integrate/folded_forces.h"
#include "runtime/integrate/linked_forces.h"
#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/row_system.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace tf::runtime {

class Projection {
public:
  // The rows of the mode with D, which `complete` makes where they are needed, as of the latest evaluation of its dynamics; all must
  // outlive the projection.
  Projection(ModelEvaluation &evaluation, const RowSystem &rows, const ContactProblem &problem, std::function<void()> complete);

  // The rows have been chosen anew. With forces that are small, or linked where they serve, D is not needed.
  void resize();
  void use(const FoldedForces *forces, LinkedForces *linked) {
    forces_ = forces;
    linked_ = linked;
  }
  [[nodiscard]] bool isNeeded() const;
  // Moves (q, v) of the state at `time`, with the rows of the latest evaluation, which was there or nearby, onto gap = 0, gap rate = 0 and
  // slip = 0 where problem.slipSign is 0 or `stopped` [tangential rows] is set, and onto the constraints, and quaternions to unit length.
  // The slips that rows get can be given, one for each tangential row of the model. Returns the size of the correction relative to `scale`
  // [n].
  double project(double time, double *state, const double *scale, const std::uint8_t *stopped, const double *slips = nullptr);
  // The largest gap, gap rate, slip, constraint or rate of a constraint at a state that project() would have to remove, relative to its
  // scale.
  [[nodiscard]] double residual(double time, const double *state);

private:
  void correct(double *target);
  void factorise(double dependence);
  [[nodiscard]] double amplification() const;
  void solveChosen();
  void correctWithDelassus(double *target);
  [[nodiscard]] double changeAlong(int row) const;
  double coordinateResiduals();
  bool projectCoordinates(double *state);
  void projectVelocities(double *velocities, const std::uint8_t *stopped, const double *slips, bool hasGapRates);

  ModelEvaluation &at_;
  const RowSystem &rows_;
  const ContactProblem &problem_;
  std::function<void()> complete_;
  const FoldedForces *forces_ = nullptr;
  LinkedForces *linked_ = nullptr;
  std::vector<std::uint8_t> corrected_, factored_;  // rows that take part; those of factor_ (none: to be made)
  std::vector<int> chosen_;                         // those rows
  SemidefiniteFactor factor_;                       // D of the chosen rows
  std::vector<double> solution_;                    // for each of them
  std::vector<double> impulse_, residual_;          // for each row
  std::vector<double> change_, motion_, constraintChange_, before_;
};

}  // namespace tf::runtime
