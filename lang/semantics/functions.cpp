// Facts about the functions of flat expressions.
#include "lang/semantics/flat_model.h"

#include <array>

namespace tf::flat {

namespace {

constexpr std::array<std::string_view, 49> kFunctions = {
    "abs",     "sign",     "sqrt",     "sin",      "cos",          "tan",       "asin",  "acos",    "atan",
    "atan2",   "sinh",     "cosh",     "tanh",     "exp",          "log",       "log10", "div",     "mod",
    "rem",     "floor",    "ceil",     "integer",  "min",          "max",       "sum",   "product", "transpose",
    "cross",   "skew",     "diagonal", "identity", "outerProduct", "symmetric", "fill",  "scalar",  "vector",
    "matrix",  "rotate",   "rotate",   "inverse",  "rotation",     "q",         "w",     "noEvent", "smooth",
    "initial", "terminal", "pre",      "edge"};
constexpr std::array<std::string_view, 3> kMoreFunctions = {"change", "sample", "String"};

}  // namespace

std::string_view nameOf(Function function) {
  const auto at = static_cast<std::size_t>(function);
  return at < kFunctions.size() ? kFunctions[at] : kMoreFunctions[at - kFunctions.size()];
}

bool hasSeams(Function function) {
  switch (function) {
  case Function::Abs:
  case Function::Sign:
  case Function::Min:
  case Function::Max:
  case Function::Floor:
  case Function::Ceil:
  case Function::Integer:
  case Function::Div:
  case Function::Mod:
  case Function::Rem:
    return true;
  default:
    return false;
  }
}

}  // namespace tf::flat
