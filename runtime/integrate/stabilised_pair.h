// An explicit pair, one of lower order for modes whose slips turn and for those steps that something else than the error ends early (an
// event, an output), and a stabilised method for those that stability would shorten: all are one-step methods, so that every step may be
// any one's. Damping that is stiff in one mode is so in the next ones: what is known of the spectrum outlives events.
#pragma once

#include "runtime/integrate/explicit_method.h"
#include "runtime/integrate/spectral_radius.h"
#include "runtime/integrate/stabilised_method.h"

#include <memory>

namespace tf::runtime {

class StabilisedPair final : public ElementMethod {
public:
  // `low` and `stabilised` may be null.
  StabilisedPair(int size, std::unique_ptr<ExplicitMethod> pair, std::unique_ptr<ExplicitMethod> low,
                 std::unique_ptr<StabilisedMethod> stabilised);

  void forget() override;
  void restart(bool slipsTurn) override;
  double adjustStep(double h, ModeDynamics &dynamics, double t0, const double *y0, const double *f0, const double *scale) override;
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void reject(const double *scale) override;
  void finish(double error, const double *scale) override;
  void interpolate(double theta, double *y) override { current().interpolate(theta, y); }
  [[nodiscard]] bool isInterpolantDear() const override { return current().isInterpolantDear(); }
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override { return current().errorNorm(scale, tolerance); }
  [[nodiscard]] double errorOrder() const override { return current().errorOrder(); }
  [[nodiscard]] int interiorStages() const override { return current().interiorStages(); }
  [[nodiscard]] double stabilityRatio() const override;
  [[nodiscard]] bool isStabilised() const override { return isStabilised_; }
  [[nodiscard]] double stiffness(const tf_model & /*model*/, const double * /*scale*/) const override {
    return isDamped_ && radius_.isKnown() ? radius_.bound() : 0;
  }

private:
  [[nodiscard]] bool needsEstimate(double h) const;
  [[nodiscard]] bool mayBeLow(double h) const;
  void judge();
  [[nodiscard]] bool isDoubted() const;
  void watchBorder(const double *scale);
  void doubtRadius(const double *error, const double *scale);
  [[nodiscard]] ExplicitMethod &explicitMethod() const { return isLow_ ? *low_ : *pair_; }
  [[nodiscard]] ElementMethod &current() const { return isStabilised_ ? static_cast<ElementMethod &>(*stabilised_) : explicitMethod(); }

  std::unique_ptr<ExplicitMethod> pair_, low_;
  bool isLow_ = false;      // the last step was low_'s, if not stabilised_'s
  bool slipsTurn_ = false;  // in this mode: no order is high where they end
  double lowLength_ = 0;    // the step that the error of low_ would allow; 0: not known
  bool endsEarly_ = false;  // the mode before this one ended in its first step
  int modeSteps_ = 0;       // in this mode
  double border_;           // of the pair, for h times the bound of the radius: what is not resolved there dies out
  std::unique_ptr<StabilisedMethod> stabilised_;
  SpectralRadius radius_;
  bool isKnown_ = false;        // damping has been found stiff, and radius_ is what it was last
  bool isDamped_ = false;       // and is so in this mode
  bool mayStabilise_ = false;   // in the next step
  bool isStabilised_ = false;   // the last step was stabilised_'s
  double length_ = 0;           // of the last step
  int borderSteps_ = 0;         // of the pair, less those that were not at its border
  int patience_;                // so many of them tell that damping is stiff
  int pause_, pauseLeft_;       // steps of the pair after one of stabilised_ that was not worth its evaluations
  int wasted_ = 0;              // evaluations of rejected steps
  int stepsSinceEstimate_ = 0;  // of stabilised_
  int doubtfulSteps_ = 0;       // in a row, at the pair's border though the bound of the radius has them well inside
  bool isNewMode_ = true;       // since the estimate
  bool isAdjusted_ = false;     // the step is shorter than wanted, or stabilised_'s
  int adjustedSteps_ = 0;       // such ones in this mode
};

}  // namespace tf::runtime
