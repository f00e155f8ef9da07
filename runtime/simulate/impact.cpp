#include "runtime/simulate/impact.h"

#include "runtime/contact/dense_kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace tf::runtime {

namespace {

// What rows of contacts make of rounding errors of coordinates and velocities, relative to the largest velocity that moves one of them.
constexpr double roundingOfVelocities = 1e-13;

}  // namespace

void Impact::assemble(double time, const double *state, const std::vector<int> &contacts) {
  const tf_model &model = at_.model();
  at_.setPoint(time, state);
  // A constant mass matrix is factorised already.
  if (model.mass_is_constant == 0 || model.nh > 0)
    at_.dynamics();
  std::fill(mask_.begin(), mask_.end(), std::uint8_t{0});
  for (int i : contacts)
    mask_[i] = 1;
  at_.contactTerms(mask_.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  std::vector<int> &tangents = tangents_;
  tangents.clear();
  for (int i : contacts)
    for (int k = 0; k < model.contacts[i].tangent_count; ++k)
      if (at_.friction[i] > 0 && takesPartInImpacts(roles_[model.contacts[i].tangent_first + k]))
        tangents.push_back(model.contacts[i].tangent_first + k);
  if (contacts != rows_.contacts() || tangents != rows_.tangents()) {
    problem_.resize(static_cast<int>(contacts.size()), static_cast<int>(tangents.size()));
    rows_.choose(model, contacts, tangents, problem_);
  }
  rows_.assemble(at_, problem_.delassus, problem_);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool grazes = std::binary_search(grazing_.begin(), grazing_.end(), contacts[i]);
    problem_.normalVelocity[i] = grazes ? 0 : at_.gapRate[contacts[i]];
    problem_.rate[i] = at_.rate[contacts[i]];
    problem_.law[i] = static_cast<ImpactLaw>(model.contacts[contacts[i]].law);
  }
  for (std::size_t j = 0; j < tangents.size(); ++j)
    problem_.slipVelocity[j] = at_.slip[tangents[j]];
  const double *velocities = state + model.nq;
  double largest = 0;
  for (const int i : contacts)
    largest = std::max(largest, at_.scales.gapRate(i, velocities));
  for (const int row : tangents)
    largest = std::max(largest, at_.scales.slip(row, velocities));
  problem_.resolution = roundingOfVelocities * largest;
  readRestitution();
}

void Impact::readRestitution() {
  for (std::size_t i = 0; i < rows_.contacts().size(); ++i)
    problem_.restitution[i] = elastic_ ? at_.restitution[rows_.contacts()[i]] : 0;
}

// Slips of two components have the state moved before their impact.
bool Impact::isAssembled(double time, const double *state, const std::vector<int> &contacts) const {
  return !assembledState_.empty() && time == assembledTime_ && contacts == rows_.contacts() &&
         std::equal(assembledState_.begin(), assembledState_.end(), state) &&
         std::all_of(problem_.partner.begin(), problem_.partner.end(), [](int partner) { return partner < 0; });
}

// Impulse times velocity of the boundary: what the row's velocity J v lacks of its rate, and H v of zero.
void Impact::findWork(const double *impulse, const double *velocities) {
  const tf_model &model = at_.model();
  const int normals = rows_.normalCount();
  boundaryWork_ = 0;
  for (int i = 0; i < rows_.count(); ++i) {
    const double rate = i < normals ? problem_.normalVelocity[i] : problem_.slipVelocity[i - normals];
    boundaryWork_ += impulse[i] * (rows_.product(i, velocities) - rate);
  }
  if (model.nh == 0)
    return;
  impulse_.assign(model.nv, 0.0);
  multiplier_.assign(model.nh, 0.0);
  rows_.addForces(impulse, impulse_.data());
  at_.mobility.multipliers(impulse_.data(), multiplier_.data(), multiplier_.data());
  for (int row = 0; row < model.nh; ++row)
    for (int k = 0; k < model.nv; ++k)
      boundaryWork_ += multiplier_[row] * at_.constraintJacobian[row * model.nv + k] * velocities[k];
}

// What the end of an impact must satisfy however it was found: v⁺ = v⁻ + D Λ, no contact approaches, Λ_n ≥ 0 and ‖Λ_t‖ ≤ μ Λ_n (the
// integral of forces within the cone is within it). Relative to the largest velocity, all rows in the metric of D.
void Impact::certify(const FrozenResult &result, const std::vector<double> &impulse) {
  const int n = problem_.normalCount, count = problem_.count();
  const auto metric = [this](int r) { return problem_.delassus(r, r) > 0 ? std::sqrt(problem_.delassus(r, r)) : 1.0; };
  const double fastest = problem_.resolution / roundingOfVelocities;
  std::vector<double> &change = impulse_;
  change.assign(count, 0.0);
  addColumns(problem_.delassus.data(), count, count, 1, impulse.data(), change.data());
  double scale = 0, worst = 0;
  const auto include = [&worst](double violation) { worst = violation > worst || std::isnan(violation) ? violation : worst; };
  for (int r = 0; r < count; ++r) {
    const double before = r < n ? problem_.normalVelocity[r] : problem_.slipVelocity[r - n], after = result.velocity[r];
    scale = std::max({scale, fastest / metric(r), std::abs(before) / metric(r), std::abs(after) / metric(r)});
    include(std::abs(after - before - change[r]) / metric(r));
    if (r < n)
      include(std::max(-after / metric(r), -impulse[r] * metric(r)));
  }
  for (int j = 0; j < problem_.tangentCount; ++j) {
    const int partner = problem_.partner[j], owner = problem_.owner[j];
    if (partner >= 0 && partner < j)
      continue;
    const double size = partner < 0 ? std::abs(impulse[n + j]) : std::hypot(impulse[n + j], impulse[n + partner]);
    include((size - problem_.friction[j] * impulse[owner]) * metric(n + j));
  }
  worstResidual_ = std::max(worstResidual_, worst / scale);
}

