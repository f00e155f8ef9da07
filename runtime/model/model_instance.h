// A model with its parameter values, starts and input constants as the user set them.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/model/outcome.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tf::runtime {

// Initial values, shapes nq, nv, nz, nu.
struct Starts {
  std::vector<double> q, v, z, u;
};

class ModelInstance {
public:
  // The model must have passed checkModel and outlive the instance.
  explicit ModelInstance(const tf_model &model);

  [[nodiscard]] const tf_model &model() const { return *model_; }

  // value of the name = sign * value of model().variables[variable].
  struct Reference {
    std::int32_t variable = -1;
    double sign = 1;
  };
  // Variable or alias of this name; blanks outside quoted parts do not count ("q[ 2 ]" is "q[2]").
  [[nodiscard]] std::optional<Reference> find(std::string_view name) const;
  // "there is no variable 'flor.gap'; did you mean 'floor.gap'?"; with `kind`, only names of that kind are suggested.
  [[nodiscard]] std::string unknownName(std::string_view name, std::optional<tf_kind> kind = std::nullopt) const;

  // Sets a parameter, the start of a coordinate, velocity or state, or the constant value of an input. Refused with a message that names
  // the reason: unknown names, results, parameters that are final, protected or structural, values that are NaN, outside min and max, not
  // whole (Integer) or not 0 or 1 (Boolean).
  Outcome<void> set(std::string_view name, double value);
  // Moves a parameter, a start or an input's default by `change`, whatever its bounds: for derivatives at the border of what is allowed.
  void nudge(std::int32_t variable, double change, double startTime);
  // Whether variable number `variable` may take the value: NaN, infinity of non-bounds, min, max, Integer, Boolean. `name` is what the
  // message calls it.
  [[nodiscard]] Outcome<void> checkValue(std::int32_t variable, double value, std::string_view name) const;
  // The same of a variable by its kind, flags and bounds.
  [[nodiscard]] static Outcome<void> checkValue(const tf_variable &described, double value, std::string_view name);
  // Computed parameters against their min and max; to be asked before a run.
  [[nodiscard]] Outcome<void> checkParameters() const;

  // np values; those bound to others are up to date.
  [[nodiscard]] std::span<const double> parameters() const { return parameters_; }
  // The model's starts with the set ones in their places; u: the model's starts or the constants set. Quaternions of which a part is set
  // are normalised.
  [[nodiscard]] Starts starts(double startTime) const;
  // As well, into `starts`, whose arrays are used again.
  void starts(double startTime, Starts &starts) const;
  // Whether the start of coordinate, velocity or state `index`, or the input `index`, was set.
  [[nodiscard]] bool isSet(tf_kind kind, std::int32_t index) const;
  // Number of the variable of this kind and index, -1 if the model lists none.
  [[nodiscard]] std::int32_t variableOf(tf_kind kind, std::int32_t index) const;
  // Name of that variable; "input 3" and the like where the model lists none.
  [[nodiscard]] std::string nameOf(tf_kind kind, std::int32_t index) const;

private:
  using Override = std::optional<double>;

  void evaluateBindings();
  [[nodiscard]] std::vector<Override> *overridesOf(std::int32_t kind);
  [[nodiscard]] const std::vector<Override> *overridesOf(std::int32_t kind) const;

  const tf_model *model_;
  std::unordered_map<std::string, Reference> names_;
  std::unordered_map<std::int64_t, std::int32_t> variables_;  // by kind and index
  std::vector<std::uint8_t> bound_;                           // np: computed from others unless set
  std::vector<double> parameters_, bindingValues_;
  std::vector<Override> parameterOverrides_, q_, v_, z_, u_;
};

}  // namespace tf::runtime
