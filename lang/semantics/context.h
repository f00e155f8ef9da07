// What one instantiation owns: the arenas of classes and components, the library, and the flat model under construction.
#pragma once

#include "lang/semantics/class_tree.h"
#include "lang/semantics/instantiate.h"
#include "lang/semantics/library.h"
#include "lang/semantics/predefined.h"

#include <deque>
#include <map>
#include <utility>

namespace tf::semantics {

// Limits that keep hostile input from exhausting stack and memory; far beyond any sensible model.
inline constexpr int kMaximumNesting = 100;             // components within components, base classes of base classes
inline constexpr int kMaximumExpressionHeight = 4000;   // of a typed expression
inline constexpr double kMaximumExpressionNodes = 2e6;  // of a typed expression, as a tree
inline constexpr int kMaximumExpressionDepth = 400;     // nested expressions, inlined calls and bindings followed
inline constexpr int kMaximumArraySize = 1'000'000;     // scalars of one array
inline constexpr int kMaximumComponents = 200'000;
inline constexpr long kMaximumTypedNodes = 20'000'000;

struct Context {
  Context(SourceManager &sourceManager, Diagnostics &sink, const InstantiateOptions &given);

  SourceManager &sources;
  Diagnostics &diagnostics;
  const InstantiateOptions &options;
  std::deque<Class> classes;
  std::deque<Component> components;
  Class *root = nullptr;  // the unnamed scope: predefined classes and top-level names
  Library library;

  flat::FlatModel model;
  std::vector<Component *> variableOwners;  // by VariableId
  std::vector<Component *> elementOwners;   // by ElementId
  std::map<std::pair<const ast::Expr *, const Class *>, flat::ExprPtr> typedBindings;
  std::map<std::pair<const Component *, std::string_view>, flat::ExprPtr> elementAttributes;  // typed; null while running or wrong
  int expressionDepth = 0;
  std::vector<const Class *> expandedFunctions;  // whose bodies are being run
  long typedNodes = 0;
  bool isOverLimit = false;
  bool isTooDeep = false;

  Class &newClass() { return classes.emplace_back(); }
  Component &newComponent() { return components.emplace_back(); }
};

}  // namespace tf::semantics
