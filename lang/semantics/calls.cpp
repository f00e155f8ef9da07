// Function calls: which function a name stands for.
#include "lang/semantics/builtin_functions.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/lookup.h"

namespace tf::semantics {

namespace {

std::vector<std::string> functionNames(Context &context, Class &scope) {
  std::vector<std::string> names = visibleNames(context, scope);
  for (const auto functions : {mathFunctions(), operatorFunctions(), arrayFunctions()})
    for (const BuiltinFunction &function : functions)
      names.emplace_back(function.name);
  return names;
}

// The class that the callee names, through packages; null with `isReported` if there was an error.
Class *findFunction(Context &context, Class &scope, const ast::Reference &callee, bool &isReported) {
  const std::string_view first = callee.parts[0].name.text;
  const bool isQualified = callee.parts.size() > 1;
  const Files files = isQualified ? Files::Search : Files::Ignore;
  Found found = callee.leadingDot ? lookupRoot(context, first, files) : lookupSimple(context, scope, first, files);
  for (std::size_t i = 1; i < callee.parts.size() && found; ++i) {
    Class *container = found.type;
    if (container == nullptr)
      break;
    const ast::Name &name = callee.parts[i].name;
    found = lookupMember(context, *container, name.text);
    if (!found) {
      isReported = true;
      context.diagnostics.report(diag::UnknownClassMember, name.span, name.text, container->name)
          .suggest(name.text, memberNames(context, *container));
      return nullptr;
    }
  }
  if (found.component != nullptr) {
    isReported = true;
    context.diagnostics.report(diag::NotAFunction, callee.span, dotted(callee));
    return nullptr;
  }
  return found.type;
}

bool isFunction(const Class &type) {
  return type.definition != nullptr &&
         (type.definition->restriction == ast::Restriction::Function || type.definition->restriction == ast::Restriction::OperatorFunction);
}

}  // namespace

Class *calledFunction(Typer &typer, const ast::Expr &call) {
  if (call.kind != ast::ExprKind::Call || call.reference.parts.empty())
    return nullptr;
  bool isReported = false;
  Class *function = findFunction(typer.context(), *typer.scope().enclosing, call.reference, isReported);
  return function != nullptr && isFunction(*function) ? function : nullptr;
}

ExprPtr Typer::call(const ast::Expr &expr) {
  const ast::Reference &callee = expr.reference;
  if (callee.parts.empty())
    return nullptr;
  bool isReported = false;
  Class *function = findFunction(context_, *scope_.enclosing, callee, isReported);
  if (isReported)
    return nullptr;
  if (function != nullptr && isFunction(*function))
    return typeFunctionCall(*this, *function, expr);
  const std::string_view name = callee.parts[0].name.text;
  if (callee.parts.size() == 1 && isBuiltinFunction(name))
    return typeBuiltinCall(*this, name, expr);
  if (function != nullptr)
    diagnostics().report(diag::NotAFunction, callee.span, dotted(callee));
  else
    diagnostics().report(diag::UnknownFunction, callee.parts[0].name.span, name).suggest(name, functionNames(context_, *scope_.enclosing));
  return nullptr;
}

}  // namespace tf::semantics
