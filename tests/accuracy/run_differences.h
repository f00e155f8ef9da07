// Sensitivities against differences of whole runs.
#pragma once

#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <vector>

namespace tf::test {

// A run of a model (its text or the name of an example) up to a time, by a parameter.
struct DifferenceCase {
  const char *file;
  double time;
  const char *name;
  double value;
  double tolerance = 2e-7;
};

inline std::ostream &operator<<(std::ostream &out, const DifferenceCase &c) {
  return out << std::string(c.file).substr(0, std::string(c.file).find('\n')) << " by " << c.name << " at " << c.time;
}

// A model's text, or (without spaces) the name of an example.
inline std::string fileOf(const char *model) {
  const std::string text = model;
  return text.find(' ') == std::string::npos ? example(text)
                                             : sourceFile("sensitivity" + std::to_string(std::hash<std::string>()(text)) + ".tf", text);
}

inline std::vector<double> states(CompiledModel &model) {
  std::vector<double> all = model.valuesOf(TF_KIND_COORDINATE);
  const std::vector<double> velocities = model.valuesOf(TF_KIND_VELOCITY);
  all.insert(all.end(), velocities.begin(), velocities.end());
  return all;
}

// Sensitivities of coordinates and velocities at the end of a run are differences of whole runs.
inline void expectDifferences(const DifferenceCase &c) {
  // Of order 4: some of the runs are far from linear in their parameter.
  const double h = 1e-5 * std::max(1.0, std::abs(c.value));
  const auto run = [&](double value) {
    CompiledModel model(fileOf(c.file), {{c.name, value}});
    model.tolerance(1e-12).run(c.time);
    return states(model);
  };
  const std::vector<double> plus = run(c.value + h), minus = run(c.value - h), plus2 = run(c.value + 2 * h), minus2 = run(c.value - 2 * h);
  CompiledModel model(fileOf(c.file), {{c.name, c.value}});
  differentiateBy(model, {c.name});
  model.tolerance(1e-10).run(c.time);
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  ASSERT_EQ(tf_get_sensitivity(model.simulation(), 0, all.data()), TF_OK) << tf_error_text(model.simulation());
  for (std::int32_t k = 0; k < model.model().variable_count; ++k) {
    const tf_variable &variable = model.model().variables[k];
    const bool isVelocity = variable.kind == TF_KIND_VELOCITY;
    if (!isVelocity && variable.kind != TF_KIND_COORDINATE)
      continue;
    const auto place = static_cast<std::size_t>(variable.index) + (isVelocity ? model.model().nq : 0);
    const double expected = (8 * (plus[place] - minus[place]) - (plus2[place] - minus2[place])) / (12 * h);
    EXPECT_NEAR(all[static_cast<std::size_t>(k)], expected, c.tolerance * std::max(1.0, std::abs(expected))) << variable.name;
  }
}

}  // namespace tf::test
