// How accelerations follow from forces under the bilateral constraints (theory.md section 1):
//     M a = f + Hᵀ ν,   H a + bias = 0,      W = M⁻¹ − M⁻¹Hᵀ (H M⁻¹ Hᵀ)⁺ H M⁻¹
// Without constraints W = M⁻¹. Redundant constraints leave a and W unique; their multipliers are the least-norm ones.
#pragma once

#include "runtime/integrate/mass_matrix.h"

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

// A constraint row that follows from others before it.
struct DependentRow {
  int row = 0;
  std::vector<int> sources;  // independent rows that it is a combination of; none: it moves nothing
};

class Mobility {
public:
  // nh constraint rows on the velocities of the mass matrix
  Mobility(MassMatrix mass, int constraints);

  // M [nv × nv, row-major, symmetric]. False if it is not positive definite (or not finite).
  bool setMass(const double *mass);
  // H [nh × nv, row-major] at the point of the mass matrix, after setMass. False if it is not finite.
  bool setConstraints(const double *jacobian);

  // x = W b; x and b may be the same.
  void apply(const double *b, double *x) const;
  // a for the force f; `bias` [nh] may be null (zero). f and a may be the same.
  void accelerate(const double *force, const double *bias, double *acceleration) const;
  // ν for the total force f, contact forces included; `bias` may be null.
  void multipliers(const double *force, const double *bias, double *multipliers) const;
  // x += M⁻¹Hᵀ (H M⁻¹ Hᵀ)⁺ r: the smallest change in the metric of M that changes H x by r.
  void correct(const double *residual, double *x) const;

  [[nodiscard]] const MassMatrix &mass() const { return mass_; }
  [[nodiscard]] bool isConstrained() const { return nh_ > 0; }
  // Of a row b, z = L⁻¹ P b and scaled = Δ⁻¹ z (mass_matrix.h) on all places without their part along the constraints, so that products of
  // halves and second halves are those of W.
  void constrain(const double *b, double *z, double *scaled) const;
  // Number of independent constraint rows.
  [[nodiscard]] int rank() const { return rank_; }
  // The part of a row's length, in the metric of M⁻¹, that is independent of the rows before it, where all are independent.
  [[nodiscard]] double independentPart(int row) const { return factor_.matrixLLT()(row, row); }
  // The rows that add nothing to those before them: the same ones wherever the same rows depend on each other.
  [[nodiscard]] std::vector<DependentRow> dependentRows() const;

private:
  void factorise();
  // ν = (H M⁻¹ Hᵀ)⁺ r in place
  void solve(Eigen::VectorXd &residual) const;
  void react(double *x) const;

  int nv_, nh_, rank_;
  MassMatrix mass_;
  Eigen::MatrixXd jacobian_;           // nv × nh: Hᵀ with its columns scaled to unit length in the metric of M⁻¹
  Eigen::MatrixXd response_;           // nv × nh: M⁻¹ Hᵀ, scaled likewise
  Eigen::MatrixXd half_, scaledHalf_;  // nv × nh: L⁻¹ P Hᵀ and Δ⁻¹ L⁻¹ P Hᵀ, scaled likewise
  Eigen::MatrixXd inertia_;            // nh × nh: H M⁻¹ Hᵀ, scaled; unit diagonal
  Eigen::VectorXd scale_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition_;
  mutable Eigen::VectorXd work_, solution_;
  Eigen::VectorXd second_;
};

}  // namespace tf::runtime
