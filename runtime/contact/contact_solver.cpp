#include "runtime/contact/contact_solver.h"

#include "runtime/contact/cone_friction.h"
#include "runtime/contact/force_set.h"
#include "runtime/contact/frame_turns.h"
#include "runtime/contact/next_derivative.h"
#include "runtime/contact/planar_friction.h"
#include "runtime/contact/single_contact.h"

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
  ConeFrictionSolver cone;
  PlanarFrictionMode previous;
  ContactProblem aligned;  // in which pairs of rows that begin to slip lie along their slip
  ContactRates alignedRates;
  std::vector<double> metric, forcesFound, accelerationsFound;
  std::vector<int> reached;  // limits that the forces lie on
  std::unique_ptr<ForceSet> set = std::make_unique<ForceSet>();
  NextDerivative next;
  ContactSolution solution, resolved;
  ContactMode kept;    // workspace of keepsRedundant
  double zero = 0;     // what counts as zero, in the metric of D
  bool conic = false;  // the solution is that of `cone`

  void pose(const ContactProblem &problem, PlanarFrictionProblem &p) const;
  void begin(const std::vector<double> &force, const std::vector<double> &acceleration, double violation, double scale);
  void solvePlanar(const ContactProblem &problem, const ContactMode *preferred);
  void solveConic(const ContactProblem &problem, const ContactMode *preferred, const double *guess);
  void finish(const ContactProblem &problem, const ContactMode *preferred);
  void labelPair(const ContactProblem &problem, const ContactMode *preferred, int j);
  void align(const ContactProblem &problem);
  void turnForces(double sense);
  void alignDegenerate(const ContactProblem &problem, const ContactRates &rates);
  void readDegenerate(const ContactProblem &problem);
  const PlanarFrictionMode *translate(const ContactMode *mode);
  void solveUnsettled(const ContactProblem &problem, const ContactMode *preferred);
  int findForced(const ContactProblem &problem);
  void labelMode(const ContactProblem &problem, const ContactMode *preferred);
  double certificate();
  bool takeForces(double accepted);
  bool keepsRedundant(const ContactProblem &problem, const ContactMode &before);
  bool settleForces(const ContactProblem &problem);
  [[nodiscard]] bool sticks(const ContactProblem &problem, int j) const;
  bool freeOverloaded(const ContactProblem &problem);
  bool startSlow(const ContactProblem &problem);
  void listDegenerate(const ContactProblem &problem, const ContactMode *preferred);
  void markDegenerate(const ContactProblem &problem, const ContactMode *preferred, const ForceLimit &limit);
  void count(const PlanarFrictionSolution &found);
};

void ContactSolver::Workspace::pose(const ContactProblem &problem, PlanarFrictionProblem &p) const {
  const int n = problem.normalCount, m = problem.tangentCount;
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
      pose(problem, solver.problem());
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
  ContactMode &mode = solution.mode;
  mode.resize(n, problem.tangentCount);
  for (int i = 0; i < n; ++i)
    mode.closed[i] = solution.forces[i] * metric[i] > zero || solution.accelerations[i] <= zero * metric[i] ? 1 : 0;
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.isDisk(j)) {
      labelPair(problem, preferred, j++);
      continue;
    }
    const double acceleration = solution.accelerations[n + j] / metric[n + j];
    const int start = acceleration > zero ? 1 : acceleration < -zero ? -1 : 0;
    int slip = problem.slipSign[j] != 0 ? problem.slipSign[j] : start;
    if (slip == 0 && withoutFriction(problem, j))
      slip = preferred != nullptr && preferred->slip[j] != 0 ? preferred->slip[j] : 1;
    mode.slip[j] = static_cast<std::int8_t>(slip);
  }
}

// A slip of two components that is zero starts along its acceleration.
void ContactSolver::Workspace::labelPair(const ContactProblem &problem, const ContactMode *preferred, int j) {
  const int row = problem.normalCount + j;
  ContactMode &mode = solution.mode;
  const double first = solution.accelerations[row], second = solution.accelerations[row + 1], length = std::hypot(first, second);
  const bool starts = length > zero * metric[row];
  mode.slip[j] = mode.slip[j + 1] = starts || withoutFriction(problem, j) ? 1 : 0;
  const bool same = !starts && preferred != nullptr && preferred->slip[j] != 0;
  mode.direction[j] = starts ? first / length : same ? preferred->direction[j] : 1;
  mode.direction[j + 1] = starts ? second / length : same ? preferred->direction[j + 1] : 0;
}

