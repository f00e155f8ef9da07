// One step of y' = f(y) by extrapolation of the linearly implicit midpoint rule, whose error has an expansion in h² (Bader and Deuflhard,
// Numerische Mathematik 41, 1983): high order, and stable where f is stiff, as friction is while a slip is small.
#ifndef TF_RUNTIME_CONTACT_EXTRAPOLATION_H
#define TF_RUNTIME_CONTACT_EXTRAPOLATION_H

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <limits>

namespace tf::runtime {

class Extrapolation {
public:
  // Prepares steps from y0. `rate(y, f)` returns false where f cannot be evaluated. `increment`: of y for the Jacobian by differences.
  template <class Rate> bool start(const Eigen::VectorXd &y0, double increment, const Rate &rate) {
    const Eigen::Index size = y0.size();
    begin_ = y0;
    if (!rate(y0, firstRate_))
      return false;
    jacobian_.resize(size, size);
    for (Eigen::Index k = 0; k < size; ++k) {
      after_ = y0;
      after_[k] += increment;
      if (!rate(after_, rate_))
        return false;
      jacobian_.col(k) = (rate_ - firstRate_) / increment;
    }
    return true;
  }

  // Over h; result in end(). False: two successive extrapolations do not agree to `accuracy` (largest entry), or f failed.
  template <class Rate> bool step(double h, double accuracy, const Rate &rate) {
    error_ = std::numeric_limits<double>::infinity();
    for (int k = 0; k < columns; ++k) {
      if (!midpoint(h, substeps[static_cast<std::size_t>(k)], rate)) {
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
      if (k > 1)
        error_ = (carried_ - table_[static_cast<std::size_t>(k - 1)]).template lpNorm<Eigen::Infinity>();
      if (k > 1 && error_ <= accuracy)
        return true;
    }
    return false;
  }
  [[nodiscard]] const Eigen::VectorXd &end() const { return carried_; }
  // Difference of the last two extrapolations; infinite where f failed.
  [[nodiscard]] double error() const { return error_; }
  // Columns of the table that were needed: few say that the step may be longer.
  [[nodiscard]] int used() const { return used_; }

  static constexpr int columns = 8;

private:
  static constexpr std::array<int, columns> substeps = {2, 6, 10, 14, 22, 34, 50, 70};

  template <class Rate> bool midpoint(double h, int count, const Rate &rate) {
    const double part = h / count;
    matrix_ = Eigen::MatrixXd::Identity(begin_.size(), begin_.size()) - part * jacobian_;
    factor_.compute(matrix_);
    change_ = factor_.solve(part * firstRate_);
    after_ = begin_ + change_;
    for (int i = 1; i < count; ++i) {
      if (!rate(after_, rate_))
        return false;
      change_ += 2 * factor_.solve(part * rate_ - change_);
      after_ += change_;
    }
    if (!rate(after_, rate_))
      return false;
    after_ += factor_.solve(part * rate_ - change_);
    return true;
  }

  Eigen::VectorXd begin_, firstRate_, rate_, after_, change_, carried_, previous_;
  Eigen::MatrixXd jacobian_, matrix_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  std::array<Eigen::VectorXd, columns> table_;
  int used_ = 0;
  double error_ = 0;
};

}  // namespace tf::runtime

#endif
