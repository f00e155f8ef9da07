// `--set` and `--input` applied to a simulation.
#pragma once

#include "compiler/driver/input_expression.h"
#include "compiler/driver/prepared_model.h"

#include <memory>
#include <vector>

namespace tf::driver {

struct TimeSpan {
  double start = 0, stop = 1;
};

// Expressions whose values the simulation asks for; they must live as long as it runs.
using InputExpressions = std::vector<std::unique_ptr<InputExpression>>;

// Parameters, starts and constant inputs first, then the table, then expressions (which see the parameters set). All mistakes are reported.
[[nodiscard]] InputExpressions applySettings(PreparedModel &prepared, const RunOptions &options, const std::vector<Setting> &settings,
                                             TimeSpan span, Session &session);

}  // namespace tf::driver
