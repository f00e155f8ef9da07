// Jams: a contact force grows beyond all bounds where slipping contacts press themselves in (Génot and Brogliato, Eur. J. Mech. A/Solids
// 18, 1999; Painlevé's paradox).
#pragma once

#include "runtime/contact/contact_problem.h"

#include <vector>

namespace tf::runtime {

struct Jam {
  int row = -1;
  double ratio = 0;  // response / own; among redundant rows that of the row alone
  // The acceleration of the row by its own force, with the friction of slips, the other active rows at rest: times that force it is the
  // acceleration that the row would have without it, reversed. `own`: without friction. NaN among redundant rows.
  double response = 0, own = 0;
};

// The normal rows whose forces grow beyond all bounds in a mode whose normal rows are all closed: what such a force, with the friction of
// slips taken along, does to its own acceleration, the other active rows at rest, has lost all but a thousandth of what it does without
// friction, or its sign. The one with the least left comes first.
std::vector<Jam> jammedNormals(const ContactProblem &problem, const ContactMode &mode);

}  // namespace tf::runtime
