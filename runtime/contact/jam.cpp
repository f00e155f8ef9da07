#include "runtime/contact/jam.h"

#include <Eigen/Dense>

#include <cmath>
#include <vector>

namespace tf::runtime {

namespace {

// Where a slow slip turns, D_s falls to zero as the square root of the time that is left: this far within the rounding of time.
constexpr double jammed = 1e-3;
// Rows whose own acceleration, the others at rest, has lost more than this are taken for redundant.
constexpr double redundant = 1e-9;

std::vector<int> activeRows(const ContactProblem &problem, const ContactMode &mode) {
  std::vector<int> rows;
  rows.reserve(problem.count());
  for (int row = 0; row < problem.count(); ++row)
    if (row < problem.normalCount || mode.slip[row - problem.normalCount] == 0)
      rows.push_back(row);
  return rows;
}

// The accelerations of the rows by forces of the rows (columns): alone, or with the friction of their contacts' slips.
Eigen::MatrixXd accelerations(const ContactProblem &problem, const std::vector<int> &rows, const ContactMode *slips) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd result(count, count);
  for (Eigen::Index c = 0; c < count; ++c)
    for (Eigen::Index r = 0; r < count; ++r) {
      result(r, c) = problem.delassus(rows[r], rows[c]);
      for (int j = 0; slips != nullptr && j < problem.tangentCount; ++j)
        if (problem.owner[j] == rows[c] && slips->slip[j] != 0)
          result(r, c) -= slips->slip[j] * problem.friction[j] * problem.delassus(rows[r], problem.normalCount + j);
    }
  return result;
}

// 1/(A⁻¹)_ii: the acceleration of a row by its own force while forces of the others keep theirs zero.
Eigen::VectorXd ownAccelerations(const Eigen::MatrixXd &matrix) { return matrix.partialPivLu().inverse().diagonal().cwiseInverse(); }

}  // namespace

int jammedNormal(const ContactProblem &problem, const ContactMode &mode) {
  const std::vector<int> rows = activeRows(problem, mode);
  if (problem.normalCount == 0)
    return -1;
  const Eigen::MatrixXd free = accelerations(problem, rows, nullptr), slipping = accelerations(problem, rows, &mode);
  Eigen::VectorXd own = ownAccelerations(free), left = ownAccelerations(slipping);
  // Forces of redundant rows are not unique: each contact is looked at alone.
  if (!(own.array() > redundant * free.diagonal().array()).all()) {
    own = free.diagonal();
    left = slipping.diagonal();
  }
  int worst = -1;
  double least = jammed;
  for (int i = 0; i < problem.normalCount; ++i) {
    const double ratio = std::isfinite(left[i]) ? left[i] / own[i] : 0;
    if (ratio <= least) {
      least = ratio;
      worst = i;
    }
  }
  return worst;
}

}  // namespace tf::runtime
