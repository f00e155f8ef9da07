#include "runtime/integrate/mode_dynamics.h"

#include "runtime/contact/jam.h"
#include "runtime/contact/time_speed.h"
#include "runtime/integrate/all_finite.h"
#include "runtime/integrate/byte_flags.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

ModeDynamics::ModeDynamics(ModelEvaluation &evaluation)
    : at_(evaluation), slips_(evaluation), projection_(evaluation, rows_, problem_, [this] { completeRows(); }),
      projected_(static_cast<std::size_t>(evaluation.model().nq) + evaluation.model().nv), roles_(rolesOfTangents(evaluation.model())),
      isPaired_(evaluation.model().nt), mask_(evaluation.model().nc + evaluation.model().nf), slidingMask_(evaluation.model().ns),
      change_(evaluation.model().nv), constraintChange_(evaluation.model().nh), plus_(evaluation.stateSize()),
      minus_(evaluation.stateSize()), shifted_(evaluation.stateSize()) {
  const std::vector<int> pair = pairsOfTangents(evaluation.model());
  for (std::size_t j = 0; j < pair.size(); ++j)
    isPaired_[j] = pair[j] >= 0;
}

// A mode without rows and sliding step variables depends on nothing but its step variables, and may begin again as it is: only the scales
// of its guards are those of where it was begun first.
bool ModeDynamics::isPrepared(const Mode &mode) const {
  return preparedRevision_ == at_.parameterRevision() && rows_.count() == 0 && sliding_.empty() && mode == mode_ && mode.held == mode_.held;
}

// The rows and step variables of the mode; what they hold is not evaluated, but for that of rows which have been solved for (true). Frames
// turn with slips of two components, and step variables that slide are not known yet: there the rows are evaluated anew.
bool ModeDynamics::choose(const Mode &mode, double time, const double *state, const SolvedContacts *solved) {
  const tf_model &model = at_.model();
  preparedRevision_ = -1;
  isBegun_ = false;
  mode_ = mode;
  std::vector<int> &contacts = contacts_, &tangents = tangents_;
  contacts.clear();
  tangents.clear();
  std::copy(mode.closed.begin(), mode.closed.end(), mask_.begin());
  forEachSet(mode.closed.data(), model.nc, [&contacts](int i) { contacts.push_back(i); });
  at_.screen().hold(mode.closed.data());
  std::fill(mask_.begin() + model.nc, mask_.end(), std::uint8_t{1});
  forEachOther(mode.tangent.data(), model.nt, Tangent::None, [&tangents](int j) { tangents.push_back(j); });
  const bool isSolved = solved != nullptr && solved->system.hasRows(contacts, tangents);
  if (isSolved)
    system_ = solved->system;
  else
    system_.choose(model, contacts, tangents);
  contactMode_.resize(problem_.normalCount, problem_.tangentCount);
  std::fill(contactMode_.closed.begin(), contactMode_.closed.end(), std::uint8_t{1});
  limitsVary_ = false;
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    contactMode_.slip[j] = static_cast<std::int8_t>(mode.tangent[tangents[j]]);
    problem_.slipSign[j] = contactMode_.slip[j];
    const int owner = problem_.owner[j];
    limitsVary_ = limitsVary_ || owner < 0 || model.contacts[contacts[owner]].friction_varies != 0;
  }
  frictionMayPeak_ = std::any_of(model.frictions, model.frictions + model.nf, [&mode](const tf_friction &element) {
    return element.bound_by_velocity != 0 && mode.tangent[element.tangent_first] != Tangent::None;
  });
  slips_.choose(mode_, rows_, problem_, time, state);
  projection_.resize();
  nothingStops_.assign(tangents.size(), 0);
  rowChange_.resize(rows_.count());
  forceChange_.resize(rows_.count());
  limitChange_.resize(tangents.size());
  closedForce_.resize(contacts.size());
  closedRate_.clear();
  for (int i : contacts)
    closedRate_.push_back(at_.rate[i]);
  sliding_.clear();
  for (int j = 0; j < model.ns; ++j) {
    slidingMask_[j] = mode.switches[j] == Switch::Sliding;
    if (slidingMask_[j])
      sliding_.push_back(j);
    else
      at_.stepVariable[j] = mode.switches[j] == Switch::One ? 1 : 0;
  }
  slidingResidual_.assign(sliding_.size(), 0.0);
  slidingMatrix_.resize(static_cast<Eigen::Index>(sliding_.size()), static_cast<Eigen::Index>(sliding_.size()));
  for (int j : sliding_)
    at_.stepVariable[j] = std::clamp(at_.stepVariable[j], 0.01, 0.99);
  leastMargins_.clear();
  isFolded_ = isSmall_ = isLinked_ = false;
  projection_.use(nullptr, nullptr);
  return isSolved && slips_.empty() && sliding_.empty();
}

