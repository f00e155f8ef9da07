#include "lang/syntax/parser.h"

#include "lang/syntax/parser_core.h"

#include <algorithm>

namespace tf::ast {

Tree::Tree() : arena(std::make_unique<Arena>()) {}
Tree::~Tree() = default;
Tree::Tree(Tree &&) noexcept = default;
Tree &Tree::operator=(Tree &&) noexcept = default;

namespace {

// The lexer runs before the parser: their diagnostics are merged in the order of the text.
void append(const Diagnostics &local, std::uint32_t unreliableFrom, Diagnostics &diagnostics) {
  std::vector<const Diagnostic *> ordered;
  for (const Diagnostic &diagnostic : local.all()) {
    if (diagnostic.span.begin <= unreliableFrom)
      ordered.push_back(&diagnostic);
  }
  std::stable_sort(ordered.begin(), ordered.end(), [](const Diagnostic *a, const Diagnostic *b) { return a->span.begin < b->span.begin; });
  for (const Diagnostic *diagnostic : ordered)
    diagnostics.add(*diagnostic);
}

}  // namespace

Tree parseFile(const SourceManager &sources, FileId file, Diagnostics &diagnostics) {
  Tree tree;
  Diagnostics local;
  syntax::Parser parser(sources, file, *tree.arena, local);
  tree.file = parser.parseFile();
  append(local, parser.unreliableFrom(), diagnostics);
  return tree;
}

Tree parseExpression(const SourceManager &sources, FileId file, Diagnostics &diagnostics) {
  Tree tree;
  Diagnostics local;
  syntax::Parser parser(sources, file, *tree.arena, local);
  tree.expression = parser.parseWholeExpression();
  append(local, parser.unreliableFrom(), diagnostics);
  return tree;
}

}  // namespace tf::ast
