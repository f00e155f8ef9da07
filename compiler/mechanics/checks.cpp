// What attributes of elements may depend on (the table of language.md section 3, lang/semantics/predefined.h), smoothness of kinematics.
#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"
#include "compiler/mechanics/slip_direction.h"
#include "lang/semantics/predefined.h"

#include <algorithm>
#include <optional>
#include <set>

namespace tf::mechanics {

using flat::Expr;
using flat::ExprKind;
using flat::Function;
using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;
using semantics::AttributeSpec;
using semantics::Dependencies;

namespace {

bool isAllowed(SymbolKind kind, const Dependencies &may) {
  switch (kind) {
  case SymbolKind::Parameter:
  case SymbolKind::StepVariable:
    return true;
  case SymbolKind::Time:
    return may.time;
  case SymbolKind::Coordinate:
    return may.coordinates;
  case SymbolKind::Velocity:
    return may.velocities;
  case SymbolKind::State:
    return may.states;
  case SymbolKind::Input:
    return may.inputs;
  default:
    return false;
  }
}

std::string listOf(const Dependencies &may) {
  std::string list;
  const auto add = [&](bool isListed, const char *name) {
    if (isListed)
      list += std::string(name) + ", ";
  };
  add(may.coordinates, "coordinates");
  add(may.velocities, "velocities");
  add(may.states, "states");
  add(may.inputs, "inputs");
  add(may.time, "time");
  if (list.empty())
    return "parameters";
  return list.substr(0, list.size() - 2) + " and parameters";
}

const semantics::PredefinedClass &classOf(const flat::Element &element) {
  static constexpr std::string_view kNames[] = {"body", "gravity", "force", "potential", "constraint", "contact", "friction"};
  return *semantics::findPredefined(kNames[static_cast<std::size_t>(element.kind)]);
}

class ElementChecks {
public:
  explicit ElementChecks(Derivation &derivation) : d_(derivation) {}

  // True if the attribute passes.
  bool check(const flat::Element &element, const flat::Attribute &attribute, const AttributeSpec &spec) {
    const std::optional<Symbol> forbidden = find(*attribute.value, [&](Symbol s) { return !isAllowed(s.kind, spec.may); });
    if (forbidden) {
      reportDependency(element, attribute, spec, *forbidden);
      return false;
    }
    return !spec.isKinematic || isSmooth(*attribute.value, element, attribute);
  }

  bool checkBound(const FrictionEntry &friction) {
    const int found = switchOnSlipDirection(d_.system, friction);
    if (found < 0)
      return true;
    const Expr &bound = *d_.model.elements[static_cast<std::size_t>(friction.element)].find("bound")->value;
    const Span condition = d_.system.switches[static_cast<std::size_t>(found)].span;
    const bool isWritten = condition.file == bound.span.file && condition.begin >= bound.span.begin && condition.end <= bound.span.end;
    d_.diagnostics
        .report(diag::BoundBySlipDirection, isWritten ? condition : narrowest(bound, {SymbolKind::StepVariable, found}), friction.name)
        .note(bound.span,
              "give the mean of the bounds of both directions, and a 'force' of half of their difference that pushes where there "
              "is less friction");
    return false;
  }

private:
  // First symbol, conditions of step variables included, that satisfies `predicate`.
  template <class Predicate> std::optional<Symbol> find(const Expr &expression, Predicate predicate) {
    for (const NodeId node : d_.equations.resolve(d_.scalariser.known(expression)))
      for (const Symbol symbol : allDependencies(d_.system, node))
        if (predicate(symbol))
          return symbol;
    return std::nullopt;
  }

  // The smallest part of the expression that depends on `symbol`.
  Span narrowest(const Expr &expression, Symbol symbol) {
    const auto isIt = [&](Symbol s) { return s == symbol; };
    const Expr *part = &expression;
    for (bool isNarrowed = true; isNarrowed && part->kind != ExprKind::Derivative;) {
      isNarrowed = false;
      for (const flat::ExprPtr &arg : part->args)
        if (find(*arg, isIt)) {
          part = arg.get();
          isNarrowed = true;
          break;
        }
    }
    return part->span;
  }

