#include "runtime/simulate/mode_selection.h"
#include "runtime/integrate/all_finite.h"
#include "runtime/integrate/byte_flags.h"
#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tf::runtime {

namespace {

// Gaps of contacts that graze may be below zero by this, times the gap's scale: rounding; and of those that no impulse can part.
constexpr double deepestGrazing = 1e-12, deepestJam = 1e-10;
// Higher gaps, times the gap's scale, are no rounding.
constexpr double lowestHop = 1e-12;
// Step variables of sliding modes may be outside [0, 1] by this.
constexpr double outsideSteps = 1e-9;

}  // namespace

ModeSelection::ModeSelection(ModeDynamics &dynamics, SelectionTolerances tolerances)
    : dynamics_(dynamics), at_(dynamics.model()), tolerances_(tolerances), contactOf_(contactsOfTangents(at_.model())),
      roles_(rolesOfTangents(at_.model())), mask_(at_.model().nc + at_.model().nf), rate_(dynamics.size()),
      freeAcceleration_(at_.model().nv), grazingSpeed_(at_.model().nc) {}

void ModeSelection::findTouching(double time, const double *state) {
  if (at_.model().nc > 0) {
    at_.setPoint(time, state);
    at_.switching(ModelEvaluation::Gaps);
  }
  listTouching(state);
}

// Gaps have been evaluated at the state. Contacts that are open in `hopping` have closed only where their gaps are zero but for rounding.
void ModeSelection::listTouching(const double *state, const Mode *hopping) {
  const tf_model &model = at_.model();
  touching_.clear();
  approaching_.clear();
  grazing_.clear();
  for (int i = 0; grazes_ && i < model.nc; ++i)
    if (!(at_.gap[i] <= closedGap(i, state)))
      grazingSpeed_[i] = 0;
  grazes_ = grazes_ && std::any_of(grazingSpeed_.begin(), grazingSpeed_.end(), [](double speed) { return speed != 0; });
  forEachSet(at_.screen().awake(), model.nc, [&](int i) {
    const bool hops = hopping != nullptr && hopping->closed[i] == 0 && at_.gap[i] > lowestHop * at_.scales.gap(i, state);
    if (at_.gap[i] <= closedGap(i, state) && !hops && !staysOpen(i, state))
      touching_.push_back(i);
  });
  if (touching_.empty())
    return;
  std::copy_if(touching_.begin(), touching_.end(), std::back_inserter(approaching_),
               [this, state](int i) { return at_.gapRate[i] < -stillRate(i, state); });
  if (!approaching_.empty())
    removeGrazing(state);
}

// A body that falls between two others into a place that it just fits touches them all the way down, but for rounding: their gaps are
// quadratic in its height. An impact would hold it there like a toggle lever, by any force. Accelerations are those of the last evaluation.
void ModeSelection::removeGrazing(const double *state) {
  // Faster approaches do not turn round within the tolerance.
  constexpr double fast = 1e-3, hardly = 2;
  const auto isSlow = [&](int i) { return at_.gapRate[i] > -fast / tolerances_.velocity * stillRate(i, state); };
  const tf_model &model = at_.model();
  if (std::none_of(approaching_.begin(), approaching_.end(), isSlow))
    return;
  slowMask_.assign(model.nc + model.nf, 0);
  for (const int i : approaching_)
    slowMask_[i] = isSlow(i) ? 1 : 0;
  at_.contactTerms(slowMask_.data());
  std::copy_if(approaching_.begin(), approaching_.end(), std::back_inserter(grazing_), [&](int i) {
    const double scale = at_.scales.gap(i, state), least = at_.gap[i] + deepestGrazing * scale, rate = at_.gapRate[i];
    if (!slowMask_[i])
      return false;
    if (-rate <= hardly * std::abs(grazingSpeed_[i]) && at_.gap[i] >= -deepestJam * scale)
      return true;
    if (!(least >= 0))
      return false;
    const double acceleration = at_.gapAcceleration(i, at_.acceleration.data()).value;
    return acceleration > 0 && rate * rate <= 2 * acceleration * least;
  });
  if (!grazing_.empty())
    approaching_.erase(std::remove_if(approaching_.begin(), approaching_.end(),
                                      [this](int i) { return std::binary_search(grazing_.begin(), grazing_.end(), i); }),
                       approaching_.end());
}

