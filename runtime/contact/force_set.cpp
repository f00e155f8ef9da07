#include "runtime/contact/force_set.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/null_space.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tf::runtime {

namespace {

// Redundant rows leave pivots of rounding size; smaller ones than this, with the diagonal of D scaled to 1, count as such.
constexpr double singularMode = 1e-8;
// Accepted contradiction between redundant rows: contacts that close a mechanism's last freedom do so within the accuracy of positions.
constexpr double redundantResidual = 1e-6;
// An active constraint depends on others where what they leave of its normal is shorter than this, relative to its length.
constexpr double activeDependence = 1e-13;
// Where a conic set has no more width than that, relative to the force scale, its innermost point is as good as the least-norm one.
constexpr double leastWidth = 1e-9;

}  // namespace

void ForceSet::view(const ContactProblem &problem) {
  load_ = problem.load;
  const int m = problem.tangentCount;
  offset_.resize(m);
  for (int j = 0; j < m; ++j)
    offset_[j] = problem.owner[j] < 0 ? problem.bound[j] : 0.0;
  rows_ = {problem.normalCount, m, &problem.delassus, problem.bias.data(), problem.owner.data(), problem.friction.data(), offset_.data()};
}

void ForceSet::setMode(const ContactProblem &problem, const ContactMode &mode) {
  const int n = problem.normalCount, m = problem.tangentCount;
  view(problem);
  active_.resize(n + m);
  slip_.resize(m);
  fixed_.assign(n, 0.0);
  limits_.clear();
  conic_ = false;
  reference_.clear();
  cone_.forget();
  for (int i = 0; i < n; ++i) {
    active_[i] = mode.closed[i];
    if (mode.closed[i])
      limits_.push_back({i, 0});
  }
  for (int j = 0; j < m; ++j) {
    const int owner = problem.owner[j];
    const bool loaded = owner < 0 || mode.closed[owner];
    slip_[j] = loaded ? mode.slip[j] : std::int8_t{0};
    active_[n + j] = loaded && mode.slip[j] == 0 ? 1 : 0;
    if (active_[n + j] && problem.partner[j] >= 0) {
      conic_ = true;
      if (problem.partner[j] > j)
        limits_.push_back({n + j, ForceLimit::disk});
    } else if (active_[n + j]) {
      limits_.push_back({n + j, 1});
      limits_.push_back({n + j, -1});
    }
  }
  equations_.setMode(rows_, active_.data(), slip_.data());
  unknown_.resize(equations_.activeCount());
  forces_.resize(n + m);
  accelerations_.resize(n + m);
  hasMode_ = true;
  leastNormTolerance_ = std::numeric_limits<double>::infinity();
}

bool ForceSet::hasMode(const ContactProblem &problem, const ContactMode &mode) const {
  if (!hasMode_ || active_.size() != mode.closed.size() + mode.slip.size() || slip_.size() != mode.slip.size())
    return false;
  // Rows of open contacts stick, without force.
  for (std::size_t j = 0; j < slip_.size(); ++j)
    if (const int owner = problem.owner[j]; slip_[j] != (owner < 0 || mode.closed[owner] != 0 ? mode.slip[j] : 0))
      return false;
  return std::equal(mode.closed.begin(), mode.closed.end(), active_.begin());
}

bool ForceSet::singular(const ContactProblem &problem) {
  view(problem);
  equations_.assemble(rows_, factor_.matrix());
  DenseMatrix &A = factor_.matrix();
  const std::vector<int> &active = equations_.active();
  unknown_.resize(active.size());
  for (std::size_t k = 0; k < active.size(); ++k) {
    const double diagonal = problem.delassus(active[k], active[k]);
    unknown_[k] = diagonal > 0 ? 1 / std::sqrt(diagonal) : 1.0;
  }
  for (int c = 0; c < A.cols(); ++c)
    for (int r = 0; r < A.rows(); ++r)
      A(r, c) *= unknown_[r] * unknown_[c];
  // With partial pivoting two pivots are the singular values of two rows but for a factor near 1.
  singular_ = !factor_.factor(singularMode) || (A.rows() > 2 && factor_.leastSingularValue() <= singularMode);
  return singular_;
}