// The problem with the pairs that begin to slip in their direction, as those that slip already are.
void ContactSolver::Workspace::align(const ContactProblem &problem) {
  aligned = problem;
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (!problem.isDisk(j) || solution.mode.slip[j] == 0)
      continue;
    aligned.turnPair(j, solution.mode.direction[j], solution.mode.direction[j + 1]);
    aligned.slipSign[j] = aligned.slipSign[j + 1] = 1;
    aligned.friction[j + 1] = aligned.bound[j + 1] = 0;
  }
}

// Forces and accelerations from the problem's frames to the aligned ones (sense 1) or back (−1).
void ContactSolver::Workspace::turnForces(double sense) {
  for (int j = 0; j + 1 < aligned.tangentCount; ++j) {
    if (aligned.partner[j] <= j || aligned.slipSign[j] == 0 || (solution.mode.direction[j] == 0 && solution.mode.direction[j + 1] == 0))
      continue;
    const int row = aligned.normalCount + j;
    for (std::vector<double> *values : {&solution.forces, &solution.accelerations})
      turnVector((*values)[row], (*values)[row + 1], solution.mode.direction[j], sense * solution.mode.direction[j + 1]);
  }
}

// Of the solution, in the frames of the problem.
double ContactSolver::Workspace::certificate() {
  return conic ? cone.certificate(solution.forces, solution.accelerations) : solver.certificate(solution.forces, solution.accelerations);
}

// The forces of the set, in the frames of the aligned problem, become those of the solution, unless they violate its conditions by more.
bool ContactSolver::Workspace::takeForces(double accepted) {
  forcesFound = solution.forces;
  accelerationsFound = solution.accelerations;
  solution.forces = set->forces();
  solution.accelerations = set->accelerations();
  if (conic)
    turnForces(-1);
  const double violation = certificate();
  if (conic)
    turnForces(1);
  if (violation > accepted) {
    solution.forces = forcesFound;
    solution.accelerations = accelerationsFound;
    return false;
  }
  solution.violation = violation;
  return true;
}

// Where several motions are consistent the previous mode goes on. One of redundant contacts holds as long as any of its forces do, which
// the solver, that has tried their least-norm force only, does not know: it is tried here, with contacts that have closed since as the
// solution has them. True: it is the solution's mode now.
bool ContactSolver::Workspace::keepsRedundant(const ContactProblem &problem, const ContactMode &before) {
  kept = solution.mode;
  bool differs = false;
  for (std::size_t i = 0; i < kept.closed.size(); ++i)
    if (before.closed[i] != 0 && kept.closed[i] == 0) {
      kept.closed[i] = 1;
      differs = true;
    }
  for (int j = 0; j < problem.tangentCount; ++j) {
    const int owner = problem.owner[j];
    if (problem.slipSign[j] != 0 || before.slip[j] != 0 || kept.slip[j] == 0 || (owner >= 0 && before.closed[owner] == 0) ||
        withoutFriction(problem, j))
      continue;
    kept.slip[j] = 0;
    differs = true;
  }
  // At the border of indeterminacy a sliding contact makes the equations singular, although it is not redundant.
  constexpr double indeterminate = 1e-3;
  const auto isIndeterminate = [&](int i) { return slidingResponse(problem, i) <= indeterminate * problem.delassus(i, i); };
  for (int i = 0; differs && i < problem.normalCount; ++i)
    differs = kept.closed[i] == 0 || !isIndeterminate(i);
  if (!differs)
    return false;
  std::swap(solution.mode, kept);
  if (conic)
    align(problem);
  const ContactProblem &framed = conic ? aligned : problem;
  set->setMode(framed, solution.mode);
  const double found = solution.violation <= settings.nearby ? solution.violation : 0;
  if (set->singular(framed) && set->solveLeastNorm(framed, settings.degeneracy) == LeastNorm::Status::Solved &&
      takeForces(std::max(10 * settings.degeneracy, found))) {
    if (conic)
      turnForces(-1);
    return true;
  }
  std::swap(solution.mode, kept);
  return false;
}

