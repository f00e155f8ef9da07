#include "compiler/driver/input_expression.h"
#include "compiler/driver/diagnostics.h"
#include "compiler/driver/smooth_piece.h"
#include "lang/semantics/instantiate.h"
#include "lang/syntax/parser.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::driver {

namespace {

using runtime::ModelInstance;

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

  // Reports everything but parameters.
  void check(const flat::Expr &expression, Diagnostics &diagnostics) const {
    if (expression.kind == flat::ExprKind::Variable && variable(expression.variable).kind != TF_KIND_PARAMETER)
      diagnostics.report(diag::NotInExpression, expression.span, variable(expression.variable).name);
    for (const flat::ExprPtr &argument : expression.args)
      check(*argument, diagnostics);
  }

  [[nodiscard]] double value(flat::VariableId id) const {
    const double parameter = instance_.parameters()[static_cast<std::size_t>(variable(id).index)];
    return references_[static_cast<std::size_t>(id)].sign * parameter;
  }

private:
  [[nodiscard]] const tf_variable &variable(flat::VariableId id) const {
    return instance_.model().variables[references_[static_cast<std::size_t>(id)].variable];
  }

  const ModelInstance &instance_;
  std::vector<ModelInstance::Reference> references_;
};

// Boolean quantities take relations, all others numbers.
void checkType(const flat::Expr &typed, const std::string &name, const ModelInstance &instance, Diagnostics &diagnostics) {
  const auto reference = instance.find(name);
  const bool wantsBoolean = reference && (instance.model().variables[reference->variable].flags & TF_BOOLEAN) != 0;
  const bool isBoolean = typed.type.base == flat::Base::Boolean;
  if (wantsBoolean != isBoolean)
    diagnostics.report(diag::SettingType, typed.span, name, wantsBoolean ? "Boolean" : "Real", isBoolean ? "Boolean" : "Real");
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
    scope.check(*typed, diagnostics);
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
  return InputExpression(std::move(folded), startTime, horizon);
}

InputExpression::Piece InputExpression::pieceAt(double segment) const {
  Piece piece{segment, std::numeric_limits<double>::infinity(), nullptr, {}};
  piece.smooth = smoothPiece(expression_, segment, piece.switching);
  for (const flat::ExprPtr &function : piece.switching)
    piece.to = std::min(piece.to, firstZero(function, segment, horizon_, resolution_));
  return piece;
}

double InputExpression::value(double time, double segment) {
  if (!piece_ || segment < piece_->from || segment >= piece_->to)
    piece_ = pieceAt(segment);
  return valueAt(piece_->smooth, time);
}

double InputExpression::nextBreakpoint(double time) {
  // Just after `time`: far enough that a decision that falls at `time` itself is made, near enough that none is passed over.
  const double segment = time + 1e-12 * std::max(1.0, std::abs(time));
  if (!piece_ || segment < piece_->from || segment >= piece_->to)
    piece_ = pieceAt(segment);
  return piece_->to;
}

}  // namespace tf::driver