// Forces λ = E x with A x = 0 are those by which shares differ: they accelerate no active row, and perhaps none of the others.
bool ForceSet::sharesMove(const ContactProblem &problem) {
  constexpr double dependent = 1e-9, visible = 1e-9;
  view(problem);
  const int k = activeCount(), n = rows_.normalCount, m = rows_.tangentCount;
  equations_.assemble(rows_, matrix_);
  partition_.find(matrix_.data(), k);
  const auto matrix = matrix_.map();
  const auto delassus = rows_.delassus->map();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
  factor.setThreshold(dependent);
  Eigen::MatrixXd kernel, accelerations;
  double largest = 0;
  for (std::size_t part = 0; part < partition_.count(); ++part) {
    const std::span<const int> places = partition_.rows(part);
    factor.compute(matrix(places, places).transpose());
    findNullSpace(factor, kernel);
    if (kernel.cols() == 0)
      continue;
    accelerations.setZero(n + m, kernel.cols());
    for (std::size_t c = 0; c < places.size(); ++c)
      accelerations += delassus.col(equations_.active()[places[c]]) * kernel.row(static_cast<Eigen::Index>(c));
    for (int j = 0; j < m; ++j) {
      const int owner = rows_.owner[j] >= 0 && equations_.position(n + j) < 0 ? equations_.position(rows_.owner[j]) : -1;
      if (const auto place = std::lower_bound(places.begin(), places.end(), owner); place != places.end() && *place == owner)
        accelerations += equations_.slipFactor(rows_, j) * delassus.col(n + j) * kernel.row(place - places.begin());
    }
    largest = std::max(largest, accelerations.cwiseAbs().maxCoeff());
  }
  return largest > 0 && largest > visible * delassus.cwiseAbs().maxCoeff();
}

bool ForceSet::listEquations(std::vector<int> &rows, std::vector<ForceLimit> &saturated) const {
  saturated.clear();
  if (!singular_) {
    rows = equations_.active();
    return true;
  }
  if (conic_ || !reference_.empty())
    return false;
  rows.clear();
  for (const int constraint : polyhedron_.active())
    if (constraint < activeCount())
      rows.push_back(equations_.active()[constraint]);
    else
      saturated.push_back(limits_[constraint - activeCount()]);
  return true;
}

// Of equal rows the least-norm forces are equal but for the multipliers of their limits.
void ForceSet::take(const ContactProblem &problem, const std::vector<double> &forces, const std::vector<double> &rest,
                    const std::vector<double> &shares) {
  view(problem);
  forces_ = forces;
  isTaken_ = true;
  takenContradiction_ = 0;
  if (!singular_)
    return;
  for (const int r : dependent_)
    takenContradiction_ = std::max(takenContradiction_, std::abs(rest[equations_.active()[r]]) / (length_[r] * forceScale_));
  takenMultiplier_.resize(limits_.size());
  findWeights();
  for (const int constraint : polyhedron_.active())
    if (const int l = constraint - activeCount(); l >= 0)
      takenMultiplier_[l] = limits_[l].side * (shares[limits_[l].row] - forces[limits_[l].row]) * limitRow(l).length;
}

bool ForceSet::solveRegular(const ContactProblem &problem) {
  view(problem);
  isTaken_ = false;
  equations_.assemble(rows_, factor_.matrix());
  if (!factor_.factor(0))
    return false;
  equations_.rightHandSide(rows_, fixed_.data(), unknown_.data());
  factor_.solve(unknown_.data());
  equations_.expandForces(rows_, unknown_.data(), forces_.data());
  for (const double f : forces_)
    if (!std::isfinite(f))
      return false;
  return true;
}