bool ModeSelection::hasStopped(double time, const double *state) {
  if (parting_.empty())
    return false;
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Gaps);
  return std::any_of(parting_.begin(), parting_.end(), [this, state](int i) { return at_.gapRate[i] <= stillRate(i, state); });
}

bool ModeSelection::letGraze(const double *state) {
  constexpr double slow = 1e-6;
  const bool mayGraze = std::all_of(approaching_.begin(), approaching_.end(), [&](int i) {
    return at_.gapRate[i] >= -slow / tolerances_.velocity * stillRate(i, state) && at_.gap[i] >= -deepestJam * at_.scales.gap(i, state);
  });
  for (const int i : approaching_)
    if (mayGraze)
      grazingSpeed_[i] = -at_.gapRate[i];
  grazes_ = grazes_ || mayGraze;
  return mayGraze;
}

// A body falls into a place that it just fits, and rests on both sides of it already, as near as the tolerance tells: there its weight has
// no lever to lift it by.
bool ModeSelection::keepOpen(const std::vector<int> &contacts, const double *state) {
  constexpr double slow = 1e-8;
  bool isAny = false;
  for (const int i : contacts)
    if (std::binary_search(touching_.begin(), touching_.end(), i) && at_.gap[i] >= -deepestJam * at_.scales.gap(i, state)) {
      grazingSpeed_[i] = -slow / tolerances_.velocity * stillRate(i, state);
      isAny = true;
    }
  grazes_ = grazes_ || isAny;
  return isAny;
}

bool ModeSelection::staysOpen(int contact, const double *state) const {
  return grazes_ && grazingSpeed_[contact] < 0 && at_.gapRate[contact] >= grazingSpeed_[contact] &&
         at_.gap[contact] >= -deepestJam * at_.scales.gap(contact, state);
}

// Gaps, slips and constraints may depend on switches of time, whose conditions may depend on other switches in turn.
void ModeSelection::setStepVariables(double time, const double *state, const Mode &previous, EventHint hint) {
  const tf_model &model = at_.model();
  if (model.ns == 0)
    return;
  ofTime_.resize(model.ns);
  for (int j = 0; j < model.ns; ++j)
    ofTime_[j] = model.switches[j].kind == TF_SWITCH_TIME;
  at_.setPoint(time, state);
  bool changes = true;
  for (int pass = 0; pass <= model.ns && changes; ++pass) {
    changes = false;
    at_.switching(ModelEvaluation::Conditions);
    at_.switchGradients(ofTime_.data());
    for (int j = 0; j < model.ns; ++j) {
      const bool slides = !previous.switches.empty() && previous.switches[j] == Switch::Sliding;
      if (slides && hint.leavingSwitch != j)
        continue;
      const bool rests = model.switches[j].kind == TF_SWITCH_REST && !previous.switches.empty() && previous.switches[j] == Switch::One &&
                         std::abs(at_.condition[j]) <= tolerances_.condition;
      const bool isOne = model.switches[j].kind == TF_SWITCH_REST ? rests : sideOf(j, hint) == Switch::One;
      const double value = isOne ? 1 : 0;
      changes = changes || at_.stepVariable[j] != value;
      at_.stepVariable[j] = value;
    }
  }
}

