// Results as rows over time: CSV (RFC 4180) or JSON.
#pragma once

#include "runtime/abi/tf_model.h"
#include "runtime/model/outcome.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tf::runtime {

// Appends the shortest decimal number that reads back as the same double; "nan", "inf", "-inf"; zero is "0" without a sign.
void appendNumber(std::string &text, double value);
// Appends a CSV field, quoted where it contains a comma, a quote or a line break.
void appendCsvField(std::string &text, std::string_view field);

// A column of the results: sign * value number `variable` of a row, under the variable's name or another one.
struct ResultColumn {
  std::int32_t variable;  // number in model.variables, or beyond them a value that the caller adds to rows
  double sign;
  const char *name, *description, *unit;
};

// The columns that a user asks to see: all variables but protected ones, in the model's order, then their other names (`y` where `y = x`).
std::vector<ResultColumn> visibleColumns(const tf_model &model);

class ResultWriter {
public:
  virtual ~ResultWriter() = default;
  // By the path's suffix: .csv or .json (in any case). The file is created at once, so that an unwritable place is noticed before the run.
  // The model must outlive the writer.
  static Outcome<std::unique_ptr<ResultWriter>> create(const std::string &path, const tf_model &model, std::vector<ResultColumn> columns);

  // values: all of model.variables [variable_count], then whatever columns refer to. CSV rows are with the operating system on return;
  // JSON's columns are written by finish.
  virtual Outcome<void> writeRow(std::span<const double> values) = 0;
  // Ends the file; also done, without report, on destruction. Further rows are not allowed.
  virtual Outcome<void> finish() = 0;
};

}  // namespace tf::runtime
