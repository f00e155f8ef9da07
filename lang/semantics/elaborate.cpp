#include "lang/semantics/elaborate.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/modification.h"

#include <algorithm>
#include <cassert>

namespace tf::semantics {

Context::Context(SourceManager &sourceManager, Diagnostics &sink, const InstantiateOptions &given)
    : sources(sourceManager), diagnostics(sink), options(given), library(sourceManager, sink, given.libraries) {}

Member *Class::find(std::string_view member) {
  const auto entry = index.find(member);
  return entry == index.end() ? nullptr : &members[entry->second];
}

std::string joinPath(std::string_view path, std::string_view name) {
  return path.empty() ? std::string(name) : std::string(path) + "." + std::string(name);
}

void makeRoot(Context &context) {
  Class &root = context.newClass();
  context.root = &root;
  root.progress = Progress::Done;
  for (const PredefinedClass &predefined : predefinedClasses()) {
    Class &entry = context.newClass();
    entry.predefined = &predefined;
    entry.name = predefined.name;
    entry.parent = &root;
    for (const std::string_view literal : predefined.literals)
      entry.literals.emplace_back(literal);
    entry.progress = Progress::Done;
    Member member;
    member.name = predefined.name;
    member.nested = &entry;
    root.index.emplace(member.name, root.members.size());
    root.members.push_back(member);
  }
}

namespace {

// What a component's modifier says about the elements of its type.
ModifierPtr childrenOnly(const ModifierPtr &modifier) {
  if (!modifier || modifier->children.empty())
    return nullptr;
  auto copy = std::make_shared<Modifier>();
  copy->span = modifier->span;
  copy->children = modifier->children;
  return copy;
}

ModifierPtr childOf(const ModifierPtr &modifier, std::string_view name) {
  const ModifierPtr *child = modifier ? modifier->find(name) : nullptr;
  return child == nullptr ? nullptr : *child;
}

ModifierPtr withoutRedeclaration(const ModifierPtr &modifier) {
  if (!modifier || !modifier->redeclaration)
    return modifier;
  auto copy = std::make_shared<Modifier>(*modifier);
  copy->redeclaration.reset();
  return copy;
}

// The declaration's own modification with the prefixes of its element.
ModifierPtr declaredModifier(Context &context, const ast::Element *element, const ast::Component &component, Class *scope) {
  const ModifierPtr made = makeModifier(component.modification, scope, context.diagnostics);
  if (!made && (element == nullptr || !element->isFinal))
    return nullptr;
  auto copy = made ? std::make_shared<Modifier>(*made) : std::make_shared<Modifier>();
  copy->name = component.name.text;
  copy->nameSpan = component.name.span;
  copy->isFinal = element != nullptr && element->isFinal;
  if (!made)
    copy->span = component.name.span;
  return copy;
}

bool mayRedeclare(Context &context, const Modifier &modifier, const ast::Element *element, Span declared) {
  if (element == nullptr || element->isReplaceable || element->isRedeclare)
    return true;
  context.diagnostics.report(diag::NotReplaceable, modifier.nameSpan, modifier.name).note(declared, "declared here");
  return false;
}

// `Real[3] x[2]` has two dimensions, the component's first.
std::vector<Dimension> dimensionsOf(const ast::ComponentClause &clause, const ast::Component &component, Class *scope) {
  std::vector<Dimension> dimensions;
  for (const ast::List<ast::Expr *> *subscripts : {&component.subscripts, &clause.subscripts})
    for (const ast::Expr *size : *subscripts)
      dimensions.push_back({size, scope});
  return dimensions;
}

class Elaboration {
public:
  Elaboration(Context &context, Class &scope) : context_(context), class_(scope), definition_(*scope.definition) {}