bool ForceSet::solveUnique(const ContactProblem &problem, double tolerance) {
  if (!solveRegular(problem))
    return false;
  double largestForce = 0, largestBias = 0;
  for (const double force : forces_)
    largestForce = std::max(largestForce, std::abs(force));
  for (int k = 0; k < static_cast<int>(limits_.size()); ++k)
    if (!(slack(problem, k) >= -tolerance * largestForce))
      return false;
  for (const int row : equations_.active())
    largestBias = std::max(largestBias, std::abs(rows_.bias[row]));
  const int count = rows_.normalCount + rows_.tangentCount;
  return std::all_of(equations_.active().begin(), equations_.active().end(), [&](int row) {
    return std::abs(rows_.bias[row] + denseDot(rows_.delassus->column(row), forces_.data(), count)) <= redundantResidual * largestBias;
  });
}

bool ForceSet::solveNearlyDependent(const ContactProblem &problem, const std::vector<double> *known, double tolerance) {
  if (conic_)
    return false;
  singular_ = !solveUnique(problem, tolerance);
  if (!singular_ || known == nullptr)
    return !singular_;
  reference_.clear();
  for (const int row : equations_.active())
    reference_.push_back((*known)[row]);
  const bool isFound = solveLeastNorm(problem, tolerance) == LeastNorm::Status::Solved;
  if (!isFound)
    reference_.clear();
  return isFound;
}

// ‖λ‖² = Σ weight² x² + constant: a normal force takes its friction along.
void ForceSet::findWeights() {
  const int k = activeCount();
  weight_.assign(k, 1.0);
  for (int j = 0; j < rows_.tangentCount; ++j) {
    const int owner = rows_.owner[j];
    if (owner < 0 || equations_.position(owner) < 0)
      continue;
    const double factor = equations_.slipFactor(rows_, j);
    weight_[equations_.position(owner)] += factor * factor;
  }
  inverseWeight_.resize(k);
  for (int c = 0; c < k; ++c) {
    weight_[c] = std::sqrt(weight_[c]);
    inverseWeight_[c] = 1 / weight_[c];
  }
}

// A x = rhs in y = weight·x.
void ForceSet::weighEquations() {
  equations_.rightHandSide(rows_, fixed_.data(), unknown_.data());
  findWeights();
}

// Of the reference, where the normal has the entries `normal` for weighted unknowns.
double ForceSet::atReference(const double *normal) const {
  double sum = 0;
  for (std::size_t c = 0; c < reference_.size(); ++c)
    sum += normal[c] * weight_[c] * reference_[c];
  return sum;
}

// Divided by the length of the row.
void ForceSet::loadEquation(int r) {
  const int k = activeCount();
  double *normal = polyhedron_.normal(r);
  equations_.assembleRow(rows_, r, normal);
  for (int c = 0; c < k; ++c)
    normal[c] *= inverseWeight_[c];
  const double squares = denseDot(normal, normal, k);
  length_[r] = squares > 0 ? std::sqrt(squares) : 1.0;
  const double inverse = 1 / length_[r];
  for (int c = 0; c < k; ++c)
    normal[c] *= inverse;
  polyhedron_.bound(r) = unknown_[r] / length_[r] - atReference(normal);
}

// Of unit length.
ForceSet::LimitRow ForceSet::limitRow(int l) const {
  const int n = rows_.normalCount;
  const ForceLimit &side = limits_[l];
  LimitRow limit;
  limit.own = equations_.position(side.row);
  limit.length = inverseWeight_[limit.own];
  limit.ownEntry = side.side == 0 ? limit.length : -side.side * limit.length;
  if (side.side != 0) {
    const int j = side.row - n, owner = rows_.owner[j];
    if (owner >= 0) {
      limit.owner = equations_.position(owner);
      limit.ownerEntry = rows_.friction[j] * inverseWeight_[limit.owner];
      limit.length = std::hypot(limit.length, limit.ownerEntry);
    } else {
      limit.bound = -offset_[j];
    }
  }
  limit.ownEntry /= limit.length;
  limit.ownerEntry /= limit.length;
  limit.bound /= limit.length;
  return limit;
}

