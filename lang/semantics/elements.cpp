#include "lang/semantics/elements.h"

#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/typing.h"

#include <algorithm>

namespace tf::semantics {

namespace {

bool fits(Shape shape, const std::vector<int> &dims) {
  const bool isScalar = dims.empty();
  const auto isVectorOf = [&](int n) { return dims.size() == 1 && dims[0] == n; };
  switch (shape) {
  case Shape::Scalar:
    return isScalar;
  case Shape::Planar:
    return isScalar || isVectorOf(2);
  case Shape::Position:
    return isScalar || isVectorOf(2) || isVectorOf(3);
  case Shape::Acceleration:
    return isVectorOf(2) || isVectorOf(3);
  case Shape::AnyVector:
    return dims.size() <= 1;
  case Shape::Inertia:
    return isScalar || dims == std::vector<int>{3, 3};
  case Shape::Rotation:
    return isVectorOf(4);
  }
  return false;
}

std::string_view describe(Shape shape) {
  switch (shape) {
  case Shape::Scalar:
    return "a scalar";
  case Shape::Planar:
    return "a scalar or 2 elements";
  case Shape::Position:
    return "a scalar or 2 or 3 elements";
  case Shape::Acceleration:
    return "2 or 3 elements";
  case Shape::AnyVector:
    return "a scalar or a vector";
  case Shape::Inertia:
    return "a scalar or 3 x 3 elements";
  case Shape::Rotation:
    return "a Rotation";
  }
  return "";
}

// The first variable in an expression, for a note that tells where its shape comes from.
const flat::Expr *firstVariable(const flat::Expr &expr) {
  if (expr.kind == flat::ExprKind::Variable)
    return &expr;
  for (const ExprPtr &arg : expr.args)
    if (const flat::Expr *found = firstVariable(*arg))
      return found;
  return nullptr;
}

void reportShape(Context &context, const AttributeSpec &spec, const flat::Expr &value, Span span) {
  Diagnostic &error = context.diagnostics.report(diag::AttributeShape, span, spec.name, describe(spec.shape), toString(value.type));
  if (const flat::Expr *variable = firstVariable(value)) {
    const flat::Variable &declared = context.model.variables[static_cast<std::size_t>(variable->variable)];
    error.note(declared.span, fmt::format("'{}' is declared here", declared.name));
  }
}

ExprPtr defaultOf(const AttributeSpec &spec, const Component &element) {
  if (!spec.hasDefault)
    return nullptr;
  const Span span = element.declaration->name.span;
  return broadcast(makeLiteral({spec.base, {}}, {spec.defaultValue}, span), element.dimensions);
}

// Removes the element's dimensions from the value's; what remains is the attribute's shape. Nothing if they do not match: reported.
ExprPtr shaped(Context &context, const Component &element, const AttributeSpec &spec, const Modifier &modifier, const ExprPtr &value) {
  const Binding &binding = *modifier.binding;
  const std::vector<int> &dims = element.dimensions;
  const auto outer = std::min<std::ptrdiff_t>(binding.outerDims, static_cast<std::ptrdiff_t>(dims.size()));
  const std::vector<int> covered(dims.begin() + outer, dims.end());
  const std::vector<int> &given = value->type.dims;
  std::vector<int> shape = given;
  if (binding.isEach) {
    if (dims.empty() && !binding.isWithinArray)
      context.diagnostics.report(diag::EachOnScalar, modifier.span, spec.name);
  } else {
    if (given.size() < covered.size()) {
      const std::string wanted = toString({value->type.base, covered});
      context.diagnostics.report(diag::ScalarWithoutEach, modifier.span, spec.name, wanted, toString(value->type));
      return nullptr;
    }
    if (!std::equal(covered.begin(), covered.end(), given.begin())) {
      context.diagnostics.report(diag::AttributeSplit, modifier.span, spec.name, element.name, toString({value->type.base, covered}),
                                 toString(value->type));
      return nullptr;
    }
    shape.assign(given.begin() + static_cast<std::ptrdiff_t>(covered.size()), given.end());
  }
  if (!fits(value->type.base == Base::Rotation ? Shape::Rotation : spec.shape, shape)) {
    reportShape(context, spec, *value, modifier.span);
    return nullptr;
  }
  return broadcast(value, {dims.begin(), binding.isEach ? dims.end() : dims.begin() + outer});
}

// False if the value is of another enumeration than the attribute, as far as literals and variables in it tell.
bool isOfEnumeration(const Context &context, const flat::Expr &value, std::span<const std::string_view> literals) {
  if (value.kind == flat::ExprKind::Variable)
    return std::ranges::equal(context.model.variables[static_cast<std::size_t>(value.variable)].literals, literals);
  if (value.kind == flat::ExprKind::Literal) {
    const auto ordinal = static_cast<std::size_t>(value.values.empty() ? 0 : value.values[0]);
    const std::string_view name = std::string_view(value.text).substr(value.text.rfind('.') + 1);
    return value.text.empty() || (ordinal >= 1 && ordinal <= literals.size() && literals[ordinal - 1] == name);
  }
  return std::ranges::all_of(
      value.args, [&](const ExprPtr &arg) { return arg->type.base != Base::Enumeration || isOfEnumeration(context, *arg, literals); });
}

std::vector<int> shapeOf(const ExprPtr &value, const Component &element) {
  return {value->type.dims.begin() + static_cast<std::ptrdiff_t>(element.dimensions.size()), value->type.dims.end()};
}

}  // namespace

const Modifier *givenAttribute(const Component &element, std::string_view name) {
  const ModifierPtr *modifier = element.leaf->leafModifier ? element.leaf->leafModifier->find(name) : nullptr;
  return modifier == nullptr || !(*modifier)->binding ? nullptr : modifier->get();
}

ExprPtr attributeOf(Context &context, Component &element, const AttributeSpec &spec) {
  const auto [entry, isNew] = context.elementAttributes.try_emplace({&element, spec.name}, nullptr);
  if (!isNew)
    return entry->second;
  const Modifier *modifier = givenAttribute(element, spec.name);
  if (modifier == nullptr)
    return entry->second = defaultOf(spec, element);
  ExprPtr value = typeBinding(context, *modifier->binding);
  if (value == nullptr)
    return nullptr;
  const bool isRotation = spec.mayBeRotation && value->type.base == Base::Rotation;
  if (!isRotation && !isConvertible(value->type.base, spec.base)) {
    context.diagnostics.report(diag::AttributeType, modifier->span, spec.name, toString({spec.base, {}}), toString(value->type));
    return nullptr;
  }
  if (spec.base == Base::Enumeration && !isOfEnumeration(context, *value, findPredefined(spec.enumeration)->literals)) {
    context.diagnostics.report(diag::AttributeType, modifier->span, spec.name, spec.enumeration, "another enumeration");
    return nullptr;
  }
  value = shaped(context, element, spec, *modifier, spec.base == Base::Real ? toReal(value) : value);
  return context.elementAttributes[{&element, spec.name}] = value;
}

ExprPtr typeElementPart(Context &context, Component &element, const ast::Name &part, Span span) {
  const PredefinedClass &predefined = *element.leaf->predefined;
  const AttributeSpec *spec = predefined.attribute(part.text);
  const ResultSpec *result = predefined.result(part.text);
  if (spec == nullptr && result == nullptr) {
    std::vector<std::string> names;
    for (const AttributeSpec &attribute : predefined.attributes)
      names.emplace_back(attribute.name);
    for (const ResultSpec &known : predefined.results)
      names.emplace_back(known.name);
    context.diagnostics.report(diag::UnknownElementPart, part.span, element.name, predefined.name, part.text).suggest(part.text, names);
    return nullptr;
  }
  if (spec != nullptr) {
    const bool isRunning = context.elementAttributes.contains({&element, spec->name}) &&
                           context.elementAttributes[{&element, spec->name}] == nullptr && givenAttribute(element, spec->name) != nullptr;
    if (const ExprPtr value = attributeOf(context, element, *spec))
      return value;
    if (isRunning && !context.diagnostics.hasErrors())
      context.diagnostics.report(diag::CyclicDefinition, part.span, element.path + "." + std::string(part.text));
    else if (givenAttribute(element, spec->name) == nullptr)
      context.diagnostics.report(diag::AttributeNotGiven, part.span, element.path, part.text);
    return nullptr;
  }
  flat::Expr read;
  read.kind = flat::ExprKind::Attribute;
  read.element = elementOf(context, element);
  read.attribute = std::string(part.text);
  read.type = {result->base, element.dimensions};
  read.variability = result->base == Base::Real ? Variability::Continuous : Variability::Discrete;
  read.span = span;
  const bool isFirstGiven = result->orShapeOf.empty() || givenAttribute(element, result->shapeOf) != nullptr;
  if (const std::string_view from = isFirstGiven ? result->shapeOf : result->orShapeOf; !from.empty())
    if (const ExprPtr model = attributeOf(context, element, *predefined.attribute(from))) {
      const std::vector<int> shape = shapeOf(model, element);
      read.type.dims.insert(read.type.dims.end(), shape.begin(), shape.end());
    }
  return std::make_shared<const flat::Expr>(std::move(read));
}

namespace {

// Of a friction polygon: two make a square; more than this many are no better than the exact form.
constexpr int kFewestDirections = 2, kMostDirections = 64;

class ElementRules {
public:
  ElementRules(Context &context, Component &element)
      : context_(context), element_(element), predefined_(*element.leaf->predefined), name_(element.declaration->name.span) {}