// What a switch of time has moved at once by more than any tolerance: a boundary into a body, a constraint or its velocity.
std::string ModeSelection::jump(const double *state) {
  constexpr double clear = 1e-6;
  const tf_model &model = at_.model();
  if (std::none_of(model.switches, model.switches + model.ns, [](const tf_switch &one) { return one.kind == TF_SWITCH_TIME; }))
    return {};
  for (int i = 0; i < model.nc; ++i)
    if (const tf_contact &contact = model.contacts[i]; at_.gap[i] < -clear * at_.scales.gap(i, state))
      return fmt::format("the gap of contact '{}' jumps to {:.6g} {}", contact.name, at_.gap[i], sourceOf(contact.location));
  if (model.nh == 0)
    return {};
  at_.constraintResiduals();
  for (int k = 0; k < model.nk; ++k) {
    const tf_constraint &constraint = model.constraints[k];
    for (int row = constraint.row_first; row < constraint.row_first + constraint.row_count; ++row)
      if (const double error = constraint.holonomic ? at_.residual[row] : 0; std::abs(error) > clear * at_.scales.residual(row))
        return fmt::format("the residual of constraint '{}' jumps to {:.6g} {}", constraint.name, error, sourceOf(constraint.location));
      else if (const double rate = at_.residualRate[row]; std::abs(rate) > clear * at_.scales.residualRate(row, state + model.nq))
        return fmt::format("the velocity of constraint '{}' jumps by {:.6g}, which only contacts may {}", constraint.name, std::abs(rate),
                           sourceOf(constraint.location));
  }
  return {};
}

// False: a coefficient of a contact that touches, or a bound, is no limit of forces; text_ says which one is negative.
bool ModeSelection::hasFrictionLimits() {
  const tf_model &model = at_.model();
  const auto check = [this](const auto &element, double limit) {
    if (limit < -negligibleFriction)
      text_ = negativeFrictionOf(element, limit);
    return text_.empty() && std::isfinite(limit);
  };
  return std::all_of(contacts_.begin(), contacts_.end(), [&](int i) { return check(model.contacts[i], at_.friction[i]); }) &&
         std::all_of(model.frictions, model.frictions + model.nf,
                     [&](const tf_friction &friction) { return check(friction, at_.bound[friction.tangent_first]); });
}

// On its surface a switch of time has the side to which time goes, any other one the relation as written.
Switch ModeSelection::sideOf(int j, EventHint hint) const {
  const tf_switch &one = at_.model().switches[j];
  if (hint.leavingSwitch == j)
    return hint.side;
  if (std::abs(at_.condition[j]) > tolerances_.condition)
    return at_.condition[j] > 0 ? Switch::One : Switch::Zero;
  const int columns = at_.columns();
  const double slope = one.kind == TF_SWITCH_TIME ? at_.conditionGradient[static_cast<std::size_t>(j) * columns + columns - 1] : 0;
  if (slope != 0)
    return slope > 0 ? Switch::One : Switch::Zero;
  return one.zero_is_positive != 0 ? Switch::One : Switch::Zero;
}

// Off its surface a switch has the sign of c. On it, the order of preference is: what the event says, the relation as written, the
// other side, sliding; the first one that is consistent is taken, so that sliding is chosen where both sides point inwards only.
void ModeSelection::classifySwitches(const Mode &previous, EventHint hint) {
  const tf_model &model = at_.model();
  surfaces_.clear();
  choices_.clear();
  left_ = -1;
  mode_.switches.assign(model.ns, Switch::Zero);
  mode_.held.assign(model.ns, 0);
  for (int j = 0; j < model.ns; ++j) {
    if (model.switches[j].kind == TF_SWITCH_REST)
      continue;
    const double c = at_.condition[j];
    const bool hinted = hint.leavingSwitch == j;
    const bool slid = !previous.switches.empty() && previous.switches[j] == Switch::Sliding;
    if (!hinted && !slid && std::abs(c) > tolerances_.condition) {
      mode_.switches[j] = c > 0 ? Switch::One : Switch::Zero;
      continue;
    }
    surfaces_.push_back(j);
    if (slid && hinted)
      left_ = j;
    const Switch written = model.switches[j].zero_is_positive != 0 ? Switch::One : Switch::Zero;
    Choices order;
    if (slid && !hinted)
      order.add(Switch::Sliding);
    order.add(hinted ? hint.side : written);
    order.add((hinted ? hint.side : written) == Switch::One ? Switch::Zero : Switch::One);
    if (model.switches[j].kind == TF_SWITCH_SLIDING && !slid)
      order.add(Switch::Sliding);
    choices_.push_back(order);
  }
}