bool ModeDynamics::hold(const Mode &mode, double time, const double *state) {
  choose(mode, time, state);
  return prepare(time, state);
}

bool ModeDynamics::start(const Mode &mode, double time, const double *state, double *rate, const SolvedContacts *solved) {
  const tf_model &model = at_.model();
  std::fill(at_.normalForce.begin(), at_.normalForce.end(), 0.0);
  std::fill(at_.tangentForce.begin(), at_.tangentForce.end(), 0.0);
  if (isPrepared(mode)) {
    for (int j = 0; j < model.ns; ++j)
      at_.stepVariable[j] = mode.switches[j] == Switch::One ? 1 : 0;
    return evaluate(time, state, rate);
  }
  const bool isSolved = choose(mode, time, state, solved);
  settled_ = solved != nullptr ? solved->settled : nullptr;
  isComplete_ = true;
  isBegun_ = isSolved ? evaluateSolved(time, state, *solved, rate) : evaluate(time, state, rate);
  if (!isBegun_) {
    settled_ = nullptr;
    return false;
  }
  isFolded_ = model.nv <= RowSystem::narrow && sliding_.empty() && (rows_.count() == 0 || !forces_.redundant());
  if (isFolded_)
    folded_.choose(at_, rows_, problem_, contactMode_, forces_);
  isSmall_ = isFolded_ && folded_.isSmall();
  chooseLinked();
  projection_.use(isSmall_ ? &folded_ : nullptr, isLinked_ ? &linked_ : nullptr);
  buildGuards();
  settled_ = nullptr;
  preparedRevision_ = at_.parameterRevision();
  return true;
}

bool ModeDynamics::fail(EvaluationFailure failure) {
  failure_ = failure;
  return false;
}

bool ModeDynamics::failMass() {
  return fail(allFinite(at_.massMatrix) && allFinite(at_.constraintJacobian) ? EvaluationFailure::SingularMass
                                                                             : EvaluationFailure::NotFinite);
}

// The branch of a coefficient that a switch ends may be negative beyond it, where a step goes before the switch is found.
void ModeDynamics::watchFriction() {
  for (int j = 0; j < problem_.tangentCount; ++j)
    if ((problem_.owner[j] >= 0 ? problem_.friction[j] : problem_.bound[j]) < -negligibleFriction)
      metNegativeFriction_ = true;
}

void ModeDynamics::beginEvaluation(double time, const double *state) {
  ++evaluations_;
  failure_ = EvaluationFailure::None;
  at_.setPoint(time, state);
}

bool ModeDynamics::prepare(double time, const double *state) {
  beginEvaluation(time, state);
  if (!slips_.empty()) {
    at_.switching(ModelEvaluation::Slips);
    slips_.align(rows_);
  }
  if (!at_.dynamics())
    return failMass();
  isGathered_ = true;
  if (rows_.count() > 0) {
    at_.contactTerms(mask_.data());
    system_.gather(at_);
    hasRows_ = false;
    watchFriction();
  }
  return true;
}

// What the mode holds at zero depends on time or inputs that change.
bool ModeDynamics::rowsVary() const {
  return std::any_of(rows_.contacts().begin(), rows_.contacts().end(), [this](int contact) { return at_.gapVaries(contact); }) ||
         std::any_of(rows_.tangents().begin(), rows_.tangents().end(), [this](int row) { return at_.slipVaries(row); });
}

// By the rank of the rows that are zero in the mode, at the point of `prepare`.
bool ModeDynamics::leavesNoVelocity() {
  constexpr double independent = 1e-6;
  const tf_model &model = at_.model();
  std::vector<const double *> &held = heldRows_;
  held.clear();
  for (int row = 0; row < model.nh; ++row)
    if (!at_.mobility.hasVanished(row))
      held.push_back(at_.constraintJacobian.data() + static_cast<std::ptrdiff_t>(row) * model.nv);
  for (int i = 0; i < rows_.count(); ++i)
    if (i < rows_.normalCount() || contactMode_.slip[i - rows_.normalCount()] == 0)
      held.push_back(rows_.jacobian(i));
  const int size = static_cast<int>(held.size());
  heldFactor_.resize(size);
  for (int j = 0; j < size; ++j)
    for (int i = j; i < size; ++i)
      heldFactor_.entry(i, j) = dot(held[i], held[j], model.nv);
  return heldFactor_.factor(independent * independent) == model.nv;
}

