// The complementarity problem of Coulomb friction with slips of one and two components: the rows of planar_friction.h, and pairs of
// TwoSided rows that share the disk ‖λ_t‖ ≤ limit: w_t = 0, or λ_t = −limit·w_t/‖w_t‖. Forces are the zeros of the projection equations
//     λ = P_K(λ − w),   w = D λ + φ,
// (Alart and Curnier, Computer Methods in Applied Mechanics and Engineering 92, 1991), found by the semismooth Newton method.
#pragma once

#include "runtime/contact/lu_factor.h"
#include "runtime/contact/planar_friction.h"

#include <Eigen/Dense>

#include <functional>
#include <vector>

namespace tf::runtime {

struct ConeFrictionProblem : PlanarFrictionProblem {
  std::vector<int> partner;  // m: the other row of a pair (the next or the previous one), or −1

  // As PlanarFrictionProblem; no pairs.
  void resize(int normals, int tangents);
};

struct ConeFrictionSolution {
  bool solved = false;
  std::vector<double> force, acceleration;
  double violation = 0, scale = 0;  // see PlanarFrictionSolution
};

class ConeFrictionSolver {
public:
  ConeFrictionProblem &problem() { return problem_; }
  [[nodiscard]] const ConeFrictionProblem &problem() const { return problem_; }

  // `guess` (may be null): forces to start from, n + m. `tolerance`: accepted violation.
  const ConeFrictionSolution &solve(const double *guess, double tolerance);
  // √D_rr, or 1 where it is zero; the same for both rows of a pair.
  [[nodiscard]] const std::vector<double> &metric() const { return metric_; }
  // Violation of the last problem's conditions by other forces and accelerations, relative to the size of the data.
  double certificate(const std::vector<double> &force, const std::vector<double> &acceleration);
  [[nodiscard]] int iterations() const { return iterations_; }

private:
  struct DiskProjection {
    bool isInside = false;
    double factor = 0, shrink = 0, rise = 0;
  };

  // Of the equations' residual behind a part of a step.
  struct LineSearch {
    double length = 0, norm = 0;
  };

  void scale();
  double positivePart(double x, double &slope) const;
  [[nodiscard]] DiskProjection projectOnDisk(double length, double bound) const;
  void residual(const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives);
  void normalResidual(int i, double force, double acceleration, bool derivatives);
  void tangentResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives);
  void diskResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives);
  [[nodiscard]] double limit(int j) const;
  [[nodiscard]] double size(const Eigen::VectorXd &force) const;
  Eigen::VectorXd newtonStep();
  LineSearch shorten(const Eigen::VectorXd &from, const Eigen::VectorXd &step, double norm, double shortest);
  double improve(Eigen::VectorXd &force);
  void sweep(Eigen::VectorXd &force, int count);
  void setSmoothing(double smoothing);
  bool followSmoothing();
  bool attempt(Eigen::VectorXd force);
  bool attemptRest();
  void wander(Eigen::VectorXd &force, const std::function<double()> &random);
  bool attemptScattered();

  ConeFrictionProblem problem_;
  ConeFrictionSolution solution_;
  std::vector<double> metric_;
  Eigen::MatrixXd delassus_, response_, jacobian_;  // in the metric of D; D + σ I; dF/dλ
  Eigen::VectorXd bias_, residual_, best_;
  std::vector<double> upper_, friction_, offset_;
  std::vector<double> pressing_;   // n: the normal force that limits see, P_K(λ − w)
  LuFactor factor_;                // of dF/dλ
  Eigen::MatrixXd pressingSlope_;  // its derivative by λ
  double magnitude_ = 0, tolerance_ = 0, bestViolation_ = 0;
  double frictionFactor_ = 1;  // of the homotopy
  double smoothing_ = 0;       // σ
  int iterations_ = 0;
};

}  // namespace tf::runtime
