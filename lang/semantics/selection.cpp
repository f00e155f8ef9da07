// Selecting from arrays, broadcasting, and taking arrays apart.
#include "lang/semantics/expressions.h"

#include <algorithm>
#include <cassert>

namespace tf::semantics {

using flat::Expr;
using flat::ExprKind;
using flat::Selection;

namespace {

Selection whole(int size) {
  Selection all;
  for (int i = 1; i <= size; ++i)
    all.positions.push_back(i);
  return all;
}

bool isWhole(const Selection &selection, int size) {
  if (selection.scalar || static_cast<int>(selection.positions.size()) != size)
    return false;
  for (int i = 0; i < size; ++i)
    if (selection.positions[static_cast<std::size_t>(i)] != i + 1)
      return false;
  return true;
}

// Of an array without elements, one of its own: what it is like is all that is asked for (Typer::selection).
bool selectsFromNone(const std::vector<Selection> &selections, const std::vector<int> &dims) {
  for (std::size_t i = 0; i < dims.size(); ++i)
    if (dims[i] == 0 && !selections[i].positions.empty())
      return true;
  return false;
}

std::vector<int> selectedDims(const std::vector<Selection> &selections) {
  std::vector<int> dims;
  for (const Selection &selection : selections)
    if (!selection.scalar)
      dims.push_back(static_cast<int>(selection.positions.size()));
  return dims;
}

void gather(const std::vector<double> &values, const std::vector<int> &dims, const std::vector<Selection> &selections, std::size_t level,
            std::size_t offset, std::vector<double> &result) {
  if (level == dims.size()) {
    result.push_back(values[offset]);
    return;
  }
  for (const int position : selections[level].positions)
    gather(values, dims, selections, level + 1, offset * static_cast<std::size_t>(dims[level]) + static_cast<std::size_t>(position - 1),
           result);
}

// Selecting from an Array node selects among its parts.
ExprPtr indexArray(const Expr &array, const std::vector<Selection> &selections, Span span) {
  const std::vector<Selection> rest(selections.begin() + 1, selections.end());
  const auto part = [&](int position) {
    const ExprPtr &arg = array.args[static_cast<std::size_t>(position - 1)];
    return rest.empty() ? arg : makeIndex(arg, rest, span);
  };
  if (selections[0].scalar)
    return part(selections[0].positions[0]);
  Expr result;
  result.kind = ExprKind::Array;
  result.type = {array.type.base, selectedDims(selections)};
  result.span = span;
  for (const int position : selections[0].positions)
    result.args.push_back(part(position));
  for (const ExprPtr &arg : result.args)
    result.variability = std::max(result.variability, arg->variability);
  return share(std::move(result));
}

// The composition of two selections of one reference: `outer` selects from what `inner` selected.
std::vector<Selection> compose(const std::vector<Selection> &inner, const std::vector<Selection> &outer) {
  std::vector<Selection> result = inner;
  std::size_t next = 0;
  for (Selection &selection : result) {
    if (selection.scalar)
      continue;
    const Selection &chosen = outer[next++];
    Selection composed;
    composed.scalar = chosen.scalar;
    for (const int position : chosen.positions)
      composed.positions.push_back(selection.positions[static_cast<std::size_t>(position - 1)]);
    selection = std::move(composed);
  }
  return result;
}

}  // namespace

ExprPtr makeIndex(const ExprPtr &array, std::vector<Selection> selections, Span span) {
  if (array == nullptr || selections.empty())
    return array;
  const std::vector<int> &dims = array->type.dims;
  assert(selections.size() <= dims.size());
  while (selections.size() < dims.size())
    selections.push_back(whole(dims[selections.size()]));
  bool isAll = true;
  for (std::size_t i = 0; i < dims.size(); ++i)
    isAll = isAll && isWhole(selections[i], dims[i]);
  if (isAll)
    return array;
  const Type type{array->type.base, selectedDims(selections)};
  if (selectsFromNone(selections, dims))
    return makeBlank(type, {}, span);
  switch (array->kind) {
  case ExprKind::Literal:
    if (type.base == Base::String)
      break;
    return makeLiteral(type, selectValues(array->values, dims, selections), span);
  case ExprKind::Array:
    return indexArray(*array, selections, span);
  case ExprKind::Variable:
  case ExprKind::Attribute: {
    Expr copy = *array;
    copy.indices = copy.indices.empty() ? std::move(selections) : compose(copy.indices, selections);
    copy.type = type;
    copy.span = span;
    return share(std::move(copy));
  }
  case ExprKind::Derivative: {
    Expr copy = *array;
    copy.height = 1;
    copy.nodes = 1;
    copy.args[0] = makeIndex(copy.args[0], std::move(selections), span);
    copy.type = type;
    return share(std::move(copy));
  }
  default:
    break;
  }
  Expr result;
  result.kind = ExprKind::Index;
  result.type = type;
  result.span = span;
  result.variability = array->variability;
  result.args = {array};
  result.indices = std::move(selections);
  return share(std::move(result));
}

std::vector<double> selectValues(const std::vector<double> &values, const std::vector<int> &dims,
                                 const std::vector<Selection> &selections) {
  std::vector<double> result;
  gather(values, dims, selections, 0, 0, result);
  return result;
}

ExprPtr elementAt(const ExprPtr &array, const std::vector<int> &index, Span span) {
  std::vector<Selection> selections;
  selections.reserve(index.size());
  for (const int position : index)
    selections.push_back({{position}, true});
  return makeIndex(array, std::move(selections), span);
}

ExprPtr broadcast(const ExprPtr &value, const std::vector<int> &dims) {
  if (value == nullptr || dims.empty())
    return value;
  Type type = value->type;
  type.dims.insert(type.dims.begin(), dims.begin(), dims.end());
  const int count = sizeOf(dims);
  if (value->kind == ExprKind::Literal && type.base != Base::String) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i)
      values.insert(values.end(), value->values.begin(), value->values.end());
    return makeLiteral(std::move(type), std::move(values), value->span);
  }
  const ExprPtr inner = broadcast(value, {dims.begin() + 1, dims.end()});
  Expr result;
  result.kind = ExprKind::Array;
  result.type = std::move(type);
  result.span = value->span;
  result.variability = value->variability;
  result.args.assign(static_cast<std::size_t>(dims[0]), inner);
  return share(std::move(result));
}

std::vector<ExprPtr> scalars(const ExprPtr &value, Span span) {
  if (value == nullptr)
    return {};
  if (value->type.dims.empty())
    return {value};
  std::vector<ExprPtr> result;
  for (int i = 1; i <= value->type.dims[0]; ++i)
    for (ExprPtr &part : scalars(elementAt(value, {i}, span), span))
      result.push_back(std::move(part));
  return result;
}

}  // namespace tf::semantics
