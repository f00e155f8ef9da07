#include "compiler/driver/selected_variables.h"

#include <algorithm>

namespace tf::driver {

bool matches(std::string_view pattern, std::string_view name) {
  constexpr std::size_t none = std::string_view::npos;
  // A '*' takes as few characters as will do: where the rest does not fit, the last one takes one more.
  std::size_t p = 0, n = 0, star = none, behindStar = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      behindStar = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != none) {
      p = star + 1;
      n = ++behindStar;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == none;
}

bool isSelected(const std::vector<std::string> &patterns, std::string_view name) {
  return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [name](const std::string &p) { return matches(p, name); });
}

std::vector<runtime::ResultColumn> selectedColumns(const tf_model &model, const std::vector<std::string> &patterns) {
  std::vector<runtime::ResultColumn> columns = runtime::visibleColumns(model);
  std::erase_if(columns, [&](const runtime::ResultColumn &column) {
    return model.variables[column.variable].kind != TF_KIND_TIME && !isSelected(patterns, column.name);
  });
  return columns;
}

bool isDifferentiated(const tf_model &model, const runtime::ResultColumn &column) {
  const tf_variable &variable = model.variables[column.variable];
  // Of other names the pointers differ.
  return column.name == variable.name && (variable.kind == TF_KIND_COORDINATE || variable.kind == TF_KIND_VELOCITY ||
                                          variable.kind == TF_KIND_STATE || variable.kind == TF_KIND_OUTPUT);
}

}  // namespace tf::driver