  void run() {
    for (const Class *derived = class_.derived; derived != nullptr; derived = derived->derived)
      if (derived->definition == class_.definition) {
        context_.diagnostics.report(diag::CyclicInheritance, definition_.name.span, definition_.name.text);
        class_.isFailed = true;
        return;
      }
    switch (definition_.form) {
    case ast::ClassForm::Long:
      elaborateLong();
      return;
    case ast::ClassForm::Short:
      elaborateShort();
      return;
    case ast::ClassForm::Enumeration:
      elaborateEnumeration();
      return;
    case ast::ClassForm::LongExtends:
      notSupported("'extends' of an inherited class");
      return;
    case ast::ClassForm::Der:
      notSupported("a partial derivative of a function");
      return;
    }
  }

private:
  void notSupported(std::string_view what) {
    context_.diagnostics.report(diag::NotSupported, definition_.name.span, what);
    class_.isFailed = true;
  }

  void elaborateEnumeration() {
    class_.predefined = &enumerationClass();
    class_.leafModifier = class_.modifier;
    if (definition_.isOpenEnumeration)
      notSupported("an enumeration with unknown literals");
    for (const ast::EnumerationLiteral &literal : definition_.literals) {
      const std::string name(literal.name.text);
      if (std::ranges::find(class_.literals, name) != class_.literals.end())
        context_.diagnostics.report(diag::DeclaredTwice, literal.name.span, name);
      class_.literals.push_back(name);
    }
  }

  void elaborateShort() {
    class_.causality = definition_.causality;
    Class *base = lookupClass(context_, *class_.parent, definition_.base);
    if (base == nullptr) {
      class_.isFailed = true;
      return;
    }
    for (const ast::Expr *size : definition_.subscripts)
      class_.dimensions.push_back({size, class_.parent});
    const ModifierPtr own = makeModifier(definition_.modification, class_.parent, context_.diagnostics);
    Class &derived = deriveFrom(*base, own, static_cast<int>(class_.dimensions.size()));
    class_.members = derived.members;
    class_.index = derived.index;
    class_.dimensions.insert(class_.dimensions.end(), derived.dimensions.begin(), derived.dimensions.end());
  }

  void elaborateLong() {
    std::vector<std::vector<Member>> own(definition_.elements.size());
    for (std::size_t i = 0; i < own.size(); ++i)
      own[i] = indexElement(definition_.elements[i]);
    std::vector<Member> ordered;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const ast::Element &element = definition_.elements[i];
      if (element.kind == ast::ElementKind::Extends && element.extends != nullptr)
        inherit(element, ordered);
      else
        for (const Member &member : own[i])
          ordered.push_back(*class_.find(member.name));
    }
    rebuildIndex(ordered);
    if (class_.predefined != nullptr)
      refuseAdditions(own);
  }

  // Like Real, the mechanical elements take no added members.
  void refuseAdditions(const std::vector<std::vector<Member>> &own) {
    Span added;
    for (const ast::Section &section : definition_.sections)
      added = section.span;
    for (const std::vector<Member> &members : own)
      if (!members.empty())
        added = members.front().span;
    if (!added.valid())
      return;
    context_.diagnostics.report(diag::PredefinedExtended, added, definition_.name.text, class_.predefined->name);
    class_.isFailed = true;
  }

  // Own elements of one declaration, entered in the index.
  std::vector<Member> indexElement(const ast::Element &element) {
    std::vector<Member> added;
    switch (element.kind) {
    case ast::ElementKind::Import:
      if (element.import != nullptr)
        class_.imports.push_back(element.import);
      break;
    case ast::ElementKind::Extends:
      break;
    case ast::ElementKind::Class:
      if (element.classDefinition == nullptr)
        break;
      if (element.isRedeclare)
        redeclared_.push_back(makeRedeclaration(element, nullptr, &class_, context_.diagnostics));
      else
        addMember(classMember(element), added);
      break;
    case ast::ElementKind::Component:
      if (element.component == nullptr)
        break;
      for (const ast::Component &component : element.component->components) {
        if (component.name.text.empty())
          continue;
        if (element.isRedeclare)
          redeclared_.push_back(makeRedeclaration(element, &component, &class_, context_.diagnostics));
        else if (!isDeclared(component.name))
          addMember(componentMember(element, component), added);
      }
      break;
    }
    return added;
  }

