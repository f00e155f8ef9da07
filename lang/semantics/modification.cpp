#include "lang/semantics/modification.h"

#include "lang/semantics/diagnostics.h"

#include <algorithm>
#include <map>
#include <string>

namespace tf::semantics {

namespace {

constexpr std::string_view kDer = "der";

// A modifier under construction; children are found by name.
struct Draft {
  Modifier node;
  std::vector<Draft> children;

  // `each` of the whole becomes one of each of its parts.
  void passEachOn() {
    for (Draft &draft : children)
      draft.node.isEach |= node.isEach;
    node.isEach = false;
  }

  [[nodiscard]] bool has(std::string_view name) const {
    return std::ranges::any_of(children, [&](const Draft &draft) { return draft.node.name == name; });
  }

  Draft &child(std::string_view name, Span nameSpan, Span span) {
    for (Draft &draft : children)
      if (draft.node.name == name)
        return draft;
    Draft &added = children.emplace_back();
    added.node.name = name;
    added.node.nameSpan = nameSpan;
    added.node.span = span;
    return added;
  }
};

ModifierPtr finish(Draft &&draft) {
  for (Draft &child : draft.children)
    draft.node.children.push_back(finish(std::move(child)));
  return std::make_shared<const Modifier>(std::move(draft.node));
}

class Builder {
public:
  Builder(Class *scope, Diagnostics &diagnostics) : scope_(scope), diagnostics_(diagnostics) {}

  // `isEach` is said of the whole modification; `areEach` of each of its arguments.
  void addModification(Draft &target, const ast::Modification &modification, bool isEach, bool areEach = false) {
    if (modification.isBreak)
      diagnostics_.report(diag::BreakNotSupported, modification.span);
    for (const ast::Argument &argument : modification.arguments)
      addArgument(target, argument, areEach || argument.isEach);
    if (modification.value == nullptr)
      return;
    if (target.node.binding)
      reportTwice(target.node.name, modification.value->span, target.node.binding->span);
    else
      target.node.binding = Binding{modification.value, scope_, modification.value->span, isEach, false, 0, {}};
  }

  void addRedeclaration(Draft &target, const ast::ComponentClause *clause, const ast::Component *component,
                        const ast::ClassDefinition *definition, bool isReplaceable) {
    if (target.node.redeclaration)
      reportTwice(target.node.name, target.node.nameSpan, target.node.span);
    target.node.redeclaration = Redeclaration{clause, component, definition, scope_, isReplaceable};
  }

private:
  void addArgument(Draft &target, const ast::Argument &argument, bool isEach) {
    switch (argument.kind) {
    case ast::ArgumentKind::Element:
      addElement(target, argument, isEach);
      return;
    case ast::ArgumentKind::Der:
      addTo(target, kDer, argument.span, argument, isEach);
      return;
    case ast::ArgumentKind::BreakComponent:
    case ast::ArgumentKind::BreakConnect:
      diagnostics_.report(diag::BreakNotSupported, argument.span);
      return;
    case ast::ArgumentKind::RedeclareComponent:
      if (argument.component != nullptr && !argument.component->components.empty()) {
        const ast::Component &component = argument.component->components[0];
        Draft &child = target.child(component.name.text, component.name.span, argument.span);
        child.node.isFinal |= argument.isFinal;
        addRedeclaration(child, argument.component, &component, nullptr, argument.isReplaceable);
      }
      return;
    case ast::ArgumentKind::RedeclareClass:
      if (argument.classDefinition != nullptr) {
        const ast::Name &name = argument.classDefinition->name;
        Draft &child = target.child(name.text, name.span, argument.span);
        child.node.isFinal |= argument.isFinal;
        addRedeclaration(child, nullptr, nullptr, argument.classDefinition, argument.isReplaceable);
      }
      return;
    }
  }

  // `a.b.c(…) = e`: prefixes belong to the last part (MLS 7.2.4).
  void addElement(Draft &target, const ast::Argument &argument, bool isEach) {
    const auto &parts = argument.path.parts;
    if (parts.empty())
      return;
    Draft *draft = &target;
    for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
      draft = &draft->child(parts[k].name.text, parts[k].name.span, argument.span);
      draft->passEachOn();
    }
    const ast::Name &last = parts[parts.size() - 1].name;
    addTo(*draft, last.text, last.span, argument, isEach);
  }

  // Of several arguments for one element, `each` of one is said of what this one modifies only.
  void addTo(Draft &target, std::string_view name, Span nameSpan, const ast::Argument &argument, bool isEach) {
    const bool isFirst = !target.has(name);
    Draft &child = target.child(name, nameSpan, argument.span);
    const bool areEach = !isFirst && isEach && !child.node.isEach;
    if (isFirst)
      child.node.isEach = isEach;
    else if (!isEach)
      child.passEachOn();
    child.node.isFinal |= argument.isFinal;
    if (argument.modification != nullptr)
      addModification(child, *argument.modification, isEach, areEach);
  }

  void reportTwice(std::string_view name, Span second, Span first) {
    diagnostics_.report(diag::ModifiedTwice, second, name).note(first, "first modified here");
  }

  Class *scope_;
  Diagnostics &diagnostics_;
};

bool saysSomething(const Modifier &modifier) { return modifier.binding || modifier.redeclaration || !modifier.children.empty(); }

}  // namespace

const ModifierPtr *Modifier::find(std::string_view child) const {
  const auto found = std::ranges::find_if(children, [&](const ModifierPtr &entry) { return entry->name == child; });
  return found == children.end() ? nullptr : &*found;
}

