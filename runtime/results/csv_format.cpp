#include "runtime/results/result_writer.h"

#include <charconv>
#include <cmath>

namespace tf::runtime {

void appendNumber(std::string &text, double value) {
  if (!std::isfinite(value)) {
    text += std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    return;
  }
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value == 0 ? 0.0 : value).ptr;
  text.append(digits, end);
}

void appendCsvField(std::string &text, std::string_view field) {
  if (field.find_first_of(",\"\r\n") == std::string_view::npos) {
    text += field;
    return;
  }
  text += '"';
  for (const char c : field) {
    if (c == '"')
      text += '"';
    text += c;
  }
  text += '"';
}

}  // namespace tf::runtime
