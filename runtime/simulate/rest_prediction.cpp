#include "runtime/simulate/rest_prediction.h"

#include "runtime/integrate/byte_flags.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace tf::runtime {

namespace {

// Impacts are followed one by one until they are this much slower than the fastest one, however well their end is known.
constexpr double slow = 3e-2;
// Slower bounces than this part of the fastest one are low, and those that are about as high as this part of the gap's scale.
constexpr double low = 1e-2, lowHeight = 1e-9;
// The next one is expected within so many times the interval between the last ones; and intervals that may be short, as a part of the run.
constexpr double intervals = 3, lowTime = 1e-3;
constexpr int firstImpacts = 3;
// Predictions from so much earlier would not be among the latest when the impacts are slow.
constexpr double early = 0.2;
// Without a prediction the next attempt is made after so many times the interval between the last impacts.
constexpr double shortestWait = 2, longestWait = 1e3;
// After a prediction of another point than the last one, or none, which happens again and again where impacts run through many contacts,
// so many impacts are let pass at most: of many contacts, a prediction of which costs as much as many impacts, the square of their number.
constexpr int shortestLimit = 15, longestLimit = 255;
// Impacts that end the hops within which others come to rest are few: these are let pass where there are many contacts only.
constexpr int shortestOuterLimit = 1;
// The next prediction is made when this share of the time is left: no usual coefficient of restitution, or rounding would decide.
constexpr double nextShare = 0.51;

}  // namespace

RestPrediction::RestPrediction(ModeDynamics &dynamics, ModeSelection &selection)
    : dynamics_(dynamics), at_(dynamics.model()), selection_(selection), ofImpacts_(dynamics.size(), at_.model().ns),
      ofAccumulations_(dynamics.size(), at_.model().ns), fastest_(at_.model().nc), last_(at_.model().nc), lastTime_(at_.model().nc),
      lastInterval_(at_.model().nc), lowUntil_(at_.model().nc), slowed_(at_.model().nc), change_(at_.model().nv), moment_(at_.model().nv),
      reach_(at_.model(), at_.scales), owner_(contactsOfTangents(at_.model())), roles_(rolesOfTangents(at_.model())) {
  reset(0);
}

void RestPrediction::reset(double time) {
  begin_ = time;
  std::fill(fastest_.begin(), fastest_.end(), 0.0);
  std::fill(last_.begin(), last_.end(), 0.0);
  impacts_ = 0;
  reach_.forget();
  restart();
}

void RestPrediction::restart() {
  ofImpacts_.restart();
  ofAccumulations_.restart();
  nearest_.clear();
  lastImpact_ = nextAttempt_ = -std::numeric_limits<double>::infinity();
  std::fill(lastTime_.begin(), lastTime_.end(), lastImpact_);
  std::fill(lastInterval_.begin(), lastInterval_.end(), std::numeric_limits<double>::infinity());
  std::fill(lowUntil_.begin(), lowUntil_.end(), lastImpact_);
  wait_ = shortestWait;
  pause_ = passed_ = outerPause_ = outerPassed_ = 0;
}

void RestPrediction::recordSwitch(int index) {
  ofImpacts_.recordSwitch(index);
  ofAccumulations_.recordSwitch(index);
}

void RestPrediction::write(double *numbers) const {
  std::copy(fastest_.begin(), fastest_.end(), numbers);
  numbers[fastest_.size()] = impacts_;
  numbers[fastest_.size() + 1] = begin_;
}

void RestPrediction::read(const double *numbers) {
  reset(numbers[fastest_.size() + 1]);
  std::copy_n(numbers, fastest_.size(), fastest_.begin());
  impacts_ = numbers[fastest_.size()];
}

// After recordImpact: slow, and sooner than the time before.
bool RestPrediction::slowsDown(const Approach &approach) const {
  return approach.speed <= early * fastest_[approach.contact] && slowed_[approach.contact] != 0;
}

