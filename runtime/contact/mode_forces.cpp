#include "runtime/contact/mode_forces.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace tf::runtime {

namespace {

// Inequalities hold to this, relative to the force scale, where a representative is chosen: events are located to rounding, not exactly.
constexpr double feasibility = 1e-9;
// And to this where the set has just become empty: dependent equations leave a residual there, and what follows is decided with such
// forces.
constexpr double coarseFeasibility = 1e-7;
// Redundant rows contradict one another by rounding, relative to the force scale; where they do by more, they no longer depend on each
// other. Well above what the contact solver accepts, so that the mode is not chosen again.
constexpr double contradiction = 1e-9;

// Whether a slip may press its contact in: without friction, and in redundant rows, it does not.
bool slipsWithFriction(const ContactProblem &problem, const ContactMode &mode) {
  for (int j = 0; j < problem.tangentCount; ++j)
    if (problem.owner[j] >= 0 && mode.closed[problem.owner[j]] != 0 && mode.slip[j] != 0 && problem.friction[j] > 0)
      return true;
  return false;
}

// Whether some slip has two components, so that its friction turns with it.
bool slipsTurn(const ContactProblem &problem) {
  for (int j = 0; j < problem.tangentCount; ++j)
    if (problem.partner[j] > j && problem.slipSign[j] != 0)
      return true;
  return false;
}

}  // namespace

struct ModeForces::Workspace {
  std::unique_ptr<ForceSet> set = std::make_unique<ForceSet>();
  bool redundant = false;
  const ContactProblem *problem = nullptr;  // of the last evaluation
  std::vector<ModeMargin> margins;
  std::vector<double> values;
  bool isCurrent = true;           // `values` are those of the last evaluation
  double allowed = contradiction;  // between redundant rows
  bool mayPress = false;
  PressingMargin pressing;
  bool isTaken = false;  // the forces are from elsewhere, with
  double takenDeterminant = 1;

  void beginPressing(const ContactProblem &at) {
    pressing.end = slipsTurn(at) ? PressingMargin::before : PressingMargin::behind;
    if (!redundant)
      set->factor().inverseDeterminant(pressing.inverseDeterminant);
    pressing.scale = 0;
    for (const double force : set->forces())
      pressing.scale = std::max(pressing.scale, std::abs(force));
  }
  void listMargins() {
    margins.clear();
    const bool conic = redundant && set->isConic();
    if (conic && !set->isInside())
      margins.push_back({{ModeMargin::commonSlack, 0}, false});
    for (std::size_t k = 0; conic && set->isInside() && k < set->limits().size(); ++k)
      margins.push_back({set->limits()[k], false});
    for (std::size_t k = 0; !conic && k < set->limits().size(); ++k)
      margins.push_back({set->limits()[k], redundant && set->saturated(static_cast<int>(k)) >= 0});
    if (redundant && !conic && set->mayContradict())
      margins.push_back({{ModeMargin::contradiction, 0}, false});
    if (mayPress)
      margins.push_back({{ModeMargin::pressing, 0}, false});
    values.resize(margins.size());
  }
  // What redundant rows have instead of a determinant: the ratio of their largest load to all normal forces passes through zero, too, where
  // these grow beyond all bounds. 1 where they are no more than the load.
  [[nodiscard]] double loadOverForces() const {
    constexpr double large = 10;
    double sum = 0;
    for (int i = 0; i < problem->normalCount; ++i)
      sum += set->forces()[i];
    const double load = set->largestLoad();
    return sum > load || sum < -large * load ? load / sum : 1;
  }
  [[nodiscard]] double relativeDeterminant() const {
    if (redundant)
      return loadOverForces();
    return isTaken ? takenDeterminant : set->factor().determinantTimes(pressing.inverseDeterminant);
  }
  // Margins are computed when they are read.
  void setProblem(const ContactProblem &at) {
    problem = &at;
    isCurrent = false;
  }
  [[nodiscard]] double value(int k) {
    const ModeMargin &margin = margins[k];
    switch (margin.limit.row) {
    case ModeMargin::commonSlack:
      return set->commonSlack();
    case ModeMargin::contradiction:
      return set->forceScale() * (1 - set->contradiction() / allowed);
    case ModeMargin::pressing:
      return pressing.value(relativeDeterminant());
    default:
      break;
    }
    return margin.multiplier ? set->multiplier(k) : set->slack(*problem, k);
  }
};

ModeForces::ModeForces() : work_(std::make_unique<Workspace>()) {}
ModeForces::~ModeForces() = default;
ModeForces::ModeForces(ModeForces &&) noexcept = default;
ModeForces &ModeForces::operator=(ModeForces &&) noexcept = default;

