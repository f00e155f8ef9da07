// Equations of a class: for-equations unrolled, if-equations selected or turned into if-expressions, assertions.
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/flatten.h"
#include "lang/semantics/records.h"
#include "lang/semantics/typing.h"

#include <algorithm>
#include <set>

namespace tf::semantics {

namespace {

class EquationFlattening {
public:
  using Visited = std::set<const ast::ClassDefinition *>;

  EquationFlattening(Context &context, Class &scope) : context_(context), scope_(scope) {}

  // The equations of a class that is inherited twice are taken once (MLS 7.1).
  void run(Visited &visited) {
    for (Class *base : scope_.bases)
      EquationFlattening(context_, *base).run(visited);
    if (scope_.definition == nullptr || !visited.insert(scope_.definition).second)
      return;
    for (const ast::Section &section : scope_.definition->sections) {
      switch (section.kind) {
      case ast::SectionKind::Equation:
      case ast::SectionKind::InitialEquation:
        isInitial_ = section.kind == ast::SectionKind::InitialEquation;
        addAll(section.equations, nullptr, target_);
        break;
      case ast::SectionKind::Algorithm:
      case ast::SectionKind::InitialAlgorithm:
        context_.diagnostics.report(diag::NotSupported, keyword(section.span, 9), "an algorithm section in a model");
        break;
      case ast::SectionKind::Constraint:
        context_.diagnostics.report(diag::NotSupported, keyword(section.span, 10), "a constraint section");
        break;
      }
    }
    if (scope_.definition->external != nullptr)
      context_.diagnostics.report(diag::NotSupported, keyword(scope_.definition->external->span, 8), "an external declaration in a model");
    for (flat::Equation &equation : target_.equations)
      context_.model.equations.push_back(std::move(equation));
    for (flat::Assertion &assertion : target_.assertions)
      context_.model.assertions.push_back(std::move(assertion));
  }

private:
  struct Collected {
    std::vector<flat::Equation> equations;
    std::vector<flat::Assertion> assertions;
    bool isRight = true;
  };

  [[nodiscard]] ExprPtr type(const ast::Expr &expr, const Locals *locals) {
    return typeExpression(context_, expr, Scope{&scope_, locals, false});
  }

  void addAll(const ast::List<ast::Equation *> &equations, const Locals *locals, Collected &out) {
    for (const ast::Equation *equation : equations)
      if (equation != nullptr && !context_.isOverLimit)
        add(*equation, locals, out);
  }

  void add(const ast::Equation &equation, const Locals *locals, Collected &out) {
    switch (equation.kind) {
    case ast::EquationKind::Equality:
      addEquality(equation, locals, out);
      return;
    case ast::EquationKind::If:
      addIf(equation, locals, out);
      return;
    case ast::EquationKind::For:
      addFor(equation, locals, out);
      return;
    case ast::EquationKind::Call:
      addCall(equation, locals, out);
      return;
    case ast::EquationKind::When:
      notSupported(keyword(equation.span, 4), "'when'", out);
      return;
    case ast::EquationKind::Connect:
      notSupported(keyword(equation.span, 7), "'connect'", out);
      return;
    case ast::EquationKind::Constraint:
      notSupported(equation.span, "an inequality as an equation", out);
      return;
    case ast::EquationKind::Error:
      out.isRight = false;
      return;
    }
  }

  static Span keyword(Span span, std::uint32_t length) { return {span.file, span.begin, std::min(span.end, span.begin + length)}; }

  void notSupported(Span span, std::string_view what, Collected &out) {
    context_.diagnostics.report(diag::NotSupported, span, what);
    out.isRight = false;
  }

  void addEquality(const ast::Equation &equation, const Locals *locals, Collected &out) {
    if (equation.left == nullptr || equation.right == nullptr) {
      out.isRight = false;
      return;
    }
    if (equation.left->kind == ast::ExprKind::Tuple && equation.left->operands.size() > 1) {
      addOutputs(equation, locals, out);
      return;
    }
    const Scope scope{&scope_, locals, false};
    Class *record = recordOf(context_, *equation.left, scope);
    if (record == nullptr)
      record = recordOf(context_, *equation.right, scope);
    if (record != nullptr)
      addFields(equation, *record, scope, {}, out);
    else
      addSides(type(*equation.left, locals), type(*equation.right, locals), equation.span, out);
  }

  // An equation between records is one between each of their fields.
  void addFields(const ast::Equation &equation, const Class &record, const Scope &scope, const std::vector<Projection> &outer,
                 Collected &out) {
    for (const Member &member : record.members) {
      if (member.component == nullptr || !resolve(context_, *member.component))
        continue;
      std::vector<Projection> field = outer;
      field.push_back({{}, member.name, {}});
      if (!member.component->isLeaf() && !member.component->instances.empty())
        addFields(equation, *member.component->instances.front(), scope, field, out);
      else if (variabilityOf(*member.component) > Variability::Parameter)
        addSides(typeProjected(context_, *equation.left, scope, field), typeProjected(context_, *equation.right, scope, field),
                 equation.span, out);
    }
  }

