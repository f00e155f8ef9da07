#include "runtime/model/model_instance.h"

#include "runtime/model/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tf::runtime {

namespace {

// Blanks outside quoted identifiers ('a b') do not count.
std::string withoutBlanks(std::string_view name) {
  std::string result;
  bool quoted = false;
  for (const char c : name) {
    if (c == '\'' && (result.empty() || result.back() != '\\'))
      quoted = !quoted;
    if (quoted || (c != ' ' && c != '\t'))
      result += c;
  }
  return result;
}

std::int64_t key(std::int32_t kind, std::int32_t index) {
  return (static_cast<std::int64_t>(kind) << 32) | static_cast<std::uint32_t>(index);
}

bool isStart(std::int32_t kind) { return kind == TF_KIND_COORDINATE || kind == TF_KIND_VELOCITY || kind == TF_KIND_STATE; }

// Why `set` refuses the variable; empty if it does not. Inputs can always be set.
std::string refusal(const tf_variable &variable) {
  const bool parameter = variable.kind == TF_KIND_PARAMETER;
  if (variable.kind == TF_KIND_INPUT || ((parameter || isStart(variable.kind)) && (variable.flags & TF_SETTABLE) != 0))
    return {};
  if (!parameter && !isStart(variable.kind))
    return fmt::format("'{}' is computed by the model and cannot be set", variable.name);
  if ((variable.flags & TF_STRUCTURAL) != 0)
    return fmt::format("'{}' is structural: its value is part of the compiled model; compile the model again with another value",
                       variable.name);
  if ((variable.flags & TF_PROTECTED) != 0)
    return fmt::format("'{}' is protected and cannot be set", variable.name);
  return parameter ? fmt::format("'{}' is final and cannot be set", variable.name)
                   : fmt::format("the start of '{}' is final and cannot be set", variable.name);
}

std::string_view kindName(tf_kind kind) {
  switch (kind) {
  case TF_KIND_COORDINATE:
    return "coordinate";
  case TF_KIND_VELOCITY:
    return "velocity";
  case TF_KIND_STATE:
    return "state";
  case TF_KIND_INPUT:
    return "input";
  case TF_KIND_PARAMETER:
    return "parameter";
  default:
    return "variable";
  }
}

}  // namespace

ModelInstance::ModelInstance(const tf_model &model) : model_(&model) {
  const auto size = [](std::int32_t count) { return static_cast<std::size_t>(count); };
  for (std::int32_t i = 0; i < model.variable_count; ++i) {
    names_.try_emplace(withoutBlanks(model.variables[i].name), Reference{i, 1});
    variables_.try_emplace(key(model.variables[i].kind, model.variables[i].index), i);
  }
  for (std::int32_t i = 0; i < model.alias_count; ++i)
    names_.try_emplace(withoutBlanks(model.aliases[i].name), Reference{model.aliases[i].variable, model.aliases[i].sign});
  parameters_.assign(model.parameters, model.parameters + model.np);
  // A parameter that the table does not list is what `bindings` makes of it: it leaves unbound ones as they are.
  bound_.assign(size(model.np), 1);
  for (std::int32_t i = 0; i < model.variable_count; ++i)
    if (model.variables[i].kind == TF_KIND_PARAMETER)
      bound_[size(model.variables[i].index)] = (model.variables[i].flags & TF_BOUND) != 0 ? 1 : 0;
  parameterOverrides_.resize(size(model.np));
  q_.resize(size(model.nq));
  v_.resize(size(model.nv));
  z_.resize(size(model.nz));
  u_.resize(size(model.nu));
  evaluateBindings();
}

std::optional<ModelInstance::Reference> ModelInstance::find(std::string_view name) const {
  const auto found = names_.find(withoutBlanks(name));
  if (found == names_.end())
    return std::nullopt;
  return found->second;
}

