#include "runtime/simulate/integrators.h"

#include "runtime/integrate/cvode_integrator.h"
#include "runtime/integrate/dormand_prince.h"
#include "runtime/integrate/element_integrator.h"
#include "runtime/integrate/radau.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

IntegratorSettings Integrators::settings(const SimulationOptions &options) const {
  const tf_model &model = dynamics_.model().model();
  IntegratorSettings settings;
  settings.tolerance = options.tolerance;
  settings.fixedStep = options.fixedStep;
  settings.scale.assign(dynamics_.size(), 1.0);
  for (int k = 0; k < model.variable_count; ++k) {
    const tf_variable &variable = model.variables[k];
    const double nominal = std::abs(variable.nominal) > 0 ? std::abs(variable.nominal) : 1;
    if (variable.kind == TF_KIND_COORDINATE)
      settings.scale[variable.index] = nominal;
    else if (variable.kind == TF_KIND_VELOCITY)
      settings.scale[model.nq + variable.index] = nominal;
    else if (variable.kind == TF_KIND_STATE)
      settings.scale[model.nq + model.nv + variable.index] = nominal;
  }
  return settings;
}

void Integrators::make(const SimulationOptions &options) {
  const IntegratorSettings settings = this->settings(options);
  const int n = dynamics_.size();
  const auto element = [&](std::unique_ptr<ElementMethod> method) {
    return std::make_unique<ElementIntegrator>(dynamics_, settings, std::move(method));
  };
  wanted_ = options.integrator;
  primaryIsStep_ = wanted_ == TF_STEP || (wanted_ == TF_AUTO && options.stages > 0);
  mayFallBack_ = wanted_ != TF_CVODE && options.fixedStep <= 0;
  fallback_.reset();
  launch_.reset();
  bounces_.reset();
  if (wanted_ == TF_CVODE)
    primary_ = std::make_unique<CvodeIntegrator>(dynamics_, settings);
  else if (primaryIsStep_)
    primary_ = element(std::make_unique<Radau>(n, options.stages > 0 ? options.stages : options.tolerance < 1e-5 ? 4 : 3));
  else
    primary_ = element(std::make_unique<DormandPrince>(n));
  const std::vector<int> pairs = pairsOfTangents(dynamics_.model().model());
  if (wanted_ != TF_STEP && std::any_of(pairs.begin(), pairs.end(), [](int first) { return first >= 0; }))
    launch_ = element(std::make_unique<Radau>(n, 4));
  if (wanted_ == TF_CVODE)
    bounces_ = element(std::make_unique<DormandPrince>(n));
  current_ = primary_.get();
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

SmoothIntegrator *Integrators::forStiffness() { return wanted_ == TF_AUTO && mayFallBack_ && current_->isStiff() ? fallback() : nullptr; }

void Integrators::countStep(tf_statistics &statistics) const {
  ++statistics.steps;
  if (current_ == fallback_.get() || (wanted_ == TF_CVODE && primaryIsCurrent()))
    ++statistics.cvode_steps;
  else if (current_ == launch_.get() || primaryIsStep_)
    ++statistics.step_steps;
  else
    ++statistics.explicit_steps;
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