  bool isDeclared(const ast::Name &name) {
    const Member *first = class_.find(name.text);
    if (first == nullptr)
      return false;
    context_.diagnostics.report(diag::DeclaredTwice, name.span, name.text).note(first->span, "first declared here");
    return true;
  }

  void addMember(const Member &member, std::vector<Member> &added) {
    if (member.component == nullptr && isDeclared({member.name, member.span}))
      return;
    class_.index.emplace(member.name, class_.members.size());
    class_.members.push_back(member);
    added.push_back(member);
  }

  Member classMember(const ast::Element &element) {
    Member member;
    member.name = element.classDefinition->name.text;
    member.span = element.classDefinition->name.span;
    member.element = &element;
    member.definition = element.classDefinition;
    member.scope = &class_;
    member.isProtected = element.isProtected;
    member.modifier = childOf(class_.modifier, member.name);
    if (member.modifier && member.modifier->redeclaration && member.modifier->redeclaration->classDefinition != nullptr &&
        mayRedeclare(context_, *member.modifier, &element, member.span)) {
      member.definition = member.modifier->redeclaration->classDefinition;
      member.scope = member.modifier->redeclaration->scope;
      member.modifier = withoutRedeclaration(member.modifier);
    }
    return member;
  }

  Member componentMember(const ast::Element &element, const ast::Component &declared) {
    Component &component = context_.newComponent();
    component.name = declared.name.text;
    component.path = joinPath(class_.path, component.name);
    component.element = &element;
    component.clause = element.component;
    component.declaration = &declared;
    component.scope = &class_;
    component.container = &class_;
    component.declaredDimensions = dimensionsOf(*component.clause, declared, &class_);
    ModifierPtr own = declaredModifier(context_, &element, declared, &class_);
    ModifierPtr outer = childOf(class_.modifier, component.name);
    if (outer && outer->redeclaration && outer->redeclaration->component != nullptr &&
        mayRedeclare(context_, *outer, &element, declared.name.span)) {
      const Redeclaration &redeclaration = *outer->redeclaration;
      own = merge(declaredModifier(context_, nullptr, *redeclaration.component, redeclaration.scope), own, context_.diagnostics);
      component.clause = redeclaration.clause;
      component.declaration = redeclaration.component;
      component.scope = redeclaration.scope;
      redeclareDimensions(component, outer->nameSpan, declared.name.span);
    }
    component.modifier = merge(withoutRedeclaration(outer), own, context_.diagnostics);
    if (class_.value)
      setRecordValue(component);
    Member member;
    member.name = component.name;
    member.span = declared.name.span;
    member.element = &element;
    member.component = &component;
    member.scope = &class_;
    member.isProtected = element.isProtected;
    setPrefixes(component, element);
    return member;
  }

  // All of them or none, which keeps those that were declared (MLS 7.3.2).
  void redeclareDimensions(Component &component, Span redeclared, Span declared) const {
    const std::vector<Dimension> own = dimensionsOf(*component.clause, *component.declaration, component.scope);
    if (own.empty())
      return;
    if (own.size() != component.declaredDimensions.size())
      context_.diagnostics.report(diag::RedeclaredRank, redeclared, component.name, own.size(), component.declaredDimensions.size())
          .note(declared, "declared here");
    else
      component.declaredDimensions = own;
  }

  void setRecordValue(Component &component) const {
    auto modifier = component.modifier ? std::make_shared<Modifier>(*component.modifier) : std::make_shared<Modifier>();
    modifier->name = component.name;
    modifier->binding = projectField(*class_.value, component.name);
    component.modifier = modifier;
  }

