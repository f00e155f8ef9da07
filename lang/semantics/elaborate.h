// Elaboration of classes: own elements, base classes, nested classes; and of components: their types and instances.
#pragma once

#include "lang/semantics/context.h"

namespace tf::semantics {

// Fills the root scope with the predefined classes.
void makeRoot(Context &context);

// Indexes the class's elements and splices in those of its base classes. A second call does nothing; during the first, what is already
// known can be looked up (names of base classes are found among own elements and enclosing scopes only).
void elaborate(Context &context, Class &scope);

// The name-space class of a top-level definition.
[[nodiscard]] Class &topLevelClass(Context &context, const ast::ClassDefinition &definition);

// The class that a member of kind class stands for.
[[nodiscard]] Class &nestedClass(Context &context, Class &scope, Member &member);

// A fresh class with the definition of `type` under a further modification: the type of one component (or of the model itself).
[[nodiscard]] Class &instantiateClass(Context &context, const Class &type, const ModifierPtr &modifier, Component *owner, std::string path,
                                      int arrayDepth);

// Reports children of a modifier that name no element (or attribute) of the class.
void checkModifierNames(Context &context, const ModifierPtr &modifier, Class &type, bool isCoordinate);

[[nodiscard]] std::string joinPath(std::string_view path, std::string_view name);

}  // namespace tf::semantics
