#include "lang/semantics/flatten.h"

#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elements.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/text.h"
#include "lang/semantics/typing.h"

#include <algorithm>
#include <set>

namespace tf::semantics {

namespace {

class Flattening {
public:
  explicit Flattening(Context &context) : context_(context) {}

  void run(Class &model) {
    declare(model, 0);
    for (Component *component : leaves_)
      complete(*component);
    for (Class *instance : instances_)
      flattenEquations(context_, *instance);
    readExperiment(model);
    checkModel(context_);
    finishModel(context_, declared_);
  }

private:
  // Makes the variables and elements, in the order of their declarations.
  void declare(Class &instance, int depth) {
    instances_.push_back(&instance);
    checkAllImports(instance);
    if (depth > kMaximumNesting)
      return;
    // By position: the vector may grow while types are looked up.
    for (std::size_t i = 0; i < instance.members.size() && !context_.isOverLimit; ++i)
      if (Component *component = instance.members[i].component)
        declareComponent(*component, depth);
  }

  void checkAllImports(const Class &instance) {
    if (instance.definition != nullptr && checkedImports_.insert(instance.definition).second)
      checkImports(context_, instance);
    for (const Class *base : instance.bases)
      checkAllImports(*base);
  }

  void declareComponent(Component &component, int depth) {
    Component *target = actual(context_, component);
    if (target != &component || !isPresent(context_, component) || !resolve(context_, component))
      return;
    if (!component.isLeaf()) {
      for (Class *inner : component.instances)
        declare(*inner, depth + 1);
      return;
    }
    leaves_.push_back(&component);
    if (component.leaf->predefined->isElement())
      (void)elementOf(context_, component);
    else
      declared_.push_back(variableOf(context_, component));
  }

  void complete(Component &component) {
    if (component.leaf->predefined->isElement()) {
      flattenElement(context_, component);
      return;
    }
    const flat::VariableId id = variableOf(context_, component);
    const ExprPtr binding = bindingOf(context_, component);
    flat::Attributes attributes = attributesOf(component, component.leaf->leafModifier, false);
    flat::Attributes derAttributes;
    if (const ModifierPtr *der = component.leaf->leafModifier ? component.leaf->leafModifier->find("der") : nullptr)
      derAttributes = attributesOf(component, *der, (*der)->isEach);
    checkBinding(component, binding);
    const bool isGiven = (component.modifier && component.modifier->binding) || givenAttribute(component, "start") != nullptr;
    if (variabilityOf(component) == Variability::Parameter && !isGiven && typeOf(component).base != Base::String)
      context_.diagnostics.report(diag::ParameterWithoutValue, component.declaration->name.span, component.path);
    evaluateIfAnnotated(component);
    flat::Variable &variable = context_.model.variables[static_cast<std::size_t>(id)];
    variable.binding = binding;
    variable.attributes = std::move(attributes);
    variable.derAttributes = std::move(derAttributes);
  }

  flat::Attributes attributesOf(Component &component, const ModifierPtr &modifier, bool isEach) {
    flat::Attributes result;
    if (!modifier)
      return result;
    const Base base = typeOf(component).base;
    const bool isDer = modifier->name == "der";
    for (const ModifierPtr &child : modifier->children) {
      if (child->name == "der" && !isDer)
        continue;
      if (!child->binding) {
        if (isDer && child->children.empty())
          context_.diagnostics.report(diag::AttributeWithoutValue, child->nameSpan, child->name);
        continue;
      }
      setAttribute(component, *child, isEach, base, isDer, result);
    }
    return result;
  }

  void setAttribute(Component &component, const Modifier &child, bool isEach, Base base, bool isDer, flat::Attributes &result) {
    const auto shaped = [&](Base wanted) {
      return typeShapedBinding(context_, *child.binding, isEach || child.isEach || child.binding->isEach, wanted, component.dimensions,
                               child.name);
    };
    const AttributeSpec *spec = component.leaf->predefined->attribute(child.name);
    static constexpr std::string_view kDerAttributes[] = {"start", "fixed", "min", "max", "nominal", "unit"};
    if (isDer && std::ranges::find(kDerAttributes, child.name) == std::end(kDerAttributes)) {
      const std::vector<std::string> names(std::begin(kDerAttributes), std::end(kDerAttributes));
      context_.diagnostics.report(diag::UnknownAttribute, child.nameSpan, child.name, "der").suggest(child.name, names);
      return;
    }
    if (spec == nullptr)
      return;
    if (spec->base == Base::String && base != Base::String) {
      (child.name == "unit" ? result.unit : child.name == "displayUnit" ? result.displayUnit : result.quantity) = text(component, child);
      return;
    }
    ExprPtr value = shaped(spec->base);
    if (value != nullptr && value->variability > Variability::Parameter) {
      context_.diagnostics.report(diag::AttributeVariability, value->span, child.name);
      return;
    }
    if (child.name == "start")
      result.start = value;
    else if (child.name == "fixed")
      result.fixed = value;
    else if (child.name == "min")
      result.min = value;
    else if (child.name == "max")
      result.max = value;
    else if (child.name == "nominal")
      result.nominal = value;
  }