  void reportDependency(const flat::Element &element, const flat::Attribute &attribute, const AttributeSpec &spec, Symbol symbol) {
    Diagnostic &diagnostic = d_.diagnostics.report(diag::ForbiddenDependency, narrowest(*attribute.value, symbol), attribute.name,
                                                   element.name, d_.names.describe(symbol), listOf(spec.may));
    if (symbol.kind == SymbolKind::NormalForce && element.kind == flat::ElementKind::Friction)
      diagnostic.note(element.span,
                      "friction in proportion to a contact's normal force is the contact's own: give it 'slip' and 'friction'");
  }

  bool dependsOnMotion(const Expr &expression) {
    return find(
               expression,
               [](Symbol s) { return s.kind != SymbolKind::Time && s.kind != SymbolKind::Parameter && s.kind != SymbolKind::StepVariable; })
        .has_value();
  }

  bool report(const Expr &seam, std::string_view what, const flat::Element &element, const flat::Attribute &attribute) {
    Diagnostic &diagnostic = d_.diagnostics.report(diag::NotSmooth, seam.span, what, attribute.name, element.name);
    if (const Span place = attribute.value->span;
        seam.span.file != place.file || seam.span.begin < place.begin || seam.span.end > place.end)
      diagnostic.note(place, fmt::format("'{}' of '{}' is given here", attribute.name, element.name));
    return false;
  }

  // No if, abs, sign, min, max, rounding over coordinates outside smooth(2, …), in the expression and in what its variables stand for.
  bool isSmooth(const Expr &expression, const flat::Element &element, const flat::Attribute &attribute) {
    const auto recurse = [&](const flat::ExprPtr &arg) { return isSmooth(*arg, element, attribute); };
    switch (expression.kind) {
    case ExprKind::Variable:
      return isSmoothVariable(expression, element, attribute);
    case ExprKind::Attribute:
      if (const flat::Attribute *given = d_.model.elements[static_cast<std::size_t>(expression.element)].find(expression.attribute))
        return isSmooth(*given->value, element, attribute);
      return true;
    case ExprKind::If:
      if (dependsOnMotion(*expression.args[0]))
        return report(expression, "if", element, attribute);
      break;
    case ExprKind::Call:
      if (expression.function == Function::Smooth)
        return isSmoothCall(expression, element, attribute);
      if (flat::hasSeams(expression.function))
        if (std::ranges::any_of(expression.args, [&](const flat::ExprPtr &arg) { return dependsOnMotion(*arg); }))
          return report(expression, flat::nameOf(expression.function), element, attribute);
      break;
    default:
      break;
    }
    return std::ranges::all_of(expression.args, recurse);
  }

  bool isSmoothCall(const Expr &expression, const flat::Element &element, const flat::Attribute &attribute) {
    const ir::Node order = d_.system.graph[d_.scalariser.known(*expression.args[0])[0]];
    return (order.op == ir::Op::Constant && order.value >= 2) || isSmooth(*expression.args[1], element, attribute);
  }

  bool isSmoothVariable(const Expr &expression, const flat::Element &element, const flat::Attribute &attribute) {
    const equations::Place place = d_.variables.place(expression.variable);
    if (place.role != equations::Role::Unknown || !visited_.insert({expression.variable, &attribute}).second)
      return true;
    const int size = d_.model.variables[static_cast<std::size_t>(expression.variable)].type.size();
    bool isFine = true;
    const Expr *last = nullptr;
    for (int k = 0; k < size && isFine; ++k) {
      const equations::ScalarEquation &equation = d_.equations.equationOf(place.first + k);
      if (equation.leftExpression == last)
        continue;
      last = equation.leftExpression;
      isFine = isSmooth(*equation.leftExpression, element, attribute) && isSmooth(*equation.rightExpression, element, attribute);
    }
    return isFine;
  }

