#include "compiler/driver/input_expression.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/smooth_piece.h"
#include "lang/semantics/instantiate.h"
#include "lang/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string>

namespace tf::driver {

namespace {

using runtime::ModelInstance;

constexpr int samples = 2048;  // of a run

// Known names get ids in order of their first use; what they are is looked at after typing, where their spans are known.
class Scope {
public:
  explicit Scope(const ModelInstance &instance) : instance_(instance) {}

  std::optional<int> resolve(const std::string &name) {
    const auto reference = instance_.find(name);
    if (!reference)
      return std::nullopt;
    references_.push_back(*reference);
    return static_cast<int>(references_.size()) - 1;
  }

  [[nodiscard]] std::vector<std::string> parameterNames() const {
    std::vector<std::string> names = {"time"};
    const tf_model &model = instance_.model();
    for (std::int32_t i = 0; i < model.variable_count; ++i) {
      if (model.variables[i].kind == TF_KIND_PARAMETER)
        names.emplace_back(model.variables[i].name);
    }
    return names;
  }

  // Reports everything but functions of time and parameters, and notes these.
  void check(const flat::Expr &expression, const SourceManager &sources, Diagnostics &diagnostics) {
    if (expression.kind == flat::ExprKind::Derivative ||
        (expression.kind == flat::ExprKind::Call && expression.function == flat::Function::Initial)) {
      diagnostics.report(diag::NotInExpression, expression.span, sources.text(expression.span));
      return;
    }
    if (expression.kind == flat::ExprKind::Variable) {
      if (const tf_variable &used = variable(expression.variable); used.kind == TF_KIND_PARAMETER)
        uses_.push_back({used.index, expression.span});
      else
        diagnostics.report(diag::NotInExpression, expression.span, used.name);
    }
    for (const flat::ExprPtr &argument : expression.args)
      check(*argument, sources, diagnostics);
  }

  [[nodiscard]] double value(flat::VariableId id) const {
    const double parameter = instance_.parameters()[static_cast<std::size_t>(variable(id).index)];
    return references_[static_cast<std::size_t>(id)].sign * parameter;
  }

  [[nodiscard]] const std::vector<InputExpression::Use> &uses() const { return uses_; }

private:
  [[nodiscard]] const tf_variable &variable(flat::VariableId id) const {
    return instance_.model().variables[references_[static_cast<std::size_t>(id)].variable];
  }

  const ModelInstance &instance_;
  std::vector<ModelInstance::Reference> references_;
  std::vector<InputExpression::Use> uses_;
};

// Boolean quantities take relations, all others numbers.
void checkType(const flat::Expr &typed, const std::string &name, const ModelInstance &instance, Diagnostics &diagnostics) {
  const auto reference = instance.find(name);
  const bool wantsBoolean = reference && (instance.model().variables[reference->variable].flags & TF_BOOLEAN) != 0;
  const bool isBoolean = typed.type.base == flat::Base::Boolean;
  if (wantsBoolean != isBoolean)
    diagnostics.report(diag::SettingType, typed.span, name, wantsBoolean ? "Boolean" : "Real", isBoolean ? "Boolean" : "Real");
}

// Where a value that the input may not have is taken first, of as many as are looked at for switches; empty: nowhere.
std::string outOfBounds(const flat::ExprPtr &expression, const std::string &name, const ModelInstance &instance, double from, double to) {
  const auto reference = instance.find(name);
  if (!reference)
    return {};
  const tf_variable &variable = instance.model().variables[reference->variable];
  for (int k = 0; k <= samples; ++k) {
    const double time = from + (to - from) * k / samples, value = reference->sign * valueAt(expression, time);
    if (!std::isfinite(value))
      continue;
    if (const auto checked = instance.checkValue(reference->variable, value, variable.name); !checked)
      return fmt::format("{} at time = {}", checked.error(), number(time));
  }
  return {};
}

}  // namespace

std::optional<InputExpression> InputExpression::parse(const std::string &name, const std::string &text, const ModelInstance &instance,
                                                      double startTime, double horizon, Session &session) {
  Diagnostics &diagnostics = session.diagnostics;
  const int errors = diagnostics.errorCount();
  const FileId file = session.sources.add(kSettingPrefix + name, text);
  Scope scope(instance);
  const flat::ExprPtr typed = typeExpression(
      session.sources, file, [&](const std::string &variable) { return scope.resolve(variable); }, scope.parameterNames(), diagnostics);
  if (typed) {
    scope.check(*typed, session.sources, diagnostics);
    checkType(*typed, name, instance, diagnostics);
  }
  if (!typed || diagnostics.errorCount() > errors)
    return std::nullopt;

  flat::ExprPtr folded = foldParameters(typed, [&](flat::VariableId id) { return scope.value(id); });
  if (folded) {
    if (const flat::ExprPtr part = arrayDecision(folded)) {
      diagnostics.report(diag::ArrayDecision, part->span, session.sources.text(part->span));
      return std::nullopt;
    }
  }
  if (!folded || !std::isfinite(valueAt(folded, startTime))) {
    diagnostics.report(diag::NotEvaluable, typed->span, name, number(startTime));
    return std::nullopt;
  }
  if (const std::string reason = outOfBounds(folded, name, instance, startTime, horizon); !reason.empty()) {
    diagnostics.report(diag::RefusedSetting, {}, name + "=" + text, reason);
    return std::nullopt;
  }
  return InputExpression(std::move(folded), scope.uses(), startTime, horizon);
}

InputExpression::InputExpression(flat::ExprPtr expression, std::vector<Use> uses, double startTime, double horizon)
    : expression_(std::move(expression)), uses_(std::move(uses)), resolution_((horizon - startTime) / samples), horizon_(horizon) {
  append(startTime);
}

void InputExpression::append(double from) {
  std::vector<DecidingFunction> deciding;
  Piece piece{from, std::numeric_limits<double>::infinity(), smoothPiece(expression_, from, resolution_, deciding)};
  for (const DecidingFunction &one : deciding)
    piece.to = std::min(piece.to, firstZero(one.function, one.from, horizon_, resolution_));
  pieces_.push_back(std::move(piece));
}

const InputExpression::Piece &InputExpression::pieceAt(double time) {
  while (pieces_.back().to <= time)
    append(pieces_.back().to);
  const auto next =
      std::upper_bound(pieces_.begin() + 1, pieces_.end(), time, [](double value, const Piece &piece) { return value < piece.from; });
  return *(next - 1);
}

double InputExpression::value(double time, double segment) { return valueAt(pieceAt(segment).smooth, time); }

double InputExpression::nextBreakpoint(double time) { return pieceAt(time).to; }

}  // namespace tf::driver