// False where it is too early for a prediction.
bool RestPrediction::recordImpact(double time, const std::vector<Approach> &approaches) {
  // A contact whose bounces are shorter than those of others, in an accumulation within theirs, says nothing about these.
  bool slowed = false;
  const double *coordinates = at_.coordinates(), farthest = at_.scales.farthest(coordinates);
  for (const auto &[contact, speed] : approaches) {
    double &fastest = fastest_[contact];
    last_[contact] = speed;
    fastest = std::max(fastest, speed);
    const double own = std::isfinite(lastTime_[contact]) ? time - lastTime_[contact] : 0;
    // What has not come back within times that become shorter does not accumulate yet.
    slowed_[contact] = own > 0 && lastInterval_[contact] > own ? 1 : 0;
    slowed = slowed || slowsDown({contact, speed});
    lastInterval_[contact] = own > 0 ? own : lastInterval_[contact];
    // Nor do shorter bounces of its own about the longer ones that they follow.
    const bool isLow = speed <= low * fastest || (own > 0 && speed * own <= lowHeight * at_.scales.gap(contact, coordinates, farthest));
    lowUntil_[contact] = isLow ? std::max(lowUntil_[contact], time + intervals * own) : -std::numeric_limits<double>::infinity();
    lastTime_[contact] = time;
  }
  const double interval = time - lastImpact_;
  if (!std::isfinite(interval))
    firstImpact_ = time;
  lastImpact_ = time;
  return ++impacts_ >= firstImpacts && slowed && std::isfinite(interval);
}

bool RestPrediction::bouncesLow(double time) const {
  return std::any_of(lowUntil_.begin(), lowUntil_.end(), [time](double end) { return time <= end; });
}

// A body that rocks from one to the other: what has opened a short while ago closes again after about as long.
void RestPrediction::endBounces(double time, const std::vector<int> &contacts) {
  const double longest = lowTime * std::max(1.0, time - begin_);
  for (std::size_t i = 0; i < lowUntil_.size(); ++i) {
    const double since = time - lastTime_[i];
    if (std::binary_search(contacts.begin(), contacts.end(), static_cast<int>(i)))
      lowUntil_[i] = -std::numeric_limits<double>::infinity();
    else if (dynamics_.mode().closed[i] == 0 && last_[i] <= low * fastest_[i] && since <= longest)
      lowUntil_[i] = std::max(lowUntil_[i], time + intervals * since);
  }
}

// Contacts that touch or have bounced take part; others are added where they may close on the way.
void RestPrediction::chooseContacts(double time, const double *state) {
  const tf_model &model = at_.model();
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Gaps);
  takesPart_.assign(model.nc + model.nf, 1);
  for (int i = 0; i < model.nc; ++i)
    takesPart_[i] = last_[i] > 0 ? 1 : 0;
  // Closed contacts are awake.
  forEachSet(at_.screen().awake(), model.nc, [&](int i) {
    if (dynamics_.mode().closed[i] || at_.gap[i] <= selection_.closedGap(i, state))
      takesPart_[i] = 1;
  });
}

// True if contacts have been added to those that take part: at a few times the speeds that they have at the ends of the way they may close.
bool RestPrediction::addReachable(double time, const double *state, const RestPoint &end) {
  constexpr double fewTimes = 4;
  const double span = fewTimes * (end.time - time);
  if (reach_.isUsed())
    coverReach(time, state, end, span);
  bool added = false;
  // Last at the state, where the gaps of contacts that are asleep are to stay positive.
  for (const bool isEnd : {true, false}) {
    at_.setPoint(isEnd ? end.time : time, isEnd ? end.state.data() : state);
    at_.switching(ModelEvaluation::Gaps, reach_.awake());
    forEachSet(reach_.awake(), at_.model().nc, [&](int i) {
      if (takesPart_[i] || at_.gap[i] > span * std::abs(at_.gapRate[i]))
        return;
      takesPart_[i] = 1;
      added = true;
    });
  }
  return added;
}

