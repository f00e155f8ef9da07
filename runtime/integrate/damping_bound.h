// How fast damping makes velocities die out.
#pragma once

#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tf::runtime {

// A bound of the spectral radius of the accelerations' derivatives by the velocities, in 1/s: the largest sum of a row's magnitudes, in
// units of `scale` [n]. `jacobian` [n × n, column-major] is that of the state's rate.
inline double dampingBound(const tf_model &model, const double *jacobian, int n, const double *scale) {
  double bound = 0;
  for (int i = model.nq; i < model.nq + model.nv; ++i) {
    double sum = 0;
    for (int j = model.nq; j < model.nq + model.nv; ++j)
      sum += std::abs(jacobian[static_cast<std::size_t>(j) * n + i]) * scale[j];
    bound = std::max(bound, sum / scale[i]);
  }
  return bound;
}

}  // namespace tf::runtime