// Now, or later in the mode.
bool ModeSelection::hasFriction(int contact) const {
  return at_.friction[contact] > 0 || at_.model().contacts[contact].friction_varies != 0;
}

void ModeSelection::chooseRows(double time, const double *state, const Mode &previous) {
  const tf_model &model = at_.model();
  std::vector<int> &contacts = contacts_, &tangents = tangents_;
  contacts.clear();
  tangents.clear();
  parting_.clear();
  for (const int i : touching_)
    if (const double rate = at_.gapRate[i], still = stillRate(i, state); std::abs(rate) <= still)
      contacts.push_back(i);
    else if (rate > 0)
      parting_.push_back(i);
  if (contacts.empty() && model.nf == 0) {
    if (problem_.count() > 0) {
      system_.choose(model, contacts, tangents);
      previousContacts_.resize(0, 0);
    }
    return;
  }
  std::fill_n(mask_.begin(), model.nc, std::uint8_t{0});
  for (const int i : contacts)
    mask_[i] = 1;
  std::fill(mask_.begin() + model.nc, mask_.end(), std::uint8_t{1});
  at_.setPoint(time, state);
  at_.contactTerms(mask_.data());
  forEachTangent(model, contacts, [&](int j) {
    if (takesPartInMotion(roles_[j]) && (contactOf_[j] < 0 || hasFriction(contactOf_[j])))
      tangents.push_back(j);
  });
  system_.choose(model, contacts, tangents);
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    const double slip = at_.slip[tangents[j]], still = stillSlip(tangents[j], state);
    if (roles_[tangents[j]] == TangentRole::Steady) {
      problem_.slipSign[j] = 1;
    } else if (problem_.partner[j] < 0) {
      problem_.slipSign[j] = slip > still ? 1 : slip < -still ? -1 : 0;
    } else if (problem_.partner[j] > static_cast<int>(j)) {
      const double other = at_.slip[tangents[j + 1]], speed = std::hypot(slip, other);
      const bool slips = speed > std::max(still, stillSlip(tangents[j + 1], state));
      problem_.slipSign[j] = problem_.slipSign[j + 1] = slips ? 1 : 0;
      if (slips)
        rows_.setFrame(static_cast<int>(j), slip / speed, other / speed);
    }
  }
  previousContacts_.resize(problem_.normalCount, problem_.tangentCount);
  readPrevious(previous);
}

void ModeSelection::readPrevious(const Mode &previous) {
  for (int i = 0; i < problem_.normalCount; ++i)
    previousContacts_.closed[i] = previous.closed[rows_.contacts()[i]];
  for (int j = 0; j < problem_.tangentCount; ++j) {
    const Tangent tangent = previous.tangent[rows_.tangents()[j]];
    previousContacts_.slip[j] = static_cast<std::int8_t>(tangent == Tangent::None ? 0 : static_cast<int>(tangent));
    if (!previous.direction.empty())
      previousContacts_.direction[j] = previous.direction[rows_.tangents()[j]];
  }
}

void ModeSelection::writeMode(const ContactMode &contacts) {
  const tf_model &model = at_.model();
  mode_.closed.assign(model.nc, 0);
  mode_.tangent.assign(model.nt, Tangent::None);
  mode_.direction.assign(model.nt, 0.0);
  for (int i = 0; i < problem_.normalCount; ++i)
    mode_.closed[rows_.contacts()[i]] = contacts.closed[i];
  for (int j = 0; j < problem_.tangentCount; ++j) {
    const int owner = problem_.owner[j];
    if (owner < 0 || contacts.closed[owner])
      mode_.tangent[rows_.tangents()[j]] = static_cast<Tangent>(contacts.slip[j]);
    mode_.direction[rows_.tangents()[j]] = contacts.direction[j];
  }
}