bool ModeForces::start(const ContactProblem &problem, const ContactMode &mode, std::unique_ptr<ForceSet> *found,
                       const std::vector<double> *known) {
  Workspace &w = *work_;
  w.isTaken = false;
  if (found != nullptr && (*found)->hasMode(problem, mode)) {
    w.set->forget();
    w.set.swap(*found);
    w.set->move(problem);
    w.redundant = w.set->isSingular();
  } else {
    w.set->setMode(problem, mode);
    w.redundant = w.set->singular(problem);
  }
  bool valid = true;
  if (w.redundant) {
    valid = w.set->hasLeastNorm(feasibility) || w.set->solveLeastNorm(problem, feasibility) == LeastNorm::Status::Solved ||
            w.set->solveLeastNorm(problem, coarseFeasibility) == LeastNorm::Status::Solved ||
            w.set->solveNearlyDependent(problem, known, feasibility);
    w.redundant = w.set->isSingular();
  } else {
    valid = w.set->solveRegular(problem);
  }
  w.allowed = contradiction;
  acceptContradiction();
  w.mayPress = valid && slipsWithFriction(problem, mode) && (!w.redundant || slipsTurn(problem));
  if (w.mayPress)
    w.beginPressing(problem);
  w.listMargins();
  w.setProblem(problem);
  return valid;
}

void ModeForces::acceptContradiction() {
  constexpr double clearly = 10;
  Workspace &w = *work_;
  if (w.redundant && w.set->mayContradict())
    w.allowed = std::max(w.allowed, clearly * w.set->contradiction());
}

void ModeForces::take(const ContactProblem &problem, const std::vector<double> &forces, const std::vector<double> &rest,
                      const std::vector<double> &shares, double relativeDeterminant) {
  Workspace &w = *work_;
  w.set->take(problem, forces, rest, shares);
  w.isTaken = true;
  w.takenDeterminant = relativeDeterminant;
  w.setProblem(problem);
}

bool ModeForces::listEquations(std::vector<int> &rows, std::vector<ForceLimit> &saturated) const {
  return work_->set->listEquations(rows, saturated);
}

bool ModeForces::evaluate(const ContactProblem &problem) {
  Workspace &w = *work_;
  w.isTaken = false;
  const bool valid = w.redundant ? w.set->solveActive(problem) : w.set->solveRegular(problem);
  if (valid)
    w.setProblem(problem);
  return valid;
}

std::span<const double> ModeForces::forces() const { return work_->set->forces(); }
std::span<const double> ModeForces::accelerations() const { return work_->set->accelerations(); }
bool ModeForces::redundant() const { return work_->redundant; }
bool ModeForces::sharesMove() const { return work_->redundant && work_->set->sharesMove(*work_->problem); }
std::span<const ModeMargin> ModeForces::margins() const { return work_->margins; }
std::span<const double> ModeForces::marginValues() const {
  Workspace &w = *work_;
  for (std::size_t k = 0; !w.isCurrent && k < w.margins.size(); ++k)
    w.values[k] = w.value(static_cast<int>(k));
  w.isCurrent = true;
  return w.values;
}

bool ModeForces::mayPress() const { return work_->mayPress; }
const PressingMargin &ModeForces::pressing() const { return work_->pressing; }

MarginOutcome ModeForces::cross(int margin) {
  Workspace &w = *work_;
  if (const int row = w.margins[margin].limit.row; !w.redundant || row == ModeMargin::contradiction || row == ModeMargin::pressing)
    return MarginOutcome::ModeEnds;
  bool exists = true;
  if (w.set->isConic()) {
    if (!w.set->isInside() || w.set->confine(*w.problem, feasibility) != LeastNorm::Status::Solved)
      return MarginOutcome::ModeEnds;
  } else if (w.margins[margin].multiplier) {
    exists = w.set->release(margin);
  } else {
    exists = w.set->activate(margin) != LeastNorm::Status::Empty;
  }
  // The search for forces that are none has released other limits.
  w.listMargins();
  w.setProblem(*w.problem);
  return exists ? MarginOutcome::Rechosen : MarginOutcome::ModeEnds;
}

bool ModeForces::sharesAreSmooth() const { return work_->set->sharesAreSmooth(); }
std::span<const double> ModeForces::shareMultipliers() const { return work_->set->shareMultipliers(*work_->problem); }

void ModeForces::forceRates(std::span<const double> accelerationRate, std::span<const double> limitRate, std::span<double> forceRate,
                            const ShareRates *shares) const {
  Workspace &w = *work_;
  if (w.redundant)
    w.set->leastNormRates(*w.problem, accelerationRate.data(), limitRate.data(), shares, forceRate.data());
  else
    w.set->forceRates(*w.problem, accelerationRate.data(), limitRate.data(), forceRate.data());
}

}  // namespace tf::runtime