// Redundant contacts share their load so that ‖λ‖ is least; the others have one force only. False: the mode has no admissible forces.
bool ContactSolver::Workspace::settleForces(const ContactProblem &problem) {
  set->setMode(problem, solution.mode);
  solution.redundant = set->singular(problem);
  solution.saturated.clear();
  if (!solution.redundant)
    return true;
  ++statistics.redundant;
  if (set->solveLeastNorm(problem, settings.degeneracy) != LeastNorm::Status::Solved &&
      !set->solveNearlyDependent(problem, &solution.forces, settings.degeneracy))
    return false;
  solution.redundant = set->isSingular();
  if (!solution.redundant)
    return true;
  // Where shares of the load move slipping contacts, the least-norm share may contradict rows that are not active: then the one found
  // stays.
  if (!takeForces(std::max(10 * settings.degeneracy, solution.violation)))
    return true;
  for (std::size_t k = 0; k < set->limits().size(); ++k)
    if (set->saturated(static_cast<int>(k)) >= 0)
      solution.saturated.push_back(set->limits()[k]);
  return true;
}

// One component that friction holds.
bool ContactSolver::Workspace::sticks(const ContactProblem &problem, int j) const {
  const int owner = problem.owner[j];
  return (owner < 0 || solution.mode.closed[owner] != 0) && problem.slipSign[j] == 0 && problem.partner[j] < 0 &&
         solution.mode.slip[j] == 0 && !withoutFriction(problem, j);
}

// A mode without admissible forces, although its accelerations are those of the solution: to hold rows whose acceleration is about zero
// takes forces beyond their limits by some such size. Contacts that pull open, and slips whose friction exceeds its limit begin. False:
// there are none.
bool ContactSolver::Workspace::freeOverloaded(const ContactProblem &problem) {
  constexpr double largest = 1e-6;
  double tolerance = settings.degeneracy;
  while (tolerance < largest && set->solveLeastNorm(problem, tolerance) != LeastNorm::Status::Solved)
    tolerance *= 10;
  const std::vector<double> &forces = set->forces();
  bool isAny = false;
  for (std::size_t i = 0; i < solution.mode.closed.size(); ++i)
    if (solution.mode.closed[i] != 0 && forces[i] * metric[i] < -zero) {
      solution.mode.closed[i] = 0;
      isAny = true;
    }
  for (int j = 0; j < problem.tangentCount; ++j) {
    const int row = problem.normalCount + j;
    const double excess = std::abs(forces[row]) - problem.limit(j, forces.data());
    if (!sticks(problem, j) || !(excess * metric[row] > zero))
      continue;
    solution.mode.slip[j] = forces[row] > 0 ? -1 : 1;
    isAny = true;
  }
  return isAny;
}

