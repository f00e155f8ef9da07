#include "lang/syntax/parser.h"

#include "lang/syntax/parser_core.h"

#include <algorithm>

namespace tf::ast {

Tree::Tree() : arena(std::make_unique<Arena>()) {}
Tree::~Tree() = default;
Tree::Tree(Tree &&) noexcept = default;
Tree &Tree::operator=(Tree &&) noexcept = default;

namespace {

// What has so many errors is no source, and every further one costs more than it tells.
constexpr std::size_t mostErrors = 100;

// The lexer runs before the parser: their diagnostics are merged in the order of the text.
void append(const Diagnostics &local, std::uint32_t unreliableFrom, Diagnostics &diagnostics) {
  std::vector<std::pair<std::uint32_t, std::size_t>> order;
  for (std::size_t i = 0; i < local.all().size(); ++i) {
    if (const std::uint32_t begin = local.all()[i].span.begin; begin <= unreliableFrom)
      order.emplace_back(begin, i);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < std::min(order.size(), mostErrors); ++k) {
    Diagnostic &diagnostic = diagnostics.add(local.all()[order[k].second]);
    if (k + 1 == mostErrors && order.size() > mostErrors)
      diagnostic.note(diagnostic.span, fmt::format("{} more errors follow, which are not listed", order.size() - mostErrors));
  }
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
