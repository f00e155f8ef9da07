// The explicit method of Dormand and Prince of order 8 with error estimates of orders 5 and 3 and dense output of order 7 (DOP853: Hairer,
// Nørsett, Wanner, Solving Ordinary Differential Equations I, II.5, II.6 and II.10). For tight tolerances.
#pragma once

#include "runtime/integrate/element_method.h"

#include <cstddef>
#include <utility>

namespace tf::runtime {

class DormandPrince8 final : public ElementMethod {
public:
  explicit DormandPrince8(int size);

  void restart() override {}
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  // The first call after an element evaluates the dynamics at three more points, and at the end again; where that fails, the cubic through
  // both ends is taken.
  void interpolate(double theta, double *y) const override;
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override;
  [[nodiscard]] double stabilityRatio() const override;
  [[nodiscard]] double errorOrder() const override { return 8; }
  [[nodiscard]] int interiorStages() const override { return 10; }

private:
  static constexpr std::size_t stageCount = 12, extraCount = 3, coefficientCount = 7;

  [[nodiscard]] double *stage(std::size_t s) const { return stages_.data() + s * static_cast<std::size_t>(n_); }
  template <const auto &table, std::size_t row, std::size_t count> void combine(double *y) const;
  template <std::size_t... s> bool solveStages(ModeDynamics &dynamics, std::index_sequence<s...> stages);
  template <std::size_t... s> bool solveExtraStages(std::index_sequence<s...> stages) const;
  void makeDense() const;

  // k1 … k12, dy/dt at the end, and the three stages of the dense output, n each; its coefficients are made when it is asked for.
  mutable std::vector<double> stages_, point_, dense_;
  mutable bool hasDense_ = false;
  std::vector<double> begin_;
  ModeDynamics *dynamics_ = nullptr;
  double t0_ = 0, h_ = 0;
};

}  // namespace tf::runtime