  void setPrefixes(Component &component, const ast::Element &element) const {
    Prefixes &prefixes = component.prefixes;
    if (class_.owner != nullptr)
      prefixes = class_.owner->prefixes;
    prefixes.isProtected |= element.isProtected;
    prefixes.isFinal |= element.isFinal || (component.modifier && component.modifier->isFinal);
    // Inputs and outputs of components are ordinary variables of the model.
    if (class_.owner == nullptr && component.clause->causality == ast::Causality::Input)
      prefixes.causality = flat::Causality::Input;
    if (class_.owner == nullptr && component.clause->causality == ast::Causality::Output)
      prefixes.causality = flat::Causality::Output;
    if (component.clause->variability == ast::Variability::None)
      return;
    static constexpr flat::Variability kVariabilities[] = {flat::Variability::Continuous, flat::Variability::Discrete,
                                                           flat::Variability::Parameter, flat::Variability::Constant};
    const flat::Variability own = kVariabilities[static_cast<int>(component.clause->variability)];
    prefixes.variability = std::min(prefixes.variability, own);
    prefixes.isVariabilityGiven = true;
  }

  void inherit(const ast::Element &element, std::vector<Member> &ordered) {
    Class *base = lookupClass(context_, class_, element.extends->base);
    if (base == nullptr) {
      class_.isFailed = true;
      return;
    }
    ModifierPtr own = makeModifier(element.extends->modification, &class_, context_.diagnostics);
    const ModifierPtr written = own;
    for (const ModifierPtr &redeclared : redeclared_) {
      auto wrapper = std::make_shared<Modifier>();
      wrapper->children.push_back(redeclared);
      own = merge(wrapper, own, context_.diagnostics);
    }
    Class &derived = deriveFrom(*base, own, 0);
    checkModifierNames(context_, written, derived, false);
    for (const Member &member : derived.members) {
      Member inherited = member;
      inherited.isProtected |= element.isProtected;
      if (inherited.isProtected && inherited.component != nullptr)
        inherited.component->prefixes.isProtected = true;
      ordered.push_back(inherited);
    }
  }

  // A base class under this class's modification. `ownDims`: array dimensions between both.
  Class &deriveFrom(const Class &base, const ModifierPtr &own, int ownDims) {
    Class &derived = context_.newClass();
    derived.definition = base.definition;
    derived.name = base.name;
    derived.parent = base.parent;
    derived.owner = class_.owner;
    derived.path = class_.path;
    derived.derived = &class_;
    derived.value = class_.value;
    derived.arrayDepth = class_.arrayDepth + ownDims;
    const ModifierPtr shifted = shiftDimensions(childrenOnly(own), class_.arrayDepth);
    derived.modifier = merge(class_.modifier, merge(shifted, base.modifier, context_.diagnostics), context_.diagnostics);
    if (base.definition == nullptr) {
      derived.predefined = base.predefined;
      derived.literals = base.literals;
    }
    class_.bases.push_back(&derived);
    elaborate(context_, derived);
    class_.isFailed |= derived.isFailed;
    if (derived.predefined != nullptr) {
      class_.predefined = derived.predefined;
      class_.leafModifier = derived.leafModifier;
      class_.literals = derived.literals;
    }
    if (class_.causality == ast::Causality::None)
      class_.causality = derived.causality;
    return derived;
  }

  // The same element inherited twice is one (MLS 7.1); different ones of one name are an error.
  void rebuildIndex(const std::vector<Member> &ordered) {
    class_.index.clear();
    class_.members.clear();
    for (const Member &member : ordered) {
      const auto [entry, isNew] = class_.index.emplace(member.name, class_.members.size());
      if (isNew) {
        class_.members.push_back(member);
        continue;
      }
      const Member &first = class_.members[entry->second];
      const bool isSame =
          first.element != nullptr && member.element != nullptr &&
          (first.element == member.element || context_.sources.text(first.element->span) == context_.sources.text(member.element->span));
      if (isSame && member.component != nullptr && member.component != first.component)
        member.component->sameAs = first.component;
      if (!isSame)
        context_.diagnostics.report(diag::DeclaredTwice, member.span, member.name).note(first.span, "first declared here");
    }
  }