bool ModeDynamics::isHeldAtRest(double time, const double *state, const double *rate, const double *scale) {
  constexpr double rounding = 1e-14;
  const tf_model &model = at_.model();
  const int velocities = model.nq, states = velocities + model.nv;
  for (int i = velocities; i < states; ++i)
    if (std::abs(state[i]) > rounding * scale[i])
      return false;
  for (int i = states; i < states + model.nz; ++i)
    if (std::abs(rate[i]) > rounding * scale[i])
      return false;
  int heldRows = model.nh + rows_.normalCount();
  for (const std::int8_t slip : contactMode_.slip)
    heldRows += slip == 0 ? 1 : 0;
  return heldRows >= model.nv && model.nv > 0 && sliding_.empty() && !at_.forcesVary() && !rowsVary() && prepare(time, state) &&
         leavesNoVelocity();
}

bool ModeDynamics::restsByItsRows(const double *state) {
  // Along an interpolant, whose rounding errors grow with the step.
  constexpr double rounding = 1e-12;
  const tf_model &model = at_.model();
  for (int i = model.nq; i < model.nq + model.nv; ++i)
    if (std::abs(state[i]) > rounding * at_.scales.nominal()[i])
      return false;
  return model.nh == 0 && model.nv > 0 && rows_.count() >= model.nv && !rowsVary() && holdsAll();
}

void ModeDynamics::keepEvaluation(double time, const double *state) {
  isProjected_ = false;
  correction_ = 0;
  at_.setPoint(time, state);
}

bool ModeDynamics::solveForces() {
  if (rows_.count() == 0) {
    at_.mobility.accelerate(at_.force.data(), at_.constraintBias.data(), at_.acceleration.data());
    return true;
  }
  if (isFolded_) {
    isComplete_ = false;
    return folded_.evaluate(at_, rows_, problem_, at_.acceleration.data()) || fail(EvaluationFailure::SingularContact);
  }
  if (!solveRows(at_.acceleration.data()))
    return fail(EvaluationFailure::SingularContact);
  rows_.accelerate(forces_.forces().data(), at_.acceleration.data());
  return true;
}

// All rows with D and φ, and their forces; `freeAcceleration` [nv] is the one without them.
bool ModeDynamics::solveRows(double *freeAcceleration) {
  completeRows();
  system_.setBias(at_, freeAcceleration);
  isComplete_ = true;
  return isBegun_ ? forces_.evaluate(problem_) : startForces(nullptr);
}

bool ModeDynamics::startForces(std::unique_ptr<ForceSet> *found) {
  if (settled_ == nullptr)
    return forces_.start(problem_, contactMode_, found);
  std::vector<double> bias = problem_.bias;
  const std::vector<double> known = system_.settle(*settled_, contactMode_);
  if (!forces_.start(problem_, contactMode_, found, &known))
    return false;
  if (!forces_.redundant())
    return true;
  // From the next evaluation on redundant rows contradict one another as they do without.
  problem_.bias.swap(bias);
  if (forces_.evaluate(problem_))
    forces_.acceptContradiction();
  problem_.bias.swap(bias);
  return forces_.evaluate(problem_);
}

// What folded forces leave out at the point of the last evaluation: W Jᵀ and D, and the forces as a function of them.
void ModeDynamics::completeRows() {
  if (!isGathered_) {
    at_.factoriseMass();
    rows_.gatherRows(at_);
  }
  isGathered_ = true;
  if (!hasRows_)
    system_.respond(at_);
  hasRows_ = true;
}

void ModeDynamics::complete() {
  completeRows();
  if (!isComplete_ && rows_.count() > 0)
    solveRows(change_.data());
}

void ModeDynamics::accelerationTerms(double *terms) {
  complete();
  const int nv = at_.model().nv;
  at_.mobility.accelerate(at_.force.data(), at_.constraintBias.data(), change_.data());
  for (int i = 0; i < nv; ++i)
    terms[i] = std::abs(change_[i]);
  std::vector<double> single(static_cast<std::size_t>(rows_.count()));
  for (int row = 0; row < rows_.count(); ++row) {
    single[row] = rowForces()[row];
    std::fill_n(change_.begin(), nv, 0.0);
    rows_.accelerate(single.data(), change_.data());
    for (int i = 0; i < nv; ++i)
      terms[i] += std::abs(change_[i]);
    single[row] = 0;
  }
}

