// The state of a simulation and its parts; simulation.cpp has the way through time, simulation_start.cpp its begin, simulation_steps.cpp
// the ends of its steps, simulation_events.cpp what happens at events, simulation_impacts.cpp frozen phases, simulation_slips.cpp the end
// and the turn of slips, simulation_continuation.cpp saved states.
#pragma once

#include "runtime/simulate/constrained_start.h"
#include "runtime/simulate/energy_balance.h"
#include "runtime/simulate/energy_jump.h"
#include "runtime/simulate/event_detection.h"
#include "runtime/simulate/event_progress.h"
#include "runtime/simulate/failure_texts.h"
#include "runtime/simulate/held_rates.h"
#include "runtime/simulate/impact.h"
#include "runtime/simulate/integrators.h"
#include "runtime/simulate/invariants.h"
#include "runtime/simulate/mode_selection.h"
#include "runtime/simulate/redundancy.h"
#include "runtime/simulate/rest_prediction.h"
#include "runtime/simulate/sensitivities.h"
#include "runtime/simulate/simulation.h"
#include "runtime/simulate/transitions.h"
#include "runtime/simulate/variable_values.h"

#include <limits>

namespace tf::runtime {

class Simulation::Implementation {
public:
  Implementation(Simulation &owner, ModelInstance &instance, InputSignals &inputs);

  tf_status initialise(double startTime);
  tf_status advanceTo(double time, double firstSample);
  void values(double *all);
  bool sensitivity(int column, double *all);
  [[nodiscard]] const tf_statistics &statistics();

  // Continuation state; plain data.
  [[nodiscard]] std::size_t stateSize();
  void save(void *buffer);
  void restore(const void *buffer);

  Simulation &owner_;
  const tf_model &model_;
  ModelInstance &instance_;
  InputSignals &inputs_;
  ModelEvaluation at_;
  ModeDynamics dynamics_;
  ModeSelection selection_;
  Impact impact_;
  RestPrediction rest_;
  VariableValues values_;
  FailureTexts failures_;
  Integrators integrators_;
  int n_;

  double time_ = 0;
  std::vector<double> state_, rate_, before_;  // q, v, z, tau; its rate; state before the event that is being handled
  std::vector<double> impulse_;
  std::vector<double> accumulated_;  // impulse_, then losses by impacts and friction: as RestPoint::accumulated, since the start
  std::vector<double> beforeValues_, beforeSensitivities_;
  Mode mode_, previousMode_;
  bool modeValid_ = false;
  double suggestedStep_ = 0;
  double nextSample_ = std::numeric_limits<double>::infinity();
  // From `begin` on slips of two components stop that are not faster than `held` of their scale.
  struct Stopping {
    double begin = std::numeric_limits<double>::infinity(), held = 0;
  } stopping_;
  bool isInSample_ = false;                                       // time_ and state_ are those of a sample
  double switchTime_ = -std::numeric_limits<double>::infinity();  // of the last switch
  double jamTime_ = -std::numeric_limits<double>::infinity();     // of the last contact that has jammed
  static constexpr std::uint64_t noRevision = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t inputRevision_ = 0;  // of the inputs that the mode was chosen with
  EventProgress progress_;
  int lastElement_ = -1;  // of the last event (Transition)
  SwitchProgress switchProgress_;
  long long reportedPoints_ = 0;
  int lingeringSteps_ = 0;  // in a row, whose ends have slips of two components that the tolerance does not see
  std::string error_;
  tf_statistics statistics_ = {};
  std::vector<double> parameters_;
  Starts starts_;
  EventDetection detection_;
  std::unique_ptr<EnergyBalance> energy_;  // where it is asked for
  Invariants invariants_;
  std::unique_ptr<Sensitivities> sensitivities_;  // where they are asked for
  bool leapsHeld_ = false;                        // the end that has been projected last has been moved by far more than the errors
  bool isShareLost_ = false;                      // theirs, unless nothing can move within what the tolerance leaves open
  bool hasStopMoved_ = false;                     // the latest differentiateStop has changed a derivative of a state
  bool areSensitivitiesLost_ = false;             // the run failed for them, and fails again
  Redundancy redundancy_;
  EnergyJump energyJump_;
  double openTimeEvent_ = std::numeric_limits<double>::quiet_NaN();  // when one has begun that has not ended: it has failed
  // workspaces
  std::vector<Transition> transitions_;
  std::vector<Approach> approaches_;  // before the event
  std::vector<int> frozenContacts_, frozenApproaching_;
  Mode restingMode_;
  std::vector<std::uint8_t> mayStop_;      // nt: slips that may become zero after an impact
  std::vector<std::uint8_t> contactMask_;  // nc + nf: whose terms are called
  std::vector<double> incoming_, afterImpact_, interpolated_, sample_, sampleRate_, slopes_;

private:
  // Whether gaps that begin at zero have opened before: to be found out, or known from before.
  enum class GapsAtStart : std::uint8_t { Unknown, AsBefore };
  // What continuation depends on and the parts of the simulation own.
  struct Continuation {
    std::vector<EnergyTotals> energy;            // one, or none without account of it
    std::vector<double> impacts, sensitivities;  // RestPrediction; the numbers of those that there are
    std::vector<double> inputs;                  // nu values
    bool hasInputsToTake = false, hasFailed = false;
  };