// The latest forces: a start for iterative solutions, which problems without disks have none of.
const double *ModeSelection::readForces() {
  if (!problem_.hasDisks())
    return nullptr;
  guess_.assign(rows_.count(), 0.0);
  for (int i = 0; i < problem_.normalCount; ++i)
    guess_[i] = at_.normalForce[rows_.contacts()[i]];
  for (int j = 0; j < problem_.tangentCount; ++j)
    guess_[problem_.normalCount + j] = rows_.tangentValue(at_.tangentForce.data(), 1, j);
  return guess_.data();
}

// Slips that are zero, and whose accelerations no force changes, go on to the side of these.
void ModeSelection::startInertSlips(const double *state) {
  for (int j = 0; j < problem_.tangentCount; ++j)
    if (const double bias = problem_.bias[problem_.normalCount + j];
        std::abs(at_.slip[rows_.tangents()[j]]) <= stillSlip(rows_.tangents()[j], state) && problem_.isInert(j))
      problem_.slipSign[j] = bias > 0 ? 1 : bias < 0 ? -1 : 0;
}

// The contact mode for the current step variables.
ModeSelection::Trial ModeSelection::solveContacts(double time, const double *state) {
  redundant_ = indeterminate_ = isSettled_ = false;
  forced_ = -1;
  if (rows_.count() == 0) {
    writeMode(previousContacts_);
    return Trial::Consistent;
  }
  at_.setPoint(time, state);
  if (!at_.dynamics()) {
    dynamics_.failMass();
    return Trial::Failed;
  }
  // Else chooseRows has called them.
  if (!surfaces_.empty())
    at_.contactTerms(mask_.data());
  if (!hasFrictionLimits())
    return Trial::Failed;
  system_.gather(at_);
  system_.respond(at_);
  system_.setBias(at_, freeAcceleration_.data());
  if (!allFinite(problem_.bias)) {
    dynamics_.fail(EvaluationFailure::NotFinite);
    return Trial::Failed;
  }
  startInertSlips(state);
  const ContactSolution &solution = solver_.solve(problem_, &previousContacts_, readForces());
  if (solution.status == ContactStatus::Inconsistent) {
    forced_ = rows_.contacts()[solution.forced];
    return Trial::FrictionalImpulse;
  }
  worstViolation_ = std::max(worstViolation_, solution.violation);
  redundant_ = solution.redundant;
  indeterminate_ = solution.status == ContactStatus::Indeterminate;
  forced_ = indeterminate_ && solution.forced >= 0 ? rows_.contacts()[solution.forced] : -1;
  writeMode(solution.mode);
  const int forceless = forcelessRow(solution);
  if (solution.degenerate.empty() && forceless < 0)
    return Trial::Consistent;
  undecided_ = solution;
  if (forceless >= 0)
    undecided_.degenerate.push_back(forceless);
  settleForces(solution);
  if (!startMode(time, state))
    return Trial::Consistent;
  rates_.resize(problem_.normalCount, problem_.tangentCount);
  dynamics_.accelerationRates(rows_, rate_.data(), rates_.accelerationRate, rates_.frictionRate, rates_.boundRate);
  writeMode(solver_.resolve(problem_, undecided_, rates_, &previousContacts_).mode);
  return Trial::Consistent;
}

// Where contacts bear nothing, to the accuracy of the solution, what is left of their forces may pull, and so may what is left of the
// accelerations of rows that the solution holds. The problem becomes the one nearby that the solution is exact for with forces that are
// zero.
void ModeSelection::settleForces(const ContactSolution &solution) {
  isSettled_ = true;
  settled_.normal.assign(at_.normalForce.size(), 0.0);
  settled_.tangent.assign(at_.tangentForce.size(), 0.0);
  settledForces_ = solution.forces;
  // Forces that hold accelerations of several rows are some times larger than those that hold one.
  const double several = problem_.hasDisks() || solution.redundant ? 1 : 3;
  settled_.scale = 0;
  for (int i = 0; i < problem_.normalCount; ++i)
    if (const double response = problem_.delassus(i, i); response > 0)
      settled_.scale = std::max(settled_.scale, several * solution.scale / std::sqrt(response));
  for (const int row : solution.degenerate)
    if (row < problem_.normalCount)
      settledForces_[row] = 0;
  for (int i = 0; i < problem_.normalCount; ++i)
    settled_.normal[rows_.contacts()[i]] = settledForces_[i];
  double *tangents = settledForces_.data() + problem_.normalCount;
  for (int j = 0; j < problem_.tangentCount; ++j)
    if (problem_.owner[j] >= 0 && settledForces_[problem_.owner[j]] == 0)
      tangents[j] = 0;
  rows_.spreadTangentForces(tangents, settled_.tangent.data());
}

