// The mode right after an instant: contact problem at acceleration level, decided by the next derivative where it is degenerate, together
// with the Filippov conditions of the switches that are on their surfaces (theory.md sections 2, 5 and 6).
#pragma once

#include "runtime/contact/contact_solver.h"
#include "runtime/integrate/mode_dynamics.h"

#include <array>
#include <string>
#include <vector>

namespace tf::runtime {

struct SelectionTolerances {
  double gap = 1e-10;        // · scale of the gap: the contact is closed
  double velocity = 1e-11;   // · scale of the velocity: gap rate or slip (its magnitude) is zero
  double condition = 1e-11;  // · max(1, |c| of the rates): the switch is on its surface
};

enum class SelectionStatus : std::uint8_t {
  Selected,
  Impact,             // a closed contact approaches
  FrictionalImpulse,  // no consistent contact forces (Painlevé): `contact` pushes
  Failed              // see text
};

struct Selection {
  SelectionStatus status = SelectionStatus::Failed;
  Mode mode;
  int contact = -1;            // FrictionalImpulse: the contact that pushes; indeterminate: one with D_s < 0, or −1
  bool isSettled = false;      // the dynamics has been started with forces that the next evaluation finds to its accuracy only
  bool indeterminate = false;  // several solutions; the most open one was taken
  std::string text;
};

// What an event says: a switch has just left its sliding mode on this side, or the normal force of a contact is zero, which the solution of
// an ill-conditioned contact problem would show as far as its error only, or it is not an event of contacts, so that those which are open
// are in a hop, however low.
struct EventHint {
  int leavingSwitch = -1;
  Switch side = Switch::Zero;
  int forceless = -1;  // contact
  bool keepsOpen = false;
};

class ModeSelection {
public:
  ModeSelection(ModeDynamics &dynamics, SelectionTolerances tolerances = {});
  ModeSelection(const ModeSelection &) = delete;
  ModeSelection &operator=(const ModeSelection &) = delete;

  // The dynamics is started in the mode that is returned (status Selected), with its last evaluation at the state. The reference is valid
  // until the next call. The contacts at the state are in touching() and approaching() afterwards.
  const Selection &select(double time, const double *state, const Mode &previous, EventHint hint = {});

  // Sets the step variables that do not slide to the sides on which the state is, with which gaps, slips and constraints are evaluated.
  void setStepVariables(double time, const double *state, const Mode &previous, EventHint hint = {});

  // dy/dt of the selected mode at the state it was selected for.
  [[nodiscard]] const std::vector<double> &rate() const { return rate_; }

  // Finds touching() and approaching() at the state.
  void findTouching(double time, const double *state);
  // Contacts with gap ≤ tolerance; of these, those whose gap rate is below −tolerance, but for those that graze: as they move they part
  // again before the gap is below zero by more than rounding.
  [[nodiscard]] const std::vector<int> &touching() const { return touching_; }
  [[nodiscard]] const std::vector<int> &approaching() const { return approaching_; }
  [[nodiscard]] const std::vector<int> &grazing() const { return grazing_; }
  // At the state, which has moved to what the selected mode holds: of the touching contacts that parted at the selection, one does no
  // longer.
  bool hasStopped(double time, const double *state);
  // The contacts in approaching(), which no impulse can part, graze as long as they are hardly faster and their gaps are hardly below zero.
  // False: they already are further below, or not all approach slowly.
  bool letGraze(const double *state);
  // Those of the contacts that touch, where they have no forces without a frictional impulse that changes nothing, stay open as if they
  // grazed, as long as they do. False: they are none.
  bool keepOpen(const std::vector<int> &contacts, const double *state);
  // What letGraze and keepOpen (negative) have noted [nc]: no contacts with a run's start, and a part of what it is continued with.
  [[nodiscard]] std::vector<double> &grazingSpeeds() {
    grazes_ = true;
    return grazingSpeed_;
  }
  // Gaps up to the first of these are closed, gap rates and slips of tangential rows up to the others are zero (ContactScales).
  [[nodiscard]] double closedGap(int contact, const double *state) const { return tolerances_.gap * at_.scales.gap(contact, state); }
  [[nodiscard]] double stillRate(int contact, const double *state) const {
    return tolerances_.velocity * at_.scales.gapRate(contact, state + at_.model().nq);
  }
  [[nodiscard]] double stillSlip(int row, const double *state) const {
    return tolerances_.velocity * at_.scales.slip(row, state + at_.model().nq);
  }
  [[nodiscard]] const SelectionTolerances &tolerances() const { return tolerances_; }
  [[nodiscard]] const ContactSolver::Statistics &contactStatistics() const { return solver_.statistics(); }
  void resetStatistics() { worstViolation_ = 0; }
  [[nodiscard]] double worstViolation() const { return worstViolation_; }

private:
  enum class Trial : std::uint8_t { Consistent, Inconsistent, FrictionalImpulse, Failed };
  // What a switch on its surface may be.
  struct Choices {
    std::array<Switch, 3> values = {};
    int count = 0, current = 0;

