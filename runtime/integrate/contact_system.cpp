#include "runtime/integrate/contact_system.h"

namespace tf::runtime {

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
