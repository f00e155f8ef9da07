// Makes typed expressions: shapes and base types are checked here, once (MLS chapter 10.6). Null arguments give null results: the error
// was reported where the null came from.
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/semantics/flat_model.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tf::semantics {

using flat::Base;
using flat::ExprPtr;
using flat::Type;
using flat::Variability;

// Completes a node: its height and size follow from its arguments.
[[nodiscard]] ExprPtr share(flat::Expr &&expr);

[[nodiscard]] ExprPtr makeReal(double value, Span span);
[[nodiscard]] ExprPtr makeInteger(double value, Span span);
[[nodiscard]] ExprPtr makeBoolean(bool value, Span span);
[[nodiscard]] ExprPtr makeString(std::string text, Span span);
// Row-major values of an array or scalar.
[[nodiscard]] ExprPtr makeLiteral(Type type, std::vector<double> values, Span span);
// Zero, false or an empty text in all places of an array, with these leading dimensions, of elements of a type: an array that has no
// elements, or a value of which the type is all that is asked for.
[[nodiscard]] ExprPtr makeBlank(Type element, const std::vector<int> &dims, Span span);

[[nodiscard]] ExprPtr makeUnary(flat::Operator op, ExprPtr operand, Span span, Diagnostics &diagnostics);
// `isElementwise`: the dotted form of + and -, which accepts a scalar beside an array.
[[nodiscard]] ExprPtr makeBinary(flat::Operator op, ExprPtr left, ExprPtr right, Span span, Diagnostics &diagnostics,
                                 bool isElementwise = false);
[[nodiscard]] ExprPtr makeIf(ExprPtr condition, ExprPtr thenValue, ExprPtr elseValue, Span span, Diagnostics &diagnostics);
// Stacks equal types along a new first dimension.
[[nodiscard]] ExprPtr makeArray(std::vector<ExprPtr> parts, Span span, Diagnostics &diagnostics);
// `isChecked` calls: the type is given.
[[nodiscard]] ExprPtr makeCall(flat::Function function, Type type, std::vector<ExprPtr> arguments, Span span);
[[nodiscard]] ExprPtr makeDerivative(ExprPtr operand, Span span);
[[nodiscard]] ExprPtr makeConcatenation(std::vector<ExprPtr> parts, int axis, Span span, Diagnostics &diagnostics);

// Selects; positions must lie within the dimensions. Selections beyond those given take the whole dimension. Array and literal nodes are
// selected from at once.
[[nodiscard]] ExprPtr makeIndex(const ExprPtr &array, std::vector<flat::Selection> selections, Span span);
// One element along the leading dimensions, 1-based.
[[nodiscard]] ExprPtr elementAt(const ExprPtr &array, const std::vector<int> &index, Span span);
// The same value for each element of the leading `dims`.
[[nodiscard]] ExprPtr broadcast(const ExprPtr &value, const std::vector<int> &dims);
// Integer to Real, nothing else changes.
[[nodiscard]] ExprPtr toReal(const ExprPtr &value);
// The scalars of an array, row-major.
[[nodiscard]] std::vector<ExprPtr> scalars(const ExprPtr &value, Span span);

// Row-major values of what `selections` (one per dimension) select.
[[nodiscard]] std::vector<double> selectValues(const std::vector<double> &values, const std::vector<int> &dims,
                                               const std::vector<flat::Selection> &selections);

// Values of Variable nodes, their indices applied.
using VariableValues = std::function<std::optional<std::vector<double>>(const flat::Expr &reference)>;
[[nodiscard]] std::optional<std::vector<double>> evaluateExpression(const flat::Expr &expression, double time,
                                                                    const VariableValues &variable);

[[nodiscard]] int sizeOf(const std::vector<int> &dims);
// "Real[2, 3]"
[[nodiscard]] std::string toString(const Type &type);
// The dimensions as written: without the four numbers of a Rotation.
[[nodiscard]] std::vector<int> visibleDims(const Type &type);
// One Rotation, not an array of them.
[[nodiscard]] inline bool isRotation(const Type &type) { return type.base == Base::Rotation && type.dims.size() == 1; }
// Whether a value of type `from` may stand where `to` is wanted, dimensions aside.
[[nodiscard]] bool isConvertible(Base from, Base to);
[[nodiscard]] inline bool isNumeric(Base base) { return base == Base::Real || base == Base::Integer; }

}  // namespace tf::semantics
