// Parsing of whole files and of single expressions (`--set u=…`).
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/syntax/ast.h"

#include <memory>

namespace tf::ast {

class Arena;

// A parsed text and the memory that it lives in.
class Tree {
public:
  Tree();
  ~Tree();
  Tree(Tree &&) noexcept;
  Tree &operator=(Tree &&) noexcept;

  File *file = nullptr;        // of parseFile
  Expr *expression = nullptr;  // of parseExpression
  std::unique_ptr<Arena> arena;
};

// Errors are reported; the tree is partial then. Never throws, never fails to return a tree.
[[nodiscard]] Tree parseFile(const SourceManager &sources, FileId file, Diagnostics &diagnostics);

// The whole text must be one expression.
[[nodiscard]] Tree parseExpression(const SourceManager &sources, FileId file, Diagnostics &diagnostics);

// The tree as canonical source (`--emit ast`): one clause, equation or statement per line, an operation inside another in parentheses
// (but `a - b + c`), without `//` and `/* */`. Reading the text again gives the same text; what could not be read is written `<error>`.
[[nodiscard]] std::string print(const File &file);
[[nodiscard]] std::string print(const Expr &expression);

}  // namespace tf::ast
