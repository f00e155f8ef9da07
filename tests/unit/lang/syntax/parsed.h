// A parsed text with all that it refers to.
#pragma once

#include "lang/syntax/parser.h"

#include <string>

namespace tf::test {

struct Parsed {
  SourceManager sources;
  Diagnostics diagnostics;
  ast::Tree tree;

  [[nodiscard]] const ast::File &file() const { return *tree.file; }
  [[nodiscard]] const ast::ClassDefinition &firstClass() const { return *tree.file->classes[0]; }
  [[nodiscard]] std::string errors() const { return render(diagnostics, sources); }
};

inline Parsed parse(std::string text) {
  Parsed parsed;
  const FileId file = parsed.sources.add("m.tf", std::move(text));
  parsed.tree = ast::parseFile(parsed.sources, file, parsed.diagnostics);
  return parsed;
}

inline Parsed parseExpression(std::string text) {
  Parsed parsed;
  const FileId file = parsed.sources.add("m.tf", std::move(text));
  parsed.tree = ast::parseExpression(parsed.sources, file, parsed.diagnostics);
  return parsed;
}

}  // namespace tf::test
