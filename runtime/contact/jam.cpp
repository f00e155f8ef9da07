#include "runtime/contact/jam.h"

#include "runtime/contact/mode_equations.h"

#include <Eigen/Dense>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tf::runtime {

namespace {

// Where a slow slip turns, D_s falls to zero as the square root of the time that is left: this far within the rounding of time.
constexpr double jammed = 1e-3;
// Rows whose own acceleration, the others at rest, has lost more than this are taken for redundant.
constexpr double redundant = 1e-9;

// The accelerations of the active rows by forces of the active rows, with `friction` of the slips [m]: the normal rows come first.
Eigen::MatrixXd accelerations(const ContactProblem &problem, const ContactMode &mode, const std::vector<double> &friction) {
  const ContactRowData rows{.normalCount = problem.normalCount,
                            .tangentCount = problem.tangentCount,
                            .delassus = &problem.delassus,
                            .bias = problem.bias.data(),
                            .owner = problem.owner.data(),
                            .friction = friction.data(),
                            .offset = problem.bound.data()};
  std::vector<std::uint8_t> active(problem.count(), 1);
  for (int j = 0; j < problem.tangentCount; ++j)
    active[problem.normalCount + j] = mode.slip[j] == 0;
  ModeEquations equations;
  equations.setMode(rows, active.data(), mode.slip.data());
  DenseMatrix matrix;
  equations.assemble(rows, matrix);
  return matrix.map();
}

// 1/(A⁻¹)_ii: the acceleration of a row by its own force while forces of the others keep theirs zero.
Eigen::VectorXd ownAccelerations(const Eigen::MatrixXd &matrix) { return matrix.partialPivLu().inverse().diagonal().cwiseInverse(); }

}  // namespace

Jam jammedNormal(const ContactProblem &problem, const ContactMode &mode) {
  if (problem.normalCount == 0)
    return {};
  const std::vector<double> none(problem.tangentCount, 0.0);
  const Eigen::MatrixXd free = accelerations(problem, mode, none), slipping = accelerations(problem, mode, problem.friction);
  Eigen::VectorXd own = ownAccelerations(free), left = ownAccelerations(slipping);
  // Forces of redundant rows are not unique: each contact is looked at alone.
  const bool isAlone = !(own.array() > redundant * free.diagonal().array()).all();
  if (isAlone) {
    own = free.diagonal();
    left = slipping.diagonal();
  }
  Jam worst;
  double least = jammed;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < problem.normalCount; ++i) {
    const double ratio = std::isfinite(left[i]) ? left[i] / own[i] : 0;
    if (ratio <= least) {
      least = ratio;
      worst = isAlone ? Jam{i, nan, nan} : Jam{i, left[i], own[i]};
    }
  }
  return worst;
}

}  // namespace tf::runtime
