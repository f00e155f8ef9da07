// The point of a polyhedron nearest to an origin: min ½‖x − x₀‖² subject to nᵀx = c for the first constraints, nᵀx ≥ c for the others.
// Dual active-set method (Goldfarb and Idnani, Mathematical Programming 27, 1983) with Hessian I: it starts at x₀ and adds one violated
// constraint after the other, so that an empty polyhedron is proved, not guessed. Dependent equations are found and left out.
#pragma once

#include "runtime/contact/dense.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tf::runtime {

class LeastNorm {
public:
  enum class Status : std::uint8_t { Solved, Empty, Contradictory };  // Contradictory: the equations alone

  // All data are undefined afterwards but the origin, which is 0. Normals should have about unit length.
  void resize(int variables, int equations, int inequalities);
  double *normal(int constraint) { return normals_.column(constraint); }
  double &bound(int constraint) { return bounds_[constraint]; }
  double &origin(int variable) { return origin_[variable]; }

  // `tolerance`: accepted violation of an inequality, `equationTolerance` of an equation that depends on others.
  Status solve(double tolerance, double equationTolerance);
  // As well with the equations of the last `solve`, for another origin.
  Status solveAgain(double tolerance, double equationTolerance);
  // The same active set for other data: least norm with the independent equations and active inequalities of the last `solve` as
  // equations. False where they have become dependent.
  bool solveActive();
  // The least-norm point (origin 0) of the active constraints as equations with other bounds.
  void pointOf(const double *bounds, double *point);
  // A value of `slack` is zero and about to become negative. Empty: no point of the polyhedron remains. Changes the active set only.
  Status activate(int constraint);
  // Removes an active inequality whose multiplier is about to become negative.
  void release(int constraint);

  [[nodiscard]] const std::vector<double> &point() const { return x_; }
  // Constraints that hold as equations: the independent equations, then inequalities.
  [[nodiscard]] const std::vector<int> &active() const { return active_; }
  // Of active()[k]; ≥ 0 for inequalities.
  [[nodiscard]] const std::vector<double> &multipliers() const { return multipliers_; }
  [[nodiscard]] double slack(int constraint) const;
  // Some equation depends on the others.
  [[nodiscard]] bool dependent() const { return dependent_; }
  // How far the slack of an inequality that is not active grows from the point of the last `solve` or `solveAgain`, moved along its normal
  // as the active constraints leave it until it meets another inequality: a lower bound of what the polyhedron has. Nothing changes.
  double slackWithinReach(int constraint);
  // After slackWithinReach: the equations alone fix the value of the inequality.
  [[nodiscard]] bool isFixed() const { return isFixed_; }
  // The largest residual of the equations at the point: of those that depended on others in the last `solve`.
  [[nodiscard]] double contradiction() const;

private:
  void mergeVariables();
  void separateVariables();
  void tellApart();
  [[nodiscard]] bool areEqual(int i, int j) const;
  [[nodiscard]] double *reflection(int k) { return reflections_.data() + static_cast<std::ptrdiff_t>(k) * rows_; }
  void loadReflection(int k);
  void formBasis();
  bool reflectActive(double accepted);
  bool reflect(int k, double accepted, int from);
  void solveReflected();
  void reflectEquations();
  void reflectKept();
  int dependentRow();
  double project(const double *normal);  // d = Jᵀ n; returns ‖d₂‖
  void append(int constraint, double multiplier, double length);
  void findDirection();
  void removeAt(int k);
  void dualDirection();  // r = R⁻¹ d₁
  void solveTransposed(const double *c);
  void fromActive(double *point) const;
  int blocking(double &step) const;
  Status addInequality(int constraint, double tolerance);

  int variables_ = 0, equations_ = 0, constraints_ = 0;
  DenseMatrix normals_, basis_, triangle_;  // J = (J₁ J₂) orthogonal, N = J₁ R
  std::vector<double> bounds_, origin_, x_, d_, r_, z_, multipliers_;
  // Since the last solve or solveActive: J = H_0 H_1 … (dense_kernels.h); J itself is made where a constraint is to be removed.
  DenseMatrix reflections_;
  int rows_ = 0;  // of reflections_
  // Variables that all active constraints have the same entries for have the same values: since solveActive, reflections are made of one
  // row for each set of them, √count times theirs.
  bool isMerged_ = false;
  std::vector<int> set_, sample_;         // of variables; of sets: the first variable
  std::vector<double> mark_, root_;       // of variables: a product with their entries; of sets
  mutable std::vector<double> setPoint_;  // workspace
  std::vector<double> scale_, cross_;
  double diagonal_ = 0;          // of R, of the constraint projected last
  std::size_t independent_ = 0;  // equations
  bool isReflected_ = false, isFixed_ = false;
  std::vector<int> active_, order_;
  bool dependent_ = false;
  std::vector<std::uint8_t> leftOut_;  // of equations: they depend on others
};

}  // namespace tf::runtime
