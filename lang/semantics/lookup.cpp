#include "lang/semantics/lookup.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"

#include <algorithm>
#include <set>

namespace tf::semantics {

namespace {

Found foundMember(Context &context, Class &scope, Member &member) {
  if (member.component != nullptr)
    return {nullptr, member.component, &scope, false};
  return {&nestedClass(context, scope, member), nullptr, &scope, false};
}

// The class of a qualified import's name; its last part may be a constant.
Found lookupImported(Context &context, const ast::Reference &reference) {
  if (reference.parts.empty())
    return {};
  Found found = lookupRoot(context, reference.parts[0].name.text, Files::Search);
  for (std::size_t i = 1; i < reference.parts.size() && found.type != nullptr; ++i)
    found = lookupMember(context, *found.type, reference.parts[i].name.text);
  return found;
}

// The import gives the class that it stands in this name.
bool introduces(const ast::Import &import, std::string_view name) {
  const std::size_t count = import.name.parts.size();
  switch (import.kind) {
  case ast::ImportKind::Qualified:
    return count > 0 && import.name.parts[count - 1].name.text == name;
  case ast::ImportKind::Renaming:
    return import.alias.text == name;
  case ast::ImportKind::List:
    return std::ranges::any_of(import.names, [&](const ast::Name &entry) { return entry.text == name; });
  case ast::ImportKind::Unqualified:
    return false;
  }
  return false;
}

Found lookupImports(Context &context, const Class &scope, std::string_view name) {
  for (const ast::Import *import : scope.imports) {
    if (!introduces(*import, name))
      continue;
    const Found found = lookupImported(context, import->name);
    if (import->kind != ast::ImportKind::List)
      return found;
    if (found.type != nullptr)
      return lookupMember(context, *found.type, name);
  }
  for (const ast::Import *import : scope.imports)
    if (import->kind == ast::ImportKind::Unqualified)
      if (const Found package = lookupImported(context, import->name); package.type != nullptr)
        if (const Found found = lookupMember(context, *package.type, name))
          return found;
  return {};
}

Found lookupPredefined(Context &context, std::string_view name) {
  const auto entry = context.root->index.find(name);
  if (entry == context.root->index.end())
    return {};
  Member &member = context.root->members[entry->second];
  return member.nested != nullptr && member.nested->definition == nullptr ? Found{member.nested, nullptr, context.root, true} : Found{};
}

Found lookupTopLevel(Context &context, std::string_view name) {
  const ast::ClassDefinition *definition = context.library.findTopLevel(name);
  return definition == nullptr ? Found{} : Found{&topLevelClass(context, *definition), nullptr, context.root, true};
}

bool isTopLevelName(const Context &context, std::string_view name) {
  const auto names = context.library.topLevelNames();
  return std::ranges::find(names, name) != names.end();
}

void reportUnknownClass(Context &context, Class &scope, const ast::Reference &reference, std::size_t part, Class *container) {
  const ast::Name &name = reference.parts[part].name;
  if (container != nullptr) {
    if (!container->isFailed)
      context.diagnostics.report(diag::UnknownClassMember, name.span, name.text, container->name)
          .suggest(name.text, memberNames(context, *container));
    return;
  }
  if (!reportFailedImport(context, scope, name.text))
    context.diagnostics.report(diag::UnknownClass, name.span, name.text).suggest(name.text, visibleNames(context, scope));
}

}  // namespace

Found lookupSimple(Context &context, Class &scope, std::string_view name, Files files) {
  for (Class *current = &scope; current != nullptr && current != context.root; current = current->parent) {
    elaborate(context, *current);
    if (Member *member = current->find(name)) {
      Found found = foundMember(context, *current, *member);
      found.isEnclosing = current != &scope;
      return found;
    }
    if (Found found = lookupImports(context, *current, name)) {
      found.isEnclosing = true;
      return found;
    }
    if (Found found = lookupMember(context, *current, name)) {
      found.isEnclosing = current != &scope;
      return found;
    }
    if (current->definition != nullptr && current->definition->isEncapsulated)
      return lookupPredefined(context, name);
  }
  if (isTopLevelName(context, name))
    return lookupTopLevel(context, name);
  if (const Found predefined = lookupPredefined(context, name))
    return predefined;
  return files == Files::Search ? lookupTopLevel(context, name) : Found{};
}

Found lookupMember(Context &context, Class &scope, std::string_view name) {
  elaborate(context, scope);
  if (Member *member = scope.find(name))
    return foundMember(context, scope, *member);
  if (scope.definition == nullptr)
    return {};
  const ast::ClassDefinition *stored = context.library.findInPackage(*scope.definition, name);
  if (stored == nullptr)
    return {};
  scope.index.emplace(stored->name.text, scope.members.size());
  Member &member = scope.members.emplace_back();
  member.name = stored->name.text;
  member.span = stored->name.span;
  member.definition = stored;
  member.scope = &scope;
  return foundMember(context, scope, member);
}

Found lookupRoot(Context &context, std::string_view name, Files files) {
  if (const Found predefined = lookupPredefined(context, name))
    return predefined;
  if (files == Files::Search || isTopLevelName(context, name))
    return lookupTopLevel(context, name);
  return {};
}

Class *lookupClass(Context &context, Class &scope, const ast::Reference &reference) {
  if (reference.parts.empty())
    return nullptr;
  const std::string_view first = reference.parts[0].name.text;
  Found found = reference.leadingDot ? lookupRoot(context, first, Files::Search) : lookupSimple(context, scope, first, Files::Search);
  Class *container = nullptr;
  for (std::size_t i = 0;; ++i) {
    if (!found) {
      reportUnknownClass(context, scope, reference, i, container);
      return nullptr;
    }
    const ast::Name &name = reference.parts[i].name;
    if (found.type == nullptr) {
      Diagnostic &error = context.diagnostics.report(diag::NotAClass, name.span, name.text);
      if (i == 0 && reference.parts.size() == 1 && findPredefined(name.text) != nullptr)
        error.message += fmt::format("; write '.{}' for the predefined class", name.text);
      if (found.component->declaration != nullptr)
        error.note(found.component->declaration->name.span, fmt::format("'{}' is declared here", name.text));
      return nullptr;
    }
    if (i + 1 == reference.parts.size())
      return found.type;
    container = found.type;
    found = lookupMember(context, *container, reference.parts[i + 1].name.text);
  }
}

void checkImports(Context &context, const Class &scope) {
  for (const ast::Import *import : scope.imports) {
    Class *container = nullptr;
    const auto &parts = import->name.parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const ast::Name &name = parts[i].name;
      const Found found = i == 0 ? lookupRoot(context, name.text, Files::Search) : lookupMember(context, *container, name.text);
      if (!found) {
        reportUnknownClass(context, *context.root, import->name, i, container);
        break;
      }
      container = found.type;
      if (container == nullptr)
        break;
    }
    for (const ast::Name &name : import->names)
      if (container != nullptr && !lookupMember(context, *container, name.text) && !container->isFailed)
        context.diagnostics.report(diag::UnknownClassMember, name.span, name.text, container->name)
            .suggest(name.text, memberNames(context, *container));
  }
}

