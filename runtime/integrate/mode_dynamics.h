// The smooth system of one mode: dy/dt at physical time t, y = (q, v, z, tau), with contact forces out of (q, v) by D (theory.md sections 2
// and 6), sliding step variables out of d c/dt = 0, and the guards whose zeros end the mode.
//
// Physical time is the independent variable where it runs: with beta = dt/dtau > 0, y' = beta (f, 1) is the same curve as dy/dt = f,
// dtau/dt = 1/beta.
#pragma once

#include "runtime/contact/mode_forces.h"
#include "runtime/integrate/contact_system.h"
#include "runtime/integrate/folded_forces.h"
#include "runtime/integrate/linked_forces.h"
#include "runtime/integrate/mode.h"
#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/projection.h"
#include "runtime/integrate/share_derivatives.h"
#include "runtime/integrate/slip_directions.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace tf::runtime {

enum class GuardKind : std::uint8_t {
  Gap,        // open contact: gap ≥ 0
  Force,      // margin of the contact forces ≥ 0
  Slip,       // slipping row: |slip| in its direction ≥ 0
  SlipAlong,  // slip of two components: its component along the reference direction ≥ 0
  Condition,  // switch off its surface: ±c ≥ 0
  StepLow,    // sliding switch: alpha ≥ 0
  StepHigh,   // sliding switch: 1 − alpha ≥ 0
};

// A function that is ≥ 0 in the mode.
struct Guard {
  GuardKind kind = GuardKind::Gap;
  int index = 0;  // contact, margin, tangential row, pair of SlipDirections, or switch
  double sign = 1;
  double scale = 1;  // magnitude below 1e-12 · scale is rounding
  // It depends on time, or on inputs that change, beside the state: error control of the state does not resolve it.
  bool varies = false;
  bool isHeld = false;  // Condition: see Mode::held
};

// Friction coefficients and bounds of elements that are no further below zero are zero but for rounding.
constexpr double negligibleFriction = 1e-9;

enum class EvaluationFailure : std::uint8_t { None, NotFinite, SingularMass, SingularContact, SlidingDiverged };

class ModeDynamics {
public:
  explicit ModeDynamics(ModelEvaluation &evaluation);
  ModeDynamics(const ModeDynamics &) = delete;
  ModeDynamics &operator=(const ModeDynamics &) = delete;

  [[nodiscard]] int size() const { return at_.stateSize(); }
  [[nodiscard]] ModelEvaluation &model() { return at_; }
  [[nodiscard]] const Mode &mode() const { return mode_; }

  // Part of the contact forces below which they need not be those of the equations.
  void setForceError(double error) { linked_.setForceError(error); }

  // Begins the mode at (t, y). False: it has no admissible forces or cannot be evaluated there.
  bool start(const Mode &mode, double time, const double *state) { return start(mode, time, state, plus_.data()); }
  // As well, with dy/dt there; `solved` (may be null): the contact problem there, with the mode's step variables.
  bool start(const Mode &mode, double time, const double *state, double *rate, const SolvedContacts *solved = nullptr);
  // The next mode is begun without anything of before, also where it is the one that was begun last.
  void forget() { preparedRevision_ = -1; }
  // For projections onto what a mode holds at zero, whether or not it has admissible forces: nothing else is ready but `evaluate`, and
  // another mode must be started before events are looked for. False: M or H cannot be evaluated there.
  bool hold(const Mode &mode, double time, const double *state);
  // dy/dt; forces, accelerations and step variables are in model() afterwards. False: see failure().
  bool evaluate(double time, const double *state, double *rate);
  // After an evaluation, and of the gradient of condition j: by how much d c_j/dt differs between the sides of its switch.
  double slopeJump(int j);
  // Of the last evaluation.
  [[nodiscard]] EvaluationFailure failure() const { return failure_; }
  // False: what the choice of a mode has met at the evaluation's point before there was one to evaluate, for failure().
  bool fail(EvaluationFailure failure);
  bool failMass();
  // Since it was last forgotten, an evaluation has met a coefficient or bound of friction below zero: a step has gone beyond a switch, or
  // the model is wrong.
  [[nodiscard]] bool metNegativeFriction() const { return metNegativeFriction_; }
  void forgetNegativeFriction() { metNegativeFriction_ = false; }
  // Bounds of friction in the mode depend on velocities: they may have peaks where slips are zero.
  [[nodiscard]] bool frictionMayPeak() const { return frictionMayPeak_; }
  // dt/dtau of the last evaluation.
  [[nodiscard]] double timeSpeed() const { return tauRate_ > 0 ? 1 / tauRate_ : 1; }

