#include "runtime/contact/impact_sequence.h"

#include "runtime/contact/breakpoint_tail.h"
#include "runtime/contact/contact_solver.h"
#include "runtime/contact/coupled_contacts.h"
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/numbers.h"
#include "runtime/contact/single_contact_phase.h"
#include "runtime/contact/time_speed.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tf::runtime {

namespace {

constexpr int eventLimit = 1000;
// A sequence that repeats passes through the same few sets of resting contacts; to find out that many contacts do not is costly.
constexpr std::size_t flightLimit = 64;
// A factor closer to 1 does not contract.
constexpr double sequenceContraction = 1e-6;
// Impacts slower than this part of the fastest one end the sequence where it does not repeat: the time left is as small.
constexpr double negligible = 1e-13;
// Contacts take part in the end of such a sequence if their last impact is not longer ago than this part of its time.
constexpr double recent = 1e-6;
// Gaps that close together differ by this part of their way.
constexpr double simultaneous = 1e-11;

// First t > 0 with gap + c2 t + w t²/2 = 0; the gap is ≥ 0, and opening or open.
double returnTime(double gap, double c2, double w) {
  const double discriminant = c2 * c2 - 2 * w * gap;
  if (discriminant < 0)
    return infinity;
  const double root = std::sqrt(discriminant);
  if (c2 <= 0)
    return gap > 0 && root - c2 > 0 ? 2 * gap / (root - c2) : infinity;
  return w < 0 ? (c2 + root) / -w : infinity;
}

}  // namespace

void SequenceProblem::resize(int normals, int tangents) {
  ContactRows::resize(normals, tangents);
  delassus.setZero(count(), count());
  bias.assign(count(), 0.0);
  gap.assign(normals, 0.0);
  velocity.assign(count(), 0.0);
  rate.assign(normals, 1.0);
  restitution.assign(normals, 0.0);
  law.assign(normals, ImpactLaw::Poisson);
}

struct ImpactSequence::Workspace {
  const SequenceProblem *problem = nullptr;
  FrozenPhase frozen;
  SingleContactPhase singleFrozen;
  FrozenProblem impact;
  ContactSolver solver{{.listsDegenerate = false}};
  ContactProblem closed;
  // inner: impacts; outer: one entry for each accumulation that was summed.
  BreakpointTail inner, outer;
  std::vector<AccumulationPoint> points;  // those whose contacts have stayed closed so far
  AccumulationPoint state;                // at the current time
  std::vector<double> gap, velocity, acceleration, force;
  std::vector<double> start, outerStart, end;  // values at the begin and the end of the current entry
  std::vector<int> rows, tangents;             // of the closed or impacting contacts
  CoupledContacts coupled;
  std::vector<int> approaching;  // of `rows`
  std::vector<double> closedForce, closedRate;
  std::vector<std::vector<int>> innerHits, outerHits;  // contacts with impacts of each entry; the last are those of the current one
  std::vector<double> lastHit;                         // n: time of the last impact
  double fastest = 0;
  // What follows from the contacts that rest and the directions of their slips; the same ones come again and again.
  struct Flight {
    std::vector<int> rows, tangents, slipSign;
    std::vector<double> acceleration, force, closedForce, closedRate;
  };
  std::vector<Flight> flights;
  std::vector<int> slipSign;  // of `tangents`

  [[nodiscard]] int n() const { return problem->normalCount; }
  [[nodiscard]] int count() const { return problem->count(); }
  void begin(const SequenceProblem &at);
  void chooseRows(bool resting);
  void resetTail(BreakpointTail &tail) const;
  void readValues(std::vector<double> &values) const;
  void addEntry(BreakpointTail &tail, std::vector<double> &from, int symbol);
  bool freeze();
  void poseClosed();
  bool solveClosed();
  bool findAccelerations();
  double nextEvent(int &row) const;
  void fly(double duration, int row);
  [[nodiscard]] std::vector<int> ending(const std::vector<std::vector<int>> &hits, int period) const;
  void sumTail(const BreakpointTail &tail, const std::vector<int> &contacts);
  void recordPoint(const std::vector<int> &contacts);
  void dropReopened();
  bool sumRepeating();
  void endSlowest();
};

