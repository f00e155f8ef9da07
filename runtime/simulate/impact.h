// Impacts: the frozen phase of all contacts with closed gap, applied to the velocities of a model (theory.md section 3).
#pragma once

#include "runtime/contact/admissible_impulse.h"
#include "runtime/contact/coupled_contacts.h"
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/single_contact_phase.h"
#include "runtime/contact/spatial_frozen_phase.h"
#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/row_system.h"

#include <string>
#include <vector>

namespace tf::runtime {

class Impact {
public:
  explicit Impact(ModelEvaluation &evaluation)
      : at_(evaluation), roles_(rolesOfTangents(evaluation.model())), mask_(evaluation.model().nc + evaluation.model().nf) {}

  // Whether the impacts that follow have restitution.
  void setElastic(bool elastic) { elastic_ = elastic; }
  [[nodiscard]] bool isElastic() const { return elastic_; }
  // Contacts (ascending) whose gap rate counts as zero in the impacts that follow.
  void setGrazing(const std::vector<int> &contacts) { grazing_ = contacts; }
  // Of the contacts `touching` (closed gaps) those that an impact of the ones `approaching` reaches, which are some of them. The reference
  // is valid until the next call.
  const std::vector<int> &reached(double time, const double *state, const std::vector<int> &touching, const std::vector<int> &approaching);
  // Moves the velocities in `state` by the impulses of the contacts `contacts` (closed gaps) and tau by the phase's duration. `forced`: of
  // these, the contacts at rest that may start a frictional impulse; the first one that its own push presses in does. `normalImpulse` [nc]
  // is added to. False: the impact has no end, see text().
  bool apply(double time, double *state, const std::vector<int> &contacts, const std::vector<int> &forced, double *normalImpulse);
  // The contact that has started the last frictional impulse, −1 if none of `forced` could.
  [[nodiscard]] int starter() const { return starter_; }

  [[nodiscard]] const std::string &text() const { return text_; }
  // The last impact has no end because contacts approach one another that no impulse can part.
  [[nodiscard]] bool isUnbounded() const { return isUnbounded_; }
  // The last impact has ended with contacts that no impulse can part and that approach, slowly.
  [[nodiscard]] bool leavesApproach() const { return leavesApproach_; }
  // Work that moving boundaries and time-dependent constraints did in the last impact, where it is measured.
  [[nodiscard]] double boundaryWork() const { return boundaryWork_; }
  void measureWork(bool measures) { measuresWork_ = measures; }
  [[nodiscard]] int breakpoints() const { return breakpoints_; }
  // The largest residual of the impacts since resetStatistics: see certify.
  [[nodiscard]] double worstResidual() const { return worstResidual_; }
  void resetStatistics() { worstResidual_ = 0; }

private:
  void findWork(const double *impulse, const double *velocities);
  void certify(const FrozenResult &result, const std::vector<double> &impulse);
  void assemble(double time, const double *state, const std::vector<int> &contacts);
  void readRestitution();
  [[nodiscard]] bool isAssembled(double time, const double *state, const std::vector<int> &contacts) const;
  [[nodiscard]] int rowOf(int contact) const;
  const FrozenResult &follow(const std::vector<int> &forced);

  ModelEvaluation &at_;
  std::vector<TangentRole> roles_;  // nt
  RowSystem rows_;
  FrozenProblem problem_;
  SingleContactPhase singlePhase_;
  AdmissibleImpulse admissible_;
  CoupledContacts coupled_;
  std::vector<int> reached_, starters_;  // contacts; their normal rows
  // Where `reached` has assembled the problem, which `apply` may take over; empty: nowhere.
  std::vector<double> assembledState_;
  double assembledTime_ = 0;
  std::vector<double> total_;  // impulse of the rows
  FrozenPhase phase_;
  SpatialFrozenPhase spatialPhase_;  // where there are slips of two components
  std::vector<std::uint8_t> mask_;
  std::vector<int> tangents_, grazing_;
  std::string text_;
  bool elastic_ = true, measuresWork_ = false, isUnbounded_ = false, leavesApproach_ = false;
  int breakpoints_ = 0, starter_ = -1;
  double boundaryWork_ = 0, worstResidual_ = 0;
  std::vector<double> impulse_, multiplier_;
};

}  // namespace tf::runtime