  // d(dy/dt)/dy [n × n, column-major] at the last evaluation's point; but not, where isShareUnknown, how redundant contacts come to share
  // their load in another way.
  bool jacobian(double time, const double *state, double *matrix);

  // What of it is stiff where slips of two components are slow: how friction turns with the velocities. It is rateByAngle angleByStateᵀ
  // [n × turningPairCount() each, column-major], at the last evaluation's point.
  void turningDerivatives(double *rateByAngle, double *angleByState);

  // After an evaluation: the accelerations depend on how redundant contacts share their load, as where some of them slide;
  [[nodiscard]] bool sharesMove();
  // and this has no derivative.
  [[nodiscard]] bool isShareUnknown() { return sharesMove() && !forces_.sharesAreSmooth(); }
  // As well: constraints and held contacts leave no velocity free.
  [[nodiscard]] bool holdsAll() {
    completeRows();
    return leavesNoVelocity();
  }
  // The mode ends at the guard because redundant contacts begin to contradict one another.
  [[nodiscard]] bool isContradiction(int guard) const {
    return guards_[guard].kind == GuardKind::Force && forces_.margins()[guards_[guard].index].limit.row == ModeMargin::contradiction;
  }

  // The accelerations depend on nothing that changes in the mode, and coordinates change as their velocities.
  [[nodiscard]] bool isUniform() const { return at_.model().uniform_flight != 0 && rows_.count() == 0; }
  // Nothing moves at (time, state) with dy/dt = `rate`, to rounding relative to `scale` [n], and as long as the mode lasts nothing will:
  // constraints and held contacts leave no velocity free. Reads the model at that point.
  bool isHeldAtRest(double time, const double *state, const double *rate, const double *scale);
  // Slips of two components turn beside a force that they may press to a pole, beyond which implicit equations have solutions, too.
  [[nodiscard]] bool mayTurnBeyondPole() const;
  // The determinant of the forces' matrix is not much smaller than at the begin of the mode (of one that may press, where it was 1).
  [[nodiscard]] bool isClearOfPole() const;
  // At the state of the last evaluation nothing moves, and neither does anything for states, parameters and inputs nearby that the mode
  // holds at rest: whatever the forces, its rows leave no acceleration.
  bool restsByItsRows(const double *state);
  // What the accelerations are sums of at the point of the last evaluation: the sizes of that without contact forces and of
  // that by each of them [nv].
  void accelerationTerms(double *terms);
  // Uniform motion, or rest, has led to (time, state): the last evaluation is that of this point as well.
  void keepEvaluation(double time, const double *state);

  // Multipliers of the constraints, into model(), at the last evaluation's point.
  void solveMultipliers();

  // Of a contact at the last evaluation's point, before rounding errors below zero are cut off; 0 where it is open.
  [[nodiscard]] double normalForce(int contact) const;
  // What rounding errors of velocities change contact forces by there, N: slow slips of two components are turned by them.
  [[nodiscard]] double forceRounding() const;

  // A guard of kind Force has changed its sign where forces grow beyond all bounds, not at a zero. At the last evaluation's point.
  [[nodiscard]] bool isPole(int guard) const;
  // The last evaluation is at a pole of the contact forces, or beyond it: what they are there says nothing.
  [[nodiscard]] bool isAtPole() const;
  // The contact whose normal force is the margin of a Force guard; −1: the margin is another one.
  [[nodiscard]] int contactOfMargin(int margin) const;
  // The closed contact whose force grows beyond all bounds at the last evaluation's point, because slips press it in (jammedNormals); −1:
  // none. Without its force it approaches by an acceleration of at least `pressing` times what the largest force at the begin of the mode
  // gives a contact, and friction has left at most `ratio` of what that force does to its own acceleration.
  [[nodiscard]] int jammedContact(double pressing = -std::numeric_limits<double>::infinity(),
                                  double ratio = std::numeric_limits<double>::infinity());

  // At the last evaluation's point: power of friction forces on the slips (≤ 0), and of all contact, friction and constraint forces on the
  // motion; they differ where boundaries move.
  double frictionPower();
  double reactionPower();

  // d/dt of the accelerations at fixed contact forces along the motion, for the rows of `rows` (of the same point): derivative of gap'' and
  // slip'' [rows], friction coefficients and bounds [tangents of rows]. `rate` is dy/dt.
  void accelerationRates(const RowSystem &rows, const double *rate, std::vector<double> &accelerationRate,
                         std::vector<double> &frictionRate, std::vector<double> &boundRate);