void ImpactSequence::Workspace::begin(const SequenceProblem &at) {
  problem = &at;
  points.clear();
  state = {};
  state.impulse.assign(count(), 0.0);
  state.impulseMoment.assign(count(), 0.0);
  state.frozenImpulse.assign(count(), 0.0);
  gap = at.gap;
  velocity = at.velocity;
  acceleration.assign(count(), 0.0);
  force.assign(count(), 0.0);
  innerHits.assign(1, {});
  outerHits.assign(1, {});
  lastHit.assign(n(), -infinity);
  fastest = 0;
  flights.clear();
  coupled.find(at.delassus, at);
  resetTail(inner);
  resetTail(outer);
  readValues(start);
  outerStart = start;
}

// Velocities, impulses, times shrink by the factor of a cycle; then gaps and moments, which are integrals, and the loss, which is as one.
void ImpactSequence::Workspace::readValues(std::vector<double> &values) const {
  values.assign(velocity.begin(), velocity.end());
  values.insert(values.end(), state.impulse.begin(), state.impulse.end());
  values.insert(values.end(), state.frozenImpulse.begin(), state.frozenImpulse.end());
  values.push_back(state.time);
  values.push_back(state.tau);
  values.insert(values.end(), gap.begin(), gap.end());
  values.insert(values.end(), state.impulseMoment.begin(), state.impulseMoment.end());
  values.push_back(state.loss);
}

void ImpactSequence::Workspace::resetTail(BreakpointTail &tail) const {
  const int compared = 3 * count() + 2;
  tail.reset(compared + n() + count() + 1, compared);
}

void ImpactSequence::Workspace::addEntry(BreakpointTail &tail, std::vector<double> &from, int symbol) {
  readValues(end);
  for (std::size_t k = 0; k < end.size(); ++k)
    from[k] = end[k] - from[k];
  tail.add(symbol, from);
  from.swap(end);
}

// Contacts with gap 0 that an impact reaches, or (`resting`) that do not open either, and their tangential rows; resting contacts come with
// the friction elements.
void ImpactSequence::Workspace::chooseRows(bool resting) {
  rows.clear();
  tangents.clear();
  for (int i = 0; i < n(); ++i)
    if (gap[i] == 0 && (!resting || velocity[i] == 0))
      rows.push_back(i);
  if (!resting) {
    approaching.clear();
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(approaching), [this](int i) { return velocity[i] < 0; });
    coupled.keepReached(rows, approaching);
  }
  for (int j = 0; j < problem->tangentCount; ++j) {
    const int owner = problem->owner[j];
    if (owner < 0 ? resting : std::binary_search(rows.begin(), rows.end(), owner))
      tangents.push_back(j);
  }
}

// The impact of the contacts with gap 0. False: it has no end.
bool ImpactSequence::Workspace::freeze() {
  chooseRows(false);
  const int ni = static_cast<int>(rows.size()), mi = static_cast<int>(tangents.size());
  impact.resize(ni, mi);
  const auto row = [&](int r) { return r < ni ? rows[r] : n() + tangents[r - ni]; };
  for (int c = 0; c < ni + mi; ++c)
    for (int r = 0; r < ni + mi; ++r)
      impact.delassus(r, c) = problem->delassus(row(r), row(c));
  for (int i = 0; i < ni; ++i) {
    const int contact = rows[i];
    fastest = std::max(fastest, -velocity[contact]);
    if (velocity[contact] < 0) {
      innerHits.back().push_back(contact);
      outerHits.back().push_back(contact);
      lastHit[contact] = state.time;
    }
    impact.normalVelocity[i] = velocity[contact];
    impact.rate[i] = problem->rate[contact];
    impact.restitution[i] = problem->restitution[contact];
    impact.law[i] = problem->law[contact];
  }
  for (int j = 0; j < mi; ++j) {
    impact.owner[j] = static_cast<int>(std::lower_bound(rows.begin(), rows.end(), problem->owner[tangents[j]]) - rows.begin());
    impact.friction[j] = problem->friction[tangents[j]];
    impact.slipVelocity[j] = velocity[n() + tangents[j]];
  }
  const FrozenResult *closedForm = singleFrozen.run(impact);
  const FrozenResult &result = closedForm != nullptr ? *closedForm : frozen.run(impact);
  if (result.status != FrozenStatus::Finished)
    return false;
  for (int c = 0; c < ni + mi; ++c) {
    state.impulse[row(c)] += result.impulse[c];
    state.frozenImpulse[row(c)] += result.impulse[c];
    const double before = c < ni ? impact.normalVelocity[c] : impact.slipVelocity[c - ni];
    state.loss -= 0.5 * result.impulse[c] * (before + result.velocity[c]);
    for (int r = 0; r < count(); ++r)
      velocity[r] += problem->delassus(r, row(c)) * result.impulse[c];
  }
  for (int r = 0; r < ni + mi; ++r)
    velocity[row(r)] = result.velocity[r];
  state.tau += result.duration;
  return true;
}