  // `(a, , c) = f(x)`
  void addOutputs(const ast::Equation &equation, const Locals *locals, Collected &out) {
    Typer typer(context_, Scope{&scope_, locals, false});
    Class *function = calledFunction(typer, *equation.right);
    if (function == nullptr) {
      context_.diagnostics.report(diag::TupleOutsideCall, equation.left->span);
      out.isRight = false;
      return;
    }
    const auto outputs = typeFunctionOutputs(typer, *function, *equation.right);
    if (outputs && outputs->size() < equation.left->operands.size())
      context_.diagnostics.report(diag::OutputCount, equation.left->span, equation.left->operands.size(), outputs->size());
    if (!outputs || outputs->size() < equation.left->operands.size()) {
      out.isRight = false;
      return;
    }
    for (std::size_t i = 0; i < equation.left->operands.size(); ++i)
      if (equation.left->operands[i] != nullptr)
        addSides(type(*equation.left->operands[i], locals), (*outputs)[i], equation.span, out);
  }

  void addSides(ExprPtr left, ExprPtr right, Span span, Collected &out) {
    if (left == nullptr || right == nullptr) {
      out.isRight = false;
      return;
    }
    if (left->type.base == Base::Real)
      right = toReal(right);
    if (right->type.base == Base::Real)
      left = toReal(left);
    if (left->type != right->type) {
      context_.diagnostics.report(diag::EquationTypes, span, toString(left->type), toString(right->type));
      out.isRight = false;
      return;
    }
    out.equations.push_back({left, right, isInitial_, span});
  }

  void addFor(const ast::Equation &equation, const Locals *locals, Collected &out) {
    std::vector<const ast::Expr *> bodies;
    collectExpressions(equation.body, bodies);
    Typer typer(context_, Scope{&scope_, locals, false});
    const bool isRight = typer.unroll(equation.iterators, bodies, [&](const Locals *bound) {
      const int before = context_.diagnostics.errorCount();
      addAll(equation.body, bound, out);
      // One mistake in the body is one error, not one per pass.
      return context_.diagnostics.errorCount() == before && !context_.isOverLimit;
    });
    out.isRight = out.isRight && isRight;
  }

  static void collectExpressions(const ast::List<ast::Equation *> &equations, std::vector<const ast::Expr *> &out) {
    for (const ast::Equation *equation : equations) {
      if (equation == nullptr)
        continue;
      for (const ast::Expr *expr : {equation->left, equation->right, equation->call})
        if (expr != nullptr)
          out.push_back(expr);
      collectExpressions(equation->body, out);
      for (const auto &branch : equation->branches)
        collectExpressions(branch.body, out);
    }
  }

  // Conditions that are known now select a branch; others need branches with the same number of equations.
  void addIf(const ast::Equation &equation, const Locals *locals, Collected &out) {
    std::vector<ExprPtr> conditions;
    std::vector<Collected> branches;
    bool hasElse = false;
    for (const auto &branch : equation.branches) {
      ExprPtr condition;
      if (branch.condition != nullptr) {
        condition = type(*branch.condition, locals);
        if (condition == nullptr || !isBoolean(*condition, branch.condition->span)) {
          out.isRight = false;
          return;
        }
        if (const auto value = constantValue(context_, *condition)) {
          if ((*value)[0] == 0)
            continue;
          condition = nullptr;
        }
      }
      conditions.push_back(condition);
      addAll(branch.body, locals, branches.emplace_back());
      out.isRight = out.isRight && branches.back().isRight;
      if (condition == nullptr) {
        hasElse = true;
        break;
      }
    }
    if (out.isRight && !branches.empty())
      combine(equation, conditions, branches, hasElse, out);
  }

  bool isBoolean(const flat::Expr &condition, Span span) {
    if (condition.type == Type{Base::Boolean, {}})
      return true;
    context_.diagnostics.report(diag::ConditionType, span, toString(condition.type));
    return false;
  }

  void combine(const ast::Equation &equation, const std::vector<ExprPtr> &conditions, std::vector<Collected> &branches, bool hasElse,
               Collected &out) {
    guardAssertions(conditions, branches, out);
    const std::size_t count = branches[0].equations.size();
    const bool isMatching = std::ranges::all_of(branches, [&](const Collected &branch) { return branch.equations.size() == count; });
    if (!isMatching || (!hasElse && count > 0)) {
      context_.diagnostics.report(diag::IfEquationBranches, keyword(equation.span, 2));
      out.isRight = false;
      return;
    }
    for (std::size_t i = 0; i < count; ++i)
      combineEquation(conditions, branches, i, out);
  }

