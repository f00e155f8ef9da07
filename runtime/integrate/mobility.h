// How accelerations follow from forces under the bilateral constraints (theory.md section 1):
//     M a = f + Hᵀ ν,   H a + bias = 0,      W = M⁻¹ − M⁻¹Hᵀ (H M⁻¹ Hᵀ)⁺ H M⁻¹
// Without constraints W = M⁻¹. Redundant constraints leave a and W unique; their multipliers are the least-norm ones. They depend on each
// other where the constraints hold, and only there: beside these positions, where stages of a step are, a choice of independent rows stands
// for all, so that the motion is a smooth function of the state there too.
#pragma once

#include "runtime/integrate/mass_matrix.h"

#include <Eigen/Dense>

#include <optional>
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
  // H [nh × nv, row-major] at the point of the mass matrix, after setMass; `shares` [nh]: a row's length relative to what it is elsewhere
  // (ContactScales::share), as of one that vanishes at a position and is made of errors near it. False if H is not finite.
  bool setConstraints(const double *jacobian, const double *shares);
  // From now on the point's independent rows stand for all, if there are fewer than all here and at the last such point, where the
  // constraints held too: rows may depend on each other at one place of the motion only. Where the motion has not gone on from that place
  // (`isElsewhere` false) no further rows are left out. True if the rows that stand for all are other ones now.
  bool chooseIndependent(bool isElsewhere);
  // The row has no part in anything: it is far shorter than elsewhere.
  [[nodiscard]] bool hasVanished(int row) const { return scale_[row] == 0; }
  // Rows depended on others at the last point of chooseIndependent.
  [[nodiscard]] bool wasRedundant() const { return deficiency_ > 0; }
  // All rows count again, as where they have become other ones.
  void keepAll();

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
  // The row that is the least independent of those before it, of all or of the rows that stand for all, and its part that is independent of
  // them, relative to its length elsewhere; none where fewer are independent.
  struct WeakRow {
    int row;
    double part;
  };
  [[nodiscard]] std::optional<WeakRow> weakestRow() const;
  // The rows that add nothing to those before them: the same ones wherever the same rows depend on each other.
  [[nodiscard]] std::vector<DependentRow> dependentRows() const;

private:
  // Rows that are independent, chosen one by one: the one whose independent part is the largest, relative to its length elsewhere.
  struct Pivots {
    std::vector<int> rows;  // in their order
    double least = 0;       // the part of the last one chosen
  };
  void factorise();
  [[nodiscard]] Pivots pivots() const;
  [[nodiscard]] double independentLength(int row, double pivot) const;
  // A ν with H M⁻¹ Hᵀ ν = r, in place: that of the rows that stand for all, or (H M⁻¹ Hᵀ)⁺ r.
  void solve(Eigen::VectorXd &residual) const;
  // ν = (H M⁻¹ Hᵀ)⁺ r in place
  void solveAll(Eigen::VectorXd &residual) const;
  void react(double *x) const;

  int nv_, nh_, rank_;
  MassMatrix mass_;
  std::vector<int> kept_;               // the rows that stand for all; empty: all
  bool isReduced_ = false;              // factor_ is that of the rows kept, of fewer than all
  int deficiency_ = 0;                  // at the last point of chooseIndependent: how many rows depend on others
  Eigen::MatrixXd jacobian_;            // nv × nh: Hᵀ with its columns scaled to unit length in the metric of M⁻¹
  Eigen::MatrixXd response_;            // nv × nh: M⁻¹ Hᵀ, scaled likewise
  Eigen::MatrixXd half_, scaledHalf_;   // nv × nh: L⁻¹ P Hᵀ and Δ⁻¹ L⁻¹ P Hᵀ, scaled likewise
  Eigen::MatrixXd inertia_;             // nh × nh: H M⁻¹ Hᵀ, scaled; unit diagonal but of rows that nearly vanish
  Eigen::VectorXd scale_, shares_;      // a row's factor; shares of setConstraints, at most 1
  Eigen::LLT<Eigen::MatrixXd> factor_;  // of all rows, or of those that stand for them
  mutable Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition_;  // of all rows, where they are not independent
  mutable Eigen::VectorXd work_, solution_, keptWork_;
  Eigen::VectorXd second_;
};

}  // namespace tf::runtime
