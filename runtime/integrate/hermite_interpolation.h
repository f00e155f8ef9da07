// The motion inside a step, out of the states and rates at its ends.
#pragma once

namespace tf::runtime {

// Arrays of `size` entries; the first `integrals` ones are those whose derivatives are the next `integrals` ones: coordinates with q' = v.
struct StepEnds {
  const double *begin, *beginRate, *end, *endRate;
  double length;
  int size, integrals;
};

// y [size] at the part theta in [0, 1] of the step. Integrals: the polynomial of degree 5 with the values, derivatives and second
// derivatives of both ends, and its derivative; other variables: the cubic with values and rates.
void interpolateBetween(const StepEnds &step, double theta, double *y);

}  // namespace tf::runtime