// As well: friction at its limit whose slip begins so slowly that it counts as a stick may hold none. These slips begin. False: there are
// none.
bool ContactSolver::Workspace::startSlow(const ContactProblem &problem) {
  constexpr double visible = 1e-3;  // of what counts as zero
  bool started = false;
  for (int j = 0; j < problem.tangentCount; ++j) {
    const int row = problem.normalCount + j;
    const double acceleration = solution.accelerations[row] / metric[row], force = solution.forces[row];
    const bool isAtLimit = (problem.limit(j, solution.forces.data()) - std::abs(force)) * metric[row] <= zero;
    if (!sticks(problem, j) || !isAtLimit || std::abs(acceleration) <= visible * zero || acceleration * force >= 0)
      continue;
    solution.mode.slip[j] = acceleration > 0 ? 1 : -1;
    started = true;
  }
  return started;
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
  reached.clear();
  for (std::size_t k = 0; k < set->limits().size(); ++k) {
    const ForceLimit &limit = set->limits()[k];
    const int j = limit.row - problem.normalCount;
    double slack = solution.forces[limit.row];
    if (limit.side == ForceLimit::disk)
      slack = problem.limit(j, solution.forces.data()) - std::hypot(slack, solution.forces[limit.row + 1]);
    else if (limit.side != 0)
      slack = problem.limit(j, solution.forces.data()) - limit.side * slack;
    if (!(slack * metric[limit.row] > zero))
      reached.push_back(static_cast<int>(k));
  }
  if (solution.redundant)
    set->keepFixed(problem, reached, 1e-7);
  for (const int k : reached)
    markDegenerate(problem, preferred, set->limits()[k]);
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

void ContactSolver::Workspace::begin(const std::vector<double> &force, const std::vector<double> &acceleration, double violation,
                                     double scale) {
  zero = settings.degeneracy * scale;
  solution.scale = scale;
  solution.forces = force;
  solution.accelerations = acceleration;
  solution.violation = violation;
  solution.redundant = false;
  solution.forced = -1;
  solution.saturated.clear();
  solution.degenerate.clear();
}

void ContactSolver::Workspace::finish(const ContactProblem &problem, const ContactMode *preferred) {
  bool mayChange = true;
  while (mayChange && !settleForces(problem))
    mayChange = freeOverloaded(problem) || startSlow(problem);
  if (settings.listsDegenerate)
    listDegenerate(problem, preferred);
}

// Where pivoting ends in a ray and there are too many modes to try: Newton's method. Where that finds no forces either, there are none for
// all that can be said; the frictional impulse that follows proves it, or changes nothing.
void ContactSolver::Workspace::solveUnsettled(const ContactProblem &problem, const ContactMode *preferred) {
  pose(problem, cone.problem());
  cone.problem().partner.assign(problem.tangentCount, -1);
  const ConeFrictionSolution &found = cone.solve(nullptr, settings.feasibility);
  statistics.newtonIterations += cone.iterations();
  metric = cone.metric();
  begin(found.force, found.acceleration, found.violation, found.scale);
  labelMode(problem, preferred);
  conic = false;
  solution.status = found.solved ? ContactStatus::Solved : ContactStatus::Inconsistent;
  if (found.solved) {
    statistics.worstViolation = std::max(statistics.worstViolation, found.violation);
    finish(problem, preferred);
  } else {
    solution.forced = findForced(problem);
  }
}

void ContactSolver::Workspace::solvePlanar(const ContactProblem &problem, const ContactMode *preferred) {
  pose(problem, solver.problem());
  const PlanarFrictionSolution &found =
      solver.solve(translate(preferred), settings.feasibility, PlanarFrictionSolver::Wanted::Accelerations);
  count(found);
  if (found.status == PlanarFrictionSolution::Status::Unsettled)
    return solveUnsettled(problem, preferred);
  metric = solver.metric();
  begin(found.force, found.acceleration, found.violation, found.scale);
  switch (found.status) {
  case PlanarFrictionSolution::Status::None:
    solution.status = ContactStatus::Inconsistent;
    break;
  case PlanarFrictionSolution::Status::Unsettled:
    break;
  case PlanarFrictionSolution::Status::Several:
    solution.status = ContactStatus::Indeterminate;
    break;
  case PlanarFrictionSolution::Status::Solved:
    solution.status = ContactStatus::Solved;
    break;
  }
  labelMode(problem, preferred);
  for (int i = 0; solution.status == ContactStatus::Indeterminate && solution.forced < 0 && i < problem.normalCount; ++i)
    if (slidingResponse(problem, i) < 0)
      solution.forced = i;
  if (!hasSolution(found)) {
    solution.forced = findForced(problem);
    return;
  }
  conic = false;
  if (preferred != nullptr && keepsRedundant(problem, *preferred))
    solution.status = ContactStatus::Solved;
  finish(problem, preferred);
}

void ContactSolver::Workspace::solveConic(const ContactProblem &problem, const ContactMode *preferred, const double *guess) {
  pose(problem, cone.problem());
  cone.problem().partner.assign(problem.tangentCount, -1);
  for (int j = 0; j < problem.tangentCount; ++j)
    if (problem.partner[j] >= 0 && problem.slipSign[j] == 0)
      cone.problem().partner[j] = problem.partner[j];
  const ConeFrictionSolution &found = cone.solve(guess, settings.feasibility);
  ++statistics.solves;
  ++statistics.conic;
  statistics.newtonIterations += cone.iterations();
  metric = cone.metric();
  begin(found.force, found.acceleration, found.violation, found.scale);
  labelMode(problem, preferred);
  // Where solutions are about to end, two of them meet, and Newton's method comes no nearer; what is zero is told as coarsely then. Forces
  // that all methods leave away from a solution have none; the frictional impulse that follows proves it, or changes nothing.
  conic = true;
  const bool isKept = preferred != nullptr && keepsRedundant(problem, *preferred);
  if (!isKept && !found.solved && found.violation > settings.nearby) {
    solution.status = ContactStatus::Inconsistent;
    solution.forced = findForced(problem);
    return;
  }
  statistics.worstViolation = std::max(statistics.worstViolation, solution.violation);
  solution.status = ContactStatus::Solved;
  align(problem);
  turnForces(1);
  finish(aligned, preferred);
  turnForces(-1);
}

// For the next derivative: pairs on the border of their disk in the direction of their force, in which alone they can leave stick.
void ContactSolver::Workspace::alignDegenerate(const ContactProblem &problem, const ContactRates &rates) {
  const int n = problem.normalCount;
  solution.forces = resolved.forces;
  solution.accelerations = resolved.accelerations;
  solution.mode = resolved.mode;
  for (const int row : resolved.degenerate) {
    const int j = row - n;
    if (j < 0 || !problem.isDisk(j))
      continue;
    const double first = resolved.forces[row], second = resolved.forces[row + 1], length = std::hypot(first, second);
    if (length * metric[row] <= zero)
      continue;
    solution.mode.slip[j] = solution.mode.slip[j + 1] = 1;
    solution.mode.direction[j] = first / length;
    solution.mode.direction[j + 1] = second / length;
  }
  align(problem);
  turnForces(1);
  alignedRates = rates;
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.partner[j] < j && aligned.slipSign[j] != 0 && problem.partner[j] >= 0)
      alignedRates.frictionRate[j] = alignedRates.boundRate[j] = 0;
    if (!problem.isDisk(j) || aligned.slipSign[j] == 0)
      continue;
    std::vector<double> &rate = alignedRates.accelerationRate;
    turnVector(rate[n + j], rate[n + j + 1], solution.mode.direction[j], solution.mode.direction[j + 1]);
    if (resolved.mode.slip[j] != 0)
      continue;
    aligned.slipSign[j] = aligned.slipSign[j + 1] = 0;
    aligned.partner[j] = aligned.partner[j + 1] = -1;
    aligned.friction[j + 1] = problem.friction[j + 1];
    aligned.bound[j + 1] = problem.bound[j + 1];
    alignedRates.frictionRate[j + 1] = rates.frictionRate[j + 1];
    alignedRates.boundRate[j + 1] = rates.boundRate[j + 1];
  }
}

