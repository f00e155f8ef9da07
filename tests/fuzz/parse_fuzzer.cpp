// Parses the input as a file and as an expression. Beyond not crashing: all ranges lie in the text, messages can be rendered, and what
// parses without an error is printed as a text that parses to the same print.
#include "lang/syntax/parser.h"
#include "lang/syntax/syntax_diagnostics.h"
#include "tests/fuzz/fuzz_entry.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

void require(bool condition, const char *what, const std::string &details) {
  if (condition)
    return;
  std::fprintf(stderr, "%s\n%s\n", what, details.c_str());
  std::abort();
}

void checkDiagnostics(const tf::SourceManager &sources, const tf::Diagnostics &diagnostics) {
  const std::string rendered = tf::render(diagnostics, sources);
  for (const tf::Diagnostic &diagnostic : diagnostics.all()) {
    require(diagnostic.span.valid() && diagnostic.span.begin <= diagnostic.span.end, "a diagnostic without a range", rendered);
    require(diagnostic.span.end <= sources.file(diagnostic.span.file).text().size(), "a range outside of the text", rendered);
  }
}

void checkFile(const std::string &text) {
  tf::SourceManager sources;
  tf::Diagnostics diagnostics;
  const tf::ast::Tree tree = tf::ast::parseFile(sources, sources.add("input.tf", text), diagnostics);
  checkDiagnostics(sources, diagnostics);
  const std::string printed = tf::ast::print(*tree.file);
  if (diagnostics.hasErrors())
    return;
  const tf::ast::Tree again = tf::ast::parseFile(sources, sources.add("printed.tf", printed), diagnostics);
  // Parentheses that the printer adds may exceed the limit of nesting.
  if (diagnostics.hasErrors() && diagnostics.all()[0].kind == &tf::syntax::TooDeep)
    return;
  require(!diagnostics.hasErrors(), "the printed text has errors", tf::render(diagnostics, sources));
  const std::string printedAgain = tf::ast::print(*again.file);
  require(printed == printedAgain, "the printed text is printed differently", printed + "\n----\n" + printedAgain);
}

void checkExpression(const std::string &text) {
  tf::SourceManager sources;
  tf::Diagnostics diagnostics;
  const tf::ast::Tree tree = tf::ast::parseExpression(sources, sources.add("input", text), diagnostics);
  checkDiagnostics(sources, diagnostics);
  (void)tf::ast::print(*tree.expression);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  const std::string text(reinterpret_cast<const char *>(data), size);
  checkFile(text);
  checkExpression(text);
  return 0;
}
