#include "runtime/integrate/contact_system.h"

#include "runtime/integrate/dot.h"

#include <cmath>

namespace tf::runtime {

void ContactSystem::setBias(const ModelEvaluation &at, double *freeAcceleration) {
  at.mobility.accelerate(at.force.data(), at.constraintBias.data(), freeAcceleration);
  rows.bias(at, freeAcceleration, problem.bias);
  if (problem.load == 0)
    problem.load = std::sqrt(std::abs(dot(at.force.data(), freeAcceleration, at.model().nv)));
}

std::vector<double> ContactSystem::settle(const SettledForces &settled, const ContactMode &mode) {
  const int normals = problem.normalCount, count = problem.count();
  std::vector<double> forces(static_cast<std::size_t>(count));
  for (int i = 0; i < normals; ++i)
    forces[i] = settled.normal[rows.contacts()[i]];
  for (int j = 0; j < problem.tangentCount; ++j)
    forces[normals + j] = rows.tangentValue(settled.tangent.data(), 1, j);
  for (int row = 0; row < count; ++row) {
    if (row >= normals && mode.slip[row - normals] != 0)
      continue;
    problem.bias[row] = 0;
    for (int c = 0; c < count; ++c)
      problem.bias[row] -= problem.delassus(row, c) * forces[c];
  }
  return forces;
}

}  // namespace tf::runtime