  Derivation &d_;
  std::set<std::pair<flat::VariableId, const flat::Attribute *>> visited_;
};

bool checkGravity(Derivation &d) {
  bool isFine = true;
  for (const GravityEntry &gravity : d.elements.gravities)
    for (const BodyEntry &body : d.elements.bodies) {
      const flat::Element &source = d.model.elements[static_cast<std::size_t>(gravity.element)];
      const flat::Element &target = d.model.elements[static_cast<std::size_t>(body.element)];
      if (!isWithin(target.scope, source.scope) || body.position.empty() || body.position.size() == gravity.acceleration.size())
        continue;
      d.diagnostics
          .report(diag::GravityDimension, source.find("acceleration")->value->span, gravity.name, gravity.acceleration.size(), body.name,
                  body.position.size())
          .note(target.find("position")->value->span, fmt::format("'position' of '{}'", body.name));
      isFine = false;
    }
  return isFine;
}

}  // namespace

std::vector<Symbol> allDependencies(const HybridSystem &system, NodeId node) {
  std::vector<Symbol> all = equations::symbolsOf(system.graph, node);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].kind != SymbolKind::StepVariable)
      continue;
    const NodeId condition = system.switches[static_cast<std::size_t>(all[k].index)].condition;
    for (const Symbol symbol : equations::symbolsOf(system.graph, condition))
      if (std::ranges::find(all, symbol) == all.end())
        all.push_back(symbol);
  }
  return all;
}

bool checkElements(Derivation &derivation) {
  ElementChecks checks(derivation);
  bool isFine = true;
  for (const flat::Element &element : derivation.model.elements)
    for (const flat::Attribute &attribute : element.attributes)
      if (const AttributeSpec *spec = classOf(element).attribute(attribute.name); spec != nullptr)
        isFine = checks.check(element, attribute, *spec) && isFine;
  // Bounds are evaluated, for which all elements must be sound.
  const bool areEvaluable = isFine;
  for (const FrictionEntry &friction : derivation.elements.frictions)
    if (areEvaluable)
      isFine = checks.checkBound(friction) && isFine;
  return checkGravity(derivation) && isFine;
}

bool checkContacts(Derivation &derivation) {
  const HybridSystem &system = derivation.system;
  const ir::Graph &graph = system.graph;
  // Rows that are not written out have been found to be otherwise.
  const auto isZero = [&](const std::vector<NodeId> &row) {
    return !row.empty() && std::ranges::all_of(row, [&](NodeId node) { return graph.isConstant(node, 0); });
  };
  const auto spanOf = [&](const ElementEntry &entry, const char *attribute) {
    return derivation.model.elements[static_cast<std::size_t>(entry.element)].find(attribute)->value->span;
  };
  const int errors = derivation.diagnostics.errorCount();
  const auto checkSlip = [&](const ElementEntry &entry, int first, int count) {
    for (int k = first; k < first + count; ++k) {
      const std::vector<NodeId> &row = system.tangents[static_cast<std::size_t>(k)].jacobian;
      if (isZero(row))
        derivation.diagnostics.report(diag::ImmovableSlip, spanOf(entry, "slip"), entry.name);
      for (const NodeId node : row)
        if (ir::dependsOn(graph, node, [](Symbol s) { return s.kind == SymbolKind::Velocity; }))
          derivation.diagnostics.report(diag::SlipNotAffine, spanOf(entry, "slip"), entry.name);
    }
  };
  for (std::size_t k = 0; k < system.contacts.size(); ++k) {
    const ContactEntry &entry = derivation.elements.contacts[k];
    if (isZero(system.contacts[k].normal))
      derivation.diagnostics.report(diag::ImmovableGap, spanOf(entry, "gap"), entry.name);
    if (graph[entry.law].op != ir::Op::Constant)
      derivation.diagnostics.report(diag::VaryingLaw, spanOf(entry, "law"), entry.name);
    checkSlip(entry, entry.tangentFirst, entry.affineCount());
  }
  for (const FrictionEntry &entry : derivation.elements.frictions)
    checkSlip(entry, entry.tangentFirst, entry.affineCount());
  for (const ForceEntry &entry : derivation.elements.forces) {
    const auto isMoving = [](Symbol s) { return s.kind == SymbolKind::Coordinate; };
    if (std::ranges::none_of(entry.at, [&](NodeId at) { return ir::dependsOn(graph, at, isMoving); }))
      derivation.diagnostics.report(diag::ImmovableForce, spanOf(entry, "at"), entry.name);
  }
  return derivation.diagnostics.errorCount() == errors;
}

}  // namespace tf::mechanics