void ImpactSequence::Workspace::poseClosed() {
  const int ni = static_cast<int>(rows.size()), mi = static_cast<int>(tangents.size());
  closed.resize(ni, mi);
  const auto row = [&](int r) { return r < ni ? rows[r] : n() + tangents[r - ni]; };
  for (int c = 0; c < ni + mi; ++c) {
    closed.bias[c] = problem->bias[row(c)];
    for (int r = 0; r < ni + mi; ++r)
      closed.delassus(r, c) = problem->delassus(row(r), row(c));
  }
  for (int j = 0; j < mi; ++j) {
    const int owner = problem->owner[tangents[j]];
    closed.owner[j] = owner < 0 ? -1 : static_cast<int>(std::lower_bound(rows.begin(), rows.end(), owner) - rows.begin());
    closed.friction[j] = problem->friction[tangents[j]];
    closed.bound[j] = problem->bound[tangents[j]];
    closed.slipSign[j] = slipSign[j];
  }
}

// Of the contacts in `rows`. False: the contact problem has no solution.
bool ImpactSequence::Workspace::solveClosed() {
  const int ni = static_cast<int>(rows.size()), mi = static_cast<int>(tangents.size());
  const auto row = [&](int r) { return r < ni ? rows[r] : n() + tangents[r - ni]; };
  poseClosed();
  acceleration = problem->bias;
  std::fill(force.begin(), force.end(), 0.0);
  closedForce.clear();
  closedRate.clear();
  if (ni + mi == 0)
    return true;
  const ContactSolution &solution = solver.solve(closed);
  if (solution.status != ContactStatus::Solved)
    return false;
  for (int c = 0; c < ni + mi; ++c) {
    force[row(c)] = solution.forces[c];
    for (int r = 0; r < count(); ++r)
      acceleration[r] += problem->delassus(r, row(c)) * solution.forces[c];
  }
  for (int r = 0; r < ni + mi; ++r)
    acceleration[row(r)] = solution.accelerations[r];
  for (int i = 0; i < ni; ++i) {
    if (solution.mode.closed[i])
      acceleration[rows[i]] = 0;
    closedForce.push_back(solution.forces[i]);
    closedRate.push_back(problem->rate[rows[i]]);
  }
  for (int j = 0; j < mi; ++j)
    if (solution.mode.slip[j] == 0 && slipSign[j] == 0 && (closed.owner[j] < 0 || solution.mode.closed[closed.owner[j]]))
      acceleration[n() + tangents[j]] = 0;
  return true;
}

// Constant forces and accelerations until the next event. False: the contact problem has no solution, or too many were different.
bool ImpactSequence::Workspace::findAccelerations() {
  chooseRows(true);
  slipSign.clear();
  for (const int j : tangents)
    slipSign.push_back(velocity[n() + j] > 0 ? 1 : velocity[n() + j] < 0 ? -1 : 0);
  const auto known = std::find_if(flights.begin(), flights.end(), [this](const Flight &flight) {
    return flight.rows == rows && flight.tangents == tangents && flight.slipSign == slipSign;
  });
  if (known != flights.end()) {
    acceleration = known->acceleration;
    force = known->force;
    closedForce = known->closedForce;
    closedRate = known->closedRate;
    return true;
  }
  if (flights.size() == flightLimit || !solveClosed())
    return false;
  flights.push_back({rows, tangents, slipSign, acceleration, force, closedForce, closedRate});
  return true;
}

