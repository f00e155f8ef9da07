#include "runtime/model/loaded_model.h"

#include <fmt/format.h>

#include <limits>

namespace tf::runtime {

namespace {

// Largest index + 1 of each kind; 0 for kinds that the runtime does not know.
std::int64_t kindSize(const tf_model &model, std::int32_t kind) {
  switch (kind) {
  case TF_KIND_TIME:
  case TF_KIND_NUMERICAL_TIME:
  case TF_KIND_TIME_SPEED:
  case TF_KIND_KINETIC_ENERGY:
  case TF_KIND_POTENTIAL_ENERGY:
  case TF_KIND_FRICTION_LOSS:
  case TF_KIND_IMPACT_LOSS:
  case TF_KIND_WORK:
    return std::numeric_limits<std::int32_t>::max();  // the index says nothing
  case TF_KIND_COORDINATE:
    return model.nq;
  case TF_KIND_VELOCITY:
  case TF_KIND_ACCELERATION:
    return model.nv;
  case TF_KIND_STATE:
  case TF_KIND_STATE_DERIVATIVE:
    return model.nz;
  case TF_KIND_INPUT:
    return model.nu;
  case TF_KIND_PARAMETER:
    return model.np;
  case TF_KIND_OUTPUT:
    return model.no;
  case TF_KIND_GAP:
  case TF_KIND_NORMAL_FORCE:
  case TF_KIND_CLOSED:
  case TF_KIND_IMPULSE:
  case TF_KIND_GAP_STEP:
  case TF_KIND_GAP_RATE_STEP:
  case TF_KIND_PUSH:
    return model.nc;
  case TF_KIND_TANGENT_FORCE:
  case TF_KIND_SLIP:
  case TF_KIND_STICKING:
  case TF_KIND_SLIP_STEP:
  case TF_KIND_THETA_BACKWARD:
  case TF_KIND_THETA_FORWARD:
    return model.nt;
  case TF_KIND_STEP_VARIABLE:
    return model.ns;
  case TF_KIND_MULTIPLIER:
    return model.nh;
  default:
    return 0;
  }
}

Failure damaged(const std::string &what) { return {"the compiled model is damaged: " + what}; }

Outcome<void> checkCounts(const tf_model &model) {
  const struct {
    const char *name;
    std::int32_t count;
    const void *table;  // not needed: any pointer that is not null
  } tables[] = {{"coordinates", model.nq, &model},
                {"velocities", model.nv, &model},
                {"states", model.nz, &model},
                {"inputs", model.nu, &model},
                {"parameters", model.np, model.parameters},
                {"contacts", model.nc, model.contacts},
                {"tangential rows", model.nt, &model},
                {"switches", model.ns, model.switches},
                {"outputs", model.no, &model},
                {"friction elements", model.nf, model.frictions},
                {"rotations", model.nr, model.quaternions},
                {"constraints", model.nk, model.constraints},
                {"constraint rows", model.nh, &model},
                {"variables", model.variable_count, model.variables},
                {"aliases", model.alias_count, model.aliases}};
  for (const auto &table : tables) {
    if (table.count < 0)
      return damaged(fmt::format("{} {}", table.count, table.name));
    if (table.count > 0 && table.table == nullptr)
      return damaged(fmt::format("no table of {}", table.name));
  }
  if (model.binding_depth < 0)
    return damaged(fmt::format("binding depth {}", model.binding_depth));
  if (model.name == nullptr || model.description == nullptr || model.generator == nullptr || model.hash == nullptr)
    return damaged("no name");
  return {};
}

Outcome<void> checkMassStructure(const tf_model &model) {
  if (model.mass_rows == nullptr)
    return {};
  if (model.mass_rows[0] != 0)
    return damaged("the structure of its mass matrix does not begin at 0");
  for (std::int32_t i = 0; i < model.nv; ++i) {
    const std::int32_t begin = model.mass_rows[i], end = model.mass_rows[i + 1];
    if (end < begin || end - begin > i || (end > begin && model.mass_columns == nullptr))
      return damaged(fmt::format("row {} of its mass matrix has {} entries", i, end - begin));
    for (std::int32_t k = begin; k < end; ++k)
      if (model.mass_columns[k] < (k == begin ? 0 : model.mass_columns[k - 1] + 1) || model.mass_columns[k] >= i)
        return damaged(fmt::format("row {} of its mass matrix has an entry in column {}", i, model.mass_columns[k]));
  }
  return {};
}

Outcome<void> checkFunctions(const tf_model &model) {
  for (const tf_function function :
       {model.bindings, model.starts, model.dynamics, model.switching, model.contact_terms, model.contact_parameters,
        model.switch_gradients, model.step_derivatives, model.dynamics_derivatives, model.outputs, model.energies})
    if (function == nullptr)
      return damaged("a function is missing");
  if (model.nq - model.nv != model.nr)
    return damaged(fmt::format("{} coordinates and {} velocities with {} rotations", model.nq, model.nv, model.nr));
  if (model.nr > 0 && (model.kinematics == nullptr || model.kinematics_derivatives == nullptr))
    return damaged("the kinematic function is missing");
  if (model.nh > 0 && model.constraint_terms == nullptr)
    return damaged("the function of the constraints is missing");
  return {};
}

Outcome<void> checkVariables(const tf_model &model) {
  if (model.variable_count < 2 || model.variables[0].kind != TF_KIND_TIME || model.variables[1].kind != TF_KIND_NUMERICAL_TIME)
    return damaged("its variables do not begin with time and numerical time");
  for (std::int32_t i = 0; i < model.variable_count; ++i) {
    const tf_variable &variable = model.variables[i];
    if (variable.name == nullptr || variable.unit == nullptr || variable.description == nullptr)
      return damaged(fmt::format("variable {} has no name", i));
    if (variable.index < 0 || variable.index >= kindSize(model, variable.kind))
      return damaged(fmt::format("variable '{}' is number {} of kind {}", variable.name, variable.index, variable.kind));
  }
  for (std::int32_t i = 0; i < model.alias_count; ++i) {
    const tf_alias &alias = model.aliases[i];
    if (alias.name == nullptr || alias.description == nullptr)
      return damaged(fmt::format("alias {} has no name", i));
    if (alias.variable < 0 || alias.variable >= model.variable_count || (alias.sign != 1 && alias.sign != -1))
      return damaged(fmt::format("alias '{}' is {} times variable {}", alias.name, alias.sign, alias.variable));
  }
  return {};
}

// Tangential rows belong to the contacts in order, then to the friction elements.
Outcome<void> checkElements(const tf_model &model) {
  std::int64_t row = 0;
  const auto rows = [&](const char *name, std::int32_t first, std::int32_t count, std::int32_t least, std::int32_t form) -> Outcome<void> {
    if (name == nullptr)
      return damaged("an element has no name");
    if (form < TF_FRICTION_EXACT || form > TF_FRICTION_POLYHEDRAL)
      return damaged(fmt::format("'{}' has the friction form {}", name, form));
    const bool fits = form == TF_FRICTION_RELAXED ? count == TF_RELAXED_ROWS : count <= 2 || form == TF_FRICTION_POLYHEDRAL;
    if (count < least || !fits || count > model.nt - row || first != row)
      return damaged(fmt::format("'{}' has {} tangential rows from row {}", name, count, first));
    row += count;
    return {};
  };
  for (std::int32_t i = 0; i < model.nc; ++i) {
    const tf_contact &contact = model.contacts[i];
    // A contact without rows may say any first row.
    if (auto checked = rows(contact.name, contact.tangent_count == 0 ? static_cast<std::int32_t>(row) : contact.tangent_first,
                            contact.tangent_count, 0, contact.friction_form);
        !checked)
      return checked;
    if (contact.law < TF_LAW_POISSON || contact.law > TF_LAW_NEWTON)
      return damaged(fmt::format("'{}' has the impact law {}", contact.name, contact.law));
  }
  for (std::int32_t i = 0; i < model.nf; ++i)
    if (auto checked = rows(model.frictions[i].name, model.frictions[i].tangent_first, model.frictions[i].tangent_count, 1,
                            model.frictions[i].friction_form);
        !checked)
      return checked;
  if (row != model.nt)
    return damaged(fmt::format("{} tangential rows, but its elements have {}", model.nt, row));
  row = 0;
  for (std::int32_t i = 0; i < model.nk; ++i) {
    const tf_constraint &constraint = model.constraints[i];
    if (constraint.name == nullptr)
      return damaged("a constraint has no name");
    if (constraint.row_count < 0 || constraint.row_first != row)
      return damaged(fmt::format("'{}' has {} constraint rows from row {}", constraint.name, constraint.row_count, constraint.row_first));
    row += constraint.row_count;
  }
  if (row != model.nh)
    return damaged(fmt::format("{} constraint rows, but its constraints have {}", model.nh, row));
  for (std::int32_t i = 0; i < model.nr; ++i)
    if (model.quaternions[i] < (i == 0 ? 0 : model.quaternions[i - 1] + 4) || model.quaternions[i] + 4 > model.nq)
      return damaged(fmt::format("the rotation {} begins with coordinate {}", i, model.quaternions[i]));
  for (std::int32_t i = 0; i < model.ns; ++i) {
    if (model.switches[i].text == nullptr)
      return damaged(fmt::format("switch {} has no text", i));
    if (model.switches[i].kind < TF_SWITCH_SLIDING || model.switches[i].kind > TF_SWITCH_REST)
      return damaged(fmt::format("switch '{}' has kind {}", model.switches[i].text, model.switches[i].kind));
    if (const std::int32_t of = model.switches[i].of; (model.switches[i].kind == TF_SWITCH_REST) != (of >= 0 && of < i))
      return damaged(fmt::format("switch '{}' is the rest of switch {}", model.switches[i].text, of));
  }
  return {};
}

}  // namespace

Outcome<void> checkModel(const tf_model &model) {
  if (model.magic != TF_MAGIC)
    return Failure{"not a compiled model: its table does not begin with the mark of one"};
  if (model.abi_version != TF_ABI_VERSION)
    return Failure{fmt::format(
        "the model was compiled for version {} of the interface of compiled models, this program has version {}; compile it again",
        model.abi_version, TF_ABI_VERSION)};
  for (const auto check : {checkCounts, checkMassStructure, checkFunctions, checkVariables, checkElements})
    if (auto checked = check(model); !checked)
      return checked;
  return {};
}

}  // namespace tf::runtime
