#include "tests/unit/runtime/model_tables.h"

#include <cassert>
#include <cmath>

namespace tf::runtime::test {

namespace {

void nothing(const double *const *, double *const *, const std::uint8_t *) {}

tf_location nextLocation(std::size_t line) { return {"hand_written.tf", static_cast<std::int32_t>(line + 1), 3}; }

}  // namespace

ModelTables::ModelTables(std::string name, std::string description) {
  model_.magic = TF_MAGIC;
  model_.abi_version = TF_ABI_VERSION;
  model_.name = keep(name);
  model_.description = keep(description);
  model_.generator = "written by hand";
  model_.hash = model_.name;
  model_.mass_is_constant = 1;
  model_.start_time = 0;
  model_.stop_time = model_.tolerance = model_.interval = std::nan("");
  for (tf_function *function :
       {&model_.bindings, &model_.starts, &model_.dynamics, &model_.switching, &model_.contact_terms, &model_.contact_parameters,
        &model_.switch_gradients, &model_.step_derivatives, &model_.dynamics_derivatives, &model_.outputs, &model_.energies})
    *function = nothing;
  variable({.name = "time", .kind = TF_KIND_TIME, .unit = "s"});
  variable({.name = "tau", .kind = TF_KIND_NUMERICAL_TIME, .unit = "s"});
}

const char *ModelTables::keep(const std::string &text) { return texts_.emplace_back(text).c_str(); }

void ModelTables::variable(const VariableSpec &spec) {
  variables_.push_back({keep(spec.name), keep(spec.unit), keep(spec.description), spec.kind, spec.index, spec.flags, spec.min, spec.max,
                        spec.nominal, nextLocation(variables_.size())});
}

void ModelTables::coordinates(const std::vector<std::string> &names, const std::string &unit) {
  const auto add = [&](const std::string &prefix, const std::string &suffix, tf_kind kind, int flags, const std::string &kindUnit) {
    for (std::size_t i = 0; i < names.size(); ++i)
      variable({.name = prefix + names[i] + suffix, .kind = kind, .index = static_cast<int>(i), .flags = flags, .unit = kindUnit});
  };
  add("", "", TF_KIND_COORDINATE, TF_FIXED | TF_SETTABLE, unit);
  add("der(", ")", TF_KIND_VELOCITY, TF_FIXED | TF_SETTABLE, unit + "/s");
  add("der(der(", "))", TF_KIND_ACCELERATION, 0, unit + "/s2");
  model_.nq = model_.nv = static_cast<std::int32_t>(names.size());
}

void ModelTables::parameter(const std::string &name, double value, int flags, const std::string &unit, double min, double max) {
  variable({.name = name,
            .kind = TF_KIND_PARAMETER,
            .index = static_cast<int>(parameters_.size()),
            .flags = flags,
            .unit = unit,
            .description = "",
            .min = min,
            .max = max});
  parameters_.push_back(value);
}

void ModelTables::alias(const std::string &name, const std::string &of, double sign) {
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].name == of) {
      aliases_.push_back({keep(name), "", static_cast<std::int32_t>(i), sign});
      return;
    }
  assert(false && "alias of an unknown variable");
}

void ModelTables::contact(const std::string &name, int tangents) {
  const int index = static_cast<int>(contacts_.size());
  contacts_.push_back({keep(name), model_.nt, tangents, TF_FRICTION_EXACT, TF_LAW_POISSON, 1, nextLocation(contacts_.size()), 0, 0});
  variable({.name = name + ".gap", .kind = TF_KIND_GAP, .index = index, .unit = "m"});
  variable({.name = name + ".normalForce", .kind = TF_KIND_NORMAL_FORCE, .index = index, .unit = "N"});
  variable({.name = name + ".closed", .kind = TF_KIND_CLOSED, .index = index, .flags = TF_BOOLEAN});
  variable({.name = name + ".impulse", .kind = TF_KIND_IMPULSE, .index = index, .unit = "N.s"});
  for (int k = 0; k < tangents; ++k) {
    const std::string subscript = tangents == 1 ? std::string() : std::string("[").append(std::to_string(k + 1)).append("]");
    variable({.name = name + ".slip" + subscript, .kind = TF_KIND_SLIP, .index = model_.nt + k, .unit = "m/s"});
    variable({.name = name + ".frictionForce" + subscript, .kind = TF_KIND_TANGENT_FORCE, .index = model_.nt + k, .unit = "N"});
  }
  if (tangents > 0)
    variable({.name = name + ".sticking", .kind = TF_KIND_STICKING, .index = model_.nt, .flags = TF_BOOLEAN});
  model_.nt += tangents;
}

void ModelTables::friction(const std::string &name) {
  frictions_.push_back({keep(name), model_.nt, 1, TF_FRICTION_EXACT, nextLocation(frictions_.size()), 0});
  variable({.name = name + ".slip", .kind = TF_KIND_SLIP, .index = model_.nt, .unit = "m/s"});
  variable({.name = name + ".force", .kind = TF_KIND_TANGENT_FORCE, .index = model_.nt, .unit = "N"});
  variable({.name = name + ".sticking", .kind = TF_KIND_STICKING, .index = model_.nt, .flags = TF_BOOLEAN});
  model_.nt += 1;
}

void ModelTables::switchFunction(const std::string &text, tf_switch_kind kind, bool zeroIsPositive) {
  variable({.name = "alpha(" + text + ")", .kind = TF_KIND_STEP_VARIABLE, .index = static_cast<int>(switches_.size())});
  switches_.push_back({keep(text), kind, zeroIsPositive ? 1 : 0, nextLocation(switches_.size()), -1});
}

const tf_model &ModelTables::finish() {
  const auto count = [](const auto &table) { return static_cast<std::int32_t>(table.size()); };
  model_.np = count(parameters_);
  model_.nc = count(contacts_);
  model_.nf = count(frictions_);
  model_.ns = count(switches_);
  model_.variable_count = count(variables_);
  model_.alias_count = count(aliases_);
  model_.variables = variables_.data();
  model_.aliases = aliases_.data();
  model_.contacts = contacts_.data();
  model_.frictions = frictions_.data();
  model_.switches = switches_.data();
  model_.parameters = parameters_.data();
  return model_;
}

}  // namespace tf::runtime::test