void ModeDynamics::response(const double *forceChange, const double *constraintChange, const double *biasChange, const double *limitChange,
                            double *accelerationChange, const ShareRates *shares) {
  at_.mobility.accelerate(forceChange, constraintChange, accelerationChange);
  if (rows_.count() == 0)
    return;
  for (int i = 0; i < rows_.count(); ++i)
    rowChange_[i] = rows_.product(i, accelerationChange) + (biasChange != nullptr ? biasChange[i] : 0);
  if (limitChange != nullptr)
    std::copy_n(limitChange, limitChange_.size(), limitChange_.begin());
  else
    std::fill(limitChange_.begin(), limitChange_.end(), 0.0);
  forces_.forceRates(rowChange_, limitChange_, forceChange_, shares);
  rows_.accelerate(forceChange_.data(), accelerationChange);
}

bool ModeDynamics::evaluate(double time, const double *state, double *rate) {
  isProjected_ = false;
  correction_ = 0;
  // What fails there is found and named here.
  if ((isSmall_ && evaluateSmall(time, state, rate)) || (isLinked_ && evaluateLinked(time, state, rate)))
    return true;
  if (!prepare(time, state) || !solveForces())
    return false;
  if (!sliding_.empty() && !solveSliding())
    return false;
  return giveRate(rate);
}

// The begin of a mode whose rows have been solved for.
bool ModeDynamics::evaluateSolved(double time, const double *state, const SolvedContacts &solved, double *rate) {
  beginEvaluation(time, state);
  isProjected_ = false;
  correction_ = 0;
  isGathered_ = hasRows_ = true;
  watchFriction();
  if (!startForces(&solved.forces))
    return fail(EvaluationFailure::SingularContact);
  at_.acceleration = solved.freeAcceleration;
  rows_.accelerate(forces_.forces().data(), at_.acceleration.data());
  return giveRate(rate);
}

bool ModeDynamics::evaluateProjected(double time, double *state, double *rate, const double *scale) {
  if (!isSmall_ || rows_.count() == 0)
    return evaluate(time, state, rate);
  // Newton's method with rows of nearby: what it leaves of the velocities is the product of the correction and of the change of the rows,
  // which is small too.
  constexpr double converged = 1e-9;
  const double correction = projection_.project(time, state, scale, nothingStops_.data());
  if (!evaluate(time, state, rate))
    return false;
  correction_ = correction;
  isProjected_ = correction <= converged;
  std::copy_n(state, projected_.size(), projected_.begin());
  return true;
}

bool ModeDynamics::evaluateSmall(double time, const double *state, double *rate) {
  beginEvaluation(time, state);
  isGathered_ = hasRows_ = isComplete_ = false;
  if (rows_.count() > 0) {
    at_.contactForces(mask_.data());
    if (limitsVary_ || preparedRevision_ != at_.parameterRevision()) {
      rows_.gatherLimits(at_, problem_);
      watchFriction();
    }
  } else {
    at_.forces();
  }
  return folded_.evaluateSmall(at_, problem_, at_.acceleration.data()) && giveRate(rate);
}

// Slips of two components and step variables that slide are left to the dense equations.
void ModeDynamics::chooseLinked() {
  linkedFailures_ = 0;
  isLinked_ = !isFolded_ && sliding_.empty() && slips_.empty() && linked_.choose(at_, rows_, problem_, contactMode_, forces_);
}

// False: by this means it cannot be evaluated there, and in the end will not be until the mode begins again. Rows that the begin of a mode
// has found dependent may be so to rounding only behind its first projection.
bool ModeDynamics::evaluateLinked(double time, const double *state, double *rate) {
  beginEvaluation(time, state);
  isGathered_ = hasRows_ = isComplete_ = false;
  if (rows_.count() > 0) {
    at_.contactForces(mask_.data(), linked_.sample(at_));
    rows_.gatherLimits(at_, problem_);
    watchFriction();
  } else {
    at_.forces(linked_.sample(at_));
  }
  constexpr int mostFailures = 3;
  const bool good = linked_.evaluate(at_, rows_, problem_, at_.acceleration.data(), forces_) && giveRate(rate);
  isLinked_ = good || ++linkedFailures_ < mostFailures;
  return good;
}

