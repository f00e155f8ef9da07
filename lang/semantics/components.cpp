#include "lang/semantics/components.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/modification.h"
#include "lang/semantics/quotient_note.h"
#include "lang/semantics/text.h"
#include "lang/semantics/typing.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace tf::semantics {

namespace {

void reportCycle(Context &context, const Component &component) {
  context.diagnostics.report(diag::CyclicDefinition, component.declaration->name.span, component.path);
}

// Chains of the classes that contain the component: a class that contains itself would be infinite.
bool isRecursive(const Component &component, const Class &type) {
  int depth = 0;
  for (const Class *container = component.container; container != nullptr;) {
    if (++depth > kMaximumNesting)
      return true;
    for (const Class *derived = container; derived != nullptr; derived = derived->derived)
      if (derived->definition == type.definition && type.definition != nullptr)
        return true;
    container = container->owner == nullptr ? nullptr : container->owner->container;
  }
  return false;
}

class Resolution {
public:
  Resolution(Context &context, Component &component) : context_(context), component_(component) {}

  bool run() {
    if (component_.clause->flow != ast::Flow::None) {
      context_.diagnostics.report(diag::NotSupported, component_.clause->prefixSpan,
                                  component_.clause->flow == ast::Flow::Flow ? "'flow'" : "'stream'");
      return false;
    }
    Class *type = lookupClass(context_, *component_.scope, component_.clause->type);
    if (type == nullptr)
      return false;
    component_.type = type;
    elaborate(context_, *type);
    if (type->isFailed || !mayBeType(*type))
      return false;
    const auto ownDims = static_cast<int>(component_.declaration->subscripts.size() + component_.clause->subscripts.size());
    if (type->predefined != nullptr)
      return resolveLeaf(*type, ownDims);
    if (component_.clause->isCoordinate)
      return wrongCoordinate();
    const bool isRecord = type->definition->restriction == ast::Restriction::Record;
    if (!isRecord && component_.modifier && component_.modifier->binding) {
      context_.diagnostics.report(diag::ComponentBinding, component_.modifier->binding->span, component_.name, type->name);
      return false;
    }
    if (isRecursive(component_, *type)) {
      context_.diagnostics.report(diag::RecursiveComponent, component_.declaration->name.span, component_.name, type->name);
      return false;
    }
    return evaluateDimensions(type->dimensions) && makeInstances(*type);
  }

private:
  bool mayBeType(const Class &type) {
    if (type.definition == nullptr)
      return true;
    const ast::Restriction restriction = type.definition->restriction;
    if (restriction == ast::Restriction::Package || restriction == ast::Restriction::Function ||
        restriction == ast::Restriction::Optimization) {
      context_.diagnostics.report(diag::NotAType, component_.clause->type.span, dotted(component_.clause->type),
                                  restriction == ast::Restriction::Package    ? "a package"
                                  : restriction == ast::Restriction::Function ? "a function"
                                                                              : "an optimization problem");
      return false;
    }
    if (!type.definition->isPartial || (component_.element != nullptr && component_.element->isOuter))
      return true;
    context_.diagnostics.report(diag::PartialComponent, component_.clause->type.span, type.name, component_.name)
        .note(type.definition->name.span, fmt::format("'{}' is declared partial here", type.name));
    return false;
  }

  bool wrongCoordinate() {
    Diagnostic &error = context_.diagnostics.report(diag::CoordinateType, component_.clause->type.span, dotted(component_.clause->type));
    if (component_.type->definition != nullptr)
      error.note(component_.type->definition->name.span, fmt::format("'{}' is declared here", component_.type->name));
    return false;
  }

