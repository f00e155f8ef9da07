#include "lang/semantics/text.h"

namespace tf::semantics {

std::string unquote(std::string_view literal) {
  if (literal.size() >= 2 && literal.front() == '"' && literal.back() == '"')
    literal = literal.substr(1, literal.size() - 2);
  static constexpr std::string_view kEscaped = "abfnrtv", kMeaning = "\a\b\f\n\r\t\v";
  std::string text;
  for (std::size_t i = 0; i < literal.size(); ++i) {
    if (literal[i] != '\\' || i + 1 == literal.size()) {
      text += literal[i];
      continue;
    }
    const char escaped = literal[++i];
    const std::size_t known = kEscaped.find(escaped);
    text += known == std::string_view::npos ? escaped : kMeaning[known];
  }
  return text;
}

std::string descriptionOf(const ast::Comment &comment) {
  std::string text;
  for (const std::string_view part : comment.strings)
    text += unquote(part);
  return text;
}

}  // namespace tf::semantics
