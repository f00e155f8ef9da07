// An input given as an expression of time and parameters: `--set 'u[2]=if time < 1 then 0 else 2*g*(time-1)'`.
//
// Between the points where a relation, abs, sign, min, max, floor, ceil, integer, div, mod or rem switches the expression is smooth: these
// points are the input's breakpoints. Inside a piece all such decisions are those of a time strictly inside it, so that values up to and at
// the piece's ends are those of its smooth continuation.
#pragma once

#include "compiler/driver/session.h"
#include "lang/semantics/flat_model.h"
#include "runtime/model/model_instance.h"

#include <optional>
#include <string>
#include <vector>

namespace tf::driver {

class InputExpression {
public:
  // Parses and types the text, a scalar expression; parameters have the values that `instance` has now. Nothing if it is wrong (reported;
  // the text's name in diagnostics is "--set NAME"). Breakpoints are sought up to `horizon`, those that are not found in closed form at a
  // resolution of `horizon - startTime` by 2048, finer where sines and cosines are faster.
  static std::optional<InputExpression> parse(const std::string &name, const std::string &text, const runtime::ModelInstance &instance,
                                              double startTime, double horizon, Session &session);

  // A parameter's place in the text.
  struct Use {
    std::int32_t parameter;  // of ModelInstance::parameters()
    Span span;
  };
  [[nodiscard]] const std::vector<Use> &uses() const { return uses_; }
  [[nodiscard]] bool isConstant() const { return expression_->kind == flat::ExprKind::Literal; }
  // The value at `time` of the smooth piece that `segment` lies in; NaN where it cannot be computed.
  double value(double time, double segment);
  // The first breakpoint after `time`; infinity if there is none up to the horizon.
  double nextBreakpoint(double time);

private:
  // The expression with all decisions of a time inside the piece made.
  struct Piece {
    double from, to;  // `to`: where one of the decisions changes
    flat::ExprPtr smooth;
  };

  InputExpression(flat::ExprPtr expression, std::vector<Use> uses, double startTime, double horizon);

  void append(double from);
  // The piece that the time lies in; the one that begins there at a breakpoint.
  const Piece &pieceAt(double time);

  flat::ExprPtr expression_;  // parameters folded: what is no literal depends on time
  std::vector<Use> uses_;
  double resolution_, horizon_;
  std::vector<Piece> pieces_;  // in order, without gaps, as far as they were asked for
};

}  // namespace tf::driver
