// The equations of motion of examples/chain.tf (three rods) as an engineer would write them after working them out on paper.
#pragma once

namespace tf::hand_written {

struct ChainParameters {
  double m = 0, l = 0, d = 0, g = 0;  // mass and length of a rod, joint damping, gravity
};

// q, v: x, y of the first node and the three angles, and their rates. Out: M [5 x 5, row-major, both halves], f [5].
void chainDynamics(const ChainParameters &p, const double *q, const double *v, double *mass, double *force);

// Normal and tangential rows of the four nodes [4 x 5 each] and their biases [4 each].
void chainContacts(const ChainParameters &p, const double *q, const double *v, double *normal, double *normalBias, double *tangent,
                   double *tangentBias);

}  // namespace tf::hand_written
