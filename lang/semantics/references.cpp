// Component references: variables, parts of arrays of models, attributes and results of elements, constants of packages, literals.
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/elements.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/typing.h"

#include <algorithm>

namespace tf::semantics {

namespace {

class ReferenceTyping {
public:
  ReferenceTyping(Typer &typer, const ast::Reference &reference, Span span)
      : typer_(typer), context_(typer.context()), reference_(reference), span_(span) {}

  ExprPtr run() {
    if (reference_.parts.empty())
      return nullptr;
    const ast::Name &first = reference_.parts[0].name;
    const Files files = reference_.parts.size() > 1 ? Files::Search : Files::Ignore;
    const Found found = reference_.leadingDot ? lookupRoot(context_, first.text, files)
                                              : lookupSimple(context_, *typer_.scope().enclosing, first.text, files);
    if (!found) {
      if (reference_.leadingDot || !reportFailedImport(context_, *typer_.scope().enclosing, first.text))
        context_.diagnostics.report(diag::UnknownName, first.span, first.text)
            .suggest(first.text, visibleNames(context_, *typer_.scope().enclosing));
      return nullptr;
    }
    isEnclosing_ = found.isEnclosing;
    if (found.component != nullptr)
      return component(*found.component, 0);
    return insideClass(*found.type, 0);
  }

private:
  [[nodiscard]] bool isLast(std::size_t part) const { return part + 1 == reference_.parts.size(); }
  [[nodiscard]] const ast::Name &name(std::size_t part) const { return reference_.parts[part].name; }

  ExprPtr insideClass(Class &type, std::size_t part) {
    if (isLast(part)) {
      context_.diagnostics.report(diag::ClassAsValue, name(part).span, name(part).text);
      return nullptr;
    }
    elaborate(context_, type);
    const ast::Name &member = name(part + 1);
    if (const auto literal = std::ranges::find(type.literals, member.text); literal != type.literals.end() && isLast(part + 1))
      return enumerationLiteral(type, static_cast<int>(literal - type.literals.begin()) + 1);
    const Found found = lookupMember(context_, type, member.text);
    if (!found) {
      std::vector<std::string> names = memberNames(context_, type);
      names.insert(names.end(), type.literals.begin(), type.literals.end());
      if (!type.isFailed)
        context_.diagnostics.report(diag::UnknownClassMember, member.span, member.text, type.name).suggest(member.text, names);
      return nullptr;
    }
    return found.component != nullptr ? component(*found.component, part + 1) : insideClass(*found.type, part + 1);
  }

  ExprPtr enumerationLiteral(const Class &type, int ordinal) {
    flat::Expr literal;
    literal.type = {Base::Enumeration, {}};
    literal.values = {static_cast<double>(ordinal)};
    literal.text = std::string(type.name) + "." + type.literals[static_cast<std::size_t>(ordinal - 1)];
    literal.span = span_;
    return std::make_shared<const flat::Expr>(std::move(literal));
  }

  ExprPtr component(Component &declared, std::size_t part) {
    Component *target = actual(context_, declared);
    if (target == nullptr)
      return nullptr;
    if (!isPresent(context_, *target)) {
      if (!target->isFailed)
        context_.diagnostics.report(diag::AbsentComponent, name(part).span, target->path)
            .note(target->declaration->condition->span, "its condition is false");
      return nullptr;
    }
    if (!resolve(context_, *target))
      return nullptr;
    if (target->isLeaf())
      return leaf(*target, part);
    return composite(*target, part);
  }

  ExprPtr composite(Component &target, std::size_t part) {
    const auto chosen = subscripts(part, target.dimensions);
    if (!chosen)
      return nullptr;
    if (isLast(part)) {
      context_.diagnostics.report(diag::ComponentAsValue, span_, target.path, target.type->name);
      return nullptr;
    }
    return selectInstances(target, *chosen, 0, 0, part);
  }

