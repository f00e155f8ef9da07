#include "runtime/contact/contact_problem.h"

namespace tf::runtime {

void ContactRows::resize(int normals, int tangents) {
  normalCount = normals;
  tangentCount = tangents;
  owner.assign(tangents, -1);
  friction.assign(tangents, 0.0);
  bound.assign(tangents, 0.0);
  slipSign.assign(tangents, 0);
}

void ContactProblem::resize(int normals, int tangents) {
  ContactRows::resize(normals, tangents);
  delassus.setZero(count(), count());
  bias.assign(count(), 0.0);
}

void ContactMode::resize(int normals, int tangents) {
  closed.assign(normals, 0);
  slip.assign(tangents, 0);
}

}  // namespace tf::runtime