void ForceSet::loadLimit(int l) {
  const int k = activeCount();
  double *normal = polyhedron_.normal(k + l);
  std::fill_n(normal, k, 0.0);
  const LimitRow limit = limitRow(l);
  normal[limit.own] = limit.ownEntry;
  if (limit.owner >= 0)
    normal[limit.owner] = limit.ownerEntry;
  polyhedron_.bound(k + l) = limit.bound - atReference(normal);
  length_[k + l] = limit.length;
}

// The least force that is compared with others: in free fall φ is what rounding leaves of loads that cancel, and its forces are none.
double ForceSet::weightlessForce() const {
  constexpr double weightless = 1e-6;
  double force = 0;
  for (const int row : equations_.active())
    if (const double response = (*rows_.delassus)(row, row); response > 0)
      force = std::max(force, weightless * load_ / std::sqrt(response));
  return force;
}

double ForceSet::largestLoad() const {
  double force = weightlessForce();
  for (const int row : equations_.active())
    if (const double response = (*rows_.delassus)(row, row); response > 0)
      force = std::max(force, std::abs(rows_.bias[row]) / response);
  return force;
}

void ForceSet::loadPolyhedron() {
  const int k = activeCount(), limits = static_cast<int>(limits_.size());
  polyhedron_.resize(k, k, limits);
  length_.resize(k + limits_.size());
  weighEquations();
  for (int r = 0; r < k; ++r)
    loadEquation(r);
  for (int l = 0; l < limits; ++l)
    loadLimit(l);
  forceScale_ = 0;
  for (int r = 0; r < k; ++r)
    forceScale_ = std::max(forceScale_, std::abs(unknown_[r]) / length_[r]);
  for (int j = 0; j < rows_.tangentCount; ++j)
    if (equations_.position(rows_.normalCount + j) >= 0)
      forceScale_ = std::max(forceScale_, rows_.offset[j]);
  for (const double force : reference_)
    forceScale_ = std::max(forceScale_, std::abs(force));
  forceScale_ = std::max(forceScale_, weightlessForce());
  if (!(forceScale_ > 0))
    forceScale_ = 1;
}

void ForceSet::expandPoint(const double *point) {
  for (int k = 0; k < activeCount(); ++k)
    unknown_[k] = point[k] / weight_[k] + (reference_.empty() ? 0 : reference_[k]);
  equations_.expandForces(rows_, unknown_.data(), forces_.data());
}

LeastNorm::Status ForceSet::solveConic(const ContactProblem &problem, double tolerance) {
  view(problem);
  if (!prepareConic())
    return LeastNorm::Status::Contradictory;
  inside_ = cone_.smallestSlack(cone_.freePoint()) >= -tolerance * forceScale_;
  if (inside_)
    expandPoint(cone_.freePoint().data());
  else
    confineConic();
  return inside_ || commonSlack_ >= -tolerance * forceScale_ ? LeastNorm::Status::Solved : LeastNorm::Status::Empty;
}

LeastNorm::Status ForceSet::solvePolyhedron(const ContactProblem &problem, double tolerance) {
  view(problem);
  hasFar_ = false;
  loadPolyhedron();
  const LeastNorm::Status status = polyhedron_.solve(tolerance * forceScale_, redundantResidual * forceScale_);
  dependent_.clear();
  for (int r = 0; r < activeCount(); ++r)
    if (const std::vector<int> &active = polyhedron_.active(); std::find(active.begin(), active.end(), r) == active.end())
      dependent_.push_back(r);
  expandPoint(polyhedron_.point().data());
  return status;
}