  // Those of kind Gap come first, the contacts ascending.
  [[nodiscard]] const std::vector<Guard> &guards() const { return guards_; }
  [[nodiscard]] int gapGuardCount() const { return gapGuardCount_; }
  // Any of them does (Guard::varies).
  [[nodiscard]] bool guardsVary() const { return guardsVary_; }
  // Values at the point of the last evaluation. Those of gaps of contacts that are asleep (GapScreen) are old: they are positive.
  void guardValues(double *values);
  // The same of some guards, and d/dt of the Gap guards (NaN of the others).
  void guardValues(std::span<const int> guards, double *values, double *rates);
  [[nodiscard]] double guardValue(int guard);
  // d/dt of a Slip guard at the last evaluation's point.
  [[nodiscard]] double slipRate(int guard) const;
  // The least and the largest value of a Force guard at the evaluations since restartMargins(), and when it was the least.
  [[nodiscard]] double leastMargin(int guard) const { return leastMargins_[guards_[guard].index]; }
  [[nodiscard]] double leastMarginTime(int guard) const { return leastMarginTimes_[guards_[guard].index]; }
  [[nodiscard]] double largestMargin(int guard) const { return largestMargins_[guards_[guard].index]; }
  void restartMargins();
  // Values and rates of some guards at the model's point, wherever the dynamics has been evaluated last: of Gap and Slip guards (zero for
  // the others).
  void switchingValues(std::span<const int> guards, double *values, double *rates);
  // Force guard `guard` has reached zero: true if the mode goes on with another representative of redundant forces (guards have changed).
  bool rechoose(int guard);
  // The mode's start has been projected to the point of the last evaluation (ModeForces).
  void acceptContradiction();

  // Projects (q, v) of the state at `time`, the last evaluation's point or near it, onto what the mode holds at zero (see Projection).
  // Returns the size of the correction relative to `scale` [n].
  double project(double time, double *state, const double *scale) {
    if (!projection_.isNeeded() || (isProjected_ && std::equal(projected_.begin(), projected_.end(), state)))
      return 0;
    if (!isSmall_ && !isLinked_)
      completeRows();
    return projection_.project(time, state, scale, nothingStops_.data());
  }
  // As well, at the begin of a mode: slips of two components that it takes for zero, and that are to start, become zero.
  double projectStart(double time, double *state, const double *scale);
  // What `project` has left, or would remove, at a state (see Projection::residual).
  [[nodiscard]] double heldResidual(double time, const double *state) { return projection_.residual(time, state); }
  // As `evaluate`, at the projection of a state near the last evaluation's point at the same time, with the rows of that point; where this
  // costs more than it saves, at the state itself.
  bool evaluateProjected(double time, double *state, double *rate, const double *scale);
  // What the last evaluation has corrected its state by, relative to its scale.
  [[nodiscard]] double correction() const { return correction_; }
  // As well; the slip of the SlipAlong guard `stopped` becomes zero too, and so do all others of two components that are not faster than
  // `part` of their scale: slips of one body stop together.
  double projectStop(double time, double *state, const double *scale, int stopped, double part);
  [[nodiscard]] bool needsProjection() const { return projection_.isNeeded(); }
  // Slips of two components that the mode holds or follows.
  [[nodiscard]] bool hasPairs() const { return problem_.hasPairs(); }
  // Rows that are held depend on each other: beside what the mode holds they may contradict one another.
  [[nodiscard]] bool hasRedundantRows() const { return rows_.count() > 0 && forces_.redundant(); }
  // Adds to the velocities of (time, state) what the mode's impulses do that take gap rates and slips of its active rows to zero, with the
  // friction of rows that slip: a motion that came to rest a little off another one, for derivatives of it. `scale` as of `project`.
  bool stop(double time, double *state, const double *scale);