const std::vector<int> &Impact::reached(double time, const double *state, const std::vector<int> &touching,
                                        const std::vector<int> &approaching) {
  // Few velocities: most contacts reach each other, and following all costs less than finding out.
  if (approaching.size() == touching.size() || at_.model().nv <= RowSystem::narrow)
    return touching;
  assemble(time, state, touching);
  assembledTime_ = time;
  assembledState_.assign(state, state + at_.stateSize());
  coupled_.find(problem_.delassus, problem_);
  starters_.clear();
  for (const int contact : approaching)
    starters_.push_back(rowOf(contact));
  reached_.resize(touching.size());
  std::iota(reached_.begin(), reached_.end(), 0);
  coupled_.keepReached(reached_, starters_);
  std::transform(reached_.begin(), reached_.end(), reached_.begin(), [this](int row) { return rows_.contacts()[row]; });
  return reached_;
}

// The normal row of a contact.
int Impact::rowOf(int contact) const {
  const std::vector<int> &contacts = rows_.contacts();
  const auto place = std::find(contacts.begin(), contacts.end(), contact);
  assert(place != contacts.end());
  return static_cast<int>(place - contacts.begin());
}

// Contacts at rest have no velocity of their own. Which of them starts a frictional impulse is not known where several are needed for the
// contact problem to have no solution.
const FrozenResult &Impact::follow(const std::vector<int> &forced) {
  const bool spatial = std::any_of(problem_.partner.begin(), problem_.partner.end(), [](int partner) { return partner >= 0; });
  const auto run = [&](int row) -> const FrozenResult & { return spatial ? spatialPhase_.run(problem_, row) : phase_.run(problem_, row); };
  starter_ = -1;
  if (forced.empty()) {
    const FrozenResult *closedForm = singlePhase_.run(problem_);
    return closedForm != nullptr ? *closedForm : run(-1);
  }
  for (const int contact : forced)
    problem_.normalVelocity[rowOf(contact)] = 0;
  const auto changes = [this](const FrozenResult &result, double least) {
    for (int j = 0; j < problem_.tangentCount; ++j)
      if (std::abs(result.velocity[problem_.normalCount + j] - problem_.slipVelocity[j]) > least * problem_.resolution)
        return true;
    return false;
  };
  const FrozenResult *result = nullptr;
  for (std::size_t k = 0; k < forced.size() && starter_ < 0; ++k) {
    result = &run(rowOf(forced[k]));
    if (result->status != FrozenStatus::Finished || (result->duration > 0 && changes(*result, 1)))
      starter_ = forced[k];
  }
  if (starter_ >= 0 || forced.size() < 2)
    return *result;
  // Contacts that only press each other in: all of them approach as slowly as can be told from rest.
  constexpr double slowest = 3, clearly = 1e3;
  for (const int contact : forced)
    problem_.normalVelocity[rowOf(contact)] = -slowest * problem_.resolution;
  result = &run(-1);
  if (changes(*result, clearly))
    starter_ = forced.front();
  return *result;
}

bool Impact::apply(double time, double *state, const std::vector<int> &contacts, const std::vector<int> &forced, double *normalImpulse) {
  const tf_model &model = at_.model();
  if (isAssembled(time, state, contacts))
    readRestitution();
  else
    assemble(time, state, contacts);
  assembledState_.clear();
  const FrozenResult &result = follow(forced);
  breakpoints_ = result.breakpointCount;
  isUnbounded_ = result.status == FrozenStatus::Unbounded;
  leavesApproach_ = result.leavesApproach;
  if (result.status != FrozenStatus::Finished) {
    std::string names;
    for (int row : result.rows)
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", model.contacts[contacts[row]].name);
    text_ = result.status == FrozenStatus::Cycle ? fmt::format("the impact of {} repeats the same sequence of contacts without end", names)
            : result.status == FrozenStatus::Unbounded
                ? fmt::format("the impact of {} never ends: the contact cannot give way to any impulse", names)
                : fmt::format("the impact of {} has no continuation that could be found", names);
    return false;
  }
  total_ = result.impulse;
  admissible_.choose(problem_, result.velocity, total_);
  certify(result, total_);
  if (measuresWork_)
    findWork(total_.data(), state + model.nq);
  rows_.accelerate(total_.data(), state + model.nq);
  state[at_.tauIndex()] += result.duration;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    normalImpulse[contacts[i]] += total_[i];
  return true;
}

}  // namespace tf::runtime
