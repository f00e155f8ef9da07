#include "runtime/contact/least_norm.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// A constraint depends on the active ones where its part outside their span is shorter, relative to unit length.
constexpr double dependence = 1e-10;

double dot(const double *a, const double *b, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    sum += a[i] * b[i];
  return sum;
}

}  // namespace

void LeastNorm::resize(int variables, int equations, int inequalities) {
  variables_ = variables;
  equations_ = equations;
  constraints_ = equations + inequalities;
  normals_.resize(variables, constraints_);
  basis_.resize(variables, variables);
  triangle_.resize(variables, variables);
  bounds_.resize(constraints_);
  origin_.assign(variables, 0.0);
  x_.resize(variables);
  d_.resize(variables);
  r_.resize(variables);
  z_.resize(variables);
  active_.reserve(variables);
  multipliers_.reserve(variables + 1);
}

double LeastNorm::slack(int constraint) const { return dot(normals_.column(constraint), x_.data(), variables_) - bounds_[constraint]; }

void LeastNorm::clearActive() {
  active_.clear();
  multipliers_.clear();
  for (int j = 0; j < variables_; ++j) {
    std::fill_n(basis_.column(j), variables_, 0.0);
    basis_(j, j) = 1;
  }
}

double LeastNorm::project(const double *normal) {
  const int q = static_cast<int>(active_.size());
  double squares = 0;
  for (int j = 0; j < variables_; ++j) {
    d_[j] = dot(basis_.column(j), normal, variables_);
    if (j >= q)
      squares += d_[j] * d_[j];
  }
  return std::sqrt(squares);
}

void LeastNorm::dualDirection() {
  const int q = static_cast<int>(active_.size());
  for (int i = q - 1; i >= 0; --i) {
    double value = d_[i];
    for (int j = i + 1; j < q; ++j)
      value -= triangle_(i, j) * r_[j];
    r_[i] = value / triangle_(i, i);
  }
}

// The new column of R is (d₁, ±‖d₂‖); a Householder reflection of J₂ takes d₂ there.
void LeastNorm::append(int constraint, double multiplier, double length) {
  const int q = static_cast<int>(active_.size());
  const double diagonal = d_[q] > 0 ? -length : length;
  for (int i = 0; i < q; ++i)
    triangle_(i, q) = d_[i];
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
  active_.push_back(constraint);
  multipliers_.push_back(multiplier);
}

void LeastNorm::removeAt(int k) {
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

LeastNorm::Status LeastNorm::addEquation(int constraint, double tolerance) {
  const double residual = slack(constraint);
  const double length = project(normals_.column(constraint));
  if (length <= dependence) {
    dependent_ = true;
    return std::abs(residual) <= tolerance ? Status::Solved : Status::Contradictory;
  }
  const int q = static_cast<int>(active_.size());
  const double step = -residual / (length * length);
  for (int j = q; j < variables_; ++j)
    for (int i = 0; i < variables_; ++i)
      x_[i] += step * d_[j] * basis_(i, j);
  dualDirection();
  for (int k = 0; k < q; ++k)
    multipliers_[k] -= step * r_[k];
  append(constraint, step, length);
  return Status::Solved;
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
    if (independent)
      for (int j = q; j < variables_; ++j)
        for (int i = 0; i < variables_; ++i)
          x_[i] += step * d_[j] * basis_(i, j);
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

LeastNorm::Status LeastNorm::solve(double tolerance, double equationTolerance) {
  clearActive();
  dependent_ = false;
  x_ = origin_;
  for (int c = 0; c < equations_; ++c)
    if (addEquation(c, equationTolerance) == Status::Contradictory)
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
  // Kept order: the pivots are the same functions of the data as long as the active set is.
  const int q = static_cast<int>(active_.size());
  order_.assign(active_.begin(), active_.end());
  clearActive();
  for (int k = 0; k < q; ++k) {
    const double length = project(normals_.column(order_[k]));
    if (!(length > dependence * 1e-3)) {
      active_.assign(order_.begin(), order_.end());
      return false;
    }
    append(order_[k], 0.0, length);
  }
  for (int k = 0; k < q; ++k)
    z_[k] = bounds_[active_[k]] - dot(normals_.column(active_[k]), origin_.data(), variables_);
  solveTransposed(z_.data());
  x_ = origin_;
  for (int j = 0; j < q; ++j)
    for (int i = 0; i < variables_; ++i)
      x_[i] += basis_(i, j) * d_[j];
  dualDirection();
  std::copy_n(r_.begin(), q, multipliers_.begin());
  return true;
}

// d₁ = R⁻ᵀ c: x = x₀ + J₁ d₁ has Nᵀ(x − x₀) = c, and its multipliers are R⁻¹ d₁.
void LeastNorm::solveTransposed(const double *c) {
  const int q = static_cast<int>(active_.size());
  for (int i = 0; i < q; ++i) {
    double value = c[i];
    for (int j = 0; j < i; ++j)
      value -= triangle_(j, i) * d_[j];
    d_[i] = value / triangle_(i, i);
  }
}

void LeastNorm::pointOf(const double *bounds, double *point) {
  const int q = static_cast<int>(active_.size());
  for (int k = 0; k < q; ++k)
    z_[k] = bounds[active_[k]];
  solveTransposed(z_.data());
  std::fill_n(point, variables_, 0.0);
  for (int j = 0; j < q; ++j)
    for (int i = 0; i < variables_; ++i)
      point[i] += basis_(i, j) * d_[j];
}

LeastNorm::Status LeastNorm::activate(int constraint) {
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
  const auto found = std::find(active_.begin(), active_.end(), constraint);
  assert(found != active_.end() && constraint >= equations_);
  removeAt(static_cast<int>(found - active_.begin()));
}

}  // namespace tf::runtime