  void run() {
    for (const AttributeSpec &spec : predefined_.attributes)
      addAttribute(spec);
    if (!hasMisplacedAttribute())
      checkRequired();
  }

private:
  void addAttribute(const AttributeSpec &spec) {
    const Modifier *modifier = givenAttribute(element_, spec.name);
    if (modifier == nullptr && spec.isSilent)
      return;
    ExprPtr value = attributeOf(context_, element_, spec);
    const Span span = modifier == nullptr ? name_ : modifier->span;
    if (value != nullptr && spec.isStructural)
      value = settled(spec, value, span);
    if (value == nullptr)
      return;
    if (modifier != nullptr) {
      checkDependencies(context_, element_, spec, *value, span);
      checkConstantRange(spec, *value, span);
    }
    // Attributes of other elements may have been made meanwhile: the reference is taken last.
    const flat::ElementId id = elementOf(context_, element_);
    context_.model.elements[static_cast<std::size_t>(id)].attributes.push_back({std::string(spec.name), value, span});
  }

  // The value as a literal; the parameters that it depends on become structural. Null if it is not one value: reported.
  ExprPtr settled(const AttributeSpec &spec, const ExprPtr &value, Span span) {
    const std::optional<std::vector<double>> values = constantValue(context_, *value);
    if (!values || std::ranges::any_of(*values, [&](double entry) { return entry != values->front(); })) {
      context_.diagnostics.report(diag::AttributeNotSettled, span, spec.name, element_.name);
      return nullptr;
    }
    return makeLiteral(value->type, *values, value->span);
  }

