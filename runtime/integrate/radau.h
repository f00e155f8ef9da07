// Radau IIA collocation with 1 to 4 stages, order 2s − 1 (Hairer, Wanner, Solving Ordinary Differential Equations II, IV.5, IV.8). The
// stage equations are solved by fixed-point iteration while it contracts fast, else by simplified Newton with the compiler's Jacobian.
// Where slow slips of two components grow, whose stiffness is that of the reciprocal slip, Newton's method has the Jacobians of all stages:
// of the turn of friction alone, which is of low rank, and of all else where that does not contract fast.
#pragma once

#include "runtime/integrate/element_method.h"
#include "runtime/integrate/low_rank_stages.h"
#include "runtime/integrate/stage_equations.h"

#include <Eigen/Dense>

#include <memory>

namespace tf::runtime {

class Radau final : public ElementMethod {
public:
  // The error that is controlled: of the end, or of the interpolant inside too, whose order is s + 1 only.
  enum class Accuracy : std::uint8_t { OfEnd, Inside };

  // 1 ≤ stages ≤ 4
  Radau(int size, int stages, Accuracy accuracy = Accuracy::OfEnd);

  void restart(bool slipsTurn) override;
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void interpolate(double theta, double *y) override;
  void accept() override;
  [[nodiscard]] bool holdsToleranceInside() const override { return errorPower_ == 1; }
  [[nodiscard]] bool hasExactStages() const override { return true; }
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override;
  [[nodiscard]] double errorOrder() const override { return (stages_ + 1) * errorPower_; }
  [[nodiscard]] int interiorStages() const override { return stages_ - 1; }
  [[nodiscard]] double stiffness(const tf_model &model, const double *scale) const override;
  [[nodiscard]] Quadrature quadrature() const override {
    const auto weights = std::span(coefficients_).last(static_cast<std::size_t>(stages_));
    return {nodes_, weights};
  }

private:
  enum class Iteration : std::uint8_t { Converged, Slow, Failed };
  // What the last element's linear equations have of the Jacobian.
  enum class Linearisation : std::uint8_t { None, Turning, Full };

  void predict(double h, const double *f0);
  void predictAlongTangent(double h, const double *f0);
  Iteration solveTurning(ModeDynamics &dynamics, double t0, double h, const double *scale, const double *f0, double accuracy);
  bool predictTurning(ModeDynamics &dynamics, double t0, double h, const double *scale);
  bool continueSlips(ModeDynamics &dynamics, double t0, double h, const double *scale, int first, int end);
  void pointOfStage(int s);
  bool evaluateStages(ModeDynamics &dynamics, double t0, double h);
  double update(double h, const double *scale);
  Iteration fixedPoint(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy);
  Iteration newton(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy);
  Iteration turningNewton(ModeDynamics &dynamics, double t0, double h, const double *scale, double accuracy);
  const double *startRate(ModeDynamics &dynamics, double t0, const double *f0);
  bool startsAreSteady(ModeDynamics &dynamics, double t0, double h);
  bool turnsBack(ModeDynamics &dynamics, double t0, double h);
  double correct(double h, const double *scale);
  bool factorise(ModeDynamics &dynamics, double t0, double h);
  bool evaluateWithJacobian(ModeDynamics &dynamics, double t0, double h, int s);
  bool factoriseStages(ModeDynamics &dynamics, double t0, double h);
  void factoriseEquations(double h);
  void estimateError(const double *f0, double h);
  void dampError(double h);

  int stages_;
  double errorPower_ = 1;
  std::vector<double> nodes_;         // c_1 … c_s = 1
  std::vector<double> coefficients_;  // a_ij, row-major
  std::vector<double> embedded_;      // weights of f0, F_1 … F_s of the error estimate
  std::vector<double> barycentric_;   // of the nodes 0, c_1 … c_s
  std::vector<double> stage_;         // Z_i = Y_i − y0
  std::vector<double> rate_;          // F_i
  std::vector<double> begin_, point_, startRate_;
  std::vector<double> angles_, previousAngles_;  // of slips that start, at all stages, by the latest iterations
  double h_ = 0;
  bool hasPast_ = false;
  std::vector<double> pastBegin_, pastStage_;
  double pastH_ = 0;
  std::unique_ptr<StageEquations> equations_, errorEquations_;
  LowRankStages turning_, errorTurning_;
  Linearisation linearisation_ = Linearisation::None;
  Eigen::VectorXd residual_, errorResidual_;
  bool stiff_ = false;
};

}  // namespace tf::runtime