std::string ModelInstance::unknownName(std::string_view name, std::optional<tf_kind> kind) const {
  const std::string plain = withoutBlanks(name), opening = plain + "[";
  NearestName nearest(plain);
  const char *first = nullptr, *last = nullptr;  // elements of an array of this name
  const auto offer = [&](const char *other, std::int32_t variable) {
    if (kind && model_->variables[variable].kind != *kind)
      return;
    nearest.offer(other);
    if (!std::string_view(other).starts_with(opening))
      return;
    first = first != nullptr ? first : other;
    last = other;
  };
  for (std::int32_t i = 0; i < model_->variable_count; ++i)
    offer(model_->variables[i].name, i);
  for (std::int32_t i = 0; i < model_->alias_count; ++i)
    offer(model_->aliases[i].name, model_->aliases[i].variable);
  if (first != nullptr)
    return fmt::format("'{}' of model '{}' is an array: name one of its elements, '{}' to '{}'", name, model_->name, first, last);
  return fmt::format("model '{}' has no {} '{}'{}", model_->name, kindName(kind.value_or(TF_KIND_TIME)), name, nearest.suggestion());
}

Outcome<void> ModelInstance::checkValue(std::int32_t variable, double value, std::string_view name) const {
  return checkValue(model_->variables[variable], value, name);
}

Outcome<void> ModelInstance::checkValue(const tf_variable &described, double value, std::string_view name) {
  if (std::isnan(value))
    return Failure{fmt::format("'{}' cannot be set to NaN", name)};
  if (std::isinf(value) && described.kind != TF_KIND_PARAMETER)
    return Failure{fmt::format("'{}' cannot be infinite", name)};
  if ((described.flags & TF_BOOLEAN) != 0 && value != 0 && value != 1)
    return Failure{fmt::format("'{}' is Boolean: its value is 0 (false) or 1 (true), not {}", name, value)};
  if ((described.flags & TF_INTEGER) != 0 && std::trunc(value) != value)
    return Failure{fmt::format("'{}' is an Integer and cannot be {}", name, value)};
  if (value < described.min)
    return Failure{fmt::format("'{}' = {} is below its minimum {}", name, value, described.min)};
  if (value > described.max)
    return Failure{fmt::format("'{}' = {} is above its maximum {}", name, value, described.max)};
  return {};
}

Outcome<void> ModelInstance::set(std::string_view name, double value) {
  const auto reference = find(name);
  if (!reference)
    return Failure{unknownName(name)};
  const tf_variable &variable = model_->variables[reference->variable];
  if (const std::string reason = refusal(variable); !reason.empty())
    return Failure{reason};
  const double own = reference->sign * value;  // signs are 1 or -1
  if (auto checked = checkValue(reference->variable, own, variable.name); !checked)
    return checked;
  (*overridesOf(variable.kind))[static_cast<std::size_t>(variable.index)] = own;
  if (variable.kind == TF_KIND_PARAMETER)
    evaluateBindings();
  return {};
}

Outcome<void> ModelInstance::checkParameters() const {
  for (std::int32_t i = 0; i < model_->variable_count; ++i) {
    const tf_variable &variable = model_->variables[i];
    if (variable.kind != TF_KIND_PARAMETER || parameterOverrides_[static_cast<std::size_t>(variable.index)])
      continue;
    const double value = parameters_[static_cast<std::size_t>(variable.index)];
    if (std::isnan(value))
      return Failure{fmt::format("'{}', which is computed from other parameters, has no value (NaN)", variable.name)};
    if (const auto checked = checkValue(i, value, variable.name); !checked)
      return Failure{(variable.flags & TF_BOUND) != 0 ? checked.error() + " (computed from other parameters)" : checked.error()};
  }
  return {};
}

// Set parameters keep their values; each evaluation makes one more level of bound ones right.
void ModelInstance::nudge(std::int32_t variable, double change, double startTime) {
  const tf_variable &moved = model_->variables[variable];
  const auto index = static_cast<std::size_t>(moved.index);
  const Starts starts = this->starts(startTime);
  const std::vector<double> &values = moved.kind == TF_KIND_PARAMETER    ? parameters_
                                      : moved.kind == TF_KIND_COORDINATE ? starts.q
                                      : moved.kind == TF_KIND_VELOCITY   ? starts.v
                                      : moved.kind == TF_KIND_STATE      ? starts.z
                                                                         : starts.u;
  (*overridesOf(moved.kind))[index] = values[index] + change;
  evaluateBindings();
}

