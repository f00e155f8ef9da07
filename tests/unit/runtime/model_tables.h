// Building the tables of a tf_model by hand, for models written in C++.
#pragma once

#include "runtime/abi/tf_model.h"

#include <cstdint>
#include <deque>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace tf::runtime::test {

// Arguments of a model's functions (tf_function).
using In = const double *const *;
using Out = double *const *;
using Mask = const std::uint8_t *;

inline bool selected(Mask mask, int row) { return mask == nullptr || mask[row] != 0; }

inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct VariableSpec {
  std::string name;
  tf_kind kind;
  int index = 0;
  int flags = 0;
  std::string unit = "";
  std::string description = "";
  double min = -infinity, max = infinity, nominal = 1;
};

// Owns the tables that `model()` points to. Functions are set by the caller; those that are not are a function without outputs.
class ModelTables {
public:
  ModelTables(std::string name, std::string description);
  ModelTables(const ModelTables &) = delete;
  ModelTables &operator=(const ModelTables &) = delete;

  // Columns time and tau are there from the beginning.
  void variable(const VariableSpec &spec);
  // The vector with elements NAME[1]... of coordinates (velocities, accelerations): columns of position, velocity and acceleration.
  void coordinates(const std::vector<std::string> &names, const std::string &unit);
  void parameter(const std::string &name, double value, int flags, const std::string &unit, double min = -infinity, double max = infinity);
  void alias(const std::string &name, const std::string &of, double sign);
  // A contact with `tangents` tangential rows and the columns of its results.
  void contact(const std::string &name, int tangents);
  void friction(const std::string &name);
  void switchFunction(const std::string &text, tf_switch_kind kind, bool zeroIsPositive);

  // The finished model; counts of everything that was added are filled in. The caller sets nz, nu and the functions before.
  tf_model &model() { return model_; }
  const tf_model &finish();

private:
  const char *keep(const std::string &text);

  tf_model model_{};
  std::deque<std::string> texts_;
  std::vector<tf_variable> variables_;
  std::vector<tf_alias> aliases_;
  std::vector<tf_contact> contacts_;
  std::vector<tf_friction> frictions_;
  std::vector<tf_switch> switches_;
  std::vector<double> parameters_;
};

}  // namespace tf::runtime::test
