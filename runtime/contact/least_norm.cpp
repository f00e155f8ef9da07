#include "runtime/contact/least_norm.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/irregular_numbers.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// A constraint depends on the active ones where its part outside their span is shorter, relative to unit length.
constexpr double dependence = 1e-8;
// Fewer variables are not worth looking for equal ones.
constexpr int fewest = 12;

}  // namespace

void LeastNorm::resize(int variables, int equations, int inequalities) {
  variables_ = variables;
  equations_ = equations;
  constraints_ = equations + inequalities;
  normals_.resize(variables, constraints_);
  basis_.resize(variables, variables);
  triangle_.resize(variables, variables);
  // One column more than there can be active constraints: `project` takes the next one.
  reflections_.resize(variables, variables + 1);
  separateVariables();
  set_.resize(variables);
  mark_.resize(variables);
  setPoint_.resize(variables);
  sample_.reserve(variables);
  root_.reserve(variables);
  scale_.resize(variables + 1);
  cross_.resize(variables + 1);
  bounds_.resize(constraints_);
  origin_.assign(variables, 0.0);
  x_.resize(variables);
  d_.resize(variables);
  r_.resize(variables);
  z_.resize(variables);
  active_.reserve(variables);
  multipliers_.reserve(variables + 1);
}

double LeastNorm::slack(int constraint) const { return denseDot(normals_.column(constraint), x_.data(), variables_) - bounds_[constraint]; }

double LeastNorm::contradiction() const {
  double worst = 0;
  for (int c = 0; dependent_ && c < equations_; ++c)
    worst = std::max(worst, std::abs(slack(c)));
  return worst;
}

// By the products of their entries with numbers of no regularity.
void LeastNorm::mergeVariables() {
  separateVariables();
  if (variables_ < fewest)
    return;
  std::fill(mark_.begin(), mark_.end(), 0.0);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    const double *normal = normals_.column(active_[k]), factor = irregularNumber(static_cast<int>(k));
    for (int i = 0; i < variables_; ++i)
      mark_[i] += factor * normal[i];
  }
  sample_.clear();
  root_.clear();
  for (int i = 0; i < variables_; ++i) {
    const auto found = std::find_if(sample_.begin(), sample_.end(), [=, this](int j) { return mark_[i] == mark_[j] && areEqual(i, j); });
    set_[i] = static_cast<int>(found - sample_.begin());
    if (found == sample_.end()) {
      sample_.push_back(i);
      root_.push_back(0);
    }
    root_[set_[i]] += 1;
  }
  for (double &root : root_)
    root = std::sqrt(root);
  rows_ = static_cast<int>(sample_.size());
  isMerged_ = rows_ < variables_;
}

void LeastNorm::separateVariables() {
  isMerged_ = false;
  rows_ = variables_;
}

// The reflections of the active constraints again, of all variables: constraints to come may tell them apart.
void LeastNorm::tellApart() {
  if (!isMerged_)
    return;
  separateVariables();
  reflectActive(0);
}

bool LeastNorm::areEqual(int i, int j) const {
  return std::all_of(active_.begin(), active_.end(), [=, this](int constraint) {
    const double *normal = normals_.column(constraint);
    return normal[i] == normal[j];
  });
}

// The normal of the active constraint k into its column.
void LeastNorm::loadReflection(int k) {
  const double *normal = normals_.column(active_[k]);
  double *column = reflection(k);
  if (!isMerged_) {
    std::copy_n(normal, variables_, column);
    return;
  }
  for (int s = 0; s < rows_; ++s)
    column[s] = normal[sample_[s]] * root_[s];
}

void LeastNorm::formBasis() {
  if (!isReflected_)
    return;
  isReflected_ = false;
  const int q = static_cast<int>(active_.size());
  for (int j = 0; j < variables_; ++j) {
    std::fill_n(basis_.column(j), variables_, 0.0);
    basis_(j, j) = 1;
    applyReflections(reflections_.data(), rows_, q, scale_.data(), cross_.data(), basis_.column(j));
  }
}

double LeastNorm::project(const double *normal) {
  const int q = static_cast<int>(active_.size());
  if (isReflected_) {
    double *column = reflection(q);
    std::copy_n(normal, variables_, column);
    diagonal_ = 0;
    const bool independent = reflectColumn(reflections_.data(), rows_, q, dependence, scale_.data(), cross_.data(), diagonal_);
    std::copy_n(column, q, d_.begin());
    return independent ? std::abs(diagonal_) : 0;
  }
  double squares = 0;
  for (int j = 0; j < variables_; ++j) {
    d_[j] = denseDot(basis_.column(j), normal, variables_);
    if (j >= q)
      squares += d_[j] * d_[j];
  }
  return std::sqrt(squares);
}