  // Slips of two components, see SlipDirections; `guard` is a SlipAlong guard.
  void setSlipAccuracy(double relative) { slips_.setAccuracy(relative); }
  bool renewDirections(double time, const double *state) { return slips_.renew(time, state); }
  void holdDirections(double part) { slips_.hold(part); }
  void slopesOfSlips(double *slopes) const { slips_.slopesOfSlips(slopes); }
  void aimDirections(const double *earlier, const double *later, const double *slopes, double part) {
    slips_.aim(earlier, later, slopes, part);
  }
  bool holdStartingDirections(double part) { return slips_.holdStarts(part); }
  [[nodiscard]] double slipSpeed(int guard) const { return slips_.speed(guards_[guard].index); }
  // Magnitude of the velocities that this is compared with.
  [[nodiscard]] double slipScale(int guard) const { return slips_.scale(guards_[guard].index); }
  [[nodiscard]] int slipRow(int guard) const { return slips_.modelRow(guards_[guard].index); }
  // Slips of two components, whose friction turns, the faster the slower they are.
  [[nodiscard]] bool hasTurningSlips() const { return !slips_.empty(); }
  [[nodiscard]] bool launches() const { return slips_.launches(); }
  [[nodiscard]] bool hasLaunched() const { return slips_.haveLaunched(); }
  [[nodiscard]] int turningPairCount() const { return slips_.count(); }
  // Two numbers for each of them.
  [[nodiscard]] int turningSlipCount() const { return 2 * slips_.count(); }
  // At (time, state), which becomes the model's point.
  void turningSlips(double time, const double *state, double *slips);
  // Their derivatives by v there, nv for each.
  void turningSlipsByVelocity(double time, const double *state, double *rows);
  // A relaxed slip stays on the edge of its disk, where it turns within slipRadius/acceleration: stiff for any integrator that is not.
  [[nodiscard]] bool holdsEdge() const;
  // At the point of the latest `switching`.
  [[nodiscard]] bool hasSlowSlips() const { return !slips_.empty() && !slips_.haveLaunched(); }
  // At the point of the last `renewDirections`, one that is not faster than `part` of its scale.
  [[nodiscard]] bool hasSlipsBelow(double part) const { return slips_.anyBelow(part); }
  // A slow slip of two components grows from (time, state) on; the slips there and their derivatives by time are remembered.
  bool slipsGrowSlowly(double time, const double *state);
  // One of them is zero there.
  [[nodiscard]] bool slipsStart() const { return slips_.anyStarts(); }
  // Moves the velocities of `state`, the last evaluation's point, so that slips of two components are what the remembered ones and their
  // derivatives become within `duration`, zero where they start: along a tangent the motion of what they slip on leaves slips of the second
  // order, in any direction.
  void continueSlips(double duration, double *state, const double *scale);
  // At (time, state) slips that grew where they were remembered have the opposite direction: implicit equations have such solutions too, in
  // which friction pushes.
  bool slipsTurnBack(double time, const double *state);
  // See SlipDirections::references.
  void slipReferences(double *directions) const { slips_.references(directions); }
  void setSlipReferences(const double *directions) { slips_.setReferences(directions); }
  // Turns the references of slips that start to the friction at (time, state), see SlipDirections::turnToFriction.
  double turnToFriction(double time, const double *state);
  // Reference directions become those of the slips at (time, state).
  void turnToSlips(double time, const double *state) {
    readSlips(time, state);
    slips_.turnToSlips();
  }
  // Angles from the references of slips that start to the slips at (time, state), one for each pair; zero for others.
  void slipAngles(double time, const double *state, double *angles);
  // dy/dt at (time, state), where slips start, with the references turned by these angles for once.
  bool evaluateTurned(double time, const double *state, const double *angles, double *rate);

