#include "lang/semantics/records.h"

#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elaborate.h"
#include "lang/semantics/lookup.h"

#include <algorithm>
#include <deque>

namespace tf::semantics {

namespace {

bool isRecord(const Class &type) {
  return type.definition != nullptr && type.predefined == nullptr &&
         (type.definition->restriction == ast::Restriction::Record || type.definition->restriction == ast::Restriction::OperatorRecord);
}

// The class that a call's name stands for, if it is a record: its constructor is called.
Class *constructedRecord(Context &context, const ast::Expr &call, const Scope &scope) {
  const ast::Reference &callee = call.reference;
  if (callee.parts.empty() || scope.enclosing == nullptr)
    return nullptr;
  const Files files = callee.parts.size() > 1 ? Files::Search : Files::Ignore;
  Found found = callee.leadingDot ? lookupRoot(context, callee.parts[0].name.text, files)
                                  : lookupSimple(context, *scope.enclosing, callee.parts[0].name.text, files);
  for (std::size_t i = 1; i < callee.parts.size() && found.type != nullptr; ++i)
    found = lookupMember(context, *found.type, callee.parts[i].name.text);
  if (found.type == nullptr)
    return nullptr;
  elaborate(context, *found.type);
  return isRecord(*found.type) ? found.type : nullptr;
}

class Projecting {
public:
  Projecting(Context &context, const Scope &scope) : context_(context), scope_(scope) {}

  ExprPtr type(const ast::Expr &expr, std::span<const Projection> projections) {
    const bool hasField = std::ranges::any_of(projections, [](const Projection &p) { return !p.field.empty(); });
    if (!hasField) {
      ExprPtr value = typeExpression(context_, expr, scope_);
      for (const Projection &projection : projections)
        if (value != nullptr)
          value = projectIndex(context_, value, projection);
      return value;
    }
    switch (expr.kind) {
    case ast::ExprKind::Tuple:
      if (expr.operands.size() == 1 && expr.operands[0] != nullptr)
        return type(*expr.operands[0], projections);
      break;
    case ast::ExprKind::Reference:
      return reference(expr, projections);
    case ast::ExprKind::If:
      return conditional(expr, projections);
    case ast::ExprKind::Array:
      if (!projections.front().index.empty())
        return expr.iterators.empty() ? element(expr, projections) : comprehension(expr, projections);
      break;
    case ast::ExprKind::Call:
      if (Class *record = constructedRecord(context_, expr, scope_); record != nullptr && !projections.front().field.empty())
        return constructed(expr, *record, projections);
      break;
    default:
      break;
    }
    context_.diagnostics.report(diag::NotSupported, expr.span, "this expression as the value of a whole record");
    return nullptr;
  }

private:
  // r → r.field, r[i].field
  ExprPtr reference(const ast::Expr &expr, std::span<const Projection> projections) {
    std::vector<ast::ReferencePart> parts(expr.reference.parts.begin(), expr.reference.parts.end());
    std::deque<ast::Expr> subscripts;
    std::deque<std::vector<ast::Expr *>> lists;
    for (const Projection &projection : projections) {
      if (!projection.field.empty()) {
        ast::ReferencePart &part = parts.emplace_back();
        part.name = {projection.field, expr.span};
        continue;
      }
      if (parts.empty() || parts.back().hasSubscripts) {
        context_.diagnostics.report(diag::NotSupported, expr.span, "this expression as the value of a whole record");
        return nullptr;
      }
      std::vector<ast::Expr *> &list = lists.emplace_back();
      for (const int position : projection.index) {
        ast::Expr &subscript = subscripts.emplace_back();
        subscript.kind = ast::ExprKind::Integer;
        subscript.number = position;
        subscript.span = expr.span;
        list.push_back(&subscript);
      }
      parts.back().subscripts = {list.data(), static_cast<std::uint32_t>(list.size())};
      parts.back().hasSubscripts = true;
    }
    ast::Expr extended = expr;
    extended.reference.parts = {parts.data(), static_cast<std::uint32_t>(parts.size())};
    return typeExpression(context_, extended, scope_);
  }

  ExprPtr conditional(const ast::Expr &expr, std::span<const Projection> projections) {
    return typeConditional(
        context_, expr, scope_,
        [this](const ast::Expr &condition, const Scope &scope) { return typeExpression(context_, condition, scope); },
        [&](const ast::Expr &value, const Scope &scope) { return Projecting(context_, scope).type(value, projections); });
  }

  // {x, y}[i]
  ExprPtr element(const ast::Expr &expr, std::span<const Projection> projections) {
    const Projection &first = projections.front();
    if (!hasSize(expr, expr.operands.size(), first, 0))
      return nullptr;
    return type(*expr.operands[static_cast<std::size_t>(first.index.front() - 1)], inside(projections, 1));
  }

  // {e for i in r, j in s}[l, k]: the last iterator is the outermost dimension.
  ExprPtr comprehension(const ast::Expr &expr, std::span<const Projection> projections) {
    const Projection &first = projections.front();
    const std::size_t levels = expr.iterators.size();
    if (first.index.size() < levels) {
      context_.diagnostics.report(diag::NotSupported, expr.span, "this expression as the value of a whole record");
      return nullptr;
    }
    Scope scope = scope_;
    std::deque<Locals> bound;
    for (std::size_t k = 0; k < levels; ++k) {
      const ast::ForIndex &index = expr.iterators[levels - 1 - k];
      const auto values = Typer(context_, scope).iteration(index, {expr.operands[0]});
      if (!values || !hasSize(expr, values->size(), first, k))
        return nullptr;
      bound.push_back({scope.locals, index.name.text, (*values)[static_cast<std::size_t>(first.index[k] - 1)]});
      scope.locals = &bound.back();
    }
    return Projecting(context_, scope).type(*expr.operands[0], inside(projections, levels));
  }