  // Values that are wrong whatever the parameters are.
  void checkConstantRange(const AttributeSpec &spec, const flat::Expr &value, Span span) {
    if (value.kind != flat::ExprKind::Literal)
      return;
    for (const double entry : value.values) {
      const bool isNegative = (spec.name == "friction" || spec.name == "bound" || spec.name == "restitution") && entry < 0;
      const bool isNotPositive = (spec.name == "rate" || spec.name == "slipRadius") && entry <= 0;
      const bool isMassNegative = (spec.name == "mass" || (spec.name == "inertia" && value.type.dims == element_.dimensions)) && entry < 0;
      if (isNegative || isNotPositive || isMassNegative) {
        context_.diagnostics.report(diag::AttributeRange, span, spec.name, isNotPositive ? "positive" : "0 or more", entry);
        return;
      }
      if (spec.name == "directions" && (entry < kFewestDirections || entry > kMostDirections)) {
        context_.diagnostics.report(diag::AttributeRange, span, spec.name, fmt::format("from {} to {}", kFewestDirections, kMostDirections),
                                    entry);
        return;
      }
      if (spec.name == "restitution" && entry > 1) {
        context_.diagnostics.report(diag::AttributeRange, span, spec.name, "1 or less", entry);
        return;
      }
    }
  }

  [[nodiscard]] bool has(std::string_view attribute) const { return givenAttribute(element_, attribute) != nullptr; }

  // An attribute that is misspelt or given as the element's value was reported; that it is missing would be a cascade.
  [[nodiscard]] bool hasMisplacedAttribute() const {
    const ModifierPtr &given = element_.leaf->leafModifier;
    return (element_.modifier && element_.modifier->binding) ||
           (given &&
            std::ranges::any_of(given->children, [&](const ModifierPtr &child) { return predefined_.attribute(child->name) == nullptr; }));
  }

  void require(std::string_view attribute) {
    if (!has(attribute))
      context_.diagnostics.report(diag::AttributeMissing, name_, predefined_.name, element_.name, attribute);
  }

  void requireWith(std::string_view attribute, std::string_view other) {
    if (has(other) && !has(attribute))
      context_.diagnostics.report(diag::AttributeMissingWith, givenAttribute(element_, other)->span, element_.name, attribute, other);
  }

  void checkRequired() {
    switch (predefined_.kind) {
    case PredefinedKind::Body:
      checkBody();
      break;
    case PredefinedKind::Gravity:
      require("acceleration");
      break;
    case PredefinedKind::Force:
      require("value");
      require("at");
      checkForceShape();
      break;
    case PredefinedKind::Potential:
      require("energy");
      break;
    case PredefinedKind::Constraint:
      checkConstraint();
      break;
    case PredefinedKind::Contact:
      require("gap");
      checkFriction();
      checkFrictionForm();
      break;
    case PredefinedKind::Friction:
      require("slip");
      require("bound");
      checkFrictionForm();
      break;
    default:
      break;
    }
  }

