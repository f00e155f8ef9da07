#include "runtime/contact/contact_solver.h"

#include "runtime/contact/force_set.h"
#include "runtime/contact/next_derivative.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

bool hasSolution(const PlanarFrictionSolution &solution) {
  return solution.status == PlanarFrictionSolution::Status::Solved || solution.status == PlanarFrictionSolution::Status::Several;
}

bool withoutFriction(const ContactProblem &problem, int j) {
  return problem.owner[j] >= 0 ? problem.friction[j] == 0 : problem.bound[j] == 0;
}

// D_s = D_nn − μ s D_nt.
double slidingResponse(const ContactProblem &problem, int i) {
  double response = problem.delassus(i, i);
  for (int j = 0; j < problem.tangentCount; ++j)
    if (problem.owner[j] == i)
      response -= problem.slipSign[j] * problem.friction[j] * problem.delassus(i, problem.normalCount + j);
  return response;
}

}  // namespace

void ContactRates::resize(int normals, int tangents) {
  accelerationRate.assign(normals + tangents, 0.0);
  frictionRate.assign(tangents, 0.0);
  boundRate.assign(tangents, 0.0);
}

struct ContactSolver::Workspace {
  Settings settings;
  Statistics statistics;
  PlanarFrictionSolver solver;
  PlanarFrictionMode previous;
  ForceSet set;
  NextDerivative next;
  ContactSolution solution, resolved;
  double zero = 0;  // what counts as zero, in the metric of D

  void pose(const ContactProblem &problem);
  const PlanarFrictionMode *translate(const ContactMode *mode);
  int findForced(const ContactProblem &problem);
  void labelMode(const ContactProblem &problem, const ContactMode *preferred);
  void settleForces(const ContactProblem &problem);
  void listDegenerate(const ContactProblem &problem, const ContactMode *preferred);
  void markDegenerate(const ContactProblem &problem, const ContactMode *preferred, const ForceLimit &limit);
  void count(const PlanarFrictionSolution &found);
};

void ContactSolver::Workspace::pose(const ContactProblem &problem) {
  const int n = problem.normalCount, m = problem.tangentCount;
  PlanarFrictionProblem &p = solver.problem();
  p.resize(n, m);
  std::copy_n(problem.delassus.data(), (n + m) * (n + m), p.delassus.data());
  std::copy_n(problem.bias.begin(), n + m, p.bias.begin());
  for (int j = 0; j < m; ++j) {
    const int sign = problem.slipSign[j];
    p.tangentKind[j] = withoutFriction(problem, j) ? TangentKind::None : sign != 0 ? TangentKind::Slip : TangentKind::TwoSided;
    p.sign[j] = static_cast<std::int8_t>(sign);
    p.owner[j] = problem.owner[j];
    p.friction[j] = problem.owner[j] >= 0 ? problem.friction[j] : 0.0;
    p.offset[j] = problem.owner[j] >= 0 ? 0.0 : problem.bound[j];
  }
}

const PlanarFrictionMode *ContactSolver::Workspace::translate(const ContactMode *mode) {
  if (mode == nullptr)
    return nullptr;
  previous.slip.assign(mode->slip.begin(), mode->slip.end());
  previous.normal.resize(mode->closed.size());
  for (std::size_t i = 0; i < mode->closed.size(); ++i)
    previous.normal[i] = mode->closed[i] ? NormalState::Active : NormalState::Off;
  return &previous;
}

// Painlevé: the contact that approaches although all others answer; first of those whose own D_s is negative.
int ContactSolver::Workspace::findForced(const ContactProblem &problem) {
  int fallback = -1;
  for (const bool negative : {true, false})
    for (int i = 0; i < problem.normalCount; ++i) {
      if ((slidingResponse(problem, i) < 0) != negative)
        continue;
      if (fallback < 0)
        fallback = i;
      pose(problem);
      solver.problem().normalKind[i] = NormalKind::Prescribed;
      solver.problem().upper[i] = 0;
      const PlanarFrictionSolution &others = solver.solve(nullptr, settings.feasibility);
      if (hasSolution(others) && others.acceleration[i] < -zero * solver.metric()[i])
        return i;
    }
  return fallback;
}

// The largest mode that the accelerations allow: every contact with w_n = 0 is closed, every row without slip and slip acceleration sticks.
void ContactSolver::Workspace::labelMode(const ContactProblem &problem, const ContactMode *preferred) {
  const int n = problem.normalCount;
  const std::vector<double> &metric = solver.metric();
  ContactMode &mode = solution.mode;
  mode.resize(n, problem.tangentCount);
  for (int i = 0; i < n; ++i)
    mode.closed[i] = solution.forces[i] * metric[i] > zero || solution.accelerations[i] <= zero * metric[i] ? 1 : 0;
  for (int j = 0; j < problem.tangentCount; ++j) {
    const double acceleration = solution.accelerations[n + j] / metric[n + j];
    const int start = acceleration > zero ? 1 : acceleration < -zero ? -1 : 0;
    int slip = problem.slipSign[j] != 0 ? problem.slipSign[j] : start;
    if (slip == 0 && withoutFriction(problem, j))
      slip = preferred != nullptr && preferred->slip[j] != 0 ? preferred->slip[j] : 1;
    mode.slip[j] = static_cast<std::int8_t>(slip);
  }
}

