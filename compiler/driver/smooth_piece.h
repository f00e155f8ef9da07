// Scalar expressions of time alone: values, decisions at a given time, and zeros.
#pragma once

#include "lang/semantics/flat_model.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tf::driver {

// The expression without its parameters: every part that does not depend on time becomes a literal. Nothing if a part has no value.
[[nodiscard]] flat::ExprPtr foldParameters(const flat::ExprPtr &expression, const std::function<double(flat::VariableId)> &parameter);

// The value of a folded expression; NaN if it has none.
[[nodiscard]] double valueAt(const flat::ExprPtr &expression, double time);

// A function of time that decides, and a time from which on it is clear of zero: before, it may be zero but for rounding.
struct DecidingFunction {
  flat::ExprPtr function;
  double from;
};

// `expression` with all decisions (relations, branches, abs, sign, min, max, floor…) as they are just after `begin`: smooth. The functions
// of time that decide are appended to `deciding`; the decisions hold until one of them passes zero. A function that is zero at `begin` but
// for rounding decides by its sign when it has left zero, within `resolution`; one that does not leave it is zero.
[[nodiscard]] flat::ExprPtr smoothPiece(const flat::ExprPtr &expression, double begin, double resolution,
                                        std::vector<DecidingFunction> &deciding);

// The first part that would have to be decided element by element, which smoothPiece does not do; null if there is none.
[[nodiscard]] flat::ExprPtr arrayDecision(const flat::ExprPtr &expression);

// First zero of a smooth expression after `begin`, infinity if there is none up to `horizon`. Affine ones are solved; others are sampled
// every `resolution` at most (32 times in a period of a sine or cosine of an affine argument), changes of sign and dips towards zero being
// narrowed down to neighbouring doubles.
[[nodiscard]] double firstZero(const flat::ExprPtr &expression, double begin, double horizon, double resolution);

}  // namespace tf::driver
