// Frames of pairs of tangential rows are turned: the new first axis is c·first + s·second, c² + s² = 1.
#pragma once

#include "runtime/contact/dense.h"

namespace tf::runtime {

// A vector's components.
inline void turnVector(double &first, double &second, double c, double s) {
  const double along = c * first + s * second;
  second = c * second - s * first;
  first = along;
}

// Rows and columns a and a + 1 of a square matrix.
inline void turnRows(DenseMatrix &matrix, int a, double c, double s) {
  const int count = matrix.rows();
  for (int r = 0; r < count; ++r)
    turnVector(matrix(r, a), matrix(r, a + 1), c, s);
  for (int r = 0; r < count; ++r)
    turnVector(matrix(a, r), matrix(a + 1, r), c, s);
}

}  // namespace tf::runtime
