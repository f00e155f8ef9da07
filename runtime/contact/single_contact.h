// The contact problem of one contact with at most one tangential row, where its mode is clear: most instants of most models pose no other.
#pragma once

#include "runtime/contact/contact_problem.h"

namespace tf::runtime {

// In closed form. False, with `solution` unchanged: the problem has other rows, its friction is not clearly below Painlevé's limit
// (theory.md section 3), or a condition holds by less than a part 1e-6 of the problem's scale, so that its mode is to be decided by
// ContactSolver. `degeneracy`: below it, relative to that scale, a slip acceleration is zero.
bool solveSingleContact(const ContactProblem &problem, double degeneracy, ContactSolution &solution);

}  // namespace tf::runtime
