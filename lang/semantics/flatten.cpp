#include "lang/semantics/flatten.h"

#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elements.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/text.h"
#include "lang/semantics/typing.h"

#include <algorithm>
#include <array>
#include <cmath>
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
      declareVariable(component);
  }

  void declareVariable(Component &component) {
    declared_.push_back(variableOf(context_, component));
    if (const auto next = static_cast<std::size_t>(declared_.back()) + 1; next < context_.model.variables.size() &&
                                                                          context_.model.variables[next].isAngularVelocity &&
                                                                          context_.variableOwners[next] == &component)
      declared_.push_back(static_cast<flat::VariableId>(next));
  }

  void complete(Component &component) {
    if (component.leaf->predefined->isElement()) {
      flattenElement(context_, component);
      return;
    }
    const flat::VariableId id = variableOf(context_, component);
    const ExprPtr binding = bindingOf(context_, component);
    flat::Attributes attributes = attributesOf(component, component.leaf->leafModifier, false, Part::Whole);
    const auto partAttributes = [&](Part part) {
      const ModifierPtr *found = component.leaf->leafModifier ? component.leaf->leafModifier->find(nameOf(part)) : nullptr;
      return found == nullptr ? flat::Attributes{} : attributesOf(component, *found, (*found)->isEach, part);
    };
    flat::Attributes derAttributes = partAttributes(Part::Derivative);
    if (typeOf(component).base == Base::Rotation && component.clause->isCoordinate) {
      const flat::Attributes ofQuaternion = partAttributes(Part::Quaternion);
      attributes.start = ofQuaternion.start ? ofQuaternion.start : attributes.start;
      attributes.fixed = ofQuaternion.fixed ? ofQuaternion.fixed : attributes.fixed;
      context_.model.variables[static_cast<std::size_t>(id) + 1].attributes = partAttributes(Part::AngularVelocity);
    }
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

  // What a modification speaks of: the variable, its derivative, or a part of a rotation.
  enum class Part : std::uint8_t { Whole, Derivative, Quaternion, AngularVelocity };

  static std::string_view nameOf(Part part) {
    static constexpr std::array<std::string_view, 4> kNames = {"", "der", "q", "w"};
    return kNames[static_cast<std::size_t>(part)];
  }

  static std::vector<std::string> attributesOf(Part part) {
    if (part == Part::Quaternion)
      return {"start", "fixed"};
    return {"start", "fixed", "min", "max", "nominal", "unit"};
  }

  flat::Attributes attributesOf(Component &component, const ModifierPtr &modifier, bool isEach, Part part) {
    flat::Attributes result;
    if (!modifier)
      return result;
    for (const ModifierPtr &child : modifier->children) {
      if (child->name == "der" && part == Part::Whole)
        continue;
      if (!child->binding) {
        if (part != Part::Whole && child->children.empty())
          context_.diagnostics.report(diag::AttributeWithoutValue, child->nameSpan, child->name);
        continue;
      }
      setAttribute(component, *child, isEach, part, result);
    }
    return result;
  }

  void setAttribute(Component &component, const Modifier &child, bool isEach, Part part, flat::Attributes &result) {
    const Base base = typeOf(component).base;
    const std::vector<std::string> names = attributesOf(part);
    if (part != Part::Whole && std::ranges::find(names, child.name) == names.end()) {
      context_.diagnostics.report(diag::UnknownAttribute, child.nameSpan, child.name, nameOf(part)).suggest(child.name, names);
      return;
    }
    const PredefinedClass &described = part == Part::AngularVelocity ? *findPredefined("Real") : *component.leaf->predefined;
    const AttributeSpec *spec = described.attribute(child.name);
    if (spec == nullptr)
      return;
    if (spec->base == Base::String && base != Base::String) {
      (child.name == "unit" ? result.unit : child.name == "displayUnit" ? result.displayUnit : result.quantity) = text(component, child);
      return;
    }
    ExprPtr value = attributeValue(component, child, isEach, part, *spec);
    if (value != nullptr && value->variability > Variability::Parameter) {
      context_.diagnostics.report(diag::AttributeVariability, value->span, child.name);
      return;
    }
    if (child.name == "start")
      result.start = value;
    else
      setCompiledIn(child.name, value, result);
  }

  // Attributes whose values are part of the compiled model: what they depend on becomes structural.
  void setCompiledIn(std::string_view name, const ExprPtr &value, flat::Attributes &result) {
    ExprPtr *target = name == "fixed"     ? &result.fixed
                      : name == "min"     ? &result.min
                      : name == "max"     ? &result.max
                      : name == "nominal" ? &result.nominal
                                          : nullptr;
    if (value == nullptr || target == nullptr)
      return;
    if (!constantValue(context_, *value)) {
      reportNotConstant(context_, *value, value->span, fmt::format("'{}'", name));
      return;
    }
    *target = value;
  }

  // `fixed` of a rotation is one for its quaternion as a whole.
  ExprPtr attributeValue(Component &component, const Modifier &child, bool isEach, Part part, const AttributeSpec &spec) {
    const bool isWholeFixed = typeOf(component).base == Base::Rotation && part != Part::AngularVelocity && spec.base == Base::Boolean;
    std::vector<int> dims = part == Part::AngularVelocity || isWholeFixed ? component.dimensions : typeOf(component).dims;
    if (part == Part::AngularVelocity)
      dims.push_back(3);
    ExprPtr value =
        typeShapedBinding(context_, *child.binding, isEach || child.isEach || child.binding->isEach, spec.base, dims, child.name);
    if (value == nullptr || !isWholeFixed)
      return value;
    const auto known = constantValue(context_, *value);
    if (!known) {
      reportNotConstant(context_, *value, value->span, "'fixed' of a rotation");
      return nullptr;
    }
    std::vector<double> entries;
    for (const double entry : *known)
      entries.insert(entries.end(), 4, entry);
    return makeLiteral({Base::Boolean, typeOf(component).dims}, std::move(entries), value->span);
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
    const ast::Name &name = setting.path.parts[0].name;
    flat::Experiment &experiment = context_.model.experiment;
    std::optional<double> *target = name.text == "StartTime"   ? &experiment.startTime
                                    : name.text == "StopTime"  ? &experiment.stopTime
                                    : name.text == "Tolerance" ? &experiment.tolerance
                                    : name.text == "Interval"  ? &experiment.interval
                                                               : nullptr;
    if (target == nullptr) {
      static const std::array<std::string, 4> known = {"StartTime", "StopTime", "Tolerance", "Interval"};
      if (!name.text.starts_with("__"))
        context_.diagnostics.report(diag::ExperimentSetting, name.span, name.text).suggest(name.text, known);
      return;
    }
    const ast::Expr &written = *setting.modification->value;
    const ExprPtr typed = typeExpression(context_, written, Scope{&model, nullptr, false});
    if (typed == nullptr)
      return;
    const bool isTolerance = name.text == "Tolerance", isInterval = name.text == "Interval";
    const std::string_view wanted = isTolerance ? "between 0 and 1" : isInterval ? "a positive number" : "a finite number";
    if (!isNumeric(typed->type.base) || !typed->type.dims.empty()) {
      context_.diagnostics.report(diag::ExperimentValue, written.span, name.text, wanted, toString(typed->type));
      return;
    }
    const auto value = constantValue(context_, *typed);
    if (!value) {
      reportNotConstant(context_, *typed, written.span, fmt::format("'{}'", name.text));
      return;
    }
    const double number = (*value)[0];
    if (!std::isfinite(number) || ((isTolerance || isInterval) && !(number > 0)) || (isTolerance && !(number < 1)))
      context_.diagnostics.report(diag::ExperimentValue, written.span, name.text, wanted, fmt::format("{:.6g}", number));
    else
      *target = number;
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
