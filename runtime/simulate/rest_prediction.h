// Zeno (theory.md section 3): the point in time where infinitely many impacts accumulate, before the impacts have been followed there.
//
// After an impact the rest of the sequence is followed with the coefficients of that instant (ImpactSequence). The point so found is wrong
// by O(T²), T the time that is left, with an expansion in powers of T: points predicted while T halves again and again are extrapolated to
// T = 0 (Richardson), and the difference of successive extrapolations tells when that is accurate enough to take the step to the point.
// Where switches change to and fro on the way, as with the sign of a velocity, the point is wrong by O(T), with as regular an expansion.
#pragma once

#include "runtime/contact/impact_sequence.h"
#include "runtime/simulate/mode_selection.h"
#include "runtime/simulate/sensitivities.h"

#include <Eigen/Core>

#include <vector>

namespace tf::runtime {

// Where contacts come to rest.
struct RestPoint {
  double time = 0;
  std::vector<double> state;        // q, v, z, tau, to the tolerance; the contacts' gaps and rates may be off by as much
  std::vector<int> contacts;        // of the model: those that come to rest, ascending
  std::vector<int> sticking;        // tangential rows of closed contacts whose slip is zero there
  std::vector<double> derivatives;  // of (q, v, z) and time by each sensitivity, where they are asked for
  // What has come together on the way: normal impulses [nc] of the impacts, their loss of energy, loss by friction between them.
  std::vector<double> accumulated;
};

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
  void recordSwitch(int index) { changed_[index] = 1; }
  // These contacts, ascending, have come to rest at `time`.
  void endBounces(double time, const std::vector<int> &contacts);

  // What continuation depends on: numberCount() numbers; reading them implies restart().
  [[nodiscard]] std::size_t numberCount() const { return fastest_.size() + 2; }
  void write(double *numbers) const;
  void read(const double *numbers);

private:
  struct Prediction {
    double remaining = 0;  // T
    RestPoint point;
    std::vector<double> derivatives;  // of (q, v, z), time and T by each sensitivity
    std::vector<double> totals;       // point.accumulated and what there was before
  };

  void forget();
  [[nodiscard]] Eigen::VectorXd extrapolationWeights(const Eigen::VectorXd &x) const;
  bool recordImpact(double time, const std::vector<Approach> &approaches);
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
  bool predict(double time, const double *state, Prediction &prediction);
  bool predictWithChosen(double time, const double *state, Prediction &prediction);
  bool refine(double time, const double *state, Prediction &prediction);
  bool follow(const std::vector<double> &coefficients, double time, const double *state, Prediction &prediction);
  bool differentiate(double time, const double *state, Sensitivities &sensitivities, Prediction &prediction);
  [[nodiscard]] int longerPause() const;
  void add(Prediction prediction);
  bool extrapolate(double tolerance, const double *scale);
  void extrapolateTotals(const std::vector<double> &last);
  [[nodiscard]] std::vector<double> extrapolatedDerivatives(std::size_t predictions, int columns) const;
  bool derivativesAgree(double tolerance, int columns);
  [[nodiscard]] bool isSlow() const;
  [[nodiscard]] double timeByRounding(const std::vector<Approach> &approaches) const;
  [[nodiscard]] double timeScale() const;
  bool nothingElseHappens();

  ModeDynamics &dynamics_;
  ModelEvaluation &at_;
  ModeSelection &selection_;
  RowSystem rows_;
  SequenceProblem problem_;
  ImpactSequence sequence_;
  std::vector<std::uint8_t> takesPart_;                     // nc + nf
  std::vector<std::uint8_t> touches_, stands_;              // rows with gap 0; normal, then tangential rows, with velocity 0
  bool isDisplaced_ = false;                                // near the point that these were found at: they are kept
  std::vector<Prediction> predictions_;                     // the latest last, T falling
  std::size_t extrapolatedFrom_ = 0;                        // how many predictions the best extrapolation takes
  RestPoint point_;                                         // extrapolated
  std::vector<double> extrapolated_;                        // its state and time; empty where there is none
  std::vector<double> fastest_, last_;                      // nc: approach speeds of impacts, the greatest and the last one
  std::vector<double> lastTime_, lastInterval_, lowUntil_;  // nc: of their last impact, since the one before, and when its low bounces end
  std::vector<std::uint8_t> changed_;                       // ns: since the latest prediction
  std::vector<std::uint8_t> alternates_;                    // ns: between the two latest predictions
  double impacts_ = 0;                                      // number
  double begin_ = 0, firstImpact_ = 0;                      // times: of the run, and since restart()
  double lastImpact_ = 0, nextAttempt_ = 0;                 // times
  int pause_ = 0, passed_ = 0;                              // impacts that are let pass before the next attempt, and those that have
  double wait_ = 0;                                         // of the last attempt without a prediction, in intervals between impacts
  std::vector<double> change_, moment_;                     // workspaces
  GapScreen reach_;                                         // of contacts that a prediction may close
  std::vector<int> owner_;                                  // nt, see contactsOfTangents
  std::vector<TangentRole> roles_;                          // nt
};

}  // namespace tf::runtime