// The mode that was decided in the aligned frames: a slip that starts has the direction against its force.
void ContactSolver::Workspace::readDegenerate(const ContactProblem &problem) {
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (!problem.isDisk(j) || aligned.partner[j] >= 0)
      continue;
    const int slip = resolved.mode.slip[j];
    resolved.mode.direction[j] = slip * solution.mode.direction[j];
    resolved.mode.direction[j + 1] = slip * solution.mode.direction[j + 1];
    resolved.mode.slip[j] = resolved.mode.slip[j + 1] = slip != 0 ? 1 : 0;
  }
}

const ContactSolution &ContactSolver::solve(const ContactProblem &problem, const ContactMode *previous, const double *guess) {
  Workspace &w = *work_;
  w.set->forget();
  if (solveSingleContact(problem, w.settings.degeneracy, w.solution) && w.solution.violation <= w.settings.feasibility) {
    ++w.statistics.solves;
    ++w.statistics.direct;
    w.statistics.worstViolation = std::max(w.statistics.worstViolation, w.solution.violation);
  } else if (problem.hasDisks()) {
    w.solveConic(problem, previous, guess);
  } else {
    w.solvePlanar(problem, previous);
  }
  return w.solution;
}

const ContactSolution &ContactSolver::resolve(const ContactProblem &problem, const ContactSolution &solution, const ContactRates &rates,
                                              const ContactMode *previous) {
  Workspace &w = *work_;
  w.resolved = solution;
  ++w.statistics.resolved;
  if (!problem.hasDisks()) {
    w.next.decide(problem, rates, previous, w.settings, w.resolved);
    return w.resolved;
  }
  const std::vector<double> forces = w.resolved.forces;
  w.alignDegenerate(problem, rates);
  w.resolved.forces = w.solution.forces;
  w.next.decide(w.aligned, w.alignedRates, previous, w.settings, w.resolved);
  w.resolved.forces = forces;
  w.readDegenerate(problem);
  return w.resolved;
}

const std::vector<double> &ContactSolver::forceRates() const { return work_->next.forceRates(); }

std::unique_ptr<ForceSet> &ContactSolver::forceSet() { return work_->set; }

const ContactSolver::Statistics &ContactSolver::statistics() const { return work_->statistics; }

}  // namespace tf::runtime