  void checkBody() {
    if (!has("position") && !has("angle") && !has("orientation"))
      context_.diagnostics.report(diag::BodyWithoutMotion, name_, element_.name);
    requireWith("mass", "position");
    requireWith("inertia", "angle");
    requireWith("inertia", "orientation");
    if (has("angle") && has("orientation"))
      context_.diagnostics.report(diag::AngleAndOrientation, givenAttribute(element_, "orientation")->span, element_.name);
    else if (has("orientation")) {
      requireShape("inertia", {3, 3}, "3 x 3 elements beside 'orientation'");
      requireShape("position", {3}, "3 elements beside 'orientation'");
    } else if (has("angle")) {
      requireShape("inertia", {}, "a scalar beside 'angle'");
    }
  }

  void requireShape(std::string_view attribute, const std::vector<int> &shape, std::string_view wanted) {
    const ExprPtr value = has(attribute) ? attributeOf(context_, element_, *predefined_.attribute(attribute)) : nullptr;
    if (value != nullptr && shapeOf(value, element_) != shape)
      context_.diagnostics.report(diag::AttributeShape, givenAttribute(element_, attribute)->span, attribute, wanted,
                                  toString({Base::Real, shapeOf(value, element_)}));
  }

  void checkConstraint() {
    if (!has("residual") && !has("velocityResidual"))
      context_.diagnostics.report(diag::AttributeMissing, name_, predefined_.name, element_.name, "residual' or 'velocityResidual");
    else if (has("residual") && has("velocityResidual"))
      context_.diagnostics.report(diag::TwoResiduals, givenAttribute(element_, "velocityResidual")->span, element_.name);
  }

  // A torque at a rotation is a vector.
  void checkForceShape() {
    const ExprPtr at = attributeOf(context_, element_, *predefined_.attribute("at"));
    if (at == nullptr || at->type.base != Base::Rotation)
      checkSameShape("value", "at");
    else
      requireShape("value", {3}, "3 elements where 'at' is a Rotation");
  }

  void checkSameShape(std::string_view first, std::string_view second) {
    const ExprPtr a = attributeOf(context_, element_, *predefined_.attribute(first));
    const ExprPtr b = attributeOf(context_, element_, *predefined_.attribute(second));
    if (a != nullptr && b != nullptr && a->type.dims != b->type.dims)
      context_.diagnostics.report(diag::AttributeShapesDiffer, givenAttribute(element_, first)->span, first, second,
                                  toString({Base::Real, shapeOf(a, element_)}), toString({Base::Real, shapeOf(b, element_)}));
  }

  // Without a slip only a friction that is constantly zero makes sense.
  void checkFriction() {
    const ExprPtr friction = attributeOf(context_, element_, *predefined_.attribute("friction"));
    if (friction == nullptr || has("slip"))
      return;
    const bool isZero = friction->kind == flat::ExprKind::Literal && std::ranges::all_of(friction->values, [](double v) { return v == 0; });
    if (!isZero)
      context_.diagnostics.report(diag::FrictionWithoutSlip, givenAttribute(element_, "friction")->span, element_.name);
  }

  // Forms other than the exact one are forms of the friction disk.
  void checkFrictionForm() {
    requireWith("frictionForm", "directions");
    requireWith("frictionForm", "slipRadius");
    const ExprPtr form = has("frictionForm") ? attributeOf(context_, element_, *predefined_.attribute("frictionForm")) : nullptr;
    if (form == nullptr)
      return;
    const std::optional<std::vector<double>> values = constantValue(context_, *form);
    if (!values || values->empty() || values->front() == 1)
      return;
    const Span span = givenAttribute(element_, "frictionForm")->span;
    if (!has("slip")) {
      context_.diagnostics.report(diag::FormWithoutPlane, span, element_.name, "none");
      return;
    }
    const ExprPtr slip = attributeOf(context_, element_, *predefined_.attribute("slip"));
    if (slip != nullptr && shapeOf(slip, element_) != std::vector<int>{2})
      context_.diagnostics.report(diag::FormWithoutPlane, span, element_.name, toString({Base::Real, shapeOf(slip, element_)}));
  }

  Context &context_;
  Component &element_;
  const PredefinedClass &predefined_;
  Span name_;
};

}  // namespace

void flattenElement(Context &context, Component &element) { ElementRules(context, element).run(); }

}  // namespace tf::semantics