// The row of the contact whose force an event says is zero, where the solution keeps it closed and does not know; −1: none.
int ModeSelection::forcelessRow(const ContactSolution &solution) const {
  const auto found = std::find(rows_.contacts().begin(), rows_.contacts().end(), forceless_);
  const int row = static_cast<int>(found - rows_.contacts().begin());
  const bool isMissed = found != rows_.contacts().end() && solution.mode.closed[row] != 0 &&
                        std::find(solution.degenerate.begin(), solution.degenerate.end(), row) == solution.degenerate.end();
  return isMissed ? row : -1;
}

// After solveContacts, at the same point.
bool ModeSelection::startMode(double time, const double *state) {
  const SolvedContacts solved = {system_, freeAcceleration_, solver_.forceSet(), isSettled_ ? &settled_ : nullptr};
  return dynamics_.start(mode_, time, state, rate_.data(), rows_.count() > 0 ? &solved : nullptr);
}

// The least forces of a redundant mode need not be those that the solver found it with: with them a slip that begins may not go where the
// mode says. Its row is held at zero then, where that is admissible; the modes on both sides would only end each other.
void ModeSelection::holdRows(double time, const double *state) {
  if (!redundant_)
    return;
  const int normals = problem_.normalCount;
  for (int pass = 0; pass < problem_.tangentCount; ++pass) {
    const Mode &before = heldMode_ = mode_;
    for (int j = 0; j < problem_.tangentCount; ++j) {
      const int row = rows_.tangents()[j];
      const auto direction = static_cast<int>(mode_.tangent[row]);
      if (problem_.partner[j] >= 0 || problem_.slipSign[j] != 0 || mode_.tangent[row] == Tangent::None || direction == 0)
        continue;
      const double bias = rows_.tangentValue(at_.tangentBias.data(), 1, j);
      double size = std::abs(bias);
      for (int k = 0; k < at_.model().nv; ++k)
        size += std::abs(rows_.jacobian(normals + j)[k] * at_.acceleration[k]);
      if (direction * (rows_.product(normals + j, at_.acceleration.data()) + bias) < -1e-10 * size)
        mode_.tangent[row] = Tangent::Stick;
    }
    if (mode_ == before)
      return;
    if (!startMode(time, state)) {
      mode_ = before;
      startMode(time, state);
      return;
    }
  }
}

// Signs of d c/dt on the surfaces agree with the sides that were assigned. What contacts hold has rates of rounding, compared with those
// that it would have without them. So has the side to which a surface is left that a motion has slid on: its rate begins at zero, a
// difference of terms that may be as large as that between the sides.
bool ModeSelection::conditionsHold(double time, const double *state) {
  stays_.assign(surfaces_.size(), 0);
  if (surfaces_.empty())
    return true;
  const tf_model &model = at_.model();
  const int nx = at_.columns();
  surfaceMask_.assign(model.ns, 0);
  for (int j : surfaces_)
    surfaceMask_[j] = 1;
  at_.setPoint(time, state);
  at_.switchGradients(surfaceMask_.data());
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const int j = surfaces_[s];
    const double *row = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(j) * nx;
    double slope = 0, size = 0, freeSize = 0;
    const auto accumulate = [&](double gradient, double rate, double freeRate = 0) {
      slope += gradient * rate;
      size += std::abs(gradient * rate);
      freeSize += std::abs(gradient * freeRate);
    };
    const int states = model.nq + model.nv + model.nz;
    for (int k = 0; k < states; ++k) {
      const bool isVelocity = k >= model.nq && k < model.nq + model.nv;
      accumulate(row[k], rate_[k], isVelocity && rows_.count() > 0 ? freeAcceleration_[k - model.nq] : 0);
    }
    for (int k = 0; k < model.nu; ++k)
      accumulate(row[states + k], at_.inputRate[k]);
    accumulate(row[nx - 1], 1);
    constexpr double rounding = 1e-12;
    stays_[s] = std::abs(slope) <= rounding * std::max(size, freeSize) ? 1 : 0;
    double tolerance = std::max(1e-10 * std::max(size, 1e-300), rounding * freeSize);
    if (j == left_)
      tolerance = std::max(tolerance, outsideSteps * dynamics_.slopeJump(j));
    if (mode_.switches[j] == Switch::One && slope < -tolerance)
      return false;
    if (mode_.switches[j] == Switch::Zero && slope > tolerance)
      return false;
    if (mode_.switches[j] == Switch::Sliding && (at_.stepVariable[j] < -outsideSteps || at_.stepVariable[j] > 1 + outsideSteps))
      return false;
  }
  return true;
}