void ForceSet::loadConic() {
  const int k = activeCount();
  hasInnermost_ = false;
  weighEquations();
  equations_.assemble(rows_, matrix_);
  cone_.resize(k, static_cast<int>(limits_.size()));
  for (int c = 0; c < k; ++c) {
    for (int r = 0; r < k; ++r)
      cone_.matrix()(r, c) = matrix_(r, c) / weight_[c];
    cone_.rhs()[c] = unknown_[c];
  }
  for (std::size_t l = 0; l < limits_.size(); ++l) {
    ConicForces::Limit &limit = cone_.limit(static_cast<int>(l));
    limit = {};
    const ForceLimit &side = limits_[l];
    const int own = equations_.position(side.row);
    if (side.side == 0) {
      limit.apex = own;
      limit.factor = 1 / weight_[own];
      continue;
    }
    const int j = side.row - rows_.normalCount, owner = rows_.owner[j];
    limit.first = own;
    limit.second = side.side == ForceLimit::disk ? equations_.position(side.row + 1) : -1;
    limit.offset = offset_[j];
    if (owner >= 0) {
      limit.apex = equations_.position(owner);
      limit.factor = rows_.friction[j] / weight_[limit.apex];
    }
  }
}

// The equations alone have been solved then. False: they contradict one another.
bool ForceSet::prepareConic() {
  loadConic();
  const bool areConsistent = cone_.prepare(redundantResidual, weightlessForce());
  forceScale_ = cone_.scale();
  length_.resize(static_cast<std::size_t>(activeCount()));
  for (int r = 0; r < activeCount(); ++r)
    length_[r] = cone_.rowLength(r);
  return areConsistent;
}

void ForceSet::confineConic() {
  findInnermost();
  expandPoint(commonSlack_ > leastWidth * forceScale_ ? cone_.leastNorm().data() : cone_.innermost().data());
}

// As confineConic, from the last point.
void ForceSet::followConic() {
  constexpr double thin = 1e-3;
  // By the slack of the last point, unless the set is about to vanish.
  if (commonSlack_ <= thin * forceScale_)
    findInnermost();
  const Eigen::VectorXd *least = commonSlack_ > leastWidth * forceScale_ ? cone_.followLeastNorm() : nullptr;
  if (least != nullptr)
    expandPoint(least->data());
  else
    confineConic();
}

void ForceSet::findInnermost() {
  if (!hasInnermost_)
    commonSlack_ = cone_.largestSlack();
  hasInnermost_ = true;
}

LeastNorm::Status ForceSet::confine(const ContactProblem &problem, double tolerance) {
  view(problem);
  inside_ = false;
  confineConic();
  return commonSlack_ > tolerance * forceScale_ ? LeastNorm::Status::Solved : LeastNorm::Status::Empty;
}

int ForceSet::conicSaturated(int k) const {
  const ForceLimit &side = limits_[k];
  const int j = side.row - rows_.normalCount;
  double force = forces_[side.row], limit = 0;
  if (side.side != 0) {
    limit = rows_.offset[j] + (rows_.owner[j] >= 0 ? rows_.friction[j] * forces_[rows_.owner[j]] : 0.0);
    force = limit - (side.side == ForceLimit::disk ? std::hypot(force, forces_[side.row + 1]) : std::abs(force));
  }
  return force <= 1e-9 * forceScale_ ? k : -1;
}

bool ForceSet::solveActive(const ContactProblem &problem) {
  view(problem);
  isTaken_ = false;
  if (conic_) {
    if (!prepareConic())
      return false;
    if (inside_)
      expandPoint(cone_.freePoint().data());
    else
      followConic();
    return true;
  }
  weighEquations();
  hasEqualShares_ = chooseShares();
  if (hasEqualShares_)
    return solveEqualShares();
  loadActive();
  const bool independent = polyhedron_.solveActive();
  if (independent)
    expandPoint(polyhedron_.point().data());
  return independent;
}

// The polyhedron's data, where others have given the forces. False: its active constraints depend on each other.
bool ForceSet::solveAll() {
  if (!hasEqualShares_)
    return true;
  hasEqualShares_ = false;
  weighEquations();
  loadActive();
  return polyhedron_.solveActive();
}