// Contacts that cannot close within `span` of either end, at the velocities there, fall asleep in reach_.
void RestPrediction::coverReach(double time, const double *state, const RestPoint &end, double span) {
  const int nq = at_.model().nq;
  std::vector<double> least(state, state + nq), most = least, coordinateRate(nq);
  for (const bool isEnd : {false, true}) {
    const double *q = isEnd ? end.state.data() : state;
    at_.setPoint(isEnd ? end.time : time, q);
    at_.kinematics(coordinateRate.data());
    for (int k = 0; k < nq; ++k) {
      const double reach = span * std::abs(coordinateRate[k]);
      least[k] = std::min(least[k], q[k] - reach);
      most[k] = std::max(most[k], q[k] + reach);
    }
  }
  least.push_back(time);
  most.push_back(time + span);
  std::vector<double> center(least), radius(least);
  for (std::size_t k = 0; k < least.size(); ++k) {
    center[k] = 0.5 * (least[k] + most[k]);
    radius[k] = 0.5 * (most[k] - least[k]);
  }
  at_.cover(reach_, center.data(), radius.data());
}

// The contacts that take part and their tangential rows, with gaps and velocities at the state.
void RestPrediction::chooseRows(double time, const double *state) {
  const tf_model &model = at_.model();
  at_.setPoint(time, state);
  at_.contactTerms(takesPart_.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips, takesPart_.data());
  std::vector<int> contacts, tangents;
  forEachSet(takesPart_.data(), model.nc, [&contacts](int i) { contacts.push_back(i); });
  forEachTangent(model, contacts, [&](int j) {
    if (takesPartInImpacts(roles_[j]) && (owner_[j] < 0 || at_.friction[owner_[j]] > 0))
      tangents.push_back(j);
  });
  problem_.resize(static_cast<int>(contacts.size()), static_cast<int>(tangents.size()));
  rows_.choose(model, contacts, tangents, problem_);
  if (!isDisplaced_)
    classify(state);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const int i = contacts[k];
    problem_.gap[k] = touches_[k] ? 0 : at_.gap[i];
    problem_.velocity[k] = stands_[k] ? 0 : at_.gapRate[i];
    problem_.rate[k] = at_.rate[i];
    problem_.restitution[k] = at_.restitution[i];
    problem_.law[k] = static_cast<ImpactLaw>(model.contacts[i].law);
  }
  for (int j = 0; j < problem_.tangentCount; ++j)
    if (const int row = problem_.normalCount + j; problem_.partner[j] < 0)
      problem_.velocity[row] = stands_[row] ? 0 : at_.slip[tangents[j]];
    else if (problem_.partner[j] > j)
      choosePair(j);
}

// A slip of two components turns by O(T) until the point of rest: its friction lies along the slip, and none across. A pair that sticks
// does so in any frame, until the sequence lets one of its rows slip: that prediction does not agree with the next one.
void RestPrediction::choosePair(int j) {
  const int row = rows_.tangents()[j], first = problem_.normalCount + j;
  const double x = at_.slip[row], y = at_.slip[row + 1], speed = std::hypot(x, y);
  const bool slips = stands_[first] == 0 && speed > 0;
  problem_.slipSign[j] = problem_.slipSign[j + 1] = slips ? 1 : 0;
  if (slips)
    rows_.setFrame(j, x / speed, y / speed);
  problem_.velocity[first] = slips ? speed : 0;
  problem_.velocity[first + 1] = 0;
}

