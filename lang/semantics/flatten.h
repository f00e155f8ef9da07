// From the instance tree to the flat model.
#pragma once

#include "lang/semantics/context.h"

namespace tf::semantics {

// Variables, elements and equations of the model instance and of everything inside it.
void flattenModel(Context &context, Class &model);

// Equations, initial equations and assertions of one class and its bases (flatten_equations.cpp).
void flattenEquations(Context &context, Class &scope);

// Replaces structural parameters by their values, orders the variables as declared (finish.cpp).
void finishModel(Context &context, const std::vector<flat::VariableId> &declared);

// Rules that need the whole model: parameters that define one another, accelerations fixed by equations (model_rules.cpp).
void checkModel(Context &context);

// Warnings about units that clash (unit_rules.cpp).
void checkUnits(const flat::FlatModel &model, Diagnostics &diagnostics);

}  // namespace tf::semantics