// Friction that a normal force takes along, and limits, tell unknowns apart.
bool ForceSet::chooseShares() {
  const int k = activeCount(), n = rows_.normalCount;
  if (!reference_.empty())
    return false;
  isAlone_.assign(k, 0);
  loads_.clear();
  for (int j = 0; j < rows_.tangentCount; ++j) {
    const int owner = rows_.owner[j], position = owner >= 0 ? equations_.position(owner) : -1;
    const double factor = equations_.slipFactor(rows_, j);
    if (position < 0 || factor == 0)
      continue;
    isAlone_[position] = 1;
    loads_.push_back({position, n + j, factor * inverseWeight_[position]});
  }
  for (const int constraint : polyhedron_.active()) {
    if (constraint < k)
      continue;
    const int row = limits_[constraint - k].row, owner = row < n ? -1 : rows_.owner[row - n];
    isAlone_[equations_.position(row)] = 1;
    if (owner >= 0)
      isAlone_[equations_.position(owner)] = 1;
  }
  return equalShares_.choose(*rows_.delassus, equations_.active(), isAlone_, static_cast<int>(polyhedron_.active().size()));
}

bool ForceSet::solveEqualShares() {
  loadShares();
  if (!equalShares_.solve(activeDependence))
    return false;
  for (int c = 0; c < activeCount(); ++c)
    unknown_[c] = equalShares_.share(equalShares_.set()[c]) * inverseWeight_[c];
  equations_.expandForces(rows_, unknown_.data(), forces_.data());
  return true;
}

// As loadEquation and loadLimit, by sets.
void ForceSet::loadShares() {
  const int k = activeCount(), sets = equalShares_.count();
  setRow_.resize(sets);
  setFactor_.resize(sets);
  for (int s = 0; s < sets; ++s) {
    const int sample = equalShares_.sample(s);
    setRow_[s] = equations_.active()[sample];
    setFactor_[s] = equalShares_.root(s) * inverseWeight_[sample];
  }
  for (int c = 0; c < sets; ++c) {
    const int constraint = polyhedron_.active()[c];
    double *normal = equalShares_.normal(c);
    if (constraint >= k) {
      const LimitRow limit = limitRow(constraint - k);
      std::fill_n(normal, sets, 0.0);
      normal[equalShares_.set()[limit.own]] = limit.ownEntry;
      if (limit.owner >= 0)
        normal[equalShares_.set()[limit.owner]] = limit.ownerEntry;
      equalShares_.bound(c) = limit.bound;
      continue;
    }
    const double *row = rows_.delassus->column(equations_.active()[constraint]);
    for (int s = 0; s < sets; ++s)
      normal[s] = row[setRow_[s]] * setFactor_[s];
    for (const Loaded &load : loads_)
      normal[equalShares_.set()[load.unknown]] += row[load.row] * load.factor;
    const double squares = denseDot(normal, normal, sets), inverse = squares > 0 ? 1 / std::sqrt(squares) : 1.0;
    for (int s = 0; s < sets; ++s)
      normal[s] *= inverse;
    equalShares_.bound(c) = unknown_[constraint] * inverse;
  }
}

// What the active constraints need only, after weighEquations; their number and order are those of the last loadPolyhedron.
void ForceSet::loadActive() {
  const int k = activeCount();
  for (const int constraint : polyhedron_.active())
    if (constraint < k)
      loadEquation(constraint);
    else
      loadLimit(constraint - k);
}

// What is left of the accelerations of dependent rows, by the lengths that these had when the set was chosen.
double ForceSet::contradiction() const {
  if (isTaken_)
    return takenContradiction_;
  double worst = 0;
  for (const int r : dependent_) {
    const int row = equations_.active()[r];
    // A row that is equal to one which holds as an equation differs from it by its bias.
    const int other = hasEqualShares_ ? equalShares_.sample(equalShares_.set()[r]) : r;
    const bool follows = other != r && !std::binary_search(dependent_.begin(), dependent_.end(), other);
    const double rest =
        rows_.bias[row] + (follows ? -rows_.bias[equations_.active()[other]]
                                   : denseDot(rows_.delassus->column(row), forces_.data(), rows_.normalCount + rows_.tangentCount));
    worst = std::max(worst, std::abs(rest) / length_[r]);
  }
  return worst / forceScale_;
}

