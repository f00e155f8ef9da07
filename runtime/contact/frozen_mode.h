// What contacts do on one piece of a frozen phase with slips of two components, and their forces there as a function of the velocities: the
// direction of friction of pairs turns with their slip (spatial_frozen_phase.h). The equations are factorised once for a piece, without
// that friction; with it remains a system of the size of the number of pairs that slip under a held contact.
#pragma once

#include "runtime/contact/conic_forces.h"
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/mode_equations.h"

#include <Eigen/Dense>

#include <vector>

namespace tf::runtime {

class FrozenMode {
public:
  enum class Normal : std::uint8_t { Off, Held, Push };     // λ_n = 0, w_n = 0, λ_n = rate
  enum class Tangent : std::uint8_t { None, Slip, Stick };  // λ_t = 0, −μ λ_n s, w_t = 0

  std::vector<Normal> normal;     // n
  std::vector<Tangent> tangent;   // m; both rows of a pair the same
  std::vector<int> sign;          // m: of slips of one component
  std::vector<double> direction;  // m: of pairs, the reference direction; (1, 0) where never set

  void resize(const FrozenProblem &problem);
  void setTangent(const FrozenProblem &problem, int j, Tangent kind, int slipSign);
  // Of the pair that begins with j, unless the vector is zero.
  void setDirection(int j, double x, double y);

  // D with the pairs that slip turned into their directions; forces (n + m) into these frames (sense 1) or back (−1).
  void turn(const FrozenProblem &problem, DenseMatrix &delassus) const;
  void turnForces(const FrozenProblem &problem, double sense, std::vector<double> &forces) const;

  // λ (n + m) at the velocities (n + m). The direction of friction is v_t/‖v_t‖ continued through zero along the reference direction, which
  // it is below `rest`. Redundant rows: the forces nearest to those of `refer`. False where they are not finite.
  bool forces(const FrozenProblem &problem, const std::vector<double> &velocity, double rest, std::vector<double> &force);
  // Forces (n + m) of the mode, of which those of redundant rows stay near.
  void refer(const std::vector<double> &force) {
    nearby_ = force;
    posed_ = false;
  }
  // Of the latest `forces`.
  [[nodiscard]] bool isRedundant() const { return redundant_; }
  // After `forces` with redundant rows: the forces with the largest common margin to their limits, 0 ≤ λ_n ≤ rate and ‖λ_t‖ ≤ μ λ_n, are
  // those to stay near. False, and nothing changes, where there is no margin; `leaving` (n + m, else 0) are then the rows without one, −1
  // at λ_n = 0 and 1 at the other limits.
  bool center(const FrozenProblem &problem, std::vector<int> &leaving);

private:
  // A matrix that may be singular: fill regular.matrix(), then call `factor`.
  struct ActiveFactor {
    LuFactor regular;
    Eigen::MatrixXd matrix;
    bool isSingular = false;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;  // where it is

    void factor();
    // The solution, of several the least one, or that nearest to `reference`.
    void solve(Eigen::VectorXd &x) const;
    void solveNear(const Eigen::VectorXd &reference, Eigen::VectorXd &x) const;
  };
  // A pair that slips, of the row j.
  struct SlippingPair {
    int row = 0, owner = 0;
    int unknown = -1;  // of the equations: the owner's normal force; −1: it is fixed
  };

  void turnDirections(const FrozenProblem &problem, const std::vector<double> &velocity, double rest);
  [[nodiscard]] bool isPosed() const;
  void pose(const FrozenProblem &problem);
  bool solveByPairs();
  void poseTurned(const FrozenProblem &problem);
  void solveTurned(const FrozenProblem &problem);
  [[nodiscard]] Eigen::VectorXd nearbyForces(const ModeEquations &equations) const;
  [[nodiscard]] ContactRowData rowsOf(const FrozenProblem &problem, const DenseMatrix &delassus, const std::vector<double> &friction) const;
  int poseLimits(const FrozenProblem &problem);

  std::vector<double> current_;  // m: directions of the pairs that slip

  // The mode without the friction of the pairs that slip, which is all that turns: its forces, and what a unit force of each row of a pair
  // adds to them (with the sign of friction).
  bool posed_ = false;
  std::vector<Normal> posedNormal_;
  std::vector<Tangent> posedTangent_;
  std::vector<int> posedSign_;
  std::vector<SlippingPair> pairs_;
  ModeEquations unturned_;
  ActiveFactor factor_;
  Eigen::VectorXd unknown_, own_;
  Eigen::MatrixXd response_;  // of pair k: columns 2 k and 2 k + 1
  LuFactor pairFactor_;
  std::vector<double> ownerForce_;  // of pairs

  // The mode with it, in frames along the slips.
  DenseMatrix turned_;
  ModeEquations equations_;
  ActiveFactor turnedFactor_;
  std::vector<double> turnedFriction_;

  std::vector<std::uint8_t> active_;
  std::vector<std::int8_t> slip_;
  std::vector<double> friction_, offset_, bias_, fixed_, nearby_;
  bool redundant_ = false;
  ConicForces admissible_;
};

}  // namespace tf::runtime
