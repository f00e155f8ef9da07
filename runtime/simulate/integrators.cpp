#include "runtime/simulate/integrators.h"

#include "runtime/integrate/bogacki_shampine.h"
#include "runtime/integrate/cvode_integrator.h"
#include "runtime/integrate/dormand_prince.h"
#include "runtime/integrate/dormand_prince_8.h"
#include "runtime/integrate/element_integrator.h"
#include "runtime/integrate/radau.h"
#include "runtime/integrate/rock2.h"
#include "runtime/integrate/rock4.h"
#include "runtime/integrate/stabilised_pair.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace tf::runtime {

namespace {

// Where the tolerance is very loose, events and stability limit the steps rather than errors: the fewer evaluations in a step the better.
// Order 8 pays but where the tolerance is loose, since its steps of twelve evaluations are too long there for the pieces between events,
// and where a step is short for other reasons than its error. Where slips of two components stop, their direction turns ever faster: no
// order is high in modes that have such slips (`slipsTurn`: a mode of the model may). ROCK4, of order 4, does not pay where the tolerance
// is tight, nor does ROCK2, of order 2, where it is not very loose. Inside stabilised steps fast components are within the tolerance, but
// their rates, the larger the faster they are, are not: without them for sensitivities, which are integrated along these.
std::unique_ptr<ElementMethod> explicitMethod(int size, const IntegratorSettings &settings, bool slipsTurn) {
  constexpr double ofRock2 = 5e-3, veryLoose = 5e-4, loose = 2e-6, tight = 2e-9;
  if (settings.fixedStep > 0)
    return std::make_unique<DormandPrince>(size);
  if (settings.tolerance <= tight && !slipsTurn)
    return std::make_unique<DormandPrince8>(size, settings.tolerance);
  const bool isHigh = settings.tolerance <= loose;
  std::unique_ptr<ExplicitMethod> pair, low;
  if (isHigh) {
    pair = std::make_unique<DormandPrince8>(size, settings.tolerance);
    low = std::make_unique<DormandPrince>(size);
  } else {
    pair = std::make_unique<DormandPrince>(size);
    if (settings.tolerance > veryLoose && !slipsTurn)
      low = std::make_unique<BogackiShampine>(size);
  }
  std::unique_ptr<StabilisedMethod> stabilised;
  if (settings.isDifferentiated)
    stabilised = nullptr;
  else if (settings.tolerance > ofRock2)
    stabilised = std::make_unique<Rock2>(size, settings.tolerance);
  else
    stabilised = std::make_unique<Rock4>(size, settings.tolerance);
  return std::make_unique<StabilisedPair>(size, std::move(pair), std::move(low), std::move(stabilised));
}

}  // namespace

IntegratorSettings Integrators::settings(const SimulationOptions &options) const {
  IntegratorSettings settings;
  settings.tolerance = options.tolerance;
  settings.fixedStep = options.fixedStep;
  settings.isDifferentiated = !options.sensitivities.empty();
  settings.scale = dynamics_.model().scales.nominal();
  return settings;
}

// Those of the run before serve again where nothing has changed; CVODE begins anew.
void Integrators::prepare(const SimulationOptions &options) {
  const bool same = primary_ && options.integrator != TF_CVODE && options.integrator == options_.integrator &&
                    options.tolerance == options_.tolerance && options.stages == options_.stages &&
                    options.fixedStep == options_.fixedStep && options.sensitivities.empty() == options_.sensitivities.empty();
  if (!same)
    make(options);
  fallback_.reset();
  for (SmoothIntegrator *integrator : {primary_.get(), launch_.get(), bounces_.get()})
    if (integrator != nullptr)
      integrator->resetStatistics();
  forget();
  use(*primary_, IntegratorReason::Primary);
  lastKind_.reset();
}

void Integrators::forget() {
  for (SmoothIntegrator *integrator : {primary_.get(), launch_.get(), bounces_.get()})
    if (integrator != nullptr)
      integrator->forget();
}

void Integrators::make(const SimulationOptions &options) {
  options_ = options;
  const IntegratorSettings settings = this->settings(options);
  const int n = dynamics_.size();
  const tf_model &model = dynamics_.model().model();
  const bool slipsTurn = std::any_of(model.contacts, model.contacts + model.nc, sharesDisk<tf_contact>) ||
                         std::any_of(model.frictions, model.frictions + model.nf, sharesDisk<tf_friction>);
  const auto element = [&](std::unique_ptr<ElementMethod> method) {
    return std::make_unique<ElementIntegrator>(dynamics_, settings, std::move(method));
  };
  // Sensitivities are integrated along the interpolant.
  const Radau::Accuracy accuracy = options.sensitivities.empty() ? Radau::Accuracy::OfEnd : Radau::Accuracy::Inside;
  wanted_ = options.integrator;
  primaryIsStep_ = wanted_ == TF_STEP || (wanted_ == TF_AUTO && options.stages > 0);
  mayFallBack_ = wanted_ != TF_CVODE && options.fixedStep <= 0;
  launch_.reset();
  bounces_.reset();
  if (wanted_ == TF_CVODE)
    primary_ = std::make_unique<CvodeIntegrator>(dynamics_, settings);
  else if (primaryIsStep_)
    primary_ = element(std::make_unique<Radau>(n, options.stages > 0 ? options.stages : options.tolerance < 1e-5 ? 4 : 3, accuracy));
  else
    primary_ = element(explicitMethod(n, settings, slipsTurn));
  if (wanted_ != TF_STEP && slipsTurn)
    launch_ = element(std::make_unique<Radau>(n, 4, accuracy));
  if (wanted_ == TF_CVODE)
    bounces_ = element(std::make_unique<DormandPrince>(n));
}