  bool resolveLeaf(const Class &type, int ownDims) {
    if (component_.clause->isCoordinate && type.predefined->kind != PredefinedKind::Real &&
        type.predefined->kind != PredefinedKind::Rotation)
      return wrongCoordinate();
    if (type.predefined->kind == PredefinedKind::Rotation && !mayBeRotation())
      return false;
    component_.leaf = &instantiateClass(context_, type, component_.modifier, &component_, component_.path, ownDims);
    checkModifierNames(context_, component_.modifier, *component_.leaf, component_.clause->isCoordinate);
    const Class *container = component_.container;
    if (container->owner == nullptr && component_.prefixes.causality == flat::Causality::Local)
      component_.prefixes.causality = component_.leaf->causality == ast::Causality::Input    ? flat::Causality::Input
                                      : component_.leaf->causality == ast::Causality::Output ? flat::Causality::Output
                                                                                             : flat::Causality::Local;
    return checkPrefixes() && evaluateDimensions(component_.leaf->dimensions);
  }

  // Inputs, parameters and discrete variables would be four numbers without the length of a unit quaternion.
  bool mayBeRotation() {
    static constexpr std::array<std::string_view, 3> kVariabilities = {"discrete", "a parameter", "a constant"};
    const Prefixes &prefixes = component_.prefixes;
    std::string_view what;
    if (prefixes.isVariabilityGiven && prefixes.variability != Variability::Continuous)
      what = kVariabilities[static_cast<std::size_t>(Variability::Discrete) - static_cast<std::size_t>(prefixes.variability)];
    else if (prefixes.causality == flat::Causality::Input)
      what = "an input";
    if (!what.empty())
      context_.diagnostics.report(diag::RotationKind, component_.clause->type.span, component_.name, what);
    return what.empty();
  }

  bool checkPrefixes() {
    if (!component_.leaf->predefined->isElement())
      return true;
    const ast::ComponentClause &clause = *component_.clause;
    const bool hasPrefix = clause.isCoordinate || clause.variability != ast::Variability::None ||
                           clause.causality != ast::Causality::None || clause.flow != ast::Flow::None;
    if (hasPrefix)
      context_.diagnostics.report(diag::ElementPrefix, clause.prefixSpan, component_.leaf->predefined->name);
    if (component_.modifier && component_.modifier->binding)
      context_.diagnostics.report(diag::ElementBinding, component_.modifier->binding->span, component_.name,
                                  component_.leaf->predefined->name);
    return true;
  }

  bool evaluateDimensions(const std::vector<Dimension> &inherited) {
    std::vector<Dimension> dimensions = component_.declaredDimensions;
    dimensions.insert(dimensions.end(), inherited.begin(), inherited.end());
    long total = 1;
    for (std::size_t i = 0; i < dimensions.size(); ++i) {
      const std::optional<int> size = dimensionSize(dimensions[i], i);
      if (!size)
        return false;
      total *= *size;
      if (total > kMaximumArraySize) {
        context_.diagnostics.report(diag::ArrayTooLarge, dimensions[i].size->span, kMaximumArraySize);
        return false;
      }
      component_.dimensions.push_back(*size);
    }
    return true;
  }

  std::optional<int> dimensionSize(const Dimension &dimension, std::size_t position) {
    if (dimension.size == nullptr || dimension.size->kind == ast::ExprKind::Error)
      return std::nullopt;
    if (dimension.size->kind == ast::ExprKind::Colon)
      return inferredSize(*dimension.size, position);
    const ExprPtr typed = typeExpression(context_, *dimension.size, Scope{dimension.scope, nullptr, false});
    if (typed == nullptr)
      return std::nullopt;
    if (typed->type != Type{Base::Integer, {}}) {
      noteQuotient(context_.diagnostics.report(diag::DimensionType, dimension.size->span, toString(typed->type)), *dimension.size, *typed);
      return std::nullopt;
    }
    const auto value = constantValue(context_, *typed);
    if (!value) {
      reportNotConstant(context_, *typed, dimension.size->span, "the size of an array");
      return std::nullopt;
    }
    if ((*value)[0] < 0 || (*value)[0] > kMaximumArraySize) {
      context_.diagnostics.report(diag::DimensionNegative, dimension.size->span, (*value)[0]);
      return std::nullopt;
    }
    return static_cast<int>((*value)[0]);
  }

