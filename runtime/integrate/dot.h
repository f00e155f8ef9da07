// Products of vectors in a fixed order of summation: the same bits on every run, independent partial sums where that is faster.
#pragma once

namespace tf::runtime {

// Σ a_k b_k
[[nodiscard]] inline double dot(const double *a, const double *b, int count) {
  int k = 0;
  double sum = 0;
  if (count >= 8) {
    double partial[4] = {};
    for (; k + 4 <= count; k += 4)
      for (int j = 0; j < 4; ++j)
        partial[j] += a[k + j] * b[k + j];
    sum = (partial[0] + partial[1]) + (partial[2] + partial[3]);
  }
  for (; k < count; ++k)
    sum += a[k] * b[k];
  return sum;
}

}  // namespace tf::runtime
