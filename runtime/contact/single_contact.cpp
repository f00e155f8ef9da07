#include "runtime/contact/single_contact.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr double clear = 1e-6;

// The rows divided by √D_rr, so that D = [1 c; c 1]; without a tangential row c = μ = 0.
struct ScaledContact {
  double normalMetric = 1, tangentMetric = 1;
  double coupling = 0, friction = 0;  // c, μ
  double normalBias = 0, tangentBias = 0;
  double scale = 0;  // of forces and accelerations
  int slipSign = 0;
  bool hasTangent = false;
};

struct ScaledSolution {
  double normalForce = 0, tangentForce = 0, normalAcceleration = 0, tangentAcceleration = 0;
  double residual = 0;  // of the rows whose acceleration is zero
  bool closed = false, sticks = false;
};

// False: other rows.
bool scaleRows(const ContactProblem &problem, ScaledContact &c) {
  if (problem.normalCount != 1 || problem.tangentCount > 1 || !(problem.delassus(0, 0) > 0))
    return false;
  c.normalMetric = std::sqrt(problem.delassus(0, 0));
  c.normalBias = problem.bias[0] / c.normalMetric;
  c.hasTangent = problem.tangentCount == 1;
  if (c.hasTangent) {
    if (problem.owner[0] != 0 || problem.partner[0] >= 0 || !(problem.friction[0] > 0) || problem.isInert(0))
      return false;
    c.tangentMetric = std::sqrt(problem.delassus(1, 1));
    c.coupling = problem.delassus(0, 1) / (c.normalMetric * c.tangentMetric);
    c.friction = problem.friction[0] * c.tangentMetric / c.normalMetric;
    c.tangentBias = problem.bias[1] / c.tangentMetric;
    c.slipSign = problem.slipSign[0];
  }
  c.scale = std::max(std::abs(c.normalBias), std::abs(c.tangentBias));
  return true;
}

// D_s > 0 for the slips that there may be: no more than one solution.
bool isUnique(const ScaledContact &c) {
  const double coupling = c.slipSign != 0 ? c.slipSign * c.coupling : std::abs(c.coupling);
  return 1 - c.friction * coupling > clear;
}

// The contact is closed and slips in the direction `sign`, which is 0 where it has no friction. False: not clearly so.
bool slide(const ScaledContact &c, int sign, ScaledSolution &s) {
  const double response = 1 - sign * c.friction * c.coupling;  // D_s
  s.normalForce = -c.normalBias / response;
  s.tangentForce = -sign * c.friction * s.normalForce;
  s.tangentAcceleration = c.tangentBias + c.coupling * s.normalForce + s.tangentForce;
  s.residual = std::abs(c.normalBias + s.normalForce + c.coupling * s.tangentForce);
  return c.slipSign != 0 || sign == 0 || sign * s.tangentAcceleration > clear * c.scale;
}

// The contact is closed, its slip is zero.
bool stickOrStart(const ScaledContact &c, ScaledSolution &s) {
  const double determinant = 1 - c.coupling * c.coupling;
  if (!(determinant > clear))
    return false;
  s.normalForce = (c.coupling * c.tangentBias - c.normalBias) / determinant;
  s.tangentForce = (c.coupling * c.normalBias - c.tangentBias) / determinant;
  const double excess = std::abs(s.tangentForce) - c.friction * s.normalForce, margin = clear * c.scale;
  if (s.normalForce > margin && excess < -margin) {
    s.sticks = true;
    s.residual = std::max(std::abs(c.normalBias + s.normalForce + c.coupling * s.tangentForce),
                          std::abs(c.tangentBias + c.coupling * s.normalForce + s.tangentForce));
    return true;
  }
  return excess > margin && slide(c, s.tangentForce > 0 ? -1 : 1, s);
}

}  // namespace

bool solveSingleContact(const ContactProblem &problem, double degeneracy, ContactSolution &solution) {
  ScaledContact c;
  if (!scaleRows(problem, c) || !isUnique(c))
    return false;
  ScaledSolution s;
  if (c.normalBias > clear * c.scale) {
    s.normalAcceleration = c.normalBias;
    s.tangentAcceleration = c.tangentBias;
  } else if (c.normalBias < -clear * c.scale) {
    s.closed = true;
    if (!(c.hasTangent && c.slipSign == 0 ? stickOrStart(c, s) : slide(c, c.slipSign, s)))
      return false;
  } else {
    return false;
  }
  solution.status = ContactStatus::Solved;
  solution.scale = c.scale;
  solution.forced = -1;
  solution.redundant = false;
  solution.saturated.clear();
  solution.degenerate.clear();
  solution.mode.resize(1, problem.tangentCount);
  solution.mode.closed[0] = s.closed ? 1 : 0;
  solution.forces.resize(problem.count());
  solution.accelerations.resize(problem.count());
  solution.forces[0] = s.normalForce / c.normalMetric;
  solution.accelerations[0] = s.normalAcceleration * c.normalMetric;
  if (c.hasTangent) {
    solution.forces[1] = s.tangentForce / c.tangentMetric;
    solution.accelerations[1] = s.tangentAcceleration * c.tangentMetric;
    const int start = s.tangentAcceleration > degeneracy * c.scale ? 1 : s.tangentAcceleration < -degeneracy * c.scale ? -1 : 0;
    solution.mode.slip[0] = static_cast<std::int8_t>(s.sticks ? 0 : c.slipSign != 0 ? c.slipSign : start);
  }
  solution.violation = s.residual / (c.scale + 1e-5 * std::max(std::abs(s.normalForce), std::abs(s.tangentForce)));
  return true;
}

}  // namespace tf::runtime
