// The scalars of a flat model: which symbols of the expression graph its variables become.
#pragma once

#include "compiler/equations/motion.h"
#include "compiler/ir/graph.h"
#include "lang/semantics/flat_model.h"

#include <string>
#include <vector>

namespace tf::equations {

enum class Role : std::uint8_t {
  Parameter,   // symbols Parameter first…
  Coordinate,  // symbols Coordinate first…
  Velocity,    // the angular velocity of a rotation: symbols Velocity first…
  Input,       // symbols Input first…
  Unknown,     // what equations determine, discrete variables included
  Constant,    // no symbol: its binding stands for it
  Text,        // Strings: no numbers
};

// Where the scalars of one flat variable are: positions first, first + 1, … (row-major) among those of its role.
struct Place {
  Role role = Role::Text;
  int first = 0;
};

struct ScalarVariable {
  flat::VariableId variable = -1;
  int position = 0;  // row-major in the variable
};

// "q[2]", "A[1,2]": the Modelica name of one scalar of an array; `position` counts row-major from 0.
[[nodiscard]] std::string elementName(const std::string &name, const std::vector<int> &dims, int position);

class VariableTable {
public:
  explicit VariableTable(const flat::FlatModel &model);

  [[nodiscard]] const flat::FlatModel &model() const { return *model_; }
  [[nodiscard]] Place place(flat::VariableId variable) const { return places_[static_cast<std::size_t>(variable)]; }
  [[nodiscard]] const std::vector<ScalarVariable> &scalars(Role role) const { return scalars_[static_cast<std::size_t>(role)]; }
  [[nodiscard]] const Motion &motion() const { return motion_; }
  [[nodiscard]] int count(Role role) const { return static_cast<int>(scalars(role).size()); }
  [[nodiscard]] const flat::Variable &variable(ScalarVariable scalar) const;
  // "q[2]"; "R.q[1]" and "R.w[3]" of a rotation.
  [[nodiscard]] std::string name(ScalarVariable scalar) const;
  // What velocity `index` belongs to: a coordinate, or a part of a rotation's angular velocity.
  [[nodiscard]] ScalarVariable velocity(int index) const { return velocities_[static_cast<std::size_t>(index)]; }
  // "der(x)", "R.w[3]".
  [[nodiscard]] std::string velocityName(int index) const;
  // What moves with it: "x", "R".
  [[nodiscard]] std::string movingName(int index) const;

private:
  void addMotion(flat::VariableId id, Role role);

  const flat::FlatModel *model_;
  std::vector<Place> places_;
  Motion motion_;  // of the scalars of role Coordinate
  std::vector<ScalarVariable> scalars_[7];
  std::vector<ScalarVariable> velocities_;
};

}  // namespace tf::equations