void ModelInstance::evaluateBindings() {
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (parameterOverrides_[i])
      parameters_[i] = *parameterOverrides_[i];
  std::array<const double *, TF_IN_COUNT> in{};
  for (std::int32_t level = 0; level < model_->binding_depth; ++level) {
    bindingValues_ = parameters_;
    in[TF_IN_P] = parameters_.data();
    double *const out[] = {bindingValues_.data()};
    model_->bindings(in.data(), out, nullptr);
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      if (bound_[i] != 0 && !parameterOverrides_[i])
        parameters_[i] = bindingValues_[i];
  }
}

Starts ModelInstance::starts(double startTime) const {
  Starts starts;
  this->starts(startTime, starts);
  return starts;
}

void ModelInstance::starts(double startTime, Starts &starts) const {
  starts.q.resize(q_.size());
  starts.v.resize(v_.size());
  starts.z.resize(z_.size());
  starts.u.resize(u_.size());
  std::array<const double *, TF_IN_COUNT> in{};
  in[TF_IN_TIME] = &startTime;
  in[TF_IN_P] = parameters_.data();
  double *const out[] = {starts.q.data(), starts.v.data(), starts.z.data(), starts.u.data()};
  model_->starts(in.data(), out, nullptr);
  const auto place = [](std::vector<double> &values, const std::vector<Override> &overrides) {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = overrides[i].value_or(values[i]);
  };
  place(starts.q, q_);
  place(starts.v, v_);
  place(starts.z, z_);
  place(starts.u, u_);
  // What is set of a quaternion gives its direction only.
  for (std::int32_t r = 0; r < model_->nr; ++r) {
    const auto first = static_cast<std::size_t>(model_->quaternions[r]);
    if (std::none_of(q_.begin() + model_->quaternions[r], q_.begin() + model_->quaternions[r] + 4,
                     [](const Override &given) { return given.has_value(); }))
      continue;
    const double length =
        std::hypot(std::hypot(starts.q[first], starts.q[first + 1]), std::hypot(starts.q[first + 2], starts.q[first + 3]));
    for (std::size_t k = first; k < first + 4; ++k)
      starts.q[k] /= length;
  }
}

const std::vector<ModelInstance::Override> *ModelInstance::overridesOf(std::int32_t kind) const {
  switch (kind) {
  case TF_KIND_PARAMETER:
    return &parameterOverrides_;
  case TF_KIND_COORDINATE:
    return &q_;
  case TF_KIND_VELOCITY:
    return &v_;
  case TF_KIND_STATE:
    return &z_;
  case TF_KIND_INPUT:
    return &u_;
  default:
    return nullptr;
  }
}

std::vector<ModelInstance::Override> *ModelInstance::overridesOf(std::int32_t kind) {
  return const_cast<std::vector<Override> *>(std::as_const(*this).overridesOf(kind));
}

bool ModelInstance::isSet(tf_kind kind, std::int32_t index) const {
  const auto *overrides = overridesOf(kind);
  return overrides != nullptr && index >= 0 && static_cast<std::size_t>(index) < overrides->size() &&
         (*overrides)[static_cast<std::size_t>(index)].has_value();
}

std::int32_t ModelInstance::variableOf(tf_kind kind, std::int32_t index) const {
  const auto found = variables_.find(key(kind, index));
  return found == variables_.end() ? -1 : found->second;
}

std::string ModelInstance::nameOf(tf_kind kind, std::int32_t index) const {
  const std::int32_t variable = variableOf(kind, index);
  return variable < 0 ? fmt::format("{} {}", kindName(kind), index + 1) : model_->variables[variable].name;
}

}  // namespace tf::runtime