// What is zero at the state but for rounding.
void RestPrediction::classify(const double *state) {
  const Mode &mode = dynamics_.mode();
  const std::vector<int> &contacts = rows_.contacts(), &tangents = rows_.tangents();
  touches_.assign(contacts.size(), 0);
  stands_.assign(contacts.size() + tangents.size(), 0);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const int i = contacts[k];
    touches_[k] = mode.closed[i] || at_.gap[i] <= selection_.closedGap(i, state);
    stands_[k] = mode.closed[i] || (touches_[k] && std::abs(at_.gapRate[i]) <= selection_.stillRate(i, state));
  }
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    const int row = tangents[j], partner = problem_.partner[j];
    const double other = partner < 0 ? 0.0 : at_.slip[tangents[static_cast<std::size_t>(partner)]];
    const double speed = std::hypot(at_.slip[row], other);
    double still = selection_.stillSlip(row, state);
    if (partner >= 0)
      still = std::max(still, selection_.stillSlip(tangents[static_cast<std::size_t>(partner)], state));
    stands_[contacts.size() + j] = mode.tangent[row] == Tangent::Stick || speed <= still;
  }
}

// D at the positions of the state.
bool RestPrediction::evaluateDelassus(double time, const double *state) {
  at_.setPoint(time, state);
  if (!at_.dynamics())
    return false;
  at_.contactTerms(takesPart_.data());
  rows_.assemble(at_, problem_.delassus, problem_);
  return true;
}

// φ alone, at other velocities: D depends on none.
void RestPrediction::evaluateBias(double time, const std::vector<double> &state) {
  at_.setPoint(time, state.data());
  at_.forces();
  if (at_.model().nh > 0)
    at_.constraintRows();
  at_.contactTerms(takesPart_.data());
  rows_.gatherLimits(at_, problem_);
  at_.mobility.accelerate(at_.force.data(), at_.constraintBias.data(), at_.acceleration.data());
  rows_.bias(at_, at_.acceleration.data(), problem_.bias);
}

// Takes the velocities of the touching contacts, which vanish at the point of rest, out of the state: terms of φ that are quadratic in
// velocities are not those of the fast motion to and fro.
void RestPrediction::stopTouching(std::vector<double> &state) {
  std::vector<Eigen::Index> moving;
  for (int i = 0; i < problem_.normalCount; ++i)
    if (touches_[i])
      moving.push_back(i);
  for (int j = 0; j < problem_.tangentCount; ++j)
    if (const int owner = problem_.owner[j]; owner >= 0 && touches_[owner] && stands_[problem_.normalCount + j])
      moving.push_back(problem_.normalCount + j);
  Eigen::VectorXd stops(static_cast<Eigen::Index>(moving.size()));
  for (std::size_t k = 0; k < moving.size(); ++k)
    stops[static_cast<Eigen::Index>(k)] = -problem_.velocity[static_cast<std::size_t>(moving[k])];
  const Eigen::MatrixXd D = problem_.delassus.map()(moving, moving);
  const Eigen::VectorXd impulse = D.completeOrthogonalDecomposition().solve(stops);
  std::vector<double> impulses(problem_.count(), 0.0);
  for (std::size_t k = 0; k < moving.size(); ++k)
    impulses[moving[k]] = impulse(static_cast<Eigen::Index>(k));
  rows_.accelerate(impulses.data(), state.data() + at_.model().nq);
}

void RestPrediction::accumulate(const AccumulationPoint &end, RestPoint &point) const {
  const int nc = at_.model().nc;
  point.accumulated.assign(nc + 2, 0.0);
  for (int k = 0; k < rows_.normalCount(); ++k)
    point.accumulated[rows_.contacts()[k]] = end.frozenImpulse[k];
  point.accumulated[nc] = end.loss;
  for (int r = rows_.normalCount(); r < rows_.count(); ++r)
    point.accumulated[nc + 1] -= (end.impulse[r] - end.frozenImpulse[r]) * problem_.velocity[r];
}

