// What gaps, slips and residuals are compared with: the magnitudes of the coordinates and velocities that move them, by how far they do.
#pragma once

#include "runtime/abi/tf_model.h"

#include <vector>

namespace tf::runtime {

class ContactScales {
public:
  static constexpr double several = 10;

  explicit ContactScales(const tf_model &model);

  // Nominal magnitudes of the state (q, v, z, tau): 1 where none is given.
  [[nodiscard]] const std::vector<double> &nominal() const { return nominal_; }
  // A change of the coordinates by their nominal magnitudes, in the velocities' kind [nv]: a rotation turns by a radian.
  [[nodiscard]] const std::vector<double> &lengths() const { return lengths_; }

  // Forgets all rows.
  void start();
  // Adds the rows at another point, of which the largest entries count: `normal` [nc × nv], `tangent` [nt × nv] as of
  // tf_model::contact_terms, `constraint` [nh × nv] as of tf_model::constraint_terms.
  void include(const double *normal, const double *tangent, const double *constraint);
  // Rows are complete.
  void finish();

  // Of a gap: what the nominal magnitude of one of its coordinates moves it by at most. 1e-12 of it is more than the rounding errors of the
  // gap at the coordinates q [nq].
  [[nodiscard]] double gap(int contact, const double *q) const { return length(contact, q); }
  // The same number where farthest(q) is known already, without a look at the coordinates unless one of them may matter.
  [[nodiscard]] double gap(int contact, const double *q, double farthest) const {
    const Row &row = rows_[contact];
    return resolved * row.lever * farthest <= row.length ? row.length : length(contact, q);
  }
  // The largest magnitude among the coordinates q [nq], without those of rotations.
  [[nodiscard]] double farthest(const double *q) const;
  // Of a gap's rate and of a tangential row's slip: what the nominal magnitude of one velocity contributes at most, larger as the fastest
  // of the velocities v [nv] is beyond its own, up to `most` times what all of them contribute. Rounding errors of fast bodies reach those
  // that touch them; the error of the row's own velocities does not exceed their sum (`most` 1).
  [[nodiscard]] double gapRate(int contact, const double *v, double most = several) const { return speed(contact, v, most); }
  [[nodiscard]] double slip(int row, const double *v, double most = several) const { return speed(model_->nc + row, v, most); }
  // What the nominal magnitude of one coordinate moves a gap, or a tangential row, by at most.
  [[nodiscard]] double normalLength(int contact) const { return rows_[contact].length; }
  [[nodiscard]] double tangentLength(int row) const { return rows_[model_->nc + row].length; }
  // Of a constraint's row and its rate.
  [[nodiscard]] double residual(int row) const { return rows_[model_->nc + model_->nt + row].length; }
  // How far the nominal magnitude of one coordinate moves the constraint's row with these entries [nv] at most, relative to that scale.
  [[nodiscard]] double share(int row, const double *entries) const;
  [[nodiscard]] double residualRate(int row, const double *v) const { return speed(model_->nc + model_->nt + row, v, several); }

private:
  // Sums of coordinates are off by a few rounding errors of the largest one: this part of it counts.
  static constexpr double resolved = 2e-3;

  // Of a row: velocity number `velocity` moves it by `size` of itself.
  struct Lever {
    int velocity;
    double size;
  };
  struct Row {
    int first = 0, count = 0;  // its part of levers_
    double length = 1;         // what the nominal magnitude of one coordinate moves it by at most
    double lever = 0;          // the largest size of the levers whose velocity is the rate of a coordinate
    double speed = 0;          // what the nominal magnitude of one velocity contributes at most, 0 where nothing moves it
  };

  // Of rows `first` to `first` + `count` − 1: their entries [count × nv].
  void includeRows(int first, int count, const double *entries);
  // The largest velocity, in units of its nominal magnitude, at least 1.
  [[nodiscard]] double fastest(const double *v) const;
  [[nodiscard]] double length(int index, const double *q) const;
  [[nodiscard]] double speed(int index, const double *v, double most) const;

  const tf_model *model_;
  std::vector<double> nominal_, lengths_;
  std::vector<double> inverse_;  // nv: of nominal_
  std::vector<int> coordinate_;  // nv: the coordinate whose rate it is, −1 of rotations
  double largestNominal_ = 0;    // of the velocities
  std::vector<double> sizes_;    // [nc + nt + nh] × nv: the largest of the rows' entries at the points included
  std::vector<Row> rows_;        // nc + nt + nh
  std::vector<Lever> levers_;    // row by row, in the order of the velocities
};

}  // namespace tf::runtime
