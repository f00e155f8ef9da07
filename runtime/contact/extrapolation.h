// One step of y' = f(y) by extrapolation of the linearly implicit midpoint rule, whose error has an expansion in h² (Bader and Deuflhard,
// Numerische Mathematik 41, 1983): high order, and stable where f is stiff, as friction is while a slip is small.
#pragma once

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tf::runtime {

class Extrapolation {
public:
  // The differential equation, as `step` asks for it:
  //   bool rate(y, f)          f(y); false where it cannot be evaluated
  //   bool factor(part)        prepares `solve`; false where the matrix is singular
  //   void solve(x)            x becomes (I − part f'(y0))⁻¹ x
  // Steps begin at y0, where f is f0.
  void start(const Eigen::VectorXd &y0, const Eigen::VectorXd &f0) {
    begin_ = y0;
    firstRate_ = f0;
  }

  // Over h; result in end(). False: two successive extrapolations do not agree to `accuracy` (largest entry) and are not about to, or f
  // failed.
  template <class Equation> bool step(double h, double accuracy, Equation &equation) {
    error_ = std::numeric_limits<double>::infinity();
    shorter_ = 0.5;
    for (int k = 0; k < columns; ++k) {
      if (!midpoint(h, substeps[static_cast<std::size_t>(k)], equation)) {
        error_ = std::numeric_limits<double>::infinity();
        return false;
      }
      // Aitken–Neville in h², from T(k, 0) to T(k, k).
      carried_ = after_;
      for (int j = 0; j < k; ++j) {
        const double ratio = static_cast<double>(substeps[static_cast<std::size_t>(k)]) / substeps[static_cast<std::size_t>(k - j - 1)];
        previous_ = table_[static_cast<std::size_t>(j)];
        table_[static_cast<std::size_t>(j)] = carried_;
        carried_ += (carried_ - previous_) / (ratio * ratio - 1);
      }
      table_[static_cast<std::size_t>(k)] = carried_;
      used_ = k + 1;
      if (!carried_.allFinite()) {
        error_ = std::numeric_limits<double>::infinity();
        return false;
      }
      const double before = error_;
      if (k > 1)
        error_ = (carried_ - table_[static_cast<std::size_t>(k - 1)]).template lpNorm<Eigen::Infinity>();
      if (k > 1 && error_ <= accuracy)
        return true;
      if (k > 2 && !converges(before, k, accuracy))
        return false;
    }
    return false;
  }
  [[nodiscard]] const Eigen::VectorXd &end() const { return carried_; }
  // Difference of the last two extrapolations; infinite where f failed.
  [[nodiscard]] double error() const { return error_; }
  // By how many times the next step may be longer, from the columns of the table that this one needed.
  [[nodiscard]] double longer() const { return used_ <= 3 ? 6 : used_ <= 4 ? 3 : used_ <= 6 ? 2 : 1; }
  // Which part of a step that failed to try next.
  [[nodiscard]] double shorter() const { return shorter_; }

  static constexpr int columns = 8;

private:
  static constexpr std::array<int, columns> substeps = {2, 6, 10, 14, 22, 34, 50, 70};

  // Column k has brought the error down from `before` so fast that the last one may reach the accuracy.
  bool converges(double before, int k, double accuracy) {
    constexpr double hopeless = 1e3, shortest = 0.1;
    const double rate = error_ / before;
    const double last = rate < 1 ? error_ * std::pow(rate, columns - 1 - k) : error_;
    if (last <= hopeless * accuracy)
      return true;
    shorter_ = rate < 1 ? std::clamp(std::pow(accuracy / last, 1.0 / (2 * columns)), shortest, 0.5) : 0.25;
    return false;
  }

  template <class Equation> bool midpoint(double h, int count, Equation &equation) {
    const double part = h / count;
    if (!equation.factor(part))
      return false;
    change_ = part * firstRate_;
    equation.solve(change_);
    after_ = begin_ + change_;
    for (int i = 1; i < count; ++i) {
      if (!equation.rate(after_, rate_))
        return false;
      rate_ = part * rate_ - change_;
      equation.solve(rate_);
      change_ += 2 * rate_;
      after_ += change_;
    }
    if (!equation.rate(after_, rate_))
      return false;
    rate_ = part * rate_ - change_;
    equation.solve(rate_);
    after_ += rate_;
    return true;
  }

  Eigen::VectorXd begin_, firstRate_, rate_, after_, change_, carried_, previous_;
  std::array<Eigen::VectorXd, columns> table_;
  int used_ = 0;
  double error_ = 0, shorter_ = 0.5;
};

}  // namespace tf::runtime
