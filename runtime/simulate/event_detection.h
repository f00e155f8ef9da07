// Where a guard of the mode falls to zero within a step (theory.md section 6: switches are never missed within a step, a gap that dips and
// returns is found).
#pragma once

#include "runtime/integrate/smooth_integrator.h"

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace tf::runtime {

struct DetectedEvent {
  int guard = -1;            // in ModeDynamics::guards(), −1: none
  double time = 0;           // estimate from the interpolant
  double low = 0, high = 0;  // bracket: the guard is ≥ 0 at low and < 0 at high
  double slope = 0;          // of the guard near the zero, < 0
};

// Its value needs contact forces or sliding step variables, an evaluation of the dynamics.
[[nodiscard]] inline bool isForceGuard(GuardKind kind) {
  return kind == GuardKind::Force || kind == GuardKind::StepLow || kind == GuardKind::StepHigh;
}

// It is a smooth function of the state between events; its rate is known, or a difference of its values.
[[nodiscard]] inline bool hasRate(GuardKind kind) { return !isForceGuard(kind); }
// The rate is such a difference inside a step. At its ends that of a slip of one component is an acceleration that is known there.
[[nodiscard]] inline bool hasRateByDifference(GuardKind kind) { return hasRate(kind) && kind != GuardKind::Gap; }
[[nodiscard]] inline bool hasRateByDifferenceAtEnds(GuardKind kind) { return hasRateByDifference(kind) && kind != GuardKind::Slip; }

// Where intervals of a step are divided: no period of what is sampled has a simple ratio to it, so that none is passed over in step with
// it.
inline constexpr double unevenPart = 0.4619397662556434;
// Fractional parts of its multiples are as uneven.
inline constexpr double goldenSection = 0.6180339887498949;

class EventDetection {
public:
  explicit EventDetection(ModeDynamics &dynamics);

  // Before all else.
  void setIntegrator(SmoothIntegrator &integrator);
  // A new mode begins at `time`, in the state of the dynamics' last evaluation.
  // Gaps that start at zero with a larger rate than `partOfRounding` of its scale are open.
  void restart(double time, double partOfRounding);
  // A step was cut short and the mode goes on, with another choice of directions or of redundant forces: gaps stay as open as they were.
  void resume(double time, double partOfRounding);
  // The integrator has been started in the new mode.
  void watchStart();
  // Where the next step should end at the latest: `limit`, or right behind an event that is expected before it.
  double stepLimit(double limit);
  // The last step was to end there, not at its limit: its length is no measure of its error.
  [[nodiscard]] bool isCut() const { return cut_; }
  // The first event in the integrator's last step, at whose end the dynamics has just been evaluated.
  DetectedEvent detect();
  // Without an event: how far the step has been searched. A step in which a guard varies too often is to be shortened to there.
  [[nodiscard]] double searchedTo() const { return searchedTo_; }
  // A gap, slip or condition is no number at the end of the step.
  [[nodiscard]] bool hasUndefined() const;
  // The step ended without an event: its end is the begin of the next one.
  void advance();
  enum class Location : std::uint8_t {
    Found,
    Unsolved,  // there is no step to there
    Vanished   // a step to there ends with a gap that is positive and grows
  };
  // Ends the integrator's step where the guard is zero, with the step's length as an unknown: to rounding, at the order of the method.
  Location locate(DetectedEvent &event);
  // After locate(): the force whose zero was to be found is clearly another one there.
  [[nodiscard]] bool missesZero(const DetectedEvent &event);
  // Of the forces at the dynamics' last evaluation the guard of the one that is farthest below zero, clearly; −1: none, or there is a pole,
  // where signs say nothing.
  [[nodiscard]] int brokenForce();
  // Where the dynamics has been evaluated last, at (time, state) with its rate: the guard of a force that is zero, to rounding, and falls;
  // −1: none. The dynamics is evaluated there again.
  [[nodiscard]] int fallingForce(double time, const double *state, const double *rate);
  // After locate(), or an evaluation of the dynamics at the event: true if a gap has closed or a force has fallen to zero before the event,
  // which the interpolant had in another order; the event is then that guard's, still to be located.
  bool findEarlier(DetectedEvent &event);
  // The projection of the end onto what the mode holds moves the gap or slip that ends the step off its zero: true if the end has been
  // moved on along its rate to there, to be projected again.
  bool returnToZero(const DetectedEvent &event);

private:
  struct Sample {
    double time = 0;
    std::vector<double> value, rate;
    std::vector<double> misfit;  // of the cubics on the interval that it divides, see isUnclear; infinite: not known
  };

  // Of one guard.
  struct Probe {
    double time = 0, value = 0, rate = 0;
  };
  // How well an interval's ends predict what is inside it: what the cubic through them misses, and what the line through them does, first
  // in the widest of the intervals around.
  struct Fit {
    Fit() { scatter.fill(misfit); }
    double misfit = std::numeric_limits<double>::infinity();
    std::array<double, 8> scatter;
  };

  [[nodiscard]] bool isCurrent() const;
  [[nodiscard]] bool opensAtSpeed(int guard, double partOfRounding) const;
  void watchZeros(double factor);
  void readStarts(double time, double partOfRounding);
  void chooseAwake();
  void coverStep(double reach);
  void wake();
  DetectedEvent search();
  void readGuards(double time, Sample &sample);
  // Moves the model's point along dy/dt from (time, state), for differences of switching functions; by how much of time. They change by
  // that times their derivative: what remains of it in the difference is as large as what it neglects.
  double stepAside(double time, const double *state, const double *rate);
  void readEnd(Sample &sample);
  void readSlipRates(Sample &sample);
  // On the interpolant; the guards that need forces are NaN where these are left out. False: there are no forces (never without them).
  bool sampleInside(double time, bool withForces, Sample &sample);
  [[nodiscard]] double farthestTurn() const;
  [[nodiscard]] long long intervalCount() const;
  [[nodiscard]] double mostIntervals() const;
  [[nodiscard]] double nextUniformSample(double time, long long number) const;
  void examineSamples(bool withForces, DetectedEvent &first);
  void forgetMisfits(Sample &middle) const;
  [[nodiscard]] bool isUnclear(int guard, const Sample &a, Sample &middle, const Sample &b, const Sample *coarser) const;
  void interpolate(double time);
  bool examineEnds(const Sample &a, const Sample &b, bool withForces, DetectedEvent &first);
  bool mayDip(int guard, const Sample &a, const Sample &b) const;
  void examine(const Sample &a, const Sample &b, int depth, DetectedEvent &first);
  void examineForces(const Sample &a, const Sample &middle, const Sample &b, DetectedEvent &first);
  void examineDip(int guard, const Sample &a, const Sample &middle, const Sample &b, DetectedEvent &first);
  void examineHeld(DetectedEvent &first);
  double threshold(int guard) const;
  double hop(int guard, double time, double gap, double rate) const;
  double level(int guard) const;
  double hopBase(int guard) const;
  [[nodiscard]] double roundingOf(int guard, double farthest) const;
  double guardAt(int guard, double time, const double *state);
  double guardInside(int guard, double time);
  double guardHere(int guard, double time);
  // event_bracketing.cpp
  bool fallsLater(int guard, const DetectedEvent &first);
  void bracket(int guard, const Sample &low, const Sample &high, DetectedEvent &first);
  void newtonZero(int guard, double zero, double x, DetectedEvent &event);
  void illinoisZero(int guard, double zero, double lowValue, double highValue, DetectedEvent &event);
  // event_screening.cpp
  [[nodiscard]] bool isFar(int guard) const;
  [[nodiscard]] bool isSteady(int guard) const;
  bool examineCubics(DetectedEvent &first);
  bool fitCubics();
  bool parabolaEvent(int guard, DetectedEvent &first) const;
  bool cubicZero(int guard, DetectedEvent &first) const;
  bool examineEndsAlone(DetectedEvent &first);
  void measureEnds(Sample &middle);
  bool othersStayPositive(int except, const Sample &a, const Sample &b, int depth, const Sample *coarser);
  // event_sampling.cpp
  Probe probe(int guard, double time);
  [[nodiscard]] bool isBlindStep() const;
  bool readInside();
  std::vector<double> cutsOfForce(int guard);
  bool isSteadyForce(int guard);
  [[nodiscard]] bool samplesVarying();
  [[nodiscard]] bool isSampled(int guard) const { return samplesVarying_ && dynamics_.guards()[guard].varies; }
  void examineVarying(DetectedEvent &first);
  void divide(int guard, const Probe &a, const Probe &b, const Fit &coarser, int depth, DetectedEvent &first);
  void bracketProbes(int guard, const Probe &low, const Probe &high, DetectedEvent &first);
  // event_prediction.cpp
  double expected();
  // event_location.cpp
  bool endsNearby(DetectedEvent &event);
  bool moveInside(DetectedEvent &event);
  bool isBetweenEnds(double time);
  bool goesOnFrom(double base, double time);
  bool extend(int guard, double zero, double value, double slope, double base, DetectedEvent &event);
  bool followInterpolant(int guard, double zero, double value, double slope, double base, DetectedEvent &event);
  bool nudge(int guard, double zero, double value, double slope, double base, DetectedEvent &event);

  ModeDynamics &dynamics_;
  SmoothIntegrator *integrator_ = nullptr;
  // Whether a guard is known to be open in this mode: because it rises from its start, or because it has been clearly positive.
  enum class Arming : std::uint8_t { Not, BySpeed, ByValue };
  // How a guard has begun.
  struct Start {
    Arming armed = Arming::Not;
    double time = 0, value = 0, rate = 0;
    double rounding = 0;  // that a gap is known to, where the coordinates are now
  };
  // Of a gap that was asleep before.
  [[nodiscard]] static Start openStart(double time) { return {Arming::ByValue, time, std::numeric_limits<double>::infinity(), 0, 0}; }
  // The guard has been clearly positive, at a time of the step.
  void arm(int guard);
  // By the last search, in a step at whose begin it was not.
  [[nodiscard]] bool isArmedNow(int guard) const;
  // Of the guards that are armed now, those that are wanted become what they were before the step.
  template <class Wanted> void disarm(const Wanted &wanted) {
    for (const auto &[k, armed] : armedNow_)
      if (wanted(k))
        starts_[k].armed = armed;
  }
  [[nodiscard]] bool hasJustBegun(int guard, double value) const;
  std::vector<Start> starts_, resumed_;           // of the guards in awake_
  std::vector<std::pair<int, Arming>> armedNow_;  // in the search, and how they were before
  std::vector<int> awake_, previous_;             // guards whose contacts are awake (GapScreen), and others but for held_; ascending
  std::vector<int> held_;                         // guards that are held (Guard::isHeld)
  long long awakeRevision_ = -1;
  bool needsForces_ = false;
  bool hasDifferences_ = false;  // guards whose rates at the ends of steps are differences
  bool needsRates_ = false;      // a guard whose rate inside the step is a difference may have come near zero
  bool varies_ = false;          // a guard does (Guard::varies)
  bool fromEnds_ = false;        // the interpolant is that of the ends of the step
  bool samplesVarying_ = false;  // event_sampling.cpp looks for the zeros of those in this step
  double probeStep_ = 0;         // of differences of guards
  int divisions_ = 0;            // of the step, for one guard
  bool wasPositive_ = false;     // that guard, before the step
  bool rises_ = false;           // it has been found clearly positive in the step
  double limit_ = 0;             // later zeros are not looked for
  double searchedTo_ = 0;        // see searchedTo()
  bool watched_ = false;         // a gap or a slip that varies has not left zero yet
  bool cut_ = false;             // see isCut
  double cutTime_ = 0;
  bool startsToRounding_ = true;
  double error_ = 0, forceError_ = 0;  // the integrator's, of guards that start at zero
  Sample begin_, end_, shifted_;
  std::vector<Sample> inside_;     // at places inside a step with forces that vary
  Sample first_;                   // at the first event found so far
  std::array<Sample, 3> inner_;    // the latest ones
  std::vector<Sample> pool_;       // one middle for each depth of the search
  std::vector<double> endsError_;  // of guards, while fromEnds_
  std::vector<double> fastest_;    // the largest rates of guards at the samples of the step
  std::vector<int> falling_;       // workspace of fallingForce
  std::vector<double> state_, scratch_, nudgeBase_, nudgeRate_, boxCenter_, boxRadius_;
};

}  // namespace tf::runtime