void Integrators::useForNewMode(bool bouncesLow) {
  slowSteps_ = 0;
  if (launch_ && dynamics_.launches())
    use(*launch_, IntegratorReason::Launch);
  else if (launch_ && wanted_ != TF_CVODE && dynamics_.holdsEdge())
    use(*launch_, IntegratorReason::Stiffness);
  else if (bounces_ && bouncesLow)
    use(*bounces_, IntegratorReason::LowBounces);
  else
    use(*primary_, IntegratorReason::Primary);
}

SmoothIntegrator *Integrators::fallback() {
  if (mayFallBack_ && !fallback_)
    fallback_ = std::make_unique<CvodeIntegrator>(dynamics_, primary_->settings());
  return fallback_.get();
}

SmoothIntegrator *Integrators::afterFailure() {
  const bool isBesideCvode = current_ == bounces_.get() || (current_ == launch_.get() && !mayFallBack_);
  SmoothIntegrator *other = isBesideCvode ? primary_.get() : fallback();
  return other != current_ ? other : nullptr;
}

// The direction of a slow slip is stiff, and its friction jumps at zero: the stages of explicit steps, on all sides of it, may average to a
// rest that no step sees. The direction of one that is not many times faster than the errors of steps is made of these.
SmoothIntegrator *Integrators::forStiffness() {
  constexpr int mostSlowSteps = 30;
  constexpr double slowest = 100;  // tolerances
  const bool isSlow = launch_ && currentKind() == Kind::Explicit && dynamics_.hasSlowSlips();
  slowSteps_ = isSlow ? slowSteps_ + 1 : 0;
  if (slowSteps_ > mostSlowSteps || (isSlow && dynamics_.hasSlipsBelow(slowest * current_->settings().tolerance)))
    return launch_.get();
  const bool mayLeave = wanted_ == TF_AUTO || (wanted_ == TF_EXPLICIT && current_->settings().isDifferentiated);
  return mayLeave && mayFallBack_ && current_->isStiff() ? fallback() : nullptr;
}

Integrators::Kind Integrators::currentKind() const {
  if (current_ == fallback_.get() || (wanted_ == TF_CVODE && primaryIsCurrent()))
    return Kind::Cvode;
  return current_ == launch_.get() || primaryIsStep_ ? Kind::Step : Kind::Explicit;
}

void Integrators::countStep(tf_statistics &statistics) const {
  ++statistics.steps;
  ++*std::array{&statistics.explicit_steps, &statistics.step_steps, &statistics.cvode_steps}[static_cast<std::size_t>(currentKind())];
  if (current_->isStabilised())
    ++statistics.stabilised_steps;
}

std::string Integrators::account(double duration, tf_statistics &statistics) {
  static constexpr std::array<std::string_view, 3> names = {"explicit", "step", "cvode"};
  static constexpr std::array<std::string_view, 5> reasons = {"a new mode, or the reason for another one is over", "slip starts from zero",
                                                              "stiff", "the tolerance could not be met", "low bounces"};
  const Kind kind = currentKind();
  const auto index = static_cast<std::size_t>(kind);
  *std::array{&statistics.explicit_time, &statistics.step_time, &statistics.cvode_time}[index] += duration;
  if (current_->isStabilised())
    statistics.stabilised_time += duration;
  const bool changes = lastKind_ && *lastKind_ != kind;
  lastKind_ = kind;
  if (!changes)
    return {};
  if (reason_ != IntegratorReason::Primary)
    ++*std::array{&statistics.launch_changes, &statistics.stiff_changes, &statistics.failure_changes,
                  &statistics.bounce_changes}[static_cast<std::size_t>(reason_) - 1];
  return fmt::format("{}: {}", names[index], reasons[static_cast<std::size_t>(reason_)]);
}

void Integrators::addStatistics(tf_statistics &statistics) const {
  for (const SmoothIntegrator *integrator : {primary_.get(), fallback_.get(), bounces_.get(), launch_.get()})
    if (integrator != nullptr) {
      statistics.rejected_steps += integrator->statistics().rejected;
      statistics.jacobians += integrator->statistics().jacobians;
      statistics.newton_iterations += integrator->statistics().iterations;
    }
}

}  // namespace tf::runtime