ModeSelection::Trial ModeSelection::tryAssignment(double time, const double *state) {
  const tf_model &model = at_.model();
  bool sliding = false;
  for (int j = 0; j < model.ns; ++j) {
    if (mode_.switches[j] == Switch::Sliding) {
      sliding = true;
      at_.stepVariable[j] = std::clamp(at_.stepVariable[j], 0.1, 0.9);
    } else {
      at_.stepVariable[j] = mode_.switches[j] == Switch::One ? 1 : 0;
    }
  }
  // The contact mode and sliding step variables depend on each other.
  for (int pass = 0; pass < 8; ++pass) {
    const Trial contacts = solveContacts(time, state);
    if (contacts != Trial::Consistent)
      return contacts;
    if (!startMode(time, state))
      return sliding ? Trial::Inconsistent : Trial::Failed;
    holdRows(time, state);
    if (!sliding || (pass > 0 && found_ == mode_))
      return conditionsHold(time, state) ? Trial::Consistent : Trial::Inconsistent;
    found_ = mode_;
  }
  return Trial::Inconsistent;
}

// Assignments in the order of preference, the first surface varying fastest.
ModeSelection::Trial ModeSelection::tryAssignments(double time, const double *state) {
  for (;;) {
    for (std::size_t s = 0; s < surfaces_.size(); ++s)
      mode_.switches[surfaces_[s]] = choices_[s].values[choices_[s].current];
    const Trial trial = tryAssignment(time, state);
    if (trial == Trial::Consistent)
      return tryRests(time, state);
    if (trial != Trial::Inconsistent)
      return trial;
    std::size_t s = 0;
    while (s < choices_.size() && ++choices_[s].current == choices_[s].count)
      choices_[s++].current = 0;
    if (s == choices_.size())
      return Trial::Inconsistent;
  }
}

// Switches whose conditions stay zero have the values that their relations have there, as written. True: some do not.
bool ModeSelection::rest(const Mode &found) {
  const tf_model &model = at_.model();
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    if (const int j = surfaces_[s]; stays_[s] != 0 && found.switches[j] != Switch::Sliding) {
      mode_.switches[j] = model.switches[j].zero_is_positive != 0 ? Switch::One : Switch::Zero;
      for (int k = j + 1; k < model.ns; ++k)
        if (model.switches[k].of == j)
          mode_.switches[k] = Switch::One;
    }
  return mode_.switches != found.switches;
}

// The same assignment, but for the switches that rest, if it is consistent with them.
ModeSelection::Trial ModeSelection::tryRests(double time, const double *state) {
  if (std::none_of(stays_.begin(), stays_.end(), [](std::uint8_t stays) { return stays != 0; }))
    return Trial::Consistent;
  const Mode found = mode_;
  const std::vector<std::uint8_t> stayed = stays_;
  if (rest(found) && (tryAssignment(time, state) != Trial::Consistent || stays_ != stayed)) {
    mode_.switches = found.switches;
    if (const Trial trial = tryAssignment(time, state); trial != Trial::Consistent)
      return trial;
  }
  return !holdConditions(time, state) || startMode(time, state) ? Trial::Consistent : Trial::Failed;
}