void LeastNorm::dualDirection() {
  const int q = static_cast<int>(active_.size());
  std::copy_n(d_.begin(), q, r_.begin());
  for (int j = q - 1; j >= 0; --j) {
    const double *column = triangle_.column(j);
    r_[j] /= column[j];
    for (int i = 0; i < j; ++i)
      r_[i] -= column[i] * r_[j];
  }
}

// The constraint of the last `project`. The new column of R is (d₁, ±‖d₂‖); a Householder reflection of J₂ takes d₂ there.
void LeastNorm::append(int constraint, double multiplier, double length) {
  const int q = static_cast<int>(active_.size());
  for (int i = 0; i < q; ++i)
    triangle_(i, q) = d_[i];
  active_.push_back(constraint);
  multipliers_.push_back(multiplier);
  if (isReflected_) {
    triangle_(q, q) = diagonal_;
    return;
  }
  const double diagonal = d_[q] > 0 ? -length : length;
  triangle_(q, q) = diagonal;
  d_[q] -= diagonal;
  double squares = 0;
  for (int j = q; j < variables_; ++j)
    squares += d_[j] * d_[j];
  if (squares > 0) {
    std::fill(z_.begin(), z_.end(), 0.0);
    for (int j = q; j < variables_; ++j)
      for (int i = 0; i < variables_; ++i)
        z_[i] += basis_(i, j) * d_[j];
    for (int j = q; j < variables_; ++j) {
      const double factor = 2 * d_[j] / squares;
      for (int i = 0; i < variables_; ++i)
        basis_(i, j) -= z_[i] * factor;
    }
  }
}

// z = J₂ d₂ of the last `project`.
void LeastNorm::findDirection() {
  const int q = static_cast<int>(active_.size());
  std::fill(z_.begin(), z_.end(), 0.0);
  if (isReflected_) {
    z_[q] = diagonal_;
    applyReflections(reflections_.data(), rows_, q + 1, scale_.data(), cross_.data(), z_.data());
    return;
  }
  for (int j = q; j < variables_; ++j)
    for (int i = 0; i < variables_; ++i)
      z_[i] += d_[j] * basis_(i, j);
}

double LeastNorm::slackWithinReach(int constraint) {
  tellApart();
  const double length = project(normals_.column(constraint));
  isFixed_ = !(length > dependence) && active_.size() == independent_;
  if (!(length > dependence))
    return slack(constraint);
  findDirection();
  double step = std::numeric_limits<double>::infinity();
  for (int c = equations_; c < constraints_; ++c) {
    const double slope = denseDot(normals_.column(c), z_.data(), variables_);
    if (slope < 0 && std::find(active_.begin(), active_.end(), c) == active_.end())
      step = std::min(step, std::max(slack(c), 0.0) / -slope);
  }
  return slack(constraint) + step * length * length;
}

void LeastNorm::removeAt(int k) {
  formBasis();
  const int q = static_cast<int>(active_.size());
  for (int j = k + 1; j < q; ++j)
    std::copy_n(triangle_.column(j), j + 1, triangle_.column(j - 1));
  // Column j − 1 now has an entry below its diagonal: rotate rows j − 1 and j.
  for (int j = k; j < q - 1; ++j) {
    const double a = triangle_(j, j), b = triangle_(j + 1, j);
    const double length = std::hypot(a, b);
    const double cosine = a / length, sine = b / length;
    for (int c = j; c < q - 1; ++c) {
      const double upper = triangle_(j, c), lower = triangle_(j + 1, c);
      triangle_(j, c) = cosine * upper + sine * lower;
      triangle_(j + 1, c) = cosine * lower - sine * upper;
    }
    for (int i = 0; i < variables_; ++i) {
      const double left = basis_(i, j), right = basis_(i, j + 1);
      basis_(i, j) = cosine * left + sine * right;
      basis_(i, j + 1) = cosine * right - sine * left;
    }
  }
  active_.erase(active_.begin() + k);
  multipliers_.erase(multipliers_.begin() + k);
}