  // simulation_start.cpp
  SimulationOptions stepOptions();
  tf_status takeStarts();
  tf_status solveStart();
  tf_status settleStart();
  using StartObjection = std::function<std::string(const char *parameter, const std::vector<double> &change)>;
  tf_status checkStartColumns(int parts, const std::vector<double> &values, const StartObjection &objection);
  tf_status checkStartDerivatives();
  tf_status checkStartingSlips();
  bool startsStayConsistent();

  // simulation_continuation.cpp
  Continuation continuation() const;
  // Calls `field`(data, bytes) for all that continuation depends on, in order.
  template <class Field> void forContinuation(Continuation &more, const Field &field);
  void beginAnew();

  // simulation.cpp
  tf_status fail(std::string text);
  tf_status failAt(std::string_view text);
  tf_status failSensitivities(std::string_view where);
  tf_status failEvaluation();
  void startMode();
  void resumeMode();
  void startIntegrator(GapsAtStart gaps);
  bool takeOver(SmoothIntegrator &integrator, IntegratorReason reason);
  void note(tf_note_kind kind, double time, const std::string &text);
  void enterSegment();
  [[nodiscard]] std::string nameOfRate(int component) const;
  bool skipTo(double limit);
  [[nodiscard]] std::string rapidSwitch();
  [[nodiscard]] std::string switchesWithoutEnd(int j) const;
  tf_status failStep(StepStatus status);
  tf_status searchStep(DetectedEvent &event);
  tf_status shortenToDefined(DetectedEvent &event);
  tf_status step(double limit);
  tf_status commit();
  void observeInvariants(bool hasAllGaps);

  // simulation_steps.cpp
  bool passStep(double &begin, double end);
  bool passSamples();
  void giveSample(double time);
  tf_status projectEnd();
  bool isSuspicious(double correction);
  tf_status endBeforeLeap(double limit);
  tf_status checkJump();
  int jumpingRate();
  tf_status checkJumpOf(HeldRow (*largestHeld)(ModelEvaluation &, const Mode &, double, const double *), const char *text);
  void noteRedundancy();
  tf_status startConstraints();
  tf_status chooseConstraints();
  tf_status checkConstraints();
  tf_status checkFriction();

  // simulation_events.cpp
  tf_status settle(std::vector<Transition> &transitions, EventHint hint = {});
  tf_status holdSelected(const Selection &selection, bool &moves);
  tf_status enterMode(const Selection &selection, std::vector<Transition> &transitions);
  void readApproaches();
  [[nodiscard]] int elementOf(const Guard &guard, int stopped) const;
  tf_status failWithoutProgress();
  bool switchesFaintly(int j);
  double crossSwitch(int guard, double farthest);
  [[nodiscard]] double timeScale() const;
  double lookAhead();
  int switchAhead();
  tf_status passSwitch(int guard, double limit);
  tf_status differentiateEvent(int guard);
  std::vector<Transition> &beginTransitions();
  void beginEvent();
  void report(const std::vector<Transition> &transitions);
  tf_status handle(DetectedEvent event, double limit);
  tf_status changeMode(const Guard &guard, int stopped, double limit);
  tf_status afterImpact(double limit);
  bool penetrates(const Mode &mode);
  bool leaves(int contact);
  tf_status comeToRest(const RestPoint &point);
  // What presses a contact that jams beyond doubt (ModeDynamics::jammedContact).
  static constexpr double clearlyPressing = 1e-4;
  int jamAt(int guard);
  tf_status jam(int contact);
  tf_status timeEvent();
  void beginSwitch();
  tf_status endSwitch(int j);
  bool switchesByMotion(int j);
  tf_status goOn();

  // simulation_impacts.cpp
  [[nodiscard]] double velocityScale(const std::vector<int> &contacts) const;
  double fastestUnresolved(const std::vector<int> &approaching);
  tf_status freeze(std::vector<Transition> &transitions, int forced);
  void copyMode(Mode &mode) const;
  bool projectOnto(const Mode &mode, double time, double *state);
  void closeTogether(const std::vector<int> &contacts);
  tf_status stopFaint(const std::vector<int> &contacts);
  [[nodiscard]] bool acceptsStop(const std::vector<int> &contacts, const Mode &resting, const std::vector<double> &gapRates,
                                 const std::vector<double> &slips, double slow);
  tf_status stopSlow(const std::vector<int> &contacts, double slow);

  // simulation_slips.cpp
  double slipSpeedInside(int guard, double time);
  void findStopping(int guard);
  tf_status differentiateStop();
  double stopTolerance();
  bool locateStop(DetectedEvent &event);
  int slipThatStops();
  double turnsBefore(const DetectedEvent &event);
  void aimDirections(const DetectedEvent &event, double part);
  double lingeringSpeed();
  int slowSlip(double least);
  int lingeringSlip();
  int chatteringSlip();
  tf_status stopLingering(int guard, double limit);
  tf_status followTurn(const DetectedEvent &event, double limit);
  tf_status approach(const DetectedEvent &event, double limit);
  tf_status chooseAnew(int guard, double limit);
  tf_status endStep(double next, double limit);
  bool jumpsAt(const DetectedEvent &event);
  tf_status resumeTurned(double limit);
  tf_status endMode(int guard, int stopped, double limit);
};

}  // namespace tf::runtime