// Where the sequence with constant coefficients leads: v' = W f + W Jᵀ λ with W, J and f constant; positions move with the mean velocity.
bool RestPrediction::moveTo(const AccumulationPoint &end, double time, const double *state, RestPoint &point) {
  const tf_model &model = at_.model();
  const double remaining = end.time;
  point.time = time + remaining;
  point.contacts.clear();
  for (const int row : end.contacts)
    point.contacts.push_back(rows_.contacts()[row]);
  point.sticking.clear();
  // A slip along its direction ends with both components; of a pair that sticks both rows must.
  for (const int j : end.sticking) {
    const int partner = problem_.partner[j];
    const bool other = partner < 0 || problem_.slipSign[j] != 0 || std::binary_search(end.sticking.begin(), end.sticking.end(), partner);
    if (!other || (partner >= 0 && partner < j))
      continue;
    point.sticking.push_back(rows_.tangents()[j]);
    if (partner >= 0)
      point.sticking.push_back(rows_.tangents()[partner]);
  }
  accumulate(end, point);
  point.state.assign(state, state + dynamics_.size());
  std::fill(change_.begin(), change_.end(), 0.0);
  std::fill(moment_.begin(), moment_.end(), 0.0);
  rows_.accelerate(end.impulse.data(), change_.data());
  rows_.accelerate(end.impulseMoment.data(), moment_.data());
  for (int i = 0; i < model.nv; ++i) {
    const double velocity = state[model.nq + i];
    point.state[model.nq + i] += at_.acceleration[i] * remaining + change_[i];
    moment_[i] += (velocity + 0.5 * at_.acceleration[i] * remaining) * remaining;
  }
  for (int i = 0; i < model.nz; ++i)
    point.state[model.nq + model.nv + i] += at_.stateRate[i] * remaining;
  point.state[at_.tauIndex()] += end.tau;
  at_.setPoint(time, state);
  at_.moveCoordinates(point.state.data(), moment_.data());
  return std::all_of(point.state.begin(), point.state.end(), [](double y) { return std::isfinite(y); });
}

bool RestPrediction::predict(double time, const double *state, RestEstimate &estimate) {
  if (!isDisplaced_)
    chooseContacts(time, state);
  const auto addsReachable = [&] { return !isDisplaced_ && addReachable(time, state, estimate.point); };
  while (predictWithChosen(time, state, estimate))
    if (!addsReachable()) {
      if (!refine(time, state, estimate))
        return false;
      if (!addsReachable())
        return true;
    }
  return false;
}

// The point of rest with the coefficients of this instant.
bool RestPrediction::predictWithChosen(double time, const double *state, RestEstimate &estimate) {
  chooseRows(time, state);
  if (!evaluateDelassus(time, state))
    return false;
  std::vector<double> coefficients(state, state + dynamics_.size());
  stopTouching(coefficients);
  return follow(coefficients, time, state, estimate);
}

// With the velocities that the last estimate leaves at its end.
bool RestPrediction::refine(double time, const double *state, RestEstimate &estimate) {
  const int nq = at_.model().nq, nv = at_.model().nv;
  std::vector<double> coefficients(state, state + dynamics_.size());
  std::copy_n(estimate.point.state.begin() + nq, nv, coefficients.begin() + nq);
  return follow(coefficients, time, state, estimate);
}

// To where the sequence leads with φ of the state `coefficients`.
bool RestPrediction::follow(const std::vector<double> &coefficients, double time, const double *state, RestEstimate &estimate) {
  evaluateBias(time, coefficients);
  const AccumulationPoint *end = sequence_.follow(problem_, wanted_);
  if (end == nullptr || !(end->time > 0) || !moveTo(*end, time, state, estimate.point))
    return false;
  estimate.remaining = end->time;
  return true;
}

