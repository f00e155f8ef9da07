// Expressions outside of any model: `--set u=…`.
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/instantiate.h"
#include "lang/semantics/typing.h"

#include "lang/syntax/parser.h"

namespace tf {

namespace {

using namespace semantics;

class FreeTyper final : public Typer {
public:
  FreeTyper(Context &context, Scope scope, const std::function<std::optional<int>(const std::string &)> &resolve,
            const std::vector<std::string> &names)
      : Typer(context, scope), resolve_(resolve), names_(names) {}

  ExprPtr reference(const ast::Reference &reference, Span span) override {
    const std::optional<std::string> name = fullName(reference);
    if (!name)
      return nullptr;
    const std::optional<int> id = resolve_(*name);
    if (!id) {
      context().diagnostics.report(diag::UnknownName, span, *name).suggest(*name, names_);
      return nullptr;
    }
    flat::Expr variable;
    variable.kind = flat::ExprKind::Variable;
    variable.variable = *id;
    variable.variability = Variability::Continuous;
    variable.span = span;
    return std::make_shared<const flat::Expr>(std::move(variable));
  }

  std::unique_ptr<Typer> makeNested(const Locals *locals) override {
    return std::make_unique<FreeTyper>(context(), Scope{scope().enclosing, locals, false}, resolve_, names_);
  }

private:
  // "arm.k[2]": subscripts must be known.
  std::optional<std::string> fullName(const ast::Reference &reference) {
    std::string name;
    for (const ast::ReferencePart &part : reference.parts) {
      name += (name.empty() ? "" : ".") + std::string(part.name.text);
      if (!part.hasSubscripts)
        continue;
      name += "[";
      for (std::size_t i = 0; i < part.subscripts.size(); ++i) {
        const auto chosen = selection(*part.subscripts[i], kMaximumArraySize);
        if (!chosen)
          return std::nullopt;
        if (!chosen->scalar) {
          diagnostics().report(diag::SubscriptType, part.subscripts[i]->span, "an array");
          return std::nullopt;
        }
        name += (i == 0 ? "" : ",") + std::to_string(chosen->positions[0]);
      }
      name += "]";
    }
    return name;
  }

  const std::function<std::optional<int>(const std::string &)> &resolve_;
  const std::vector<std::string> &names_;
};

}  // namespace

flat::ExprPtr typeExpression(SourceManager &sources, FileId file, const std::function<std::optional<int>(const std::string &)> &resolve,
                             const std::vector<std::string> &names, Diagnostics &diagnostics) {
  const int before = diagnostics.errorCount();
  const ast::Tree tree = ast::parseExpression(sources, file, diagnostics);
  if (tree.expression == nullptr || diagnostics.errorCount() > before)
    return nullptr;
  const InstantiateOptions options;
  Context context(sources, diagnostics, options);
  makeRoot(context);
  Class &scope = context.newClass();
  scope.parent = context.root;
  scope.progress = Progress::Done;
  ExprPtr typed = FreeTyper(context, Scope{&scope, nullptr, false}, resolve, names).type(*tree.expression);
  if (typed == nullptr)
    return nullptr;
  if (!typed->type.dims.empty() || typed->type.base == Base::String) {
    diagnostics.report(diag::ArgumentType, tree.expression->span, "a scalar", toString(typed->type));
    return nullptr;
  }
  return typed;
}

}  // namespace tf
