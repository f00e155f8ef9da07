// Modifications: from syntax to trees, merging (outer over inner, MLS 7.2), splitting over array elements (MLS 7.2.5).
#pragma once

#include "lang/semantics/class_tree.h"

#include "lang/base/diagnostics.h"

namespace tf::semantics {

// The tree of `modification`, written in `scope`. Null if there is nothing in it. Reports what is modified twice.
[[nodiscard]] ModifierPtr makeModifier(const ast::Modification *modification, Class *scope, Diagnostics &diagnostics);

// The modifier that a `redeclare` element of a class stands for.
[[nodiscard]] ModifierPtr makeRedeclaration(const ast::Element &element, const ast::Component *component, Class *scope,
                                            Diagnostics &diagnostics);

// Union of both; `outer` wins where both say something. Reports an outer modification of what is final in `inner`.
[[nodiscard]] ModifierPtr merge(const ModifierPtr &outer, const ModifierPtr &inner, Diagnostics &diagnostics);

// The modifier of element `index` (1-based) of an array: values without `each` are indexed, `each` is dropped.
// `sizes`: the dimensions of the array.
[[nodiscard]] ModifierPtr splitForElement(const ModifierPtr &modifier, const std::vector<int> &index, const std::vector<int> &sizes);

// Values written below `depth` dimensions (those of an array type's own modification) cover the dimensions after them.
[[nodiscard]] ModifierPtr shiftDimensions(const ModifierPtr &modifier, int depth);

// The modifier of field values: a record's value `= r` gives its element `name` the value `r.name`.
[[nodiscard]] Binding projectField(const Binding &binding, std::string_view field);

}  // namespace tf::semantics