// The latest forces into the model's arrays, with what follows from them.
void ModeDynamics::recordForces() {
  const auto forces = rowForces();
  const std::vector<int> &contacts = rows_.contacts();
  const std::size_t normals = contacts.size();
  for (std::size_t i = 0; i < normals; ++i)
    at_.normalForce[contacts[i]] = std::max(closedForce_[i] = forces[i], 0.0);
  rows_.spreadTangentForces(forces.data() + normals, at_.tangentForce.data());
  recordMargins();
}

// Out of the forces, accelerations and state derivatives.
bool ModeDynamics::giveRate(double *rate) {
  const tf_model &model = at_.model();
  if (rows_.count() > 0)
    recordForces();
  tauRate_ = numericalTimeRate(closedForce_, closedRate_, loadRatio_);
  double *rest = rate + model.nq + model.nv;
  rest[model.nz] = tauRate_;
  bool isFinite = copyFinite(at_.stateRate.data(), model.nz, rest) + tauRate_ * 0 == 0;
  if (isSmall_ && model.kinematics == nullptr) {
    isFinite = folded_.giveRates(at_, rate) && isFinite;
  } else {
    at_.kinematics(rate);
    isFinite = isFinite && copyFinite(at_.acceleration.data(), model.nv, rate + model.nq) == 0 && allFinite(rate, model.nq);
  }
  return isFinite || fail(EvaluationFailure::NotFinite);
}

void ModeDynamics::solveMultipliers() {
  const tf_model &model = at_.model();
  if (model.nh == 0)
    return;
  std::copy(at_.force.begin(), at_.force.end(), change_.begin());
  if (rows_.count() > 0)
    rows_.addForces(rowForces().data(), change_.data());
  at_.mobility.multipliers(change_.data(), at_.constraintBias.data(), at_.multiplier.data());
}

double ModeDynamics::normalForce(int contact) const {
  for (int i = 0; i < rows_.normalCount(); ++i)
    if (rows_.contacts()[i] == contact)
      return rowForces()[i];
  return 0;
}

double ModeDynamics::forceRounding() const {
  constexpr double rounding = 10 * std::numeric_limits<double>::epsilon();
  double turned = 0, largest = 0;
  for (int pair = 0; pair < slips_.count(); ++pair)
    turned = std::max(turned, std::min(1.0, rounding * slips_.scale(pair) / slips_.speed(pair)));
  if (turned > 0)
    for (const double force : rowForces())
      largest = std::max(largest, std::abs(force));
  return turned * largest;
}

int ModeDynamics::jammedContact(double pressing, double ratio) {
  complete();
  for (const Jam &jam : jammedNormals(problem_, contactMode_))
    if (jam.ratio <= ratio && !(closedForce_[jam.row] * jam.response <= pressing * jam.own * beginForce_))
      return rows_.contacts()[jam.row];
  if (constexpr double near = 1e-3; !isNearSharedPole(std::min(near, ratio)))
    return -1;
  // Of redundant contacts that jam one another each may be right alone.
  const auto normals = rowForces().first(rows_.normalCount());
  return rows_.contacts()[std::max_element(normals.begin(), normals.end()) - normals.begin()];
}

bool ModeDynamics::stop(double time, double *state, const double *scale) {
  // Beside the positions that the mode holds redundant rows contradict one another, and their forces are none that stop anything. A
  // projection knows of no friction of rows that slip.
  const auto sticks = [this](int row) { return mode_.tangent[row] == Tangent::Stick; };
  if (hasRedundantRows() && std::all_of(rows_.tangents().begin(), rows_.tangents().end(), sticks)) {
    keepEvaluation(time, state);
    project(time, state, scale);
    return true;
  }
  if (!evaluate(time, state, plus_.data()))
    return false;
  if (rows_.count() == 0)
    return true;
  complete();
  const tf_model &model = at_.model();
  const int normals = rows_.normalCount();
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (int i = 0; i < rows_.count(); ++i)
    rowChange_[i] = i < normals ? at_.gapRate[rows_.contacts()[i]] : rows_.tangentValue(at_.slip.data(), 1, i - normals);
  std::fill(limitChange_.begin(), limitChange_.end(), 0.0);
  forces_.forceRates(rowChange_, limitChange_, forceChange_);
  rows_.accelerate(forceChange_.data(), state + model.nq);
  return true;
}

