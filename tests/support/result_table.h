// Result and event files as tests read them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tf::test {

class ResultTable {
public:
  // Reads a CSV file with a header row. Throws std::runtime_error if it is malformed.
  explicit ResultTable(const std::filesystem::path &path);

  [[nodiscard]] const std::vector<std::string> &names() const { return names_; }
  [[nodiscard]] std::size_t rowCount() const { return rows_.size(); }
  // Throws std::out_of_range where there is no such column.
  [[nodiscard]] const std::string &text(std::size_t row, const std::string &column) const;
  [[nodiscard]] double value(std::size_t row, const std::string &column) const;
  // The last row whose `time` is within 1e-9 of the given one; throws std::out_of_range if there is none.
  [[nodiscard]] std::size_t rowAt(double time) const;

private:
  std::vector<std::string> names_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tf::test