ModifierPtr makeModifier(const ast::Modification *modification, Class *scope, Diagnostics &diagnostics) {
  if (modification == nullptr)
    return nullptr;
  Draft draft;
  draft.node.span = modification->span;
  draft.node.nameSpan = modification->span;
  Builder(scope, diagnostics).addModification(draft, *modification, false);
  return finish(std::move(draft));
}

ModifierPtr makeRedeclaration(const ast::Element &element, const ast::Component *component, Class *scope, Diagnostics &diagnostics) {
  Draft draft;
  const ast::Name &name = component != nullptr ? component->name : element.classDefinition->name;
  draft.node.name = name.text;
  draft.node.nameSpan = name.span;
  draft.node.span = element.span;
  draft.node.isFinal = element.isFinal;
  Builder builder(scope, diagnostics);
  builder.addRedeclaration(draft, element.component, component, element.classDefinition, element.isReplaceable);
  return finish(std::move(draft));
}

namespace {

// As Draft::passEachOn; a binding knows its own.
ModifierPtr withEachPassedOn(const ModifierPtr &modifier) {
  if (!modifier->isEach)
    return modifier;
  auto copy = std::make_shared<Modifier>(*modifier);
  copy->isEach = false;
  for (ModifierPtr &child : copy->children) {
    auto part = std::make_shared<Modifier>(*child);
    part->isEach = true;
    child = part;
  }
  return copy;
}

// Whether both say something of different parts, `each` of which is said of the one only.
bool differInEach(const Modifier &outer, const Modifier &inner) {
  return outer.isEach != inner.isEach && saysSomething(outer) && (!inner.children.empty() || (inner.binding && !outer.binding));
}

}  // namespace

ModifierPtr merge(const ModifierPtr &outer, const ModifierPtr &inner, Diagnostics &diagnostics) {
  if (!outer)
    return inner;
  if (!inner)
    return outer;
  if (differInEach(*outer, *inner))
    return merge(withEachPassedOn(outer), withEachPassedOn(inner), diagnostics);
  if (inner->isFinal && saysSomething(*outer))
    diagnostics.report(diag::FinalModified, outer->nameSpan, inner->name).note(inner->span, "declared final here");
  auto merged = std::make_shared<Modifier>(*outer);
  merged->isFinal = outer->isFinal || inner->isFinal;
  if (!merged->binding) {
    merged->binding = inner->binding;
    merged->isEach = outer->isEach || inner->isEach;
  }
  if (!merged->redeclaration)
    merged->redeclaration = inner->redeclaration;
  for (const ModifierPtr &child : inner->children) {
    const auto same = std::ranges::find_if(merged->children, [&](const ModifierPtr &entry) { return entry->name == child->name; });
    if (same == merged->children.end())
      merged->children.push_back(child);
    else
      *same = merge(*same, child, diagnostics);
  }
  return merged;
}

namespace {

// Applies `change` to every binding below `modifier`.
template <class Change> ModifierPtr mapBindings(const ModifierPtr &modifier, const Change &change) {
  auto copy = std::make_shared<Modifier>(*modifier);
  if (copy->binding)
    change(*copy->binding);
  for (ModifierPtr &child : copy->children)
    child = mapBindings(child, change);
  return copy;
}

}  // namespace

namespace {

void splitBinding(Binding &binding, const std::vector<int> &index, const std::vector<int> &sizes) {
  if (binding.outerDims < static_cast<int>(index.size()))
    binding.projections.push_back({{index.begin() + binding.outerDims, index.end()}, {}, {sizes.begin() + binding.outerDims, sizes.end()}});
}

// Below the elements of the array: `each` keeps its value whole.
ModifierPtr splitNested(const ModifierPtr &modifier, const std::vector<int> &index, const std::vector<int> &sizes) {
  if (modifier->isEach)
    return mapBindings(modifier, [](Binding &binding) { binding.isWithinArray = true; });
  auto copy = std::make_shared<Modifier>(*modifier);
  if (copy->binding && copy->binding->isEach)
    copy->binding->isWithinArray = true;
  else if (copy->binding)
    splitBinding(*copy->binding, index, sizes);
  for (ModifierPtr &child : copy->children)
    child = splitNested(child, index, sizes);
  return copy;
}

}  // namespace

ModifierPtr splitForElement(const ModifierPtr &modifier, const std::vector<int> &index, const std::vector<int> &sizes) {
  if (!modifier)
    return nullptr;
  auto copy = std::make_shared<Modifier>(*modifier);
  if (copy->binding && !copy->binding->isEach)
    splitBinding(*copy->binding, index, sizes);
  for (ModifierPtr &child : copy->children) {
    if (!child->isEach) {
      child = splitNested(child, index, sizes);
      continue;
    }
    auto element = std::make_shared<Modifier>(*child);
    element->isEach = false;
    if (element->binding)
      element->binding->isEach = false;
    child = element;
  }
  return copy;
}

ModifierPtr shiftDimensions(const ModifierPtr &modifier, int depth) {
  if (!modifier || depth == 0)
    return modifier;
  return mapBindings(modifier, [depth](Binding &binding) { binding.outerDims += depth; });
}

Binding projectField(const Binding &binding, std::string_view field) {
  Binding projected = binding;
  projected.projections.push_back({{}, field, {}});
  return projected;
}

}  // namespace tf::semantics
