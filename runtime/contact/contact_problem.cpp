#include "runtime/contact/contact_problem.h"

#include "runtime/contact/frame_turns.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void ContactRows::resize(int normals, int tangents) {
  normalCount = normals;
  tangentCount = tangents;
  owner.assign(tangents, -1);
  friction.assign(tangents, 0.0);
  bound.assign(tangents, 0.0);
  slipSign.assign(tangents, 0);
  partner.assign(tangents, -1);
}

bool ContactProblem::isInert(int j) const {
  const int row = normalCount + j;
  if (partner[j] >= 0)
    return false;
  if (owner[j] >= 0)
    return isInertSlip(delassus(row, row), delassus(owner[j], owner[j]));
  double largest = 0;
  for (int other = 0; other < count(); ++other) {
    const double response = std::sqrt(delassus(other, other));
    if (other != row && response > 0)
      largest = std::max(largest, std::abs(bias[other]) / response);
    if (other >= normalCount && owner[other - normalCount] < 0)
      largest = std::max(largest, bound[other - normalCount] * response);
  }
  return largest > 0 && std::abs(bias[row]) > deadCentre * largest * std::sqrt(std::max(0.0, delassus(row, row)));
}

bool ContactRows::hasDisks() const {
  for (int j = 0; j < tangentCount; ++j)
    if (isDisk(j))
      return true;
  return false;
}

bool ContactRows::hasPairs() const {
  return std::any_of(partner.begin(), partner.end(), [](int other) { return other >= 0; });
}

void ContactProblem::resize(int normals, int tangents) {
  ContactRows::resize(normals, tangents);
  delassus.setZero(count(), count());
  bias.assign(count(), 0.0);
  load = 0;
}

void ContactProblem::turnPair(int j, double c, double s) {
  const int a = normalCount + j;
  turnRows(delassus, a, c, s);
  turnVector(bias[a], bias[a + 1], c, s);
}

void ContactMode::resize(int normals, int tangents) {
  closed.assign(normals, 0);
  slip.assign(tangents, 0);
  direction.assign(tangents, 0.0);
}

}  // namespace tf::runtime
