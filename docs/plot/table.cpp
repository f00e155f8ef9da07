#include "docs/plot/table.h"

#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace tf::plot {

namespace {

std::vector<std::string> splitRow(const std::string &line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

// Cells that are not numbers (kinds of events) count as NaN.
double number(const std::string &text) {
  char *end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0' ? value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Table::Table(const std::string &path) : path_(path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) {
    throw std::runtime_error("cannot read '" + path + "'");
  }
  const std::vector<std::string> names = splitRow(line);
  std::vector<std::vector<double>> values(names.size());
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = splitRow(line);
    for (std::size_t i = 0; i < names.size(); ++i) {
      values[i].push_back(i < fields.size() ? number(fields[i]) : std::numeric_limits<double>::quiet_NaN());
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns_[names[i]] = std::move(values[i]);
  }
}

const std::vector<double> &Table::column(const std::string &name) const {
  const auto found = columns_.find(name);
  if (found == columns_.end()) {
    throw std::runtime_error("'" + path_ + "' has no column '" + name + "'");
  }
  return found->second;
}

}  // namespace tf::plot