  // The member of every selected instance, stacked along the dimensions that are not dropped.
  ExprPtr selectInstances(Component &target, const std::vector<flat::Selection> &chosen, std::size_t dimension, std::size_t offset,
                          std::size_t part) {
    if (dimension == target.dimensions.size())
      return member(*target.instances[offset], part + 1);
    const auto size = static_cast<std::size_t>(target.dimensions[dimension]);
    std::vector<ExprPtr> parts;
    const bool isGiven = dimension < chosen.size();
    const std::size_t count = isGiven ? chosen[dimension].positions.size() : size;
    if (count == 0 || size == 0)
      return memberOfNone(target, chosen, dimension, part);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t position = isGiven ? static_cast<std::size_t>(chosen[dimension].positions[i] - 1) : i;
      parts.push_back(selectInstances(target, chosen, dimension + 1, offset * size + position, part));
      if (parts.back() == nullptr)
        return nullptr;
    }
    return isGiven && chosen[dimension].scalar ? parts[0] : makeArray(std::move(parts), span_, context_.diagnostics);
  }

  // Of an array of components without any, along `dimension`: what it is like is told by their type.
  ExprPtr memberOfNone(Component &target, const std::vector<flat::Selection> &chosen, std::size_t dimension, std::size_t part) {
    std::vector<int> dims;
    for (std::size_t d = dimension; d < target.dimensions.size(); ++d)
      if (d >= chosen.size())
        dims.push_back(target.dimensions[d]);
      else if (!chosen[d].scalar)
        dims.push_back(static_cast<int>(chosen[d].positions.size()));
    elaborate(context_, *target.type);
    const Member *found = target.type->find(name(part + 1).text);
    if (found == nullptr)
      return member(*target.type, part + 1);
    const bool isVariable = isLast(part + 1) && found->component != nullptr && resolve(context_, *found->component) &&
                            found->component->isLeaf() && !found->component->leaf->predefined->isElement();
    if (!isVariable)
      return makeBlank({Base::Real, {}}, dims, span_);
    const ExprPtr element = makeBlank(typeOf(*found->component), {}, span_);
    const auto inner = subscripts(part + 1, element->type.dims);
    return inner ? broadcast(makeIndex(element, *inner, span_), dims) : nullptr;
  }

  ExprPtr member(Class &instance, std::size_t part) {
    const ast::Name &wanted = name(part);
    Member *found = instance.find(wanted.text);
    if (found == nullptr || found->component == nullptr) {
      if (!instance.isFailed)
        context_.diagnostics.report(diag::UnknownComponentMember, wanted.span, wanted.text, name(part - 1).text, instance.name)
            .suggest(wanted.text, memberNames(context_, instance));
      return nullptr;
    }
    if (found->isProtected) {
      context_.diagnostics.report(diag::ProtectedMember, wanted.span, wanted.text, name(part - 1).text)
          .note(found->span, "declared protected here");
      return nullptr;
    }
    return component(*found->component, part);
  }

  ExprPtr leaf(Component &target, std::size_t part) {
    const auto chosen = subscripts(part, target.dimensions);
    if (!chosen)
      return nullptr;
    if (target.leaf->predefined->isElement() && isEnclosing_) {
      reportOutside(target, part);
      return nullptr;
    }
    if (target.leaf->predefined->isElement())
      return elementPart(target, *chosen, part);
    const bool isRotation = target.leaf->predefined->kind == PredefinedKind::Rotation;
    if (!isLast(part) && !(isRotation && isRotationPart(part + 1))) {
      context_.diagnostics.report(diag::NoMembers, name(part + 1).span, name(part).text, target.leaf->predefined->name,
                                  name(part + 1).text);
      return nullptr;
    }
    if (variabilityOf(target) == Variability::Constant)
      return constant(target, *chosen);
    if (isEnclosing_ || isOutside(target)) {
      reportOutside(target, part);
      return nullptr;
    }
    flat::Expr variable;
    variable.kind = flat::ExprKind::Variable;
    variable.variable = variableOf(context_, target);
    variable.type = typeOf(target);
    variable.variability = variabilityOf(target);
    variable.span = span_;
    if (!isLast(part))
      return rotationPart(target, std::move(variable), *chosen, part + 1);
    return makeIndex(std::make_shared<const flat::Expr>(std::move(variable)), *chosen, span_);
  }

  [[nodiscard]] bool isRotationPart(std::size_t part) const { return isLast(part) && (name(part).text == "q" || name(part).text == "w"); }

