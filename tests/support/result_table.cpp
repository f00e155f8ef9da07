#include "tests/support/result_table.h"
#include "tests/support/process.h"

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace tf::test {

namespace {

// The records of RFC 4180.
std::vector<std::vector<std::string>> records(std::string_view text) {
  std::vector<std::vector<std::string>> result;
  std::vector<std::string> record;
  std::string field;
  bool isQuoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (isQuoted) {
      if (c != '"')
        field += c;
      else if (i + 1 < text.size() && text[i + 1] == '"')
        field += text[++i];
      else
        isQuoted = false;
    } else if (c == '"') {
      isQuoted = true;
    } else if (c == ',' || c == '\n') {
      record.push_back(std::move(field));
      field.clear();
      if (c == '\n')
        result.push_back(std::exchange(record, {}));
    } else if (c != '\r') {
      field += c;
    }
  }
  if (isQuoted || !field.empty() || !record.empty())
    throw std::runtime_error("the last record is not complete");
  return result;
}

}  // namespace

ResultTable::ResultTable(const std::filesystem::path &path) {
  auto all = records(readFile(path));
  if (all.empty())
    throw std::runtime_error(path.string() + " has no header");
  names_ = all.front();
  for (std::size_t i = 0; i < names_.size(); ++i)
    columns_.emplace(names_[i], i);
  rows_.assign(std::make_move_iterator(all.begin() + 1), std::make_move_iterator(all.end()));
  for (const auto &row : rows_) {
    if (row.size() != names_.size())
      throw std::runtime_error(path.string() + " has rows of different lengths");
  }
}

const std::string &ResultTable::text(std::size_t row, const std::string &column) const {
  const auto place = columns_.find(column);
  if (place == columns_.end())
    throw std::out_of_range("no column " + column);
  return rows_.at(row)[place->second];
}

double ResultTable::value(std::size_t row, const std::string &column) const {
  const std::string &field = text(row, column);
  char *end = nullptr;
  const double result = std::strtod(field.c_str(), &end);
  if (field.empty() || *end != '\0')
    throw std::runtime_error("'" + field + "' is no number");
  return result;
}

std::size_t ResultTable::rowAt(double time) const {
  for (std::size_t row = rows_.size(); row-- > 0;) {
    if (std::abs(value(row, "time") - time) <= 1e-9)
      return row;
  }
  throw std::out_of_range("no row at time " + std::to_string(time));
}

}  // namespace tf::test