    void add(Switch value) { values[count++] = value; }
  };

  void listTouching(const double *state, const Mode *hopping = nullptr);
  void removeGrazing(const double *state);
  [[nodiscard]] bool staysOpen(int contact, const double *state) const;
  void startInertSlips(const double *state);
  Trial tryAssignments(double time, const double *state);
  Trial tryRests(double time, const double *state);
  bool rest(const Mode &found);
  bool holdConditions(double time, const double *state);
  bool isHeld(const double *gradient);
  void settleForces(const ContactSolution &solution);
  [[nodiscard]] int forcelessRow(const ContactSolution &solution) const;
  [[nodiscard]] Switch sideOf(int j, EventHint hint) const;
  [[nodiscard]] std::string jump(const double *state);
  bool hasFrictionLimits();
  [[nodiscard]] bool hasFriction(int contact) const;
  void classifySwitches(const Mode &previous, EventHint hint);
  void chooseRows(double time, const double *state, const Mode &previous);
  Trial tryAssignment(double time, const double *state);
  Trial solveContacts(double time, const double *state);
  bool startMode(double time, const double *state);
  void holdRows(double time, const double *state);
  bool conditionsHold(double time, const double *state);
  void writeMode(const ContactMode &contacts);
  void readPrevious(const Mode &previous);
  const double *readForces();

  ModeDynamics &dynamics_;
  ModelEvaluation &at_;
  SelectionTolerances tolerances_;
  ContactSolver solver_;
  ContactSystem system_;
  RowSystem &rows_ = system_.rows;
  ContactProblem &problem_ = system_.problem;
  ContactMode previousContacts_;
  ContactRates rates_;
  ContactSolution undecided_;
  Selection selection_;
  Mode &mode_ = selection_.mode;  // what is being tried
  Mode found_, heldMode_;
  std::vector<int> touching_, approaching_, grazing_, parting_;  // parting_: of those that touched at the last choice of rows
  std::vector<int> contacts_, tangents_;                         // of the problem
  std::vector<int> surfaces_;                                    // switches on their surfaces
  int left_ = -1;                                                // of them, where a sliding mode ends; −1: none
  std::vector<Choices> choices_;                                 // of each, in order of preference
  std::vector<std::uint8_t> stays_;                              // of each: its condition stays zero in the mode
  std::vector<int> contactOf_;                                   // nt, see contactsOfTangents
  std::vector<TangentRole> roles_;                               // nt
  std::vector<std::uint8_t> mask_, surfaceMask_, ofTime_;        // nc + nf; ns; ns
  std::vector<std::uint8_t> slowMask_;                           // nc + nf
  std::vector<double> rate_, freeAcceleration_, guess_, settledForces_;
  std::vector<double> grazingSpeed_;  // nc: of letGraze
  bool grazes_ = false;               // one of them may not be zero
  SettledForces settled_;
  bool isSettled_ = false;  // forces of the contact problem solved last
  int forced_ = -1;
  int forceless_ = -1;                              // see EventHint
  bool redundant_ = false, indeterminate_ = false;  // of the contact problem solved last
  double worstViolation_ = 0;
  std::string text_;
};

}  // namespace tf::runtime