// Redundant contacts share their load so that ‖λ‖ is least; the others have one force only.
void ContactSolver::Workspace::settleForces(const ContactProblem &problem) {
  set.setMode(problem, solution.mode);
  solution.redundant = set.singular(problem);
  solution.saturated.clear();
  if (!solution.redundant)
    return;
  ++statistics.redundant;
  if (set.solveLeastNorm(problem, settings.degeneracy) != LeastNorm::Status::Solved)
    return;
  // Where shares of the load move slipping contacts, the least-norm share may contradict rows that are not active: then the one found
  // stays.
  const double violation = solver.certificate(set.forces(), set.accelerations());
  if (violation > std::max(10 * settings.degeneracy, solution.violation))
    return;
  solution.violation = violation;
  solution.forces = set.forces();
  solution.accelerations = set.accelerations();
  for (std::size_t k = 0; k < set.limits().size(); ++k)
    if (set.saturated(static_cast<int>(k)) >= 0)
      solution.saturated.push_back(set.limits()[k]);
}

void ContactSolver::Workspace::markDegenerate(const ContactProblem &problem, const ContactMode *preferred, const ForceLimit &limit) {
  const int n = problem.normalCount, row = limit.row;
  if (std::find(solution.degenerate.begin(), solution.degenerate.end(), row) != solution.degenerate.end())
    return;
  solution.degenerate.push_back(row);
  if (preferred == nullptr)
    return;
  // Where the previous mode has the same forces, its label stays.
  if (row < n)
    solution.mode.closed[row] = preferred->closed[row];
  else if (preferred->slip[row - n] == -limit.side)
    solution.mode.slip[row - n] = preferred->slip[row - n];
}

// Limits that all admissible forces of the mode lie on.
void ContactSolver::Workspace::listDegenerate(const ContactProblem &problem, const ContactMode *preferred) {
  solution.degenerate.clear();
  const std::vector<double> &metric = solver.metric();
  for (std::size_t k = 0; k < set.limits().size(); ++k) {
    const ForceLimit limit = set.limits()[k];
    const int j = limit.row - problem.normalCount;
    const double slack =
        limit.side == 0 ? solution.forces[limit.row] : problem.limit(j, solution.forces.data()) - limit.side * solution.forces[limit.row];
    if (slack * metric[limit.row] > zero)
      continue;
    if (!solution.redundant || !set.canLeave(problem, static_cast<int>(k), 1e-7))
      markDegenerate(problem, preferred, limit);
  }
}

void ContactSolver::Workspace::count(const PlanarFrictionSolution &found) {
  ++statistics.solves;
  statistics.previousModeKept += solver.path() == PlanarFrictionSolver::Path::Previous ? 1 : 0;
  statistics.enumerated += solver.path() == PlanarFrictionSolver::Path::Enumeration ? 1 : 0;
  statistics.activeSet += solver.path() == PlanarFrictionSolver::Path::ActiveSet ? 1 : 0;
  statistics.pivoted += solver.path() == PlanarFrictionSolver::Path::Pivoting ? 1 : 0;
  statistics.pivots += solver.pivots();
  if (hasSolution(found))
    statistics.worstViolation = std::max(statistics.worstViolation, found.violation);
}

ContactSolver::ContactSolver() : ContactSolver(Settings{}) {}
ContactSolver::ContactSolver(const Settings &settings) : work_(std::make_unique<Workspace>()) { work_->settings = settings; }
ContactSolver::~ContactSolver() = default;
ContactSolver::ContactSolver(ContactSolver &&) noexcept = default;
ContactSolver &ContactSolver::operator=(ContactSolver &&) noexcept = default;

const ContactSolution &ContactSolver::solve(const ContactProblem &problem, const ContactMode *previous) {
  Workspace &w = *work_;
  ContactSolution &solution = w.solution;
  w.pose(problem);
  const PlanarFrictionSolution &found = w.solver.solve(w.translate(previous), w.settings.feasibility);
  w.count(found);
  w.zero = w.settings.degeneracy * found.scale;
  solution.forces = found.force;
  solution.accelerations = found.acceleration;
  solution.violation = found.violation;
  solution.redundant = false;
  solution.forced = -1;
  solution.saturated.clear();
  solution.degenerate.clear();
  switch (found.status) {
  case PlanarFrictionSolution::Status::None:
    solution.status = ContactStatus::Inconsistent;
    break;
  case PlanarFrictionSolution::Status::Unsettled:
    solution.status = ContactStatus::Unsettled;
    break;
  case PlanarFrictionSolution::Status::Several:
    solution.status = ContactStatus::Indeterminate;
    break;
  case PlanarFrictionSolution::Status::Solved:
    solution.status = ContactStatus::Solved;
    break;
  }
  w.labelMode(problem, previous);
  if (!hasSolution(found)) {
    solution.forced = w.findForced(problem);
    return solution;
  }
  w.settleForces(problem);
  w.listDegenerate(problem, previous);
  return solution;
}

const ContactSolution &ContactSolver::resolve(const ContactProblem &problem, const ContactSolution &solution, const ContactRates &rates,
                                              const ContactMode *previous) {
  Workspace &w = *work_;
  w.resolved = solution;
  ++w.statistics.resolved;
  w.next.decide(problem, rates, previous, w.settings, w.resolved);
  return w.resolved;
}

const std::vector<double> &ContactSolver::forceRates() const { return work_->next.forceRates(); }

const ContactSolver::Statistics &ContactSolver::statistics() const { return work_->statistics; }

}  // namespace tf::runtime
