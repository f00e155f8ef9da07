// The integrators of a run and which of them follows the mode (theory.md section 6): the primary one of the options; CVODE, where it is to
// take over; collocation for slips of two components that start from zero; the explicit one for low bounces beside CVODE.
#pragma once

#include "runtime/integrate/smooth_integrator.h"
#include "runtime/simulate/simulation.h"

#include <memory>
#include <optional>
#include <string>

namespace tf::runtime {

// Why an integrator follows the mode.
enum class IntegratorReason : std::uint8_t {
  Primary,    // it is the one of the options
  Launch,     // slips of two components start from zero
  Stiffness,  // stability limited the steps of the one before
  Failure,    // the one before could not meet the tolerance
  LowBounces
};

class Integrators {
public:
  explicit Integrators(ModeDynamics &dynamics) : dynamics_(dynamics) {}

  // For a new run with these options; the primary one is the current one.
  void prepare(const SimulationOptions &options);
  // What they have learnt from the steps before.
  void forget();
  [[nodiscard]] SmoothIntegrator &current() { return *current_; }
  void use(SmoothIntegrator &integrator, IntegratorReason reason) {
    current_ = &integrator;
    reason_ = reason;
  }

  [[nodiscard]] SmoothIntegrator &primary() { return *primary_; }
  [[nodiscard]] bool primaryIsCurrent() const { return current_ == primary_.get(); }
  // For a mode that begins as the dynamics was started: slips of two components find their direction within instants, in which the
  // tolerance does not see it; collocation, whose stages obey the law of friction exactly, follows them. Between low bounces, see below.
  void useForNewMode(bool bouncesLow);
  // CVODE starts with steps of low order, which low bounces would consist of. Null: the primary one is as good.
  [[nodiscard]] SmoothIntegrator *forLowBounces() { return bounces_.get(); }
  [[nodiscard]] bool isForLowBounces() const { return bounces_ != nullptr && current_ == bounces_.get(); }
  // The slips that the current one was chosen for are no longer small.
  [[nodiscard]] bool launchIsOver() const { return current_ == launch_.get() && dynamics_.hasLaunched() && !dynamics_.holdsEdge(); }
  // To take over where the current one cannot meet the tolerance; null: there is none.
  [[nodiscard]] SmoothIntegrator *afterFailure();
  // After a step without event. To take over where stability limits the steps of the current one, or slips of two components stay slow;
  // null: there is none.
  [[nodiscard]] SmoothIntegrator *forStiffness();

  // Counts a step of the current one.
  void countStep(tf_statistics &statistics) const;
  // It covered the given time. Returns "cvode: stiff" if the step before was another integrator's, else an empty text.
  std::string account(double duration, tf_statistics &statistics);
  // Rejected steps, Jacobians and iterations of all.
  void addStatistics(tf_statistics &statistics) const;

private:
  enum class Kind : std::uint8_t { Explicit, Step, Cvode };

  void make(const SimulationOptions &options);
  [[nodiscard]] IntegratorSettings settings(const SimulationOptions &options) const;
  [[nodiscard]] Kind currentKind() const;
  SmoothIntegrator *fallback();

  ModeDynamics &dynamics_;
  SimulationOptions options_;                             // that they were made for
  std::unique_ptr<SmoothIntegrator> primary_, fallback_;  // the fallback is made when it is needed first
  std::unique_ptr<SmoothIntegrator> launch_, bounces_;
  tf_integrator wanted_ = TF_AUTO;
  bool primaryIsStep_ = false, mayFallBack_ = false;
  SmoothIntegrator *current_ = nullptr;
  IntegratorReason reason_ = IntegratorReason::Primary;
  std::optional<Kind> lastKind_;  // of the last step
  int slowSteps_ = 0;             // of the explicit one in which a slip of two components was small
};

}  // namespace tf::runtime
