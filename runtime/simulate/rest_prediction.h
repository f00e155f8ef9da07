// Zeno (theory.md section 3): the point in time where infinitely many impacts accumulate, before the impacts have been followed there.
//
// After an impact the rest of the sequence is followed with the coefficients of that instant (ImpactSequence). The points so found are
// extrapolated (RestSeries) until they are accurate enough to take the step to the point: one series of those where impacts accumulate, and
// one of those where such points do, as where one end of a rod comes to rest within each hop of the other one.
#pragma once

#include "runtime/contact/impact_sequence.h"
#include "runtime/simulate/mode_selection.h"
#include "runtime/simulate/rest_series.h"
#include "runtime/simulate/sensitivities.h"

#include <vector>

namespace tf::runtime {

// The speed at which a contact approaches before an impact.
struct Approach {
  int contact = 0;
  double speed = 0;
};

class RestPrediction {
public:
  RestPrediction(ModeDynamics &dynamics, ModeSelection &selection);

  // Forgets everything: a new run that begins at `time`.
  void reset(double time);
  // The forces have changed by a jump: earlier predictions are void.
  void restart();

  // After an impact of these contacts at `time` that has led to `state`; the dynamics is in the mode that follows. `accumulated` is as that
  // of the point, since the run has begun. The point of rest where it is known to `tolerance` (relative to max(scale, |y|), [n]), else
  // null. The pointer is valid until the next call. `sensitivities` (may be null) are those along the impact, whose time moves; their point
  // of rest must be known as well.
  const RestPoint *afterImpact(double time, const std::vector<Approach> &approaches, const double *state,
                               const std::vector<double> &accumulated, double tolerance, const double *scale, Sensitivities *sensitivities);

  // The last impact of a contact was slow, compared with its fastest one, and its next one is still to be expected.
  [[nodiscard]] bool bouncesLow(double time) const;
  // A switch has changed its side.
  void recordSwitch(int index);
  // These contacts, ascending, have come to rest at `time`.
  void endBounces(double time, const std::vector<int> &contacts);

  // What continuation depends on: numberCount() numbers; reading them implies restart().
  [[nodiscard]] std::size_t numberCount() const { return fastest_.size() + 2; }
  void write(double *numbers) const;
  void read(const double *numbers);

private:
  // What afterImpact is called with.
  struct LastImpact {
    double time = 0, previous = 0;  // of it and of the one before
    const std::vector<Approach> &approaches;
    const double *state = nullptr;
    const std::vector<double> &accumulated;
    double tolerance = 0;
    const double *scale = nullptr;
    Sensitivities *sensitivities = nullptr;
  };

  bool recordImpact(double time, const std::vector<Approach> &approaches);
  [[nodiscard]] bool slowsDown(const Approach &approach) const;
  void chooseContacts(double time, const double *state);
  bool addReachable(double time, const double *state, const RestPoint &end);
  void coverReach(double time, const double *state, const RestPoint &end, double span);
  void chooseRows(double time, const double *state);
  void choosePair(int j);
  void classify(const double *state);
  bool evaluateDelassus(double time, const double *state);
  void evaluateBias(double time, const std::vector<double> &state);
  void stopTouching(std::vector<double> &state);
  void accumulate(const AccumulationPoint &end, RestPoint &point) const;
  bool moveTo(const AccumulationPoint &end, double time, const double *state, RestPoint &point);
  bool predict(double time, const double *state, RestEstimate &estimate);
  bool predictWithChosen(double time, const double *state, RestEstimate &estimate);
  bool refine(double time, const double *state, RestEstimate &estimate);
  bool follow(const std::vector<double> &coefficients, double time, const double *state, RestEstimate &estimate);
  bool differentiate(double time, const double *state, Sensitivities &sensitivities, RestEstimate &estimate);
  [[nodiscard]] int longerPause(int pause, int limit) const;
  const RestPoint *afterImpacts(const LastImpact &impact);
  const RestPoint *afterAccumulations(const LastImpact &impact);
  bool makeEstimate(const LastImpact &impact, Accumulation wanted, RestEstimate &estimate);
  const RestPoint *pointOf(RestSeries &series, const LastImpact &impact, double resolved);
  [[nodiscard]] bool isSlow(const RestPoint &point) const;
  [[nodiscard]] double timeByRounding(const std::vector<Approach> &approaches) const;
  [[nodiscard]] double timeScale() const;
  bool nothingElseHappens(const RestSeries &series);

  ModeDynamics &dynamics_;
  ModelEvaluation &at_;
  ModeSelection &selection_;
  RowSystem rows_;
  SequenceProblem problem_;
  ImpactSequence sequence_;
  std::vector<std::uint8_t> takesPart_;            // nc + nf
  std::vector<std::uint8_t> touches_, stands_;     // rows with gap 0; normal, then tangential rows, with velocity 0
  bool isDisplaced_ = false;                       // near the point that these were found at: they are kept
  Accumulation wanted_ = Accumulation::OfImpacts;  // of what is being followed
  RestSeries ofImpacts_, ofAccumulations_;
  std::vector<int> nearest_;                                // contacts of the latest estimate of where impacts accumulate
  std::vector<double> fastest_, last_;                      // nc: approach speeds of impacts, the greatest and the last one
  std::vector<double> lastTime_, lastInterval_, lowUntil_;  // nc: of their last impact, since the one before, and when its low bounces end
  std::vector<std::uint8_t> slowed_;                        // nc: the last interval was shorter than the one before
  double impacts_ = 0;                                      // number
  double begin_ = 0, firstImpact_ = 0;                      // times: of the run, and since restart()
  double lastImpact_ = 0, nextAttempt_ = 0;                 // times
  int pause_ = 0, passed_ = 0;                              // impacts that are let pass before the next attempt, and those that have
  int outerPause_ = 0, outerPassed_ = 0;                    // the same, of points where others accumulate
  double wait_ = 0;                                         // of the last attempt without a prediction, in intervals between impacts
  std::vector<double> change_, moment_;                     // workspaces
  GapScreen reach_;                                         // of contacts that a prediction may close
  std::vector<int> owner_;                                  // nt, see contactsOfTangents
  std::vector<TangentRole> roles_;                          // nt
};

}  // namespace tf::runtime
