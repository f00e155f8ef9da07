// Slips of two components: friction opposes v_t/‖v_t‖, continued through v_t = 0 along a reference direction, so that a step may end where
// the slip vanishes (theory.md section 4).
#pragma once

#include "runtime/integrate/mode.h"
#include "runtime/integrate/model_evaluation.h"
#include "runtime/integrate/row_system.h"

#include <algorithm>
#include <vector>

namespace tf::runtime {

// The pairs of tangential rows that slip in a mode, each with the direction of its friction. Slips are those of the latest `switching`.
class SlipDirections {
public:
  explicit SlipDirections(ModelEvaluation &evaluation) : at_(evaluation) {}

  // Slips below this part of their scale have the reference direction, unless they grow: within the accuracy of velocities.
  void setAccuracy(double relative) { accuracy_ = std::max(relative, 1e-12); }

  // The pairs among `rows` that slip (problem.slipSign ≠ 0), with the reference directions of a new mode that begins at (t, y): those of
  // the slips, or the mode's own where they are zero.
  void choose(const Mode &mode, const RowSystem &rows, const ContactRows &problem, double time, const double *state);
  // The directions at (t, y) become the reference of the next step. True: friction jumps with one of them, that of a slow slip.
  bool renew(double time, const double *state);
  // Turns the rows' frames into the directions at the point of the latest `switching`.
  void align(RowSystem &rows) const;

  [[nodiscard]] bool empty() const { return pairs_.empty(); }
  [[nodiscard]] int count() const { return static_cast<int>(pairs_.size()); }
  // First row of a pair among the tangential rows chosen, and among those of the model.
  [[nodiscard]] int row(int pair) const { return pairs_[pair].row; }
  [[nodiscard]] int modelRow(int pair) const { return pairs_[pair].modelRow; }
  // Part of the slip along the reference direction, and ‖v_t‖.
  [[nodiscard]] double along(int pair) const { return along(pairs_[pair]); }
  [[nodiscard]] double speed(int pair) const;
  // Magnitude of the velocities that the slip is compared with (ContactScales); slips below `rounding` have the reference direction.
  [[nodiscard]] double scale(int pair) const { return pairs_[pair].scale; }
  [[nodiscard]] double rounding(int pair) const { return accuracy_ * scale(pair); }

  // A slip starts from zero at the last `choose`: its direction is stiff at first, for any integrator that is not.
  [[nodiscard]] bool launches() const { return launches_; }
  // Which of them start or grow at the point of the latest `switching`, where these are the rates of their speeds. Whether a slow one does.
  bool watchGrowth(const double *rates);
  // The mode that has just begun takes it for zero, with a direction to begin with.
  [[nodiscard]] bool isGiven(int pair) const { return pairs_[pair].given; }
  // It was zero there, within rounding.
  [[nodiscard]] bool starts(int pair) const { return pairs_[pair].starts; }
  [[nodiscard]] bool anyStarts() const;
  // The reference directions, two numbers for each. Only those of pairs that start are set.
  void references(double *directions) const;
  void setReferences(const double *directions);
  // Turns those to the friction that Newton's method wants where it has begun with zero slips: there the slope of friction is the part of
  // the slip across the reference over twice the rounding of slips (see `turning`). Returns the largest angle.
  double turnToFriction();
  // Angles from the references of those that start to the slips at the point of the latest `switching`, one for each pair; zero for others.
  void angles(double *values) const;
  void turnReferences(const double *angles);
  // The reference directions become those of the slips, which are not zero, at the point of the latest `switching`.
  void turnToSlips();
  // One of those that grew has the opposite direction at the point of the latest `switching`.
  [[nodiscard]] bool turnBack() const;
  // Some slip is not faster than `part` of its scale at the point of the last `renew`.
  [[nodiscard]] bool anyBelow(double part) const;
  // No slip is small any more, there too.
  [[nodiscard]] bool haveLaunched() const;
  // The direction of friction is the reference direction (or what `aim` says), whatever the slip is, for the pairs that are now not faster
  // than `part` of their scale, until `renew`, `choose` or the next call; for all others it is that of the slip.
  void hold(double part);
  // The same, but for those that start at the latest `watchGrowth` alone. False: there are none.
  bool holdStarts(double part);
  // Slopes of the slips at the model's point against their references [count()].
  void slopesOfSlips(double *slopes) const;
  // Directions that `hold` holds have these slopes against the references, where the slips turn evenly: where slopes at two times before a
  // stop, one twice as long as the other, differ little; until hold(0), `renew` or `choose`. Those of slips that are not small against
  // `part` of their scale become those of the slips.
  void aim(const double *earlier, const double *later, const double *slopes, double part);

  // Derivatives of the slips by (q, v) at (t, y), whose contact terms have been evaluated; the evaluation returns to that point.
  void differentiate(double time, const double *state);
  // The same by v alone, and zero by q, at the point of the latest contact terms and `switching`.
  void differentiateByVelocity();
  // All slips, two for each pair, at the point of the latest `switching`.
  void slips(double *values) const;
  // Their derivatives by v, nv for each, at the point of the latest contact terms.
  void slipsByVelocity(double *rows) const;
  // Derivative of the angle of friction's direction by number `column` of (q, v) there, in radians per unit.
  [[nodiscard]] double turning(int pair, int column) const;

private:
  struct Pair {
    int row = 0, modelRow = 0;
    double c = 1, s = 0;  // reference direction
    double scale = 1;
    bool given = false;  // the reference direction, by the mode that has just begun: it takes the slip for zero
    bool held = false;
    double heldSlope = 0, width = 0;     // see `aim`: of the direction that is held against the reference, and the slips that have it
    bool grows = false, starts = false;  // at the latest `watchGrowth`
  };

  // See `renew`.
  bool update(double time, const double *state);
  // Slope of friction's direction against the reference, at the point of the latest `switching`.
  [[nodiscard]] double slope(const Pair &pair) const;
  static void turn(Pair &pair, double cosine, double sine);
  void copySlipsByVelocity();
  [[nodiscard]] bool isBelow(int pair, double part) const;
  // Slips below have the reference direction: rounding errors of those that grow, whose direction is known from the start on.
  [[nodiscard]] double rounding(const Pair &pair) const;
  // The part along the reference below which the slope leaves that of the slip.
  [[nodiscard]] double smoothing(const Pair &pair) const;
  [[nodiscard]] double along(const Pair &pair) const;
  [[nodiscard]] double across(const Pair &pair) const;

  ModelEvaluation &at_;
  std::vector<Pair> pairs_;
  double accuracy_ = 1e-12;
  bool launches_ = false;
  std::vector<double> slipByState_;  // d slip/d(q, v): two rows for each pair
};

}  // namespace tf::runtime