  Context &context_;
  Class &class_;
  const ast::ClassDefinition &definition_;
  std::vector<ModifierPtr> redeclared_;
};

}  // namespace

void elaborate(Context &context, Class &scope) {
  if (scope.progress != Progress::Fresh)
    return;
  scope.progress = Progress::Running;
  if (scope.definition == nullptr)
    scope.leafModifier = scope.modifier;
  else
    Elaboration(context, scope).run();
  scope.progress = Progress::Done;
}

Class &topLevelClass(Context &context, const ast::ClassDefinition &definition) {
  Class &root = *context.root;
  for (const Member &member : root.members)
    if (member.definition == &definition)
      return *member.nested;
  Class &entry = context.newClass();
  entry.definition = &definition;
  entry.name = definition.name.text;
  entry.parent = &root;
  entry.path = std::string(definition.name.text);
  Member member;
  member.name = entry.name;
  member.definition = &definition;
  member.nested = &entry;
  root.members.push_back(member);
  return entry;
}

Class &nestedClass(Context &context, Class &scope, Member &member) {
  if (member.nested != nullptr)
    return *member.nested;
  assert(member.definition != nullptr);
  Class &nested = context.newClass();
  nested.definition = member.definition;
  nested.name = member.definition->name.text;
  nested.parent = member.scope;
  nested.path = joinPath(scope.path, member.name);
  nested.modifier = childrenOnly(member.modifier);
  member.nested = &nested;
  return nested;
}

Class &instantiateClass(Context &context, const Class &type, const ModifierPtr &modifier, Component *owner, std::string path,
                        int arrayDepth) {
  Class &instance = context.newClass();
  instance.definition = type.definition;
  instance.name = type.name;
  instance.parent = type.parent;
  instance.owner = owner;
  instance.path = std::move(path);
  instance.arrayDepth = arrayDepth;
  if (type.definition == nullptr) {
    instance.predefined = type.predefined;
    instance.literals = type.literals;
  } else if (modifier && modifier->binding && type.definition->restriction == ast::Restriction::Record) {
    instance.value = modifier->binding;
  }
  instance.modifier = merge(childrenOnly(modifier), type.modifier, context.diagnostics);
  elaborate(context, instance);
  return instance;
}

namespace {

// An attribute has a value and nothing inside.
void checkAttributeModifier(Context &context, const Modifier &attribute) {
  for (const ModifierPtr &inside : attribute.children)
    context.diagnostics.report(diag::UnknownAttribute, inside->nameSpan, inside->name, attribute.name);
  if (!attribute.binding && attribute.children.empty())
    context.diagnostics.report(diag::AttributeWithoutValue, attribute.nameSpan, attribute.name);
}

}  // namespace

void checkModifierNames(Context &context, const ModifierPtr &modifier, Class &type, bool isCoordinate) {
  if (!modifier || type.isFailed)
    return;
  for (const ModifierPtr &child : modifier->children) {
    if (type.find(child->name) != nullptr)
      continue;
    if (type.predefined != nullptr && type.predefined->attribute(child->name) != nullptr) {
      checkAttributeModifier(context, *child);
      continue;
    }
    const bool isRotationPart =
        type.predefined != nullptr && type.predefined->kind == PredefinedKind::Rotation && (child->name == "q" || child->name == "w");
    if (isRotationPart && isCoordinate)
      continue;
    if (child->name == "der" && type.predefined != nullptr) {
      if (!isCoordinate)
        context.diagnostics.report(diag::DerModifierOutsideCoordinate, child->nameSpan);
      continue;
    }
    const auto &kind = type.predefined != nullptr ? diag::UnknownAttribute : diag::UnknownModified;
    context.diagnostics.report(kind, child->nameSpan, child->name, type.predefined != nullptr ? type.predefined->name : type.name)
        .suggest(child->name, memberNames(context, type));
  }
}

}  // namespace tf::semantics
