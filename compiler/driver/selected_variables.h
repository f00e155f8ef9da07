// The variables that --variables chooses.
#pragma once

#include "runtime/results/result_writer.h"

#include <string>
#include <string_view>
#include <vector>

namespace tf::driver {

// Whether the pattern is the whole name, where '*' stands for any characters and '?' for one. Brackets are those of subscripts.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name);

// Whether any of the patterns does, or there is none.
[[nodiscard]] bool isSelected(const std::vector<std::string> &patterns, std::string_view name);

// The visible columns of the model (runtime::visibleColumns) that the patterns select, and its time.
[[nodiscard]] std::vector<runtime::ResultColumn> selectedColumns(const tf_model &model, const std::vector<std::string> &patterns);

// Whether the column is a coordinate, velocity, state or output by its own name: these have sensitivities.
[[nodiscard]] bool isDifferentiated(const tf_model &model, const runtime::ResultColumn &column);

}  // namespace tf::driver