// How the estimate moves with the sensitivities; false where it ends in another way nearby.
bool RestPrediction::differentiate(double time, const double *state, Sensitivities &sensitivities, RestEstimate &estimate) {
  const int n = sensitivities.size(), count = n + 2;
  RestEstimate displaced;
  const auto values = [&](double at, double *point, double *result) {
    if (!predict(at, point, displaced) || displaced.point.contacts != estimate.point.contacts ||
        displaced.point.sticking != estimate.point.sticking)
      return false;
    std::copy_n(displaced.point.state.begin(), n, result);
    result[n] = displaced.point.time;
    result[n + 1] = displaced.remaining;
    return true;
  };
  estimate.derivatives.resize(static_cast<std::size_t>(count) * sensitivities.columnCount());
  isDisplaced_ = true;
  bool isGood = true;
  for (int column = 0; column < sensitivities.columnCount() && isGood; ++column)
    isGood = sensitivities.differentiate(values, time, state, column, count,
                                         estimate.derivatives.data() + static_cast<std::ptrdiff_t>(count) * column);
  isDisplaced_ = false;
  return isGood;
}

int RestPrediction::longerPause(int pause, int limit) const {
  const int contacts = rows_.normalCount();
  return std::min(2 * pause + 1, std::clamp(contacts * contacts * limit / shortestLimit, limit, longestLimit));
}

// Times are as exact as a part of the run, and of some times the impacts' duration.
double RestPrediction::timeScale() const {
  constexpr double sometimes = 10;
  return std::min(std::max(1.0, lastImpact_ - begin_), sometimes * (lastImpact_ - firstImpact_));
}

bool RestPrediction::isSlow(const RestPoint &point) const {
  return std::all_of(point.contacts.begin(), point.contacts.end(),
                     [this](int i) { return last_[i] > 0 && last_[i] <= slow * fastest_[i]; });
}

// No other contact has closed and no switch has changed at the point, but for those that do on the way again and again.
bool RestPrediction::nothingElseHappens(const RestSeries &series) {
  const tf_model &model = at_.model();
  const RestPoint &point = series.point();
  at_.setPoint(point.time, point.state.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Conditions);
  for (int i = 0; i < model.nc; ++i)
    if (!std::binary_search(point.contacts.begin(), point.contacts.end(), i) && !dynamics_.mode().closed[i] && at_.gap[i] < 0)
      return false;
  for (int j = 0; j < model.ns; ++j)
    if (const Switch side = dynamics_.mode().switches[j]; model.switches[j].kind != TF_SWITCH_REST && side != Switch::Sliding &&
                                                          !series.alternates(j) && (at_.condition[j] > 0) != (side == Switch::One))
      return false;
  return true;
}

// What the duration of a bounce is wrong by, at both of its ends, because gaps are no better than the coordinates that they are differences
// of.
double RestPrediction::timeByRounding(const std::vector<Approach> &approaches) const {
  constexpr double largest = 1e-12;
  const double *coordinates = at_.coordinates(), farthest = at_.scales.farthest(coordinates);
  double longest = 0;
  for (const auto &[contact, speed] : approaches)
    if (speed > 0)
      longest = std::max(
          longest,
          std::min(std::numeric_limits<double>::epsilon() * farthest, largest * at_.scales.gap(contact, coordinates, farthest)) / speed);
  return 2 * longest;
}

const RestPoint *RestPrediction::afterImpact(double time, const std::vector<Approach> &approaches, const double *state,
                                             const std::vector<double> &accumulated, double tolerance, const double *scale,
                                             Sensitivities *sensitivities) {
  const LastImpact impact = {time, lastImpact_, approaches, state, accumulated, tolerance, scale, sensitivities};
  if (!recordImpact(time, approaches))
    return nullptr;
  if (time >= nextAttempt_ && ++passed_ > pause_)
    if (const RestPoint *point = afterImpacts(impact); point != nullptr)
      return point;
  return afterAccumulations(impact);
}