  // The value of a String attribute, the same for all elements of an array.
  std::string text(const Component &component, const Modifier &child) {
    const ExprPtr value = typeBinding(context_, *child.binding);
    if (value == nullptr)
      return {};
    if (value->type.base != Base::String || value->kind != flat::ExprKind::Literal) {
      context_.diagnostics.report(diag::BindingType, value->span, child.name, "String", toString(value->type));
      return {};
    }
    const bool isEach = child.isEach || child.binding->isEach;
    const bool isInherited = child.binding->outerDims >= static_cast<int>(component.dimensions.size());
    if (!component.dimensions.empty() && !isEach && !isInherited)
      context_.diagnostics.report(diag::ScalarWithoutEach, value->span, child.name, toString({Base::String, component.dimensions}),
                                  toString(value->type));
    if (component.dimensions.empty() && isEach && !child.binding->isWithinArray)
      context_.diagnostics.report(diag::EachOnScalar, child.span, child.name);
    return value->text;
  }

  void checkBinding(const Component &component, const ExprPtr &binding) {
    if (component.clause->isCoordinate && component.modifier && component.modifier->binding)
      context_.diagnostics.report(diag::CoordinateBinding, component.modifier->binding->span, component.name);
    if (binding == nullptr)
      return;
    const Variability own = variabilityOf(component);
    // Integers and Booleans change at events only, whatever they are made of.
    const bool isDiscreteType = own == Variability::Discrete && typeOf(component).base != Base::Real;
    if (binding->variability > own && !isDiscreteType) {
      static constexpr std::string_view kNames[] = {"constant", "parameter", "discrete variable", "variable"};
      context_.diagnostics.report(diag::BindingVariability, binding->span, kNames[static_cast<std::size_t>(own)], component.name,
                                  kNames[static_cast<std::size_t>(binding->variability)]);
    }
  }

  // `annotation(Evaluate = true)` makes a parameter structural.
  void evaluateIfAnnotated(Component &component) {
    const ast::Modification *annotation = component.declaration->comment.annotation;
    if (annotation == nullptr || variabilityOf(component) != Variability::Parameter)
      return;
    for (const ast::Argument &argument : annotation->arguments) {
      const bool isEvaluate = argument.kind == ast::ArgumentKind::Element && argument.path.parts.size() == 1 &&
                              argument.path.parts[0].name.text == "Evaluate" && argument.modification != nullptr &&
                              argument.modification->value != nullptr;
      if (!isEvaluate || argument.modification->value->kind != ast::ExprKind::Boolean || argument.modification->value->number == 0)
        continue;
      if (!valueOf(context_, component) && component.bindingProgress == Progress::Done && component.binding != nullptr)
        context_.diagnostics.report(diag::NotConstant, component.binding->span, "a parameter with Evaluate = true");
    }
  }

  void readExperiment(Class &model) {
    const ast::Modification *annotation = model.definition == nullptr ? nullptr : model.definition->annotation;
    if (annotation == nullptr)
      return;
    for (const ast::Argument &argument : annotation->arguments)
      if (argument.kind == ast::ArgumentKind::Element && argument.path.parts.size() == 1 &&
          argument.path.parts[0].name.text == "experiment" && argument.modification != nullptr)
        for (const ast::Argument &setting : argument.modification->arguments)
          readSetting(model, setting);
  }

  void readSetting(Class &model, const ast::Argument &setting) {
    if (setting.path.parts.size() != 1 || setting.modification == nullptr || setting.modification->value == nullptr)
      return;
    const std::string_view name = setting.path.parts[0].name.text;
    flat::Experiment &experiment = context_.model.experiment;
    std::optional<double> *target = name == "StartTime"   ? &experiment.startTime
                                    : name == "StopTime"  ? &experiment.stopTime
                                    : name == "Tolerance" ? &experiment.tolerance
                                    : name == "Interval"  ? &experiment.interval
                                                          : nullptr;
    if (target == nullptr)
      return;
    const ast::Expr &written = *setting.modification->value;
    const ExprPtr typed = typeExpression(context_, written, Scope{&model, nullptr, false});
    if (typed == nullptr)
      return;
    const auto value = isNumeric(typed->type.base) && typed->type.dims.empty() ? constantValue(context_, *typed) : std::nullopt;
    if (value)
      *target = (*value)[0];
    else
      context_.diagnostics.report(diag::NotConstant, written.span, fmt::format("'{}'", name));
  }

  Context &context_;
  std::vector<Class *> instances_;
  std::vector<Component *> leaves_;
  std::set<const ast::ClassDefinition *> checkedImports_;
  std::vector<flat::VariableId> declared_;
};

}  // namespace

void flattenModel(Context &context, Class &model) { Flattening(context).run(model); }

}  // namespace tf::semantics