// Time until a gap closes (row i) or the slip of a closed contact or friction element ends (row n + j).
double ImpactSequence::Workspace::nextEvent(int &row) const {
  double first = infinity;
  row = -1;
  for (int r = 0; r < count(); ++r) {
    double time = infinity;
    if (r < n()) {
      if (gap[r] > 0 || velocity[r] > 0 || acceleration[r] > 0)
        time = returnTime(gap[r], velocity[r], acceleration[r]);
    } else if (std::find(tangents.begin(), tangents.end(), r - n()) != tangents.end() && velocity[r] * acceleration[r] < 0) {
      time = -velocity[r] / acceleration[r];
    }
    if (time < first) {
      first = time;
      row = r;
    }
  }
  return first;
}

void ImpactSequence::Workspace::fly(double duration, int row) {
  for (int r = 0; r < count(); ++r) {
    const double step = acceleration[r] * duration;
    if (r < n()) {
      const double way = std::abs(velocity[r] * duration) + 0.5 * std::abs(step * duration);
      gap[r] += velocity[r] * duration + 0.5 * step * duration;
      const bool approaches = velocity[r] + step < 0;
      if (r == row || gap[r] < 0 || (approaches && gap[r] <= simultaneous * way))
        gap[r] = 0;
    }
    state.impulseMoment[r] += state.impulse[r] * duration + 0.5 * force[r] * duration * duration;
    state.impulse[r] += force[r] * duration;
    velocity[r] = r == row && r >= n() ? 0 : velocity[r] + step;
  }
  state.time += duration;
  state.tau += duration / timeSpeed(closedForce, closedRate);
}

// Contacts with impacts in the last cycle, ascending.
std::vector<int> ImpactSequence::Workspace::ending(const std::vector<std::vector<int>> &hits, int period) const {
  std::vector<int> contacts;
  for (auto entry = hits.end() - period; entry != hits.end(); ++entry)
    contacts.insert(contacts.end(), entry->begin(), entry->end());
  std::sort(contacts.begin(), contacts.end());
  contacts.erase(std::unique(contacts.begin(), contacts.end()), contacts.end());
  return contacts;
}

// Adds all that is to come of a repeating sequence. Integrals: the part of the limit velocity (or impulse) grows with the time that is
// left, the rest, quadratic in what shrinks, by the square of the factor.
void ImpactSequence::Workspace::sumTail(const BreakpointTail &tail, const std::vector<int> &contacts) {
  const int rowCount = count(), timeIndex = 3 * rowCount;
  const double factor = tail.factor(), square = factor * factor / (1 - factor * factor);
  const double left = tail.tail(timeIndex), last = tail.cycle(timeIndex);
  for (int r = 0; r < rowCount; ++r) {
    velocity[r] = std::binary_search(contacts.begin(), contacts.end(), r) ? 0 : velocity[r] + tail.tail(r);
    state.impulse[r] += tail.tail(rowCount + r);
    state.frozenImpulse[r] += tail.tail(2 * rowCount + r);
    const double integral = tail.cycle(timeIndex + 2 + n() + r);
    state.impulseMoment[r] += state.impulse[r] * left - (state.impulse[r] * last - integral) * square;
  }
  double quadraticLoss = tail.cycle(timeIndex + 2 + n() + rowCount);
  for (int r = 0; r < rowCount; ++r) {
    state.loss -= tail.tail(2 * rowCount + r) * velocity[r];
    quadraticLoss += tail.cycle(2 * rowCount + r) * velocity[r];
  }
  state.loss += quadraticLoss * square;
  for (int i = 0; i < n(); ++i)
    gap[i] = std::binary_search(contacts.begin(), contacts.end(), i)
                 ? 0
                 : gap[i] + velocity[i] * left - (velocity[i] * last - tail.cycle(timeIndex + 2 + i)) * square;
  state.time += left;
  state.tau += tail.tail(timeIndex + 1);
}