  bool hasSize(const ast::Expr &expr, std::size_t size, const Projection &projection, std::size_t dimension) {
    if (projection.sizes[dimension] == static_cast<int>(size))
      return true;
    context_.diagnostics.report(diag::SplitSize, expr.span, size, projection.sizes[dimension]);
    return false;
  }

  // What is left of the projections within an element of these dimensions.
  static std::vector<Projection> inside(std::span<const Projection> projections, std::size_t dimensions) {
    std::vector<Projection> rest(projections.begin(), projections.end());
    if (rest.front().index.size() == dimensions) {
      rest.erase(rest.begin());
    } else {
      const auto count = static_cast<std::ptrdiff_t>(dimensions);
      rest.front().index.erase(rest.front().index.begin(), rest.front().index.begin() + count);
      rest.front().sizes.erase(rest.front().sizes.begin(), rest.front().sizes.begin() + count);
    }
    return rest;
  }

  // R(a, y = b).y; what is not given has the value of its declaration.
  ExprPtr constructed(const ast::Expr &expr, Class &record, std::span<const Projection> projections) {
    const std::string_view field = projections.front().field;
    const auto rest = projections.subspan(1);
    if (!checkArguments(expr, record))
      return nullptr;
    for (const ast::NamedArgument &named : expr.named)
      if (named.name.text == field && named.value != nullptr)
        return type(*named.value, rest);
    std::size_t position = 0;
    for (const Member &member : record.members) {
      if (member.component == nullptr)
        continue;
      if (member.name == field) {
        if (position < expr.operands.size())
          return type(*expr.operands[position], rest);
        return defaultValue(expr, record, *member.component, rest);
      }
      ++position;
    }
    context_.diagnostics.report(diag::UnknownClassMember, expr.span, field, record.name);
    return nullptr;
  }

  ExprPtr defaultValue(const ast::Expr &expr, const Class &record, const Component &component, std::span<const Projection> rest) {
    if (component.modifier && component.modifier->binding) {
      const Binding &binding = *component.modifier->binding;
      return typeProjected(context_, *binding.expression, Scope{binding.scope, nullptr, false}, rest);
    }
    context_.diagnostics.report(diag::ArgumentMissing, expr.span, component.name, record.name);
    return nullptr;
  }

  bool checkArguments(const ast::Expr &expr, const Class &record) {
    const auto fields = std::ranges::count_if(record.members, [](const Member &member) { return member.component != nullptr; });
    if (expr.operands.size() > static_cast<std::size_t>(fields)) {
      context_.diagnostics.report(diag::ArgumentCount, expr.span, record.name, fmt::format("{} argument{}", fields, fields == 1 ? "" : "s"),
                                  expr.operands.size());
      return false;
    }
    for (const ast::NamedArgument &named : expr.named)
      if (!record.index.contains(named.name.text)) {
        std::vector<std::string> names;
        names.reserve(record.members.size());
        for (const Member &member : record.members)
          names.emplace_back(member.name);
        context_.diagnostics.report(diag::UnknownArgument, named.name.span, record.name, named.name.text).suggest(named.name.text, names);
        return false;
      }
    return true;
  }

  Context &context_;
  const Scope &scope_;
};

}  // namespace

ExprPtr projectIndex(Context &context, const ExprPtr &value, const Projection &projection) {
  const std::vector<int> &index = projection.index;
  const std::vector<int> &dims = value->type.dims;
  if (dims.size() < index.size()) {
    context.diagnostics.report(diag::NeedsEach, value->span, toString(value->type));
    return nullptr;
  }
  for (std::size_t i = 0; i < index.size(); ++i)
    if (dims[i] != projection.sizes[i]) {
      context.diagnostics.report(diag::SplitSize, value->span, dims[i], projection.sizes[i]);
      return nullptr;
    }
  return elementAt(value, index, value->span);
}

ExprPtr typeProjected(Context &context, const ast::Expr &expr, const Scope &scope, std::span<const Projection> projections) {
  return Projecting(context, scope).type(expr, projections);
}

Class *recordOf(Context &context, const ast::Expr &expr, const Scope &scope) {
  if (expr.kind == ast::ExprKind::Call)
    return constructedRecord(context, expr, scope);
  if (expr.kind != ast::ExprKind::Reference || expr.reference.leadingDot || expr.reference.parts.empty())
    return nullptr;
  const auto &parts = expr.reference.parts;
  for (const Locals *local = scope.locals; local != nullptr; local = local->outer)
    if (local->name == parts[0].name.text)
      return nullptr;
  Found found = lookupSimple(context, *scope.enclosing, parts[0].name.text, Files::Ignore);
  for (std::size_t i = 0; found.component != nullptr; ++i) {
    Component *component = actual(context, *found.component);
    if (component == nullptr || !isPresent(context, *component) || !resolve(context, *component) || component->isLeaf() ||
        component->instances.empty())
      return nullptr;
    Class *instance = component->instances.front();
    if (i + 1 == parts.size())
      return isRecord(*instance) && (component->dimensions.empty() || parts[i].hasSubscripts) ? instance : nullptr;
    Member *member = instance->find(parts[i + 1].name.text);
    if (member == nullptr)
      return nullptr;
    found = {nullptr, member->component, instance, false};
  }
  return nullptr;
}

}  // namespace tf::semantics
