// What holds of a model with every integrator.
#pragma once

#include "tests/accuracy/support/compiled_model.h"

#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace tf::test {

// Simulates the file's model from 0 to `end` with each of them and hands it to `check`, whose findings are reported with the integrator.
// `prepare` is called before the simulation.
inline void withEachIntegrator(const std::string &file, double tolerance, double end, const std::function<void(CompiledModel &)> &check,
                               const Settings &settings = {}, const std::function<void(CompiledModel &)> &prepare = {}) {
  for (const tf_integrator integrator : integrators) {
    SCOPED_TRACE("integrator " + std::to_string(integrator));
    CompiledModel model(file, settings);
    if (prepare) {
      prepare(model);
    }
    model.tolerance(tolerance).integrator(integrator).run(end);
    check(model);
  }
}

}  // namespace tf::test
