// A result file of tfc: a header row and numbers (RFC 4180).
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

namespace tf::plot {

class Table {
public:
  // Throws std::runtime_error with the file's name if it cannot be read.
  explicit Table(const std::string &path);

  // The column of that name; throws std::runtime_error if there is none.
  [[nodiscard]] const std::vector<double> &column(const std::string &name) const;

private:
  std::string path_;
  std::unordered_map<std::string, std::vector<double>> columns_;
};

}  // namespace tf::plot