int LeastNorm::blocking(double &step) const {
  int found = -1;
  for (std::size_t k = 0; k < active_.size(); ++k) {
    if (active_[k] < equations_ || !(r_[k] > 0))
      continue;
    const double ratio = std::max(multipliers_[k], 0.0) / r_[k];
    if (found < 0 || ratio < step) {
      found = static_cast<int>(k);
      step = ratio;
    }
  }
  return found;
}

LeastNorm::Status LeastNorm::addInequality(int constraint, double tolerance) {
  double multiplier = 0;
  while (true) {
    const double length = project(normals_.column(constraint));
    const bool independent = length > dependence;
    dualDirection();
    double dualStep = std::numeric_limits<double>::infinity();
    const int block = blocking(dualStep);
    if (!independent && block < 0)
      return slack(constraint) >= -tolerance ? Status::Solved : Status::Empty;
    const double primalStep = independent ? -slack(constraint) / (length * length) : std::numeric_limits<double>::infinity();
    const double step = std::min(primalStep, dualStep);
    const int q = static_cast<int>(active_.size());
    if (independent) {
      findDirection();
      for (int i = 0; i < variables_; ++i)
        x_[i] += step * z_[i];
    }
    for (int k = 0; k < q; ++k)
      multipliers_[k] -= step * r_[k];
    multiplier += step;
    if (primalStep <= dualStep) {
      append(constraint, multiplier, length);
      return Status::Solved;
    }
    removeAt(block);
  }
}

// The least-norm point of the active constraints as equations. False where one depends on others.
bool LeastNorm::reflectActive(double accepted) {
  const int q = static_cast<int>(active_.size());
  for (int begin = 0; begin < q; begin += reflectionWidth) {
    const int end = std::min(begin + reflectionWidth, q);
    for (int k = begin; k < end; ++k)
      loadReflection(k);
    const bool isPanel = end == begin + reflectionWidth;
    if (isPanel)
      reflectColumns(reflections_.data(), rows_, begin, scale_.data(), cross_.data());
    for (int k = begin; k < end; ++k)
      if (!reflect(k, accepted, isPanel ? begin : 0))
        return false;
  }
  return true;
}

// The normal in column k of reflections_, to which the first `from` reflections have been applied, becomes column k of R; false where it
// depends on those before.
bool LeastNorm::reflect(int k, double accepted, int from) {
  if (!reflectColumn(reflections_.data(), rows_, k, accepted, scale_.data(), cross_.data(), triangle_(k, k), from))
    return false;
  std::copy_n(reflection(k), k, triangle_.column(k));
  return true;
}

// x and the multipliers of the active constraints, which have just been reflected.
void LeastNorm::solveReflected() {
  isReflected_ = true;
  const int q = static_cast<int>(active_.size());
  for (int k = 0; k < q; ++k)
    z_[k] = bounds_[active_[k]] - denseDot(normals_.column(active_[k]), origin_.data(), variables_);
  solveTransposed(z_.data());
  fromActive(x_.data());
  for (int i = 0; i < variables_; ++i)
    x_[i] += origin_[i];
  dualDirection();
  multipliers_.assign(r_.begin(), r_.begin() + q);
}

// The independent equations become active. Without pivoting a dependence may be spread over several of them, none of which is near enough
// to the span of those before: then one that has the largest part in it is left out.
void LeastNorm::reflectEquations() {
  leftOut_.assign(equations_, 0);
  reflectKept();
  for (int row = dependentRow(); row >= 0; row = dependentRow()) {
    leftOut_[active_[row]] = 1;
    reflectKept();
  }
  independent_ = active_.size();
}

// The active equation with the largest part in a combination of all of them that is zero, −1: there is none. By inverse iteration.
int LeastNorm::dependentRow() {
  constexpr int passes = 2;
  const int q = static_cast<int>(active_.size());
  double length = 0;
  const auto normalise = [&](std::vector<double> &v) {
    length = std::sqrt(denseDot(v.data(), v.data(), q));
    for (int k = 0; k < q; ++k)
      v[k] /= length;
  };
  for (int k = 0; k < q; ++k)
    r_[k] = irregularNumber(k);
  for (int pass = 0; pass < passes; ++pass) {
    solveTransposed(r_.data());
    normalise(d_);
    dualDirection();
    normalise(r_);
  }
  if (q == 0 || !(length * dependence >= 1))
    return -1;
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  return static_cast<int>(std::max_element(r_.begin(), r_.begin() + q, larger) - r_.begin());
}

