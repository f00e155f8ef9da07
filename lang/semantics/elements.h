// Mechanical elements (language.md section 3): their attributes, results and rules.
#pragma once

#include "lang/semantics/context.h"
#include "lang/semantics/expressions.h"

namespace tf::semantics {

// The typed value of an attribute, with the element's dimensions followed by its own shape; its default where there is one; null if it is
// not given or wrong (reported).
[[nodiscard]] ExprPtr attributeOf(Context &context, Component &element, const AttributeSpec &spec);

// `name.attribute` or `name.result`, for all elements of an array of them. An attribute that is given is replaced by its value.
[[nodiscard]] ExprPtr typeElementPart(Context &context, Component &element, const ast::Name &part, Span span);

// Fills the flat element's attributes and checks the element's rules.
void flattenElement(Context &context, Component &element);

// The modifier that gives the attribute, or null.
[[nodiscard]] const Modifier *givenAttribute(const Component &element, std::string_view name);

// Rules about what an attribute's value depends on (element_rules.cpp).
void checkDependencies(Context &context, const Component &element, const AttributeSpec &spec, const flat::Expr &value, Span span);

}  // namespace tf::semantics
