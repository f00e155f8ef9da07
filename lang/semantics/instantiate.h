// From syntax trees to a FlatModel: lookup, modification merging, instantiation, typing, constant evaluation.
#pragma once

#include "lang/base/diagnostics.h"
#include "lang/semantics/flat_model.h"

#include <functional>
#include <map>

namespace tf {

struct InstantiateOptions {
  std::string model;                                  // --model; empty: the only candidate of the given files
  std::vector<std::string> libraries;                 // -L, in order; the standard library's folder comes last
  std::map<std::string, double> structuralOverrides;  // --set on parameters, by full name; only structural ones are read here
};

struct Instantiation {
  std::optional<flat::FlatModel> model;  // absent if there were errors
  std::vector<std::string> candidates;   // when no model was named and there is not exactly one
  std::vector<std::string> files;        // every file that was read, in order (the cache's key)
};

// Reads `files` (paths) and the library files that they refer to. Errors are reported to `diagnostics`.
[[nodiscard]] Instantiation instantiate(SourceManager &sources, const std::vector<std::string> &files, const InstantiateOptions &options,
                                        Diagnostics &diagnostics);

// Types a free-standing scalar expression of `time` and named quantities (`--set u=…`): `resolve` maps a full name such as "arm.k" or
// "k[2]" to a number that becomes a Variable node with that id, or nothing if unknown (reported, with a suggestion out of `names`).
[[nodiscard]] flat::ExprPtr typeExpression(SourceManager &sources, FileId file,
                                           const std::function<std::optional<int>(const std::string &)> &resolve,
                                           const std::vector<std::string> &names, Diagnostics &diagnostics);

// Value of a scalar or array expression, row-major; `variable` gives the scalars of a Variable node. Nothing if it cannot be evaluated.
[[nodiscard]] std::optional<std::vector<double>>
evaluate(const flat::Expr &expression, double time, const std::function<std::optional<std::vector<double>>(flat::VariableId)> &variable);

}  // namespace tf
