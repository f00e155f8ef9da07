#include "compiler/equations/variable_table.h"

#include <fmt/format.h>

#include <cassert>

namespace tf::equations {

namespace {

Role roleOf(const flat::Variable &variable) {
  if (variable.type.base == flat::Base::String)
    return Role::Text;
  if (variable.isCoordinate)
    return Role::Coordinate;
  if (variable.isAngularVelocity)
    return Role::Velocity;
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
    for (int k = 0; k < variable.type.size(); ++k)
      list.push_back({static_cast<flat::VariableId>(id), k});
    addMotion(static_cast<flat::VariableId>(id), role);
  }
}

// A rotation's angular velocity is the next variable: its scalars are the velocities that the rotation brought.
void VariableTable::addMotion(flat::VariableId id, Role role) {
  const flat::Variable &added = model_->variables[static_cast<std::size_t>(id)];
  const bool isRotation = added.type.base == flat::Base::Rotation;
  if (role == Role::Coordinate && isRotation) {
    for (int k = 0; k < added.type.size() / 4; ++k)
      motion_.addRotation();
    return;
  }
  if (role == Role::Coordinate)
    motion_.addCoordinates(added.type.size());
  else if (role != Role::Velocity)
    return;
  places_.back().first = role == Role::Velocity ? static_cast<int>(velocities_.size()) : places_.back().first;
  for (int k = 0; k < added.type.size(); ++k)
    velocities_.push_back({id, k});
  assert(static_cast<int>(velocities_.size()) == motion_.velocities());
}

const flat::Variable &VariableTable::variable(ScalarVariable scalar) const {
  return model_->variables[static_cast<std::size_t>(scalar.variable)];
}

std::string VariableTable::name(ScalarVariable scalar) const {
  const flat::Variable &owner = variable(scalar);
  const bool isRotation = owner.type.base == flat::Base::Rotation;
  if (!isRotation && !owner.isAngularVelocity)
    return elementName(owner.name, owner.type.dims, scalar.position);
  const std::vector<int> outer(owner.type.dims.begin(), owner.type.dims.end() - 1);
  const int size = owner.type.dims.back();
  const std::string rotation = isRotation ? owner.name : owner.name.substr(0, owner.name.size() - 2);
  return fmt::format("{}.{}[{}]", elementName(rotation, outer, scalar.position / size), isRotation ? "q" : "w", scalar.position % size + 1);
}

std::string VariableTable::velocityName(int index) const {
  const std::string of = name(velocity(index));
  return variable(velocity(index)).isAngularVelocity ? of : "der(" + of + ")";
}

std::string VariableTable::movingName(int index) const {
  const std::string of = name(velocity(index));
  return variable(velocity(index)).isAngularVelocity ? of.substr(0, of.rfind('.')) : of;
}

}  // namespace tf::equations
