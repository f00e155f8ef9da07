// The contact problem of a state, for a choice of rows: here alone it is assembled, for the choice of a mode among the contacts that touch,
// and in the mode that has been chosen.
#pragma once

#include "runtime/contact/force_set.h"
#include "runtime/integrate/row_system.h"

#include <memory>
#include <vector>

namespace tf::runtime {

// Contact forces that are known to be exact where the accelerations of rows that they hold are so by rounding only [nc], [nt]; and the
// magnitude that they are zero relative to.
struct SettledForces {
  std::vector<double> normal, tangent;
  double scale = 0;
};

struct ContactSystem {
  RowSystem rows;
  ContactProblem problem;

  // See RowSystem::choose.
  void choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents) {
    problem.resize(static_cast<int>(contacts.size()), static_cast<int>(tangents.size()));
    rows.choose(model, contacts, tangents, problem);
  }
  [[nodiscard]] bool hasRows(const std::vector<int> &contacts, const std::vector<int> &tangents) const {
    return contacts == rows.contacts() && tangents == rows.tangents();
  }

  // At the evaluation's point, where the dynamics and the contact terms have been called, in this order: J, friction and bounds;
  void gather(const ModelEvaluation &at) { rows.gather(at, problem); }
  // D;
  void respond(const ModelEvaluation &at) { rows.respond(at, problem.delassus); }
  // the acceleration without the forces of the rows [nv], φ and, where the rows have just been chosen, its load.
  void setBias(const ModelEvaluation &at, double *freeAcceleration);
  // φ of the rows that do not slip becomes that with which these forces hold them exactly, in the problem nearby where they do. Returns the
  // forces of the rows.
  std::vector<double> settle(const SettledForces &settled, const ContactMode &mode);
};

// The contact problem at the point of the evaluation, all of it, and what has been found of its forces (see ModeForces::start): a mode of
// the same rows that begins there begins with them.
struct SolvedContacts {
  const ContactSystem &system;
  const std::vector<double> &freeAcceleration;
  std::unique_ptr<ForceSet> &forces;
  const SettledForces *settled = nullptr;  // for modes of other rows, too
};

}  // namespace tf::runtime