// Of the switches that rest, those whose conditions no force can move in the mode. True: there are some. conditionsHold has evaluated the
// gradients.
bool ModeSelection::holdConditions(double time, const double *state) {
  const tf_model &model = at_.model();
  if (model.nh > 0) {
    at_.setPoint(time, state);
    at_.constraintRows();
  }
  const std::vector<std::uint8_t> before = mode_.held;
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    if (const int j = surfaces_[s]; stays_[s] != 0 && mode_.switches[j] != Switch::Sliding)
      mode_.held[j] = isHeld(at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(j) * at_.columns()) ? 1 : 0;
  return mode_.held != before;
}

// The gradient of a condition by (q, v, z, …): as that of a velocity, or of a position, it is a combination of the rows that the mode
// holds.
bool ModeSelection::isHeld(const double *gradient) {
  const tf_model &model = at_.model();
  const auto moves = [](const double *part, int count) { return std::any_of(part, part + count, [](double g) { return g != 0; }); };
  if (model.nq != model.nv && moves(gradient, model.nq))
    return false;
  if (moves(gradient + model.nq + model.nv, model.nz + model.nu))
    return false;
  std::vector<double> held;
  const auto add = [&](const double *row) { held.insert(held.end(), row, row + model.nv); };
  for (int i = 0; i < rows_.normalCount(); ++i)
    if (mode_.closed[rows_.contacts()[i]])
      add(rows_.jacobian(i));
  for (int j = 0; j < static_cast<int>(rows_.tangents().size()); ++j)
    if (mode_.tangent[rows_.tangents()[j]] == Tangent::Stick)
      add(rows_.jacobian(rows_.normalCount() + j));
  for (int row = 0; row < model.nh; ++row)
    add(at_.constraintJacobian.data() + static_cast<std::ptrdiff_t>(row) * model.nv);
  if (held.empty() || !moves(gradient, model.nq + model.nv))
    return false;
  const Eigen::Map<const Eigen::MatrixXd> rows(held.data(), model.nv, static_cast<Eigen::Index>(held.size()) / model.nv);
  constexpr double rounding = 1e-10;
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> combination(rows);
  for (const double *part : {gradient, gradient + model.nq}) {
    const int count = part == gradient ? model.nq : model.nv;
    if (!moves(part, count))
      continue;
    const Eigen::Map<const Eigen::VectorXd> g(part, count);
    if (!((rows * combination.solve(g) - g).norm() <= rounding * g.norm()))
      return false;
  }
  return true;
}

const Selection &ModeSelection::select(double time, const double *state, const Mode &previous, EventHint hint) {
  Selection &result = selection_;
  const tf_model &model = at_.model();
  result.text.clear();
  text_.clear();
  forceless_ = hint.forceless;
  setStepVariables(time, state, previous, hint);
  at_.setPoint(time, state);
  at_.switching();
  if (std::string text = jump(state); !text.empty()) {
    result.status = SelectionStatus::Failed;
    result.text = std::move(text);
    return result;
  }
  listTouching(state, hint.keepsOpen ? &previous : nullptr);
  if (!approaching_.empty()) {
    result.status = SelectionStatus::Impact;
    return result;
  }
  classifySwitches(previous, hint);
  chooseRows(time, state, previous);
  const Trial trial = tryAssignments(time, state);
  result.indeterminate = indeterminate_;
  result.isSettled = isSettled_;
  result.contact = forced_;
  switch (trial) {
  case Trial::Consistent:
    result.status = SelectionStatus::Selected;
    break;
  case Trial::FrictionalImpulse:
    result.status = SelectionStatus::FrictionalImpulse;
    break;
  case Trial::Inconsistent:
    result.status = SelectionStatus::Failed;
    result.text = fmt::format("no consistent continuation of the switches at '{}'", model.switches[surfaces_.front()].text);
    break;
  case Trial::Failed:
    result.status = SelectionStatus::Failed;
    result.text = text_;
    break;
  }
  return result;
}

}  // namespace tf::runtime
