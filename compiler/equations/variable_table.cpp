#include "compiler/equations/variable_table.h"

namespace tf::equations {

namespace {

Role roleOf(const flat::Variable &variable) {
  if (variable.type.base == flat::Base::String)
    return Role::Text;
  if (variable.isCoordinate)
    return Role::Coordinate;
  if (variable.variability == flat::Variability::Constant)
    return Role::Constant;
  if (variable.variability == flat::Variability::Parameter)
    return Role::Parameter;
  // An input that the model itself binds to something that varies is an ordinary variable.
  const bool isDriven = variable.binding && variable.binding->variability > flat::Variability::Parameter;
  return variable.causality == flat::Causality::Input && !isDriven ? Role::Input : Role::Unknown;
}

}  // namespace

std::string elementName(const std::string &name, const std::vector<int> &dims, int position) {
  if (dims.empty())
    return name;
  std::string subscripts;
  for (std::size_t k = dims.size(); k-- > 0;) {
    const int extent = dims[k] > 0 ? dims[k] : 1;
    subscripts = std::to_string(position % extent + 1) + (subscripts.empty() ? "" : ",") + subscripts;
    position /= extent;
  }
  return name + "[" + subscripts + "]";
}

VariableTable::VariableTable(const flat::FlatModel &model) : model_(&model) {
  places_.reserve(model.variables.size());
  for (std::size_t id = 0; id < model.variables.size(); ++id) {
    const flat::Variable &variable = model.variables[id];
    const Role role = roleOf(variable);
    auto &list = scalars_[static_cast<std::size_t>(role)];
    places_.push_back({role, static_cast<int>(list.size())});
    if (role == Role::Coordinate)
      motion_.addCoordinates(variable.type.size());
    for (int k = 0; k < variable.type.size(); ++k)
      list.push_back({static_cast<flat::VariableId>(id), k});
  }
}

const flat::Variable &VariableTable::variable(ScalarVariable scalar) const {
  return model_->variables[static_cast<std::size_t>(scalar.variable)];
}

std::string VariableTable::name(ScalarVariable scalar) const {
  const flat::Variable &owner = variable(scalar);
  return elementName(owner.name, owner.type.dims, scalar.position);
}

}  // namespace tf::equations