  // assert(c) under the condition g is assert(not g or c); conditions of earlier branches are false.
  void guardAssertions(const std::vector<ExprPtr> &conditions, std::vector<Collected> &branches, Collected &out) {
    ExprPtr earlier;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      for (flat::Assertion &assertion : branches[b].assertions) {
        if (conditions[b] != nullptr) {
          const ExprPtr otherwise = makeUnary(flat::Operator::Not, conditions[b], assertion.span, context_.diagnostics);
          assertion.condition = makeBinary(flat::Operator::Or, otherwise, assertion.condition, assertion.span, context_.diagnostics);
        }
        if (earlier != nullptr)
          assertion.condition = makeBinary(flat::Operator::Or, earlier, assertion.condition, assertion.span, context_.diagnostics);
        out.assertions.push_back(std::move(assertion));
      }
      if (conditions[b] != nullptr)
        earlier = earlier == nullptr ? conditions[b]
                                     : makeBinary(flat::Operator::Or, earlier, conditions[b], conditions[b]->span, context_.diagnostics);
    }
  }

  [[nodiscard]] bool isSameSide(const ExprPtr &a, const ExprPtr &b) const {
    return context_.sources.text(a->span) == context_.sources.text(b->span);
  }

  // l = if c then r1 else r2 where the left sides are the same, else if c then l1 − r1 else l2 − r2 = 0.
  void combineEquation(const std::vector<ExprPtr> &conditions, const std::vector<Collected> &branches, std::size_t i, Collected &out) {
    const flat::Equation &first = branches[0].equations[i];
    const bool isSame =
        std::ranges::all_of(branches, [&](const Collected &branch) { return isSameSide(branch.equations[i].left, first.left); });
    const auto value = [&](const Collected &branch) {
      const flat::Equation &equation = branch.equations[i];
      return isSame ? equation.right
                    : makeBinary(flat::Operator::Minus, equation.left, equation.right, equation.span, context_.diagnostics);
    };
    ExprPtr result = value(branches.back());
    for (std::size_t b = branches.size() - 1; b-- > 0;)
      result = makeIf(conditions[b], value(branches[b]), result, branches[b].equations[i].span, context_.diagnostics);
    if (result == nullptr) {
      out.isRight = false;
      return;
    }
    const ExprPtr left = isSame ? first.left : broadcast(makeReal(0, first.span), result->type.dims);
    out.equations.push_back({left, result, isInitial_, first.span});
  }

  void addCall(const ast::Equation &equation, const Locals *locals, Collected &out) {
    const ast::Expr *call = equation.call;
    if (call == nullptr || call->kind != ast::ExprKind::Call) {
      out.isRight = false;
      return;
    }
    const ast::Reference &callee = call->reference;
    const std::string_view name = callee.parts.size() == 1 ? callee.parts[0].name.text : std::string_view();
    if (name == "assert")
      addAssertion(*call, locals, out);
    else
      notSupported(callee.span, fmt::format("'{}'", context_.sources.text(callee.span)), out);
  }

  void addAssertion(const ast::Expr &call, const Locals *locals, Collected &out) {
    const ast::Expr *parts[3] = {};
    static constexpr std::string_view kNames[] = {"condition", "message", "level"};
    for (std::size_t i = 0; i < std::min<std::size_t>(call.operands.size(), 3); ++i)
      parts[i] = call.operands[i];
    bool isUnknown = call.operands.size() > 3;
    for (const ast::NamedArgument &named : call.named) {
      const auto found = std::ranges::find(kNames, named.name.text);
      if (found == std::end(kNames))
        isUnknown = true;
      else
        parts[found - std::begin(kNames)] = named.value;
    }
    if (isUnknown || parts[0] == nullptr || parts[1] == nullptr) {
      context_.diagnostics.report(diag::ArgumentCount, call.span, "assert", "2 to 3 arguments", call.operands.size() + call.named.size());
      out.isRight = false;
      return;
    }
    flat::Assertion assertion;
    assertion.span = call.span;
    assertion.condition = type(*parts[0], locals);
    const ExprPtr message = type(*parts[1], locals);
    const ExprPtr level = parts[2] == nullptr ? nullptr : type(*parts[2], locals);
    if (assertion.condition == nullptr || message == nullptr || !isBoolean(*assertion.condition, parts[0]->span)) {
      out.isRight = false;
      return;
    }
    if (message->type != Type{Base::String, {}}) {
      context_.diagnostics.report(diag::ArgumentType, parts[1]->span, "a String", toString(message->type));
      out.isRight = false;
      return;
    }
    assertion.message = message->kind == flat::ExprKind::Literal ? message->text : std::string(context_.sources.text(parts[1]->span));
    assertion.isWarning = level != nullptr && level->kind == flat::ExprKind::Literal && level->values[0] == 1;
    out.assertions.push_back(std::move(assertion));
  }

  Context &context_;
  Class &scope_;
  bool isInitial_ = false;
  Collected target_;
};

}  // namespace

void flattenEquations(Context &context, Class &scope) {
  EquationFlattening::Visited visited;
  EquationFlattening(context, scope).run(visited);
}

}  // namespace tf::semantics
