// What stops a run, in terms of the model: element, value, time, source line.
#pragma once

#include "runtime/integrate/mode_dynamics.h"
#include "runtime/model/model_instance.h"

#include <string>
#include <vector>

namespace tf::runtime {

class FailureTexts {
public:
  // Both must outlive the texts.
  FailureTexts(ModeDynamics &dynamics, const ModelInstance &instance)
      : model_(instance.model()), at_(dynamics.model()), dynamics_(dynamics), instance_(instance),
        all_(static_cast<std::size_t>(model_.nc) + model_.nf, 1) {}

  // Each is empty where nothing is wrong.
  // Restitution and rate of contacts at the parameters.
  std::string contactParameters();
  // Gaps, friction coefficients, bounds and radii of relaxed slips at the start (time, state).
  std::string contactsAtStart(double time, const double *state);
  // The first contact or friction element with relaxed friction, which sensitivities do not go through.
  [[nodiscard]] std::string relaxedSensitivities() const;
  // Start values [q, v, z] that are not finite.
  [[nodiscard]] std::string startValues(const double *state) const;
  // The first contact (that is closed in the mode, if one is given) or friction element whose coefficient or bound is negative at the
  // evaluation's point.
  std::string negativeFriction(const Mode *mode = nullptr);

  // "the mass matrix is singular: …", or what is wrong with it.
  [[nodiscard]] std::string singularMass() const;
  // The first contact whose gap, or friction element or touching contact whose slip, friction or bound, or a derivative of it, is no finite
  // number at (time, state).
  std::string undefinedContact(double time, const double *state);
  // The failure of the dynamics' last evaluation.
  std::string evaluation();

private:
  std::string slipRadii();
  std::string nonFinite();
  std::string nonFiniteContact();
  std::string nonFiniteConstraint();
  [[nodiscard]] std::string place(tf_kind kind, int index) const;

  const tf_model &model_;
  ModelEvaluation &at_;
  ModeDynamics &dynamics_;
  const ModelInstance &instance_;
  std::vector<std::uint8_t> all_;  // mask of all contacts and friction elements
};

}  // namespace tf::runtime
