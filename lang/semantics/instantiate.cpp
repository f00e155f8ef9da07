#include "lang/semantics/instantiate.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/flatten.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/text.h"

#include <algorithm>
#include <cassert>

namespace tf {

namespace {

using namespace semantics;

bool isModel(const ast::ClassDefinition &definition) {
  switch (definition.restriction) {
  case ast::Restriction::Model:
  case ast::Restriction::Block:
  case ast::Restriction::Class:
  case ast::Restriction::Optimization:
    return !definition.isPartial;
  default:
    return false;
  }
}

std::string qualified(const std::string &prefix, std::string_view name) {
  return prefix.empty() ? std::string(name) : prefix + "." + std::string(name);
}

// Models of a class: itself, or those inside a package.
void collectCandidates(const ast::ClassDefinition &definition, const std::string &prefix, std::vector<std::string> &names) {
  const std::string name = qualified(prefix, definition.name.text);
  if (isModel(definition))
    names.push_back(name);
  if (definition.restriction != ast::Restriction::Package)
    return;
  for (const ast::Element &element : definition.elements)
    if (element.kind == ast::ElementKind::Class && element.classDefinition != nullptr && !element.isProtected)
      collectCandidates(*element.classDefinition, name, names);
}

// Models at the top of the given files; if there are none, those inside packages.
std::vector<std::string> candidatesOf(const Library &library) {
  std::vector<std::string> names;
  std::vector<std::string> inPackages;
  for (const ast::File *file : library.given()) {
    const std::string within = file->hasWithin ? dotted(file->within) : std::string();
    for (const ast::ClassDefinition *definition : file->classes)
      if (definition != nullptr)
        collectCandidates(*definition, within, definition->restriction == ast::Restriction::Package ? inPackages : names);
  }
  return names.empty() ? inPackages : names;
}

// A model of a file whose `within` names a package that is not there.
Class *findInGivenFiles(Context &context, const std::string &name) {
  for (const ast::File *file : context.library.given())
    for (const ast::ClassDefinition *definition : file->classes)
      if (definition != nullptr && file->hasWithin && qualified(dotted(file->within), definition->name.text) == name)
        return &topLevelClass(context, *definition);
  return nullptr;
}

// The class to instantiate; null: reported, or there are candidates to choose from.
Class *chooseModel(Context &context, Instantiation &result) {
  std::vector<std::string> candidates = candidatesOf(context.library);
  std::string name = context.options.model;
  if (name.empty()) {
    if (candidates.size() != 1) {
      if (candidates.empty() && !context.diagnostics.hasErrors())
        context.diagnostics.report(diag::NoModel, Span{});
      result.candidates = std::move(candidates);
      return nullptr;
    }
    name = candidates.front();
  }
  Class *chosen = lookupQualified(context, name);
  if (chosen == nullptr)
    chosen = findInGivenFiles(context, name);
  if (chosen == nullptr) {
    context.diagnostics.report(diag::UnknownModel, Span{}, name).suggest(name, candidates);
    return nullptr;
  }
  if (chosen->definition == nullptr || !isModel(*chosen->definition)) {
    const bool isPartial = chosen->definition != nullptr && chosen->definition->isPartial;
    const Span span = chosen->definition == nullptr ? Span{} : chosen->definition->name.span;
    context.diagnostics.report(isPartial ? diag::PartialModel : diag::NotAModel, span, name);
    return nullptr;
  }
  if (chosen->definition->restriction == ast::Restriction::Optimization) {
    context.diagnostics.report(diag::OptimizationAsModel, chosen->definition->name.span, name);
    return nullptr;
  }
  return chosen;
}

}  // namespace

Instantiation instantiate(SourceManager &sources, const std::vector<std::string> &files, const InstantiateOptions &options,
                          Diagnostics &diagnostics) {
  Instantiation result;
  Context context(sources, diagnostics, options);
  makeRoot(context);
  for (const std::string &file : files)
    context.library.addGiven(file);
  Class *chosen = diagnostics.hasErrors() ? nullptr : chooseModel(context, result);
  if (chosen != nullptr) {
    Class &model = instantiateClass(context, *chosen, nullptr, nullptr, "", 0);
    model.isModel = true;
    context.model.name = chosen->path;
    context.model.description = descriptionOf(model.definition->comment);
    context.model.span = model.definition->name.span;
    if (!model.isFailed)
      flattenModel(context, model);
    if (!diagnostics.hasErrors()) {
      checkUnits(context.model, diagnostics);
      assert(flat::verify(context.model).empty());
      result.model = std::move(context.model);
    }
  }
  result.files = context.library.files();
  return result;
}

}  // namespace tf