void ModeDynamics::readSlips(double time, const double *state) {
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips);
}

bool ModeDynamics::slipsGrowSlowly(double time, const double *state) {
  if (slips_.empty())
    return false;
  readSlips(time, state);
  if (slips_.haveLaunched() || !evaluate(time, state, plus_.data()))
    return false;
  completeRows();
  at_.switching(ModelEvaluation::Slips);
  rememberedSlip_.assign(at_.slip.begin(), at_.slip.end());
  std::vector<double> rates(rows_.tangents().size()), growth(slips_.count());
  for (std::size_t j = 0; j < rates.size(); ++j) {
    const int row = rows_.normalCount() + static_cast<int>(j);
    rates[j] = rows_.product(row, at_.acceleration.data()) + rows_.modelBias(at_, row);
  }
  for (int pair = 0; pair < slips_.count(); ++pair)
    growth[pair] = rates[slips_.row(pair)];
  slipRate_.assign(at_.model().nt, 0.0);
  rows_.spreadTangentForces(rates.data(), slipRate_.data());
  return slips_.watchGrowth(growth.data());
}

void ModeDynamics::continueSlips(double duration, double *state, const double *scale) {
  std::vector<double> wanted(rememberedSlip_.size(), 0.0);
  stops_ = nothingStops_;
  for (int pair = 0; pair < slips_.count(); ++pair) {
    stopPair(pair);
    if (slips_.starts(pair))
      continue;
    const int first = slips_.modelRow(pair);
    for (int row = first; row < first + 2; ++row)
      wanted[row] = rememberedSlip_[row] + duration * slipRate_[row];
  }
  completeRows();
  projection_.project(at_.time(), state, scale, stops_.data(), wanted.data());
}

double ModeDynamics::turnToFriction(double time, const double *state) {
  readSlips(time, state);
  return slips_.turnToFriction();
}

void ModeDynamics::slipAngles(double time, const double *state, double *angles) {
  readSlips(time, state);
  slips_.angles(angles);
}

bool ModeDynamics::evaluateTurned(double time, const double *state, const double *angles, double *rate) {
  std::vector<double> references(turningSlipCount());
  slips_.references(references.data());
  slips_.turnReferences(angles);
  const bool good = evaluate(time, state, rate);
  slips_.setReferences(references.data());
  return good;
}

bool ModeDynamics::slipsTurnBack(double time, const double *state) {
  readSlips(time, state);
  return slips_.turnBack();
}

void ModeDynamics::turningSlips(double time, const double *state, double *slips) {
  readSlips(time, state);
  slips_.slips(slips);
}

void ModeDynamics::turningSlipsByVelocity(double time, const double *state, double *rows) {
  at_.setPoint(time, state);
  at_.contactTerms(mask_.data());
  slips_.slipsByVelocity(rows);
}

bool ModeDynamics::holdsEdge() const {
  return std::any_of(rows_.tangents().begin(), rows_.tangents().end(),
                     [this](int row) { return roles_[row] == TangentRole::Edge && mode_.tangent[row] == Tangent::Stick; });
}

double ModeDynamics::frictionPower() {
  double power = 0;
  if (rows_.tangents().empty())
    return power;
  at_.switching(ModelEvaluation::Slips);
  for (const int row : rows_.tangents())
    if (roles_[row] == TangentRole::Steady)
      power += relaxedFrictionPower(at_.tangentForce.data() + row, at_.slip.data() + row);
    else if (roles_[row] == TangentRole::Always)
      power += at_.tangentForce[row] * at_.slip[row];
  return power;
}

double ModeDynamics::reactionPower() {
  completeRows();
  const tf_model &model = at_.model();
  const double *velocities = at_.velocities();
  double power = 0;
  for (int i = 0; i < rows_.count(); ++i)
    power += rowForces()[i] * rows_.product(i, velocities);
  solveMultipliers();
  if (model.nh == 0)
    return power;
  // Constraints that do not move do no work. What is left of their rates would, at multipliers of any size (where a mechanism is stretched
  // and other constraints hold it).
  at_.constraintResiduals();
  for (int row = 0; row < model.nh; ++row) {
    double rate = 0;
    for (int k = 0; k < model.nv; ++k)
      rate += at_.constraintJacobian[row * model.nv + k] * velocities[k];
    power += at_.multiplier[row] * (rate - at_.residualRate[row]);
  }
  return power;
}

}  // namespace tf::runtime