  // The quaternion `R.q` or the angular velocity `R.w` in the body's frame; that of a coordinate is a variable of its own.
  ExprPtr rotationPart(const Component &target, flat::Expr &&rotation, const std::vector<flat::Selection> &chosen, std::size_t part) {
    const bool isQuaternion = name(part).text == "q";
    const bool isVelocity = !isQuaternion && target.clause->isCoordinate;
    if (isVelocity) {
      rotation.variable += 1;
      rotation.type = {Base::Real, target.dimensions};
      rotation.type.dims.push_back(3);
    }
    ExprPtr selected = makeIndex(std::make_shared<const flat::Expr>(std::move(rotation)), chosen, span_);
    if (!isVelocity && !visibleDims(selected->type).empty()) {
      context_.diagnostics.report(diag::NotSupported, span_, "a part of an array of rotations");
      return nullptr;
    }
    if (!isVelocity)
      selected = makeCall(isQuaternion ? flat::Function::Quaternion : flat::Function::AngularVelocity, {Base::Real, {isQuaternion ? 4 : 3}},
                          {selected}, span_);
    const ast::ReferencePart &last = reference_.parts[part];
    if (!last.hasSubscripts)
      return selected;
    const auto inner = typer_.selections(last.subscripts, selected->type.dims, span_);
    return inner ? makeIndex(selected, *inner, span_) : nullptr;
  }

  void reportOutside(const Component &target, std::size_t part) {
    const ast::ClassDefinition *container = target.container == nullptr ? nullptr : target.container->definition;
    if (container != nullptr && container->restriction == ast::Restriction::Function) {
      context_.diagnostics.report(diag::FunctionBody, span_, fmt::format("'{}' is read before it has a value", name(part).text));
      return;
    }
    context_.diagnostics.report(diag::NotAConstant, name(part).span, name(part).text)
        .note(target.declaration->name.span, fmt::format("'{}' is declared here", name(part).text));
  }

  // Whether the component is no part of the model's instance: it belongs to a package or to a class as such.
  [[nodiscard]] static bool isOutside(const Component &target) {
    const Class *container = target.container;
    while (container != nullptr) {
      const Class *instance = container;
      while (instance->derived != nullptr)
        instance = instance->derived;
      if (instance->owner == nullptr)
        return !instance->isModel;
      container = instance->owner->container;
    }
    return true;
  }

  ExprPtr constant(Component &target, const std::vector<flat::Selection> &chosen) {
    if (target.leaf->predefined->kind == PredefinedKind::String) {
      const ExprPtr value = bindingOf(context_, target);
      if (value != nullptr && value->kind == flat::ExprKind::Literal)
        return makeString(value->text, span_);
    }
    const auto values = valueOf(context_, target);
    if (!values) {
      if (target.value == std::nullopt && !context_.diagnostics.hasErrors())
        context_.diagnostics.report(diag::ConstantWithoutValue, span_, target.path)
            .note(target.declaration->name.span, fmt::format("'{}' is declared here", target.name));
      return nullptr;
    }
    return makeIndex(makeLiteral(typeOf(target), *values, span_), chosen, span_);
  }

  ExprPtr elementPart(Component &target, const std::vector<flat::Selection> &chosen, std::size_t part) {
    if (isLast(part)) {
      context_.diagnostics.report(diag::ElementAsValue, span_, target.path, target.leaf->predefined->name);
      return nullptr;
    }
    if (!isLast(part + 1)) {
      context_.diagnostics.report(diag::NoMembers, name(part + 2).span, name(part + 1).text, target.leaf->predefined->name,
                                  name(part + 2).text);
      return nullptr;
    }
    const ExprPtr whole = typeElementPart(context_, target, name(part + 1), span_);
    if (whole == nullptr)
      return nullptr;
    const ast::ReferencePart &last = reference_.parts[part + 1];
    ExprPtr selected = makeIndex(whole, chosen, span_);
    if (!last.hasSubscripts)
      return selected;
    const auto inner = typer_.selections(last.subscripts, selected->type.dims, span_);
    return inner ? makeIndex(selected, *inner, span_) : nullptr;
  }

  std::optional<std::vector<flat::Selection>> subscripts(std::size_t part, const std::vector<int> &dims) {
    return typer_.selections(reference_.parts[part].subscripts, dims, reference_.parts[part].name.span);
  }

  Typer &typer_;
  Context &context_;
  const ast::Reference &reference_;
  Span span_;
  bool isEnclosing_ = false;  // found in an enclosing class, where only constants can be used (MLS 5.3.1)
};

}  // namespace

ExprPtr Typer::reference(const ast::Reference &name, Span span) { return ReferenceTyping(*this, name, span).run(); }

}  // namespace tf::semantics