  [[nodiscard]] const RowSystem &rows() const { return rows_; }
  [[nodiscard]] long long evaluations() const { return evaluations_; }
  void resetStatistics() { evaluations_ = 0; }

private:
  void readSlips(double time, const double *state);
  [[nodiscard]] bool isPrepared(const Mode &mode) const;
  [[nodiscard]] bool rowsVary() const;
  [[nodiscard]] bool leavesNoVelocity();
  bool choose(const Mode &mode, double time, const double *state, const SolvedContacts *solved = nullptr);
  bool prepare(double time, const double *state);
  bool evaluateSolved(double time, const double *state, const SolvedContacts &solved, double *rate);
  void beginEvaluation(double time, const double *state);
  bool evaluateSmall(double time, const double *state, double *rate);
  bool evaluateLinked(double time, const double *state, double *rate);
  void chooseLinked();
  bool giveRate(double *rate);
  void watchFriction();
  bool solveForces();
  bool solveRows(double *freeAcceleration);
  bool startForces(std::unique_ptr<ForceSet> *found);
  void completeRows();
  // Both rows of a slip of two components are among those that the next projection stops.
  void stopPair(int pair) { stops_[slips_.row(pair)] = stops_[slips_.row(pair) + 1] = 1; }
  void complete();
  [[nodiscard]] std::span<const double> rowForces() const { return isFolded_ ? folded_.forces() : forces_.forces(); }
  // Redundant contacts together press themselves in: their load is no more than about this part of their forces, which have grown beyond
  // all bounds, or changed their signs there (0).
  [[nodiscard]] bool isNearSharedPole(double part) const;
  [[nodiscard]] std::span<const double> marginValues() const { return isFolded_ ? folded_.marginValues() : forces_.marginValues(); }
  [[nodiscard]] Eigen::Index limitStepCount() const;
  void findLimitSteps(int j, Eigen::Ref<Eigen::VectorXd> steps);
  void readLimits();
  double slopeByStep(int s, int j, const Eigen::Ref<const Eigen::VectorXd> &limitSteps);
  bool solveSliding();
  // Change of acceleration for a change of f, of the constraints' and of the rows' bias and of the rows' limits, at fixed M, H and D;
  // `shares` (may be null): as redundant rows share their load in the end.
  void response(const double *forceChange, const double *constraintChange, const double *biasChange, const double *limitChange,
                double *accelerationChange, const ShareRates *shares = nullptr);
  void kinematicColumn(int k, double *column) const;
  void limitColumn(int k, std::vector<double> &friction, std::vector<double> &limit) const;
  void conditionRates(double *rates);
  void differenceJacobian(double time, const double *state, double *matrix);
  [[nodiscard]] double readGuard(const Guard &guard) const;
  [[nodiscard]] double readRate(const Guard &guard) const;
  void evaluateGuards();
  void buildGuards();
  void scaleForces();
  [[nodiscard]] int ownerOf(int row) const;
  [[nodiscard]] bool varies(const Guard &guard) const;
  void recordForces();
  void recordMargins();

  ModelEvaluation &at_;
  Mode mode_;
  ContactSystem system_;
  RowSystem &rows_ = system_.rows;
  ContactProblem &problem_ = system_.problem;
  ContactMode contactMode_;
  ModeForces forces_;
  FoldedForces folded_;
  LinkedForces linked_;
  ShareDerivatives shareDerivatives_;
  bool isFolded_ = false;    // folded_ gives the forces
  bool isSmall_ = false;     // by evaluateSmall
  bool isLinked_ = false;    // linked_ gives the forces, by evaluateLinked
  int linkedFailures_ = 0;   // in this mode
  bool isGathered_ = false;  // the last evaluation has gathered rows_ and factorised M
  bool hasRows_ = false;     // D is that of the last evaluation too
  bool isComplete_ = false;  // and forces_
  bool limitsVary_ = false;  // coefficients and bounds of friction do, with more than parameters
  bool frictionMayPeak_ = false;
  bool metNegativeFriction_ = false;
  double correction_ = 0;
  bool isProjected_ = false;  // projected_ is the point of the last evaluation, and its own projection
  SlipDirections slips_;
  Projection projection_;
  std::vector<double> projected_;                   // q, v
  std::vector<TangentRole> roles_;                  // nt
  std::vector<std::uint8_t> isPaired_;              // nt
  std::vector<std::uint8_t> nothingStops_, stops_;  // tangential rows
  std::vector<double> rememberedSlip_, slipRate_;   // nt, see slipsGrowSlowly
  std::vector<std::uint8_t> mask_, slidingMask_;
  std::vector<int> sliding_;
  std::vector<Guard> guards_;
  int gapGuardCount_ = 0;
  bool guardsVary_ = false;
  std::vector<double> leastMargins_, leastMarginTimes_, largestMargins_;  // of forces_
  std::vector<double> closedForce_, closedRate_, loadRatio_;
  double beginForce_ = 0;           // the largest one at the begin of the mode
  std::vector<double> forceScale_;  // of rows: of those that act on one another
  std::vector<int> group_;
  double tauRate_ = 1;
  long long preparedRevision_ = -1;  // the parameters with which the mode was begun, −1: none
  EvaluationFailure failure_ = EvaluationFailure::None;
  long long evaluations_ = 0;
  const SettledForces *settled_ = nullptr;  // while a mode begins, of its contact problem there
  bool isBegun_ = false;                    // by `start`: forces_ go on from one evaluation to the next
  // workspaces
  std::vector<int> contacts_, tangents_;
  std::vector<double> change_, constraintChange_, rowChange_, forceChange_, limitChange_, slidingResidual_, plus_, minus_, shifted_;
  std::vector<const double *> heldRows_;
  SemidefiniteFactor heldFactor_;
  Eigen::MatrixXd slidingMatrix_, limitSteps_;
  Eigen::PartialPivLU<Eigen::MatrixXd> slidingFactor_;
};

}  // namespace tf::runtime