void LeastNorm::reflectKept() {
  separateVariables();
  active_.clear();
  dependent_ = false;
  for (int c = 0; c < equations_; ++c) {
    if (leftOut_[c] != 0) {
      dependent_ = true;
      continue;
    }
    const int q = static_cast<int>(active_.size());
    if (q == variables_) {
      dependent_ = true;
      break;
    }
    std::copy_n(normals_.column(c), variables_, reflection(q));
    if (reflect(q, dependence, 0))
      active_.push_back(c);
    else
      dependent_ = true;
  }
}

LeastNorm::Status LeastNorm::solve(double tolerance, double equationTolerance) {
  reflectEquations();
  return solveAgain(tolerance, equationTolerance);
}

LeastNorm::Status LeastNorm::solveAgain(double tolerance, double equationTolerance) {
  tellApart();
  active_.resize(independent_);
  solveReflected();
  if (contradiction() > equationTolerance)
    return Status::Contradictory;
  // Each addition raises the dual objective; the limit is for rounding in degenerate polyhedra, where the order of index ends cycles.
  const int limit = 20 * (constraints_ + variables_) + 100;
  for (int iteration = 0; iteration < limit; ++iteration) {
    int worst = -1;
    double violation = tolerance;
    for (int c = equations_; c < constraints_; ++c) {
      const double excess = -slack(c);
      if (excess > violation) {
        worst = c;
        violation = excess;
        if (iteration > limit / 2)
          break;
      }
    }
    if (worst < 0)
      return Status::Solved;
    if (addInequality(worst, tolerance) == Status::Empty)
      return Status::Empty;
  }
  return Status::Empty;
}

bool LeastNorm::solveActive() {
  mergeVariables();
  // Kept order: the pivots are the same functions of the data as long as the active set is.
  if (!reflectActive(dependence * 1e-3))
    return false;
  solveReflected();
  return true;
}

// point = J₁ d₁
void LeastNorm::fromActive(double *point) const {
  const int q = static_cast<int>(active_.size());
  std::fill_n(point, variables_, 0.0);
  if (isMerged_) {
    std::fill(setPoint_.begin(), setPoint_.end(), 0.0);
    std::copy_n(d_.begin(), q, setPoint_.begin());
    applyReflections(reflections_.data(), rows_, q, scale_.data(), cross_.data(), setPoint_.data());
    for (int i = 0; i < variables_; ++i)
      point[i] = setPoint_[set_[i]] / root_[set_[i]];
    return;
  }
  if (isReflected_) {
    std::copy_n(d_.begin(), q, point);
    applyReflections(reflections_.data(), rows_, q, scale_.data(), cross_.data(), point);
    return;
  }
  for (int j = 0; j < q; ++j)
    for (int i = 0; i < variables_; ++i)
      point[i] += basis_(i, j) * d_[j];
}

// d₁ = R⁻ᵀ c: x = x₀ + J₁ d₁ has Nᵀ(x − x₀) = c, and its multipliers are R⁻¹ d₁.
void LeastNorm::solveTransposed(const double *c) {
  const int q = static_cast<int>(active_.size());
  for (int i = 0; i < q; ++i) {
    d_[i] = (c[i] - denseDot(triangle_.column(i), d_.data(), i)) / triangle_(i, i);
  }
}

void LeastNorm::pointOf(const double *bounds, double *point) {
  const int q = static_cast<int>(active_.size());
  for (int k = 0; k < q; ++k)
    z_[k] = bounds[active_[k]];
  solveTransposed(z_.data());
  fromActive(point);
}

LeastNorm::Status LeastNorm::activate(int constraint) {
  tellApart();
  double multiplier = 0;
  while (true) {
    const double length = project(normals_.column(constraint));
    if (length > dependence) {
      append(constraint, multiplier, length);
      return Status::Solved;
    }
    dualDirection();
    double step = 0;
    const int block = blocking(step);
    if (block < 0)
      return Status::Empty;
    for (std::size_t k = 0; k < active_.size(); ++k)
      multipliers_[k] -= step * r_[k];
    multiplier += step;
    removeAt(block);
  }
}

void LeastNorm::release(int constraint) {
  tellApart();
  const auto found = std::find(active_.begin(), active_.end(), constraint);
  assert(found != active_.end() && constraint >= equations_);
  removeAt(static_cast<int>(found - active_.begin()));
}

}  // namespace tf::runtime