bool ForceSet::release(int k) {
  if (!solveAll())
    return false;
  polyhedron_.release(activeCount() + k);
  return true;
}

LeastNorm::Status ForceSet::activate(int k) {
  if (!solveAll())
    return LeastNorm::Status::Empty;
  loadLimit(k);
  return polyhedron_.activate(activeCount() + k);
}

const std::vector<double> &ForceSet::accelerations() {
  equations_.accelerations(rows_, forces_.data(), accelerations_.data());
  return accelerations_;
}

// Projects a point far along the normals of the limits onto the set: far enough, that is where the sum of their slacks is largest. False:
// not to the accuracy that is needed.
bool ForceSet::goFarAlong(const std::vector<int> &limits) {
  if (!hasFar_)
    far_ = polyhedron_;
  hasFar_ = true;
  const double distance = 1e4 * forceScale_, accepted = 1e-8 * forceScale_, contradiction = redundantResidual * forceScale_;
  for (int c = 0; c < activeCount(); ++c) {
    double normal = 0;
    for (const int k : limits)
      normal += far_.normal(activeCount() + k)[c];
    far_.origin(c) = polyhedron_.point()[c] + distance * normal;
  }
  return far_.solveAgain(accepted, contradiction) == LeastNorm::Status::Solved;
}

void ForceSet::keepFixed(const ContactProblem &problem, std::vector<int> &fixed, double tolerance) {
  if (fixed.empty())
    return;
  view(problem);
  const double visible = tolerance * forceScale_;
  if (conic_) {
    findInnermost();
    std::erase_if(fixed, [&](int k) { return cone_.slack(k, cone_.innermost()) > visible; });
    return;
  }
  // A clear way off a limit, or none at all, shows at once.
  std::vector<int> open, leaving;
  for (const int k : fixed)
    if (polyhedron_.slackWithinReach(activeCount() + k) > visible)
      leaving.push_back(k);
    else if (!polyhedron_.isFixed())
      open.push_back(k);
  const auto leaves = [&](int k) { return far_.slack(activeCount() + k) > visible; };
  // Where the largest sum of slacks, none of them negative, is none, so is each.
  while (!open.empty()) {
    std::vector<int> gone;
    if (goFarAlong(open))
      std::copy_if(open.begin(), open.end(), std::back_inserter(gone), leaves);
    else if (open.size() > 1)
      std::copy_if(open.begin(), open.end(), std::back_inserter(gone), [&](int k) { return goFarAlong({k}) && leaves(k); });
    if (gone.empty())
      break;
    leaving.insert(leaving.end(), gone.begin(), gone.end());
    std::erase_if(open, [&](int k) { return std::find(gone.begin(), gone.end(), k) != gone.end(); });
  }
  std::erase_if(fixed, [&](int k) { return std::find(leaving.begin(), leaving.end(), k) != leaving.end(); });
}

int ForceSet::saturated(int k) const {
  if (conic_)
    return conicSaturated(k);
  const std::vector<int> &active = polyhedron_.active();
  const auto found = std::find(active.begin(), active.end(), activeCount() + k);
  return found == active.end() ? -1 : static_cast<int>(found - active.begin());
}

double ForceSet::slack(const ContactProblem &problem, int k) const {
  const ForceLimit &side = limits_[k];
  if (side.side == 0)
    return forces_[side.row];
  if (side.side == ForceLimit::disk)
    return problem.limit(side.row - problem.normalCount, forces_.data()) - std::hypot(forces_[side.row], forces_[side.row + 1]);
  return problem.limit(side.row - problem.normalCount, forces_.data()) - side.side * forces_[side.row];
}

}  // namespace tf::runtime
