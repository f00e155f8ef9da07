#include "runtime/integrate/linked_forces.h"

#include "runtime/contact/dense_kernels.h"

#include <algorithm>
#include <limits>

namespace tf::runtime {

namespace {

// Multiplications of the dense equations, whose loops are long and simple, against those of the recursion: measured, to some tens of
// percent.
bool isWorthwhile(double velocities, double rows) {
  constexpr double ofOneStep = 300;
  const double mass = velocities * velocities * velocities / 6;
  const double response = velocities * rows * (velocities + rows) / 2, forces = rows * rows * rows / 3;
  return mass + response + forces > ofOneStep * (velocities + rows);
}

}  // namespace

bool LinkedForces::choose(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem, const ContactMode &mode,
                          const ModeForces &start) {
  const tf_model &model = at.model();
  if (model.nv <= RowSystem::narrow || model.nh > 0 || at.mobility.mass().blocks().size() != 1 ||
      !isWorthwhile(model.nv, rows.uniqueCount()))
    return false;
  normals_ = rows.normalCount();
  force_.resize(model.nv);
  forces_.resize(rows.count());
  rest_.assign(rows.count(), 0.0);
  shares_.assign(rows.count(), 0.0);
  equations_.clear();
  saturated_.clear();
  isKnown_ = samples_ = false;
  if (rows.count() > 0 && !start.listEquations(equations_, saturated_))
    return false;
  mayPress_ = rows.count() > 0 && start.mayPress();
  if (!listActive(rows, problem, mode))
    return false;
  system_.followDeterminant(mayPress_);
  if (!mayPress_)
    return true;
  if (!factorise(at, rows, problem))
    return false;
  begin_ = system_.determinant();
  return true;
}

// False: a normal force is at its limit, and shares what equal ones do.
bool LinkedForces::listActive(const RowSystem &rows, const ContactRows &problem, const ContactMode &mode) {
  const int n = rows.normalCount();
  active_.clear();
  limited_.clear();
  for (int row = 0; row < rows.count(); ++row) {
    const auto limit = std::find_if(saturated_.begin(), saturated_.end(), [row](const ForceLimit &other) { return other.row == row; });
    if (limit != saturated_.end() && limit->side == 0)
      return false;
    if (limit != saturated_.end())
      limited_.push_back({row, problem.owner[row - n], static_cast<double>(-limit->side), true});
    else if (row < n || mode.slip[row - n] == 0)
      active_.push_back(row);
    else
      limited_.push_back({row, problem.owner[row - n], static_cast<double>(mode.slip[row - n]), false});
  }
  return true;
}

// Of equal rows the first one.
void LinkedForces::listRows(const RowSystem &rows) {
  rows_.clear();
  number_.resize(rows.count());
  for (int row = 0; row < rows.count(); ++row) {
    const int first = rows.firstEqual(row);
    if (first == row) {
      number_[row] = static_cast<int>(rows_.size());
      rows_.push_back({rows.jacobian(row), rows.endOf(row)});
    } else {
      number_[row] = number_[first];
    }
  }
}

// The same rows where the model has them; one that reaches further is left by the solution. False: those that were equal differ.
bool LinkedForces::readRows(const ModelEvaluation &at, const RowSystem &rows) {
  int next = 0;
  for (int row = 0; row < rows.count(); ++row) {
    const double *entries = rows.modelRow(at, row);
    if (entries == nullptr)
      return false;
    SemiseparableSystem::Row &own = rows_[number_[row]];
    if (number_[row] == next) {
      own.entries = entries;
      ++next;
    } else if (!RowSystem::areEqual(entries, own.entries, rows.width())) {
      return false;
    }
  }
  return true;
}

// Friction that a normal force takes along tells it apart from those of equal rows.
void LinkedForces::findSets(const RowSystem &rows, const ContactRows &problem) {
  const int n = rows.normalCount();
  isAlone_.assign(active_.size(), 0);
  for (const Limited &limited : limited_)
    if (limited.place >= 0 && problem.friction[limited.row - n] != 0)
      isAlone_[limited.place] = 1;
  sets_.clear();
  joined_.clear();
  setOf_.resize(active_.size());
  setOfNumber_.assign(rows_.size(), -1);
  for (std::size_t a = 0; a < active_.size(); ++a) {
    int own = -1, *set = isAlone_[a] != 0 ? &own : &setOfNumber_[number_[active_[a]]];
    if (*set < 0) {
      *set = static_cast<int>(sets_.size());
      sets_.push_back({active_[a], 0, -1});
    }
    setOf_[a] = *set;
    ++sets_[*set].count;
  }
}

// The friction that unknown forces take along, and the rows that share them.
void LinkedForces::listFrictions(int normals, const ContactRows &problem) {
  frictions_.clear();
  for (const Limited &limited : limited_)
    if (limited.place >= 0 && isAlone_[limited.place] != 0)
      frictions_.push_back({setOf_[limited.place], number_[limited.row], -limited.sign * problem.friction[limited.row - normals]});
  for (const Joined &joined : joined_)
    frictions_.push_back({joined.set, joined.number, static_cast<double>(joined.count) / sets_[joined.set].count});
}

// One for each set, once those without have joined others. False: the rows depend on each other otherwise.
bool LinkedForces::assignEquations() {
  for (const Limited &limited : limited_)
    if (limited.sticks && setOfNumber_[number_[limited.row]] < 0)
      return false;
  for (const int row : equations_) {
    const auto place = std::lower_bound(active_.begin(), active_.end(), row);
    const bool isActive = place != active_.end() && *place == row;
    const int set = isActive ? setOf_[place - active_.begin()] : setOfNumber_[number_[row]];
    if (set < 0 || sets_[set].equation >= 0)
      return false;
    sets_[set].equation = row;
  }
  return joinSets();
}

// Rows that were equal when the mode began, those of nodes that lie beside a rod that has lifted its end by a trifle, say, have one
// equation in it, and go on sharing their force: equally, but for the difference of the rows.
bool LinkedForces::joinSets() {
  std::vector<int> &place = setPlace_;  // of the sets with an equation
  place.clear();
  int count = 0;
  for (const Set &set : sets_)
    place.push_back(set.equation >= 0 ? count++ : -1);
  if (count == static_cast<int>(sets_.size()))
    return true;
  for (std::size_t s = 0; s < sets_.size(); ++s)
    if (place[s] < 0 && !joinSet(static_cast<int>(s)))
      return false;
  for (Joined &joined : joined_)
    joined.set = place[joined.set];
  for (std::vector<int> *sets : {&setOf_, &setOfNumber_})
    for (int &set : *sets)
      set = set < 0 ? -1 : place[set] >= 0 ? place[set] : place[hostOf_[set]];
  std::erase_if(sets_, [](const Set &set) { return set.equation < 0; });
  return true;
}

// The set with an equation whose rows are nearest to those of set s. False: none is near enough: shares are not quite equal where rows
// are not, and others' forces change as well, by that part.
bool LinkedForces::joinSet(int s) {
  const double nearby = 0.1 * forceError_;
  const int number = number_[sets_[s].row];
  if (setOfNumber_[number] != s)
    return false;
  double least = nearby;
  int host = -1;
  for (std::size_t t = 0; t < sets_.size(); ++t) {
    const int other = number_[sets_[t].row];
    if (sets_[t].equation < 0 || setOfNumber_[other] != static_cast<int>(t))
      continue;
    const SemiseparableSystem::Row &x = rows_[number], &y = rows_[other];
    const Difference difference = largestDifference(x.entries, y.entries, std::max(x.end, y.end));
    if (difference.largest <= least * difference.ofFirst) {
      least = difference.largest / difference.ofFirst;
      host = static_cast<int>(t);
    }
  }
  hostOf_.resize(sets_.size());
  hostOf_[s] = host;
  if (host >= 0)
    joined_.push_back({host, number, sets_[s].count});
  return host >= 0;
}

bool LinkedForces::factorise(const ModelEvaluation &at, const RowSystem &rows, const ContactRows &problem) {
  listRows(rows);
  findSets(rows, problem);
  for (Correction &correction : corrections_)
    correction.isKnown = correction.isCurrent = false;
  isKnown_ = assignEquations();
  if (!isKnown_)
    return false;
  unknowns_.clear();
  for (const Set &set : sets_)
    unknowns_.push_back(number_[set.equation]);
  listFrictions(rows.normalCount(), problem);
  isKnown_ = system_.factorise(at.massMatrix.data(), at.model().nv, rows_, unknowns_, frictions_);
  sampled_.clear();
  return isKnown_;
}

// Of solutions: well below what shows; of small tolerances rounding is not far from it.
double LinkedForces::accuracy() const {
  constexpr double part = 1e-5;
  return std::max(SemiseparableSystem::rounding, part * forceError_);
}

// Those of all systems. False: they are too many.
bool LinkedForces::chooseColumns() {
  sampleColumns_ = system_.columns();
  for (const Correction &correction : corrections_)
    if (correction.isKnown)
      for (const int column : correction.system.columns())
        if (std::find(sampleColumns_.begin(), sampleColumns_.end(), column) == sampleColumns_.end())
          sampleColumns_.push_back(column);
  return sampleColumns_.size() <= MassSample::mostColumns;
}

MassSample *LinkedForces::sample(const ModelEvaluation &at) {
  constexpr double resolved = 1e-12;  // sums of many entries are no better
  samples_ = isKnown_ && at.model().mass_products != 0 && accuracy() >= resolved && chooseColumns();
  if (samples_ && sampleColumns_ != sampled_) {
    sampled_ = sampleColumns_;
    sample_.choose(sampled_, system_.scale());
  }
  return samples_ ? &sample_ : nullptr;
}

// Friction may begin or cease to take part, as coefficients are zero or not.
bool LinkedForces::refactorise(const ModelEvaluation &at, const RowSystem &rows, const ContactProblem &problem) {
  const int n = rows.normalCount();
  for (const Limited &limited : limited_)
    if (limited.place >= 0 && (problem.friction[limited.row - n] != 0) != (isAlone_[limited.place] != 0))
      return false;
  if (!readRows(at, rows))
    return false;
  listFrictions(n, problem);
  return samples_ ? system_.refactorise(sample_, rows_, accuracy()) : system_.refactorise(at.massMatrix.data(), rows_);
}

void LinkedForces::expand(const ContactProblem &problem) {
  for (std::size_t a = 0; a < active_.size(); ++a)
    forces_[active_[a]] = unknownForce_[setOf_[a]] / sets_[setOf_[a]].count;
  for (const Limited &limited : limited_)
    forces_[limited.row] = -limited.sign * problem.limit(limited.row - problem.normalCount, forces_.data());
}

bool LinkedForces::solve(const ModelEvaluation &at, const RowSystem &rows, const ContactProblem &problem, double *acceleration) {
  std::copy_n(at.force.data(), at.model().nv, force_.data());
  for (const Limited &limited : limited_)
    if (limited.place < 0) {
      const SemiseparableSystem::Row &row = rows_[number_[limited.row]];
      const double force = -limited.sign * problem.bound[limited.row - problem.normalCount];
      for (int k = 0; k < row.end; ++k)
        force_[k] += row.entries[k] * force;
    }
  bias_.resize(sets_.size());
  unknownForce_.resize(sets_.size());
  for (std::size_t s = 0; s < sets_.size(); ++s)
    bias_[s] = rows.modelBias(at, sets_[s].equation);
  return system_.solve(force_.data(), bias_.data(), acceleration, unknownForce_.data(), accuracy());
}

bool LinkedForces::evaluate(ModelEvaluation &at, RowSystem &rows, const ContactProblem &problem, double *acceleration, ModeForces &forces) {
  for (Correction &correction : corrections_)
    correction.isCurrent = false;
  if (!(isKnown_ && refactorise(at, rows, problem) && solve(at, rows, problem, acceleration))) {
    at.completeMass();
    samples_ = false;
    rows.gatherRows(at);
    if (!factorise(at, rows, problem) || !solve(at, rows, problem, acceleration))
      return false;
  }
  if (rows.count() == 0)
    return true;
  expand(problem);
  compareEqual(at, rows, acceleration);
  forces.take(problem, forces_, rest_, shares_, mayPress_ ? system_.determinant().relativeTo(begin_) : 1);
  return true;
}

// By what the row contradicts the equation of its set.
double LinkedForces::contradiction(const ModelEvaluation &at, const RowSystem &rows, int row, int set, const double *acceleration) const {
  const int equation = sets_[set].equation, number = number_[row];
  if (equation == row)
    return 0;
  if (number == number_[equation])
    return rows.modelBias(at, row) - rows.modelBias(at, equation);
  return denseDot(rows_[number].entries, acceleration, rows_[number].end) + rows.modelBias(at, row);
}

// By what equal rows contradict one another, and how they differ in their shares.
void LinkedForces::compareEqual(const ModelEvaluation &at, const RowSystem &rows, const double *acceleration) {
  for (std::size_t a = 0; a < active_.size(); ++a)
    rest_[active_[a]] = contradiction(at, rows, active_[a], setOf_[a], acceleration);
  for (const Limited &limited : limited_)
    if (limited.sticks) {
      const int s = setOfNumber_[number_[limited.row]];
      rest_[limited.row] = contradiction(at, rows, limited.row, s, acceleration);
      shares_[limited.row] = unknownForce_[s] / sets_[s].count;
    }
}

bool LinkedForces::factorise(ModelEvaluation &at, Correction &correction) {
  if (correction.isCurrent)
    return true;
  SemiseparableSystem &system = correction.system;
  // The sample's sums have been seen to be right.
  constexpr double accepted = std::numeric_limits<double>::infinity();
  const bool again = correction.isKnown;
  correction.isKnown = samples_ && again && system.refactorise(sample_, rows_, accepted);
  if (!correction.isKnown) {
    at.completeMass();
    const double *mass = at.massMatrix.data();
    correction.isKnown =
        (again && system.refactorise(mass, rows_)) || system.factorise(mass, at.model().nv, rows_, correction.unknowns, {});
  }
  correction.isCurrent = correction.isKnown;
  return correction.isKnown;
}

bool LinkedForces::correct(ModelEvaluation &at, const std::vector<std::uint8_t> &takesPart, const double *residual, double *change) {
  if (!isKnown_ || !joined_.empty())
    return false;
  chosen_.clear();
  chosenNumbers_.clear();
  isChosen_.assign(rows_.size(), 0);
  for (std::size_t row = 0; row < takesPart.size(); ++row)
    if (std::uint8_t &isChosen = isChosen_[number_[row]]; takesPart[row] != 0 && isChosen == 0) {
      isChosen = 1;
      chosen_.push_back(static_cast<int>(row));
      chosenNumbers_.push_back(number_[row]);
    }
  Correction &correction = corrections_[!chosen_.empty() && chosen_.back() >= normals_ ? 1 : 0];
  if (correction.rows != chosen_ || correction.unknowns != chosenNumbers_) {
    correction.rows = chosen_;
    correction.unknowns = chosenNumbers_;
    correction.isKnown = correction.isCurrent = false;
  }
  force_.assign(at.model().nv, 0.0);
  change_.resize(at.model().nv);
  bias_.resize(chosen_.size());
  unknownForce_.resize(chosen_.size());
  for (std::size_t k = 0; k < chosen_.size(); ++k)
    bias_[k] = -residual[chosen_[k]];
  // Corrections are small, and those of coordinates are repeated.
  constexpr double accuracy = 1e-10;
  const auto solve = [&] {
    return factorise(at, correction) && correction.system.solve(force_.data(), bias_.data(), change_.data(), unknownForce_.data(), accuracy,
                                                                SemiseparableSystem::Check::Rows);
  };
  if (!solve()) {
    // The structure may have been that of other numbers.
    const bool again = correction.isKnown;
    correction.isKnown = correction.isCurrent = false;
    if (!again || !solve())
      return false;
  }
  for (int i = 0; i < at.model().nv; ++i)
    change[i] += change_[i];
  return true;
}

}  // namespace tf::runtime