bool reportFailedImport(Context &context, const Class &scope, std::string_view name) {
  for (const Class *current = &scope; current != nullptr && current != context.root; current = current->parent) {
    if (std::ranges::any_of(current->imports, [&](const ast::Import *import) { return introduces(*import, name); })) {
      checkImports(context, *current);
      return true;
    }
    if (current->definition != nullptr && current->definition->isEncapsulated)
      return false;
  }
  return false;
}

Class *lookupQualified(Context &context, std::string_view dottedName) {
  Found found;
  bool isFirst = true;
  while (!dottedName.empty()) {
    const std::size_t dot = dottedName.find('.');
    const std::string_view part = dottedName.substr(0, dot);
    dottedName = dot == std::string_view::npos ? std::string_view() : dottedName.substr(dot + 1);
    if (isFirst)
      found = lookupTopLevel(context, part);
    else if (found.type != nullptr)
      found = lookupMember(context, *found.type, part);
    isFirst = false;
    if (found.type == nullptr)
      return nullptr;
  }
  return found.type;
}

std::vector<std::string> memberNames(Context &context, Class &scope) {
  elaborate(context, scope);
  std::vector<std::string> names;
  names.reserve(scope.members.size());
  for (const Member &member : scope.members)
    names.emplace_back(member.name);
  if (scope.predefined != nullptr)
    for (const AttributeSpec &attribute : scope.predefined->attributes)
      names.emplace_back(attribute.name);
  return names;
}

std::vector<std::string> visibleNames(Context &context, Class &scope) {
  std::set<std::string> names;
  for (Class *current = &scope; current != nullptr && current != context.root; current = current->parent) {
    for (const Member &member : current->members)
      names.emplace(member.name);
    for (const ast::Import *import : current->imports) {
      if (import->kind == ast::ImportKind::Renaming)
        names.emplace(import->alias.text);
      else if (import->kind == ast::ImportKind::Qualified && !import->name.parts.empty())
        names.emplace(import->name.parts[import->name.parts.size() - 1].name.text);
    }
  }
  for (const Member &member : context.root->members)
    names.emplace(member.name);
  for (const std::string &name : context.library.topLevelNames())
    names.insert(name);
  return {names.begin(), names.end()};
}

std::string dotted(const ast::Reference &reference) {
  std::string text = reference.leadingDot ? "." : "";
  for (std::size_t i = 0; i < reference.parts.size(); ++i)
    text += (i == 0 ? "" : ".") + std::string(reference.parts[i].name.text);
  return text;
}

}  // namespace tf::semantics