bool RestPrediction::makeEstimate(const LastImpact &impact, Accumulation wanted, RestEstimate &estimate) {
  wanted_ = wanted;
  if (!predict(impact.time, impact.state, estimate) ||
      (impact.sensitivities != nullptr && !differentiate(impact.time, impact.state, *impact.sensitivities, estimate)))
    return false;
  estimate.totals.resize(impact.accumulated.size());
  std::ranges::transform(impact.accumulated, estimate.point.accumulated, estimate.totals.begin(), std::plus());
  return true;
}

const RestPoint *RestPrediction::afterImpacts(const LastImpact &impact) {
  passed_ = 0;
  const double coarseness = timeByRounding(impact.approaches);
  RestEstimate nearest;
  if (!makeEstimate(impact, Accumulation::OfImpacts, nearest)) {
    ofImpacts_.forget();
    nearest_.clear();
    // Impacts of many contacts may go on for long without a repeating sequence, which is costly to find out.
    pause_ = longerPause(pause_, shortestLimit);
    wait_ = std::min(2 * wait_, longestWait);
    nextAttempt_ = impact.time + wait_ * (impact.time - impact.previous);
    return nullptr;
  }
  nearest_ = nearest.point.contacts;
  wait_ = shortestWait;
  // Where switches change on the way, as many times less time may be left as the prediction is wrong by.
  nextAttempt_ = ofImpacts_.alternates() ? impact.time : impact.time + (1 - nextShare) * nearest.remaining;
  if (ofImpacts_.alternates() && !ofImpacts_.isWanted(nearest.remaining))
    return nullptr;
  // Times and gaps are resolved to rounding, and speeds with them: those of so many impacts as are about the size of those that come add up
  // like a random walk, and the time that is left is their number times that between two.
  const double number = nearest.remaining / (impact.time - impact.previous);
  const double resolved = number * std::sqrt(number) * std::max(std::numeric_limits<double>::epsilon(), coarseness / timeScale());
  const bool isFirst = ofImpacts_.isEmpty(), isOther = ofImpacts_.add(std::move(nearest));
  if (!isFirst)
    pause_ = isOther ? longerPause(pause_, shortestLimit) : 0;
  const RestPoint *point = pointOf(ofImpacts_, impact, resolved);
  if (point != nullptr)
    pause_ = 0;
  return point;
}

// An impact of a contact that bounces lower and lower, but not to the rest that comes next: others come to rest within its hops.
const RestPoint *RestPrediction::afterAccumulations(const LastImpact &impact) {
  const auto goesOn = [this](const Approach &approach) {
    return slowsDown(approach) && !std::binary_search(nearest_.begin(), nearest_.end(), approach.contact);
  };
  if (nearest_.empty() || std::none_of(impact.approaches.begin(), impact.approaches.end(), goesOn) || ++outerPassed_ <= outerPause_)
    return nullptr;
  outerPassed_ = 0;
  RestEstimate outer;
  if (!makeEstimate(impact, Accumulation::OfAccumulations, outer)) {
    ofAccumulations_.forget();
    outerPause_ = longerPause(outerPause_, shortestOuterLimit);
    return nullptr;
  }
  if (!ofAccumulations_.isWanted(outer.remaining))
    return nullptr;
  outerPause_ = ofAccumulations_.add(std::move(outer)) ? longerPause(outerPause_, shortestOuterLimit) : 0;
  return pointOf(ofAccumulations_, impact, std::numeric_limits<double>::epsilon());
}

// Of a series, where it is known well enough and the impacts are slow; `resolved`: no better, relative to the time scale.
const RestPoint *RestPrediction::pointOf(RestSeries &series, const LastImpact &impact, double resolved) {
  if (!series.extrapolate(std::max(impact.tolerance, resolved), impact.scale, timeScale()) || !(series.point().time > impact.time) ||
      !isSlow(series.point()) || !nothingElseHappens(series))
    return nullptr;
  if (impact.sensitivities != nullptr && !series.derivativesAgree(impact.tolerance, impact.sensitivities->columnCount()))
    return nullptr;
  return &series.point();
}

}  // namespace tf::runtime
