// All forces of a mode whose sticking contacts are redundant and some of which have a slip of two components: the convex set
//     A x = b,   slack_k(x) = factor_k x_apex + offset_k − ‖(x_t0, x_t1)‖ ≥ 0
// with A singular. Its representative is the least-norm point; the set is empty where the largest common slack is negative
// (theory.md section 6). Both are convex problems in the null space of A: a logarithmic barrier (Boyd and Vandenberghe, Convex
// Optimization, 2004, sections 11.3 and 11.6) finds which limits are active, and Newton's method on the optimality conditions with these
// limits (Nocedal and Wright, Numerical Optimization, 2nd edition, chapter 18) leads to rounding. Along a motion the latter alone follows
// both points. A falls into parts that have no variable in common, as those of bodies apart, which are factorised one by one.
#pragma once

#include "runtime/contact/matrix_parts.h"

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

class ConicForces {
public:
  struct Limit {
    int apex = -1;                // variable, or −1
    double factor = 0;            // of the apex
    double offset = 0;            // ≥ 0
    int first = -1, second = -1;  // variables of the tangential force, −1 where absent
  };

  // A, b and limits are undefined afterwards.
  void resize(int variables, int limits);
  // Another set begins, perhaps of other limits: there are no points to follow.
  void forget() { innermost_.isKnown = least_.isKnown = false; }
  Eigen::MatrixXd &matrix() { return matrix_; }
  Eigen::VectorXd &rhs() { return rhs_; }
  Limit &limit(int k) { return limits_[k]; }

  // Makes the rows of A unit vectors and factorises it. False: the dependent equations contradict the others by more than `tolerance`,
  // relative to scale(), the size of the point or `leastScale`, if that is more.
  bool prepare(double tolerance, double leastScale = 0);
  // Of row r of A, before prepare(); 1 where it is zero.
  [[nodiscard]] double rowLength(int r) const { return rowLength_[r]; }
  // The least-norm solution of A x = b alone.
  [[nodiscard]] const Eigen::VectorXd &freePoint() const { return free_; }
  // max over A x = b of min_k slack_k (up to a force far beyond that of freePoint), to 1e-6 of itself, and a point where it is reached;
  // from the last one if there is one.
  double largestSlack();
  [[nodiscard]] const Eigen::VectorXd &innermost() const { return innermost_.point; }
  // The least-norm point of the set, after largestSlack() > 0.
  const Eigen::VectorXd &leastNorm();
  // After prepare(): the same point from the last one. Null where it is not found so, or there is no last one.
  const Eigen::VectorXd *followLeastNorm();
  // y −= A x, where most entries of x may be zero.
  void subtractProduct(const Eigen::VectorXd &x, Eigen::VectorXd &y) const;
  // Least-norm solution of A x = b for another b.
  void solve(const Eigen::VectorXd &rhs, Eigen::VectorXd &x) const;
  // z of rows with Aᵀ z = x, zero of those that depend on others; x has no part in the null space of A.
  void multipliersOf(const Eigen::VectorXd &x, Eigen::VectorXd &z) const;

  [[nodiscard]] double slack(int k, const Eigen::VectorXd &x) const;
  [[nodiscard]] double smallestSlack(const Eigen::VectorXd &x) const;
  // Magnitude of forces.
  [[nodiscard]] double scale() const { return scale_; }

private:
  // Of equations and variables (of the same numbers) that are not coupled with others.
  struct Part {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor;
    Eigen::VectorXd values;
  };

  // Objective −common/weight (common slack is the last unknown) or ½‖x‖²/weight (common slack 0).
  enum class Aim : bool { CommonSlack, LeastNorm };
  // ∇f = Σ multiplier ∇slack over the active limits, in the kernel; f = −common slack or ½‖x‖², multipliers of the latter relative to the
  // force scale.
  struct Optimum {
    Eigen::VectorXd point;
    double common = 0;  // slack of the active limits
    std::vector<int> active;
    Eigen::VectorXd multiplier;
    bool isKnown = false;
  };

  void findKernel();
  bool follow(Aim aim, Optimum &optimum);
  void approach(Aim aim, Optimum &optimum);
  void center(Aim aim, double weight);
  bool barrier(Aim aim, double weight, double &value, bool derivatives);
  // conic_active_set.cpp
  void findActive(double weight, Optimum &optimum) const;
  bool solveActive(Aim aim, Optimum &optimum);
  bool newtonStep(Aim aim, Optimum &optimum, double &change);
  [[nodiscard]] bool obeysActive(const Optimum &optimum) const;
  [[nodiscard]] int mostViolated(const Optimum &optimum) const;

  Eigen::MatrixXd matrix_, kernel_, kernelRows_;  // kernelRows: the transposed kernel
  Eigen::VectorXd rhs_, rowLength_, free_;
  Optimum innermost_, least_, trial_;
  std::vector<Limit> limits_;
  MatrixParts partition_;
  mutable std::vector<Part> parts_;  // as many as the partition has, and others of before
  bool hasKernel_ = false;
  Eigen::VectorXd unknown_, step_, gradient_, point_, base_;  // unknown: coordinates in the kernel, then the common slack
  Eigen::MatrixXd hessian_;
  Eigen::LDLT<Eigen::MatrixXd> hessianFactor_;
  Eigen::VectorXd du_, logSlope_;  // of the slack and of the barrier of one limit
  // Of an optimum with its active limits; slope: kernel × active.
  Eigen::VectorXd across_;
  Eigen::MatrixXd slope_, optimality_;
  Eigen::PartialPivLU<Eigen::MatrixXd> optimalityFactor_;
  double scale_ = 1;
};

}  // namespace tf::runtime