void ImpactSequence::Workspace::recordPoint(const std::vector<int> &contacts) {
  for (int j = 0; j < problem->tangentCount; ++j) {
    const int owner = problem->owner[j];
    if (owner >= 0 && gap[owner] == 0 && velocity[owner] == 0 && std::abs(velocity[n() + j]) <= 1e-9 * fastest)
      velocity[n() + j] = 0;
  }
  AccumulationPoint point = state;
  point.contacts = contacts;
  for (int j = 0; j < problem->tangentCount; ++j)
    if (const int owner = problem->owner[j];
        owner >= 0 && problem->friction[j] > 0 && gap[owner] == 0 && velocity[owner] == 0 && velocity[n() + j] == 0)
      point.sticking.push_back(j);
  points.push_back(std::move(point));
}

// Points whose contacts have opened again were the end of a part of the sequence only.
void ImpactSequence::Workspace::dropReopened() {
  std::erase_if(points, [this](const AccumulationPoint &point) {
    return std::any_of(point.contacts.begin(), point.contacts.end(), [this](int i) { return gap[i] > 0 || velocity[i] != 0; });
  });
}

// Sums the impacts where they repeat, and then the accumulations where these do: true.
bool ImpactSequence::Workspace::sumRepeating() {
  const auto contracts = [](BreakpointTail &tail) {
    return tail.repeats() && tail.factor() > 0 && tail.factor() < 1 - sequenceContraction;
  };
  if (!contracts(inner))
    return false;
  std::vector<int> contacts = ending(innerHits, inner.period());
  sumTail(inner, contacts);
  recordPoint(contacts);
  int symbol = 0;
  for (const int i : contacts)
    symbol = (31 * symbol + i + 1) % 1000003;
  addEntry(outer, outerStart, symbol);
  const bool isNested = contracts(outer);
  if (isNested) {
    contacts = ending(outerHits, outer.period());
    sumTail(outer, contacts);
    dropReopened();
    recordPoint(contacts);
    resetTail(outer);
    outerHits.clear();
    readValues(outerStart);
  }
  outerHits.emplace_back();
  resetTail(inner);
  innerHits.clear();
  readValues(start);
  return isNested;
}

// The impacts have become so slow that nothing is left to come.
void ImpactSequence::Workspace::endSlowest() {
  std::vector<int> contacts;
  for (int i = 0; i < n(); ++i)
    if (state.time - lastHit[i] <= recent * state.time)
      contacts.push_back(i);
  for (const int i : contacts)
    gap[i] = velocity[i] = 0;
  dropReopened();
  recordPoint(contacts);
}

ImpactSequence::ImpactSequence() : work_(std::make_unique<Workspace>()) {}
ImpactSequence::~ImpactSequence() = default;
ImpactSequence::ImpactSequence(ImpactSequence &&) noexcept = default;
ImpactSequence &ImpactSequence::operator=(ImpactSequence &&) noexcept = default;

const AccumulationPoint *ImpactSequence::follow(const SequenceProblem &problem, Accumulation wanted) {
  Workspace &w = *work_;
  w.begin(problem);
  for (int event = 0; event < eventLimit; ++event) {
    if (!w.findAccelerations())
      return nullptr;
    int row = -1;
    const double duration = w.nextEvent(row);
    // What happens later than all that has led to the point is a matter of another time.
    if (row < 0 || (wanted == Accumulation::OfImpacts && !w.points.empty() && duration > w.points.front().time))
      break;
    w.fly(duration, row);
    double approach = 0;
    for (int i = 0; i < w.n(); ++i)
      if (w.gap[i] == 0)
        approach = std::max(approach, -w.velocity[i]);
    if (approach > 0 && !w.freeze())
      return nullptr;
    w.dropReopened();
    w.addEntry(w.inner, w.start, row);
    if (w.sumRepeating() && wanted == Accumulation::OfAccumulations)
      return &w.points.back();
    w.innerHits.emplace_back();
    if (approach > 0 && approach < negligible * w.fastest) {
      w.endSlowest();
      break;
    }
  }
  return w.points.empty() || wanted == Accumulation::OfAccumulations ? nullptr : &w.points.front();
}

}  // namespace tf::runtime
