// Input tables from CSV (RFC 4180): a header row with `time` and names of inputs, then rows of numbers with nondecreasing times.
#pragma once

#include "runtime/model/model_instance.h"
#include "runtime/model/outcome.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tf::runtime {

// One input's points; times nondecreasing (equal times are a jump), at least one point.
struct InputTable {
  std::int32_t input;  // index in u
  std::vector<double> times, values;
};

// The tables of all inputs of the file. Accepted beyond the RFC: a byte order mark, LF or CR LF, blank lines, blanks around unquoted
// fields. Errors name file, line and column (from 1, in bytes) and what was found. `fileName` is for messages.
Outcome<std::vector<InputTable>> parseInputTables(std::string_view text, const std::string &fileName, const ModelInstance &instance);
Outcome<std::vector<InputTable>> readInputTables(const std::string &path, const ModelInstance &instance);

}  // namespace tf::runtime
