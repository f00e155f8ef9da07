#include "runtime/contact/jam.h"

#include "runtime/contact/coupling.h"
#include "runtime/contact/mode_equations.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace tf::runtime {

namespace {

// Where a slow slip turns, D_s falls to zero as the square root of the time that is left: this far within the rounding of time.
constexpr double jammedRatio = 1e-3;
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

// The rows in parts, ascending, such that forces of one part accelerate rows of no other.
std::vector<std::vector<int>> uncoupledParts(const Eigen::MatrixXd &free, const Eigen::MatrixXd &slipping) {
  const auto count = static_cast<int>(free.rows());
  std::vector<std::vector<int>> parts;
  std::vector<int> rows(count);
  std::iota(rows.begin(), rows.end(), 0);
  std::vector<std::uint8_t> isListed(count, 0);
  for (const int first : rows) {
    if (isListed[first])
      continue;
    std::vector<int> part{first};
    isListed[first] = 1;
    addCoupled(part, isListed, rows, [&](int j, int i) { return free(i, j) != 0 || slipping(i, j) != 0 || slipping(j, i) != 0; });
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

std::vector<Jam> jammedNormals(const ContactProblem &problem, const ContactMode &mode) {
  if (problem.normalCount == 0)
    return {};
  const std::vector<double> none(problem.tangentCount, 0.0);
  const Eigen::MatrixXd allFree = accelerations(problem, mode, none), allSlipping = accelerations(problem, mode, problem.friction);
  std::vector<Jam> jams;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<int> &rows : uncoupledParts(allFree, allSlipping)) {
    const Eigen::MatrixXd free = allFree(rows, rows), slipping = allSlipping(rows, rows);
    Eigen::VectorXd own = ownAccelerations(free), left = ownAccelerations(slipping);
    // Forces of redundant rows are not unique: each contact is looked at alone.
    const bool isAlone = !(own.array() > redundant * free.diagonal().array()).all();
    if (isAlone) {
      own = free.diagonal();
      left = slipping.diagonal();
    }
    for (std::size_t k = 0; k < rows.size() && rows[k] < problem.normalCount; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double ratio = std::isfinite(left[i]) ? left[i] / own[i] : 0;
      if (ratio <= jammedRatio)
        jams.push_back(isAlone ? Jam{rows[k], ratio, nan, nan} : Jam{rows[k], ratio, left[i], own[i]});
    }
  }
  std::sort(jams.begin(), jams.end(), [](const Jam &a, const Jam &b) { return std::pair(a.ratio, a.row) < std::pair(b.ratio, b.row); });
  return jams;
}

}  // namespace tf::runtime