  std::optional<int> inferredSize(const ast::Expr &colon, std::size_t position) {
    if (!component_.modifier || !component_.modifier->binding) {
      context_.diagnostics.report(diag::SizeUnknown, colon.span, component_.name);
      return std::nullopt;
    }
    const ExprPtr value = typeBinding(context_, *component_.modifier->binding);
    if (value == nullptr)
      return std::nullopt;
    if (position >= value->type.dims.size()) {
      context_.diagnostics.report(diag::ShapeMismatch, value->span, component_.name, "an array", toString(value->type));
      return std::nullopt;
    }
    return value->type.dims[position];
  }

  bool makeInstances(const Class &type) {
    const int count = sizeOf(component_.dimensions);
    if (static_cast<long>(context_.components.size()) + count > kMaximumComponents) {
      if (!context_.isOverLimit)
        context_.diagnostics.report(diag::ModelTooLarge, component_.declaration->name.span, kMaximumComponents);
      context_.isOverLimit = true;
      return false;
    }
    std::vector<int> index(component_.dimensions.size(), 1);
    for (int i = 0; i < count; ++i) {
      const ModifierPtr modifier =
          component_.dimensions.empty() ? component_.modifier : splitForElement(component_.modifier, index, component_.dimensions);
      Class &instance = instantiateClass(context_, type, modifier, &component_, component_.path + subscriptText(index), 0);
      component_.instances.push_back(&instance);
      if (i == 0)
        checkModifierNames(context_, component_.modifier, instance, false);
      for (std::size_t d = index.size(); d-- > 0;) {
        if (++index[d] <= component_.dimensions[d])
          break;
        index[d] = 1;
      }
      if (context_.isOverLimit)
        return false;
    }
    return true;
  }

  static std::string subscriptText(const std::vector<int> &index) {
    if (index.empty())
      return {};
    std::string text = "[";
    for (std::size_t i = 0; i < index.size(); ++i)
      text += (i == 0 ? "" : ",") + std::to_string(index[i]);
    return text + "]";
  }

  Context &context_;
  Component &component_;
};

}  // namespace

bool resolve(Context &context, Component &component) {
  if (component.typeProgress == Progress::Done)
    return !component.isFailed;
  if (component.typeProgress == Progress::Running) {
    reportCycle(context, component);
    return false;
  }
  component.typeProgress = Progress::Running;
  component.isFailed = !Resolution(context, component).run();
  component.typeProgress = Progress::Done;
  return !component.isFailed;
}

Component *actual(Context &context, Component &component) {
  if (component.sameAs != nullptr)
    return actual(context, *component.sameAs);
  if (component.element == nullptr || !component.element->isOuter)
    return &component;
  if (component.inner != nullptr)
    return component.inner;
  if (component.modifier && !component.element->isInner)
    context.diagnostics.report(diag::OuterModified, component.modifier->span, component.name);
  const Class *container = component.container;
  while (container != nullptr) {
    // The outermost derived class knows all members of the instance.
    const Class *instance = container;
    while (instance->derived != nullptr)
      instance = instance->derived;
    const auto entry = instance->index.find(component.name);
    if (entry != instance->index.end()) {
      const Member &member = instance->members[entry->second];
      if (member.component != nullptr && member.component != &component && member.element != nullptr && member.element->isInner)
        return component.inner = actual(context, *member.component);
    }
    container = instance->owner == nullptr ? nullptr : instance->owner->container;
  }
  context.diagnostics.report(diag::NoInner, component.declaration->name.span, component.name);
  component.isFailed = true;
  component.typeProgress = Progress::Done;
  return nullptr;
}

bool isPresent(Context &context, Component &component) {
  if (component.declaration->condition == nullptr || component.conditionProgress == Progress::Done)
    return component.isPresent;
  if (component.conditionProgress == Progress::Running) {
    reportCycle(context, component);
    return false;
  }
  component.conditionProgress = Progress::Running;
  const ast::Expr &condition = *component.declaration->condition;
  const ExprPtr typed = typeExpression(context, condition, Scope{component.scope, nullptr, false});
  component.isPresent = false;
  if (typed != nullptr && typed->type != Type{Base::Boolean, {}}) {
    context.diagnostics.report(diag::ConditionType, condition.span, toString(typed->type));
    component.isFailed = true;
  } else if (typed == nullptr) {
    component.isFailed = true;
  } else if (const auto value = constantValue(context, *typed)) {
    component.isPresent = (*value)[0] != 0;
  } else {
    component.isFailed = true;
    reportNotConstant(context, *typed, condition.span, "the condition of a component");
  }
  component.conditionProgress = Progress::Done;
  return component.isPresent;
}

Type typeOf(const Component &component) {
  assert(component.isLeaf());
  Type type{baseOf(component.leaf->predefined->kind), component.dimensions};
  if (type.base == Base::Rotation)
    type.dims.push_back(4);
  return type;
}

Variability variabilityOf(const Component &component) {
  if (component.prefixes.isVariabilityGiven && component.prefixes.variability != Variability::Continuous)
    return component.prefixes.variability;
  const Base base = baseOf(component.leaf->predefined->kind);
  return base == Base::Real || base == Base::Rotation ? Variability::Continuous : Variability::Discrete;
}

namespace {

// "R.w", the variable after the rotation coordinate.
void addAngularVelocity(Context &context, Component &component) {
  flat::Variable velocity = context.model.variables[static_cast<std::size_t>(component.variable)];
  velocity.name += ".w";
  velocity.type = {Base::Real, component.dimensions};
  velocity.type.dims.push_back(3);
  velocity.isCoordinate = false;
  velocity.isAngularVelocity = true;
  velocity.description.clear();
  context.model.variables.push_back(std::move(velocity));
  context.variableOwners.push_back(&component);
}

}  // namespace

flat::VariableId variableOf(Context &context, Component &component) {
  assert(component.isLeaf() && !component.leaf->predefined->isElement());
  if (component.variable >= 0)
    return component.variable;
  component.variable = static_cast<int>(context.model.variables.size());
  flat::Variable &variable = context.model.variables.emplace_back();
  context.variableOwners.push_back(&component);
  variable.name = component.path;
  variable.type = typeOf(component);
  variable.variability = variabilityOf(component);
  variable.causality = component.prefixes.causality;
  variable.isComponentInput = component.container->owner != nullptr &&
                              (component.clause->causality == ast::Causality::Input || component.leaf->causality == ast::Causality::Input);
  variable.isCoordinate = component.clause->isCoordinate;
  variable.isFinal = component.prefixes.isFinal;
  variable.isProtected = component.prefixes.isProtected;
  variable.description = descriptionOf(component.declaration->comment);
  variable.literals = component.leaf->literals;
  variable.span = component.declaration->name.span;
  if (variable.isCoordinate && variable.type.base == Base::Rotation)
    addAngularVelocity(context, component);
  return component.variable;
}

flat::ElementId elementOf(Context &context, Component &component) {
  assert(component.isLeaf() && component.leaf->predefined->isElement());
  if (component.elementId >= 0)
    return component.elementId;
  component.elementId = static_cast<int>(context.model.elements.size());
  flat::Element &element = context.model.elements.emplace_back();
  context.elementOwners.push_back(&component);
  element.kind = elementKindOf(component.leaf->predefined->kind);
  element.name = component.path;
  element.dims = component.dimensions;
  element.scope = component.container->path;
  element.description = descriptionOf(component.declaration->comment);
  element.span = component.declaration->name.span;
  return component.elementId;
}

}  // namespace tf::semantics
