#include "tests/benchmarks/hand_written/chain_equations.h"

#include <cmath>

namespace tf::hand_written {

// Centre of rod i: r + sum_j c_ij e_j with c_ij = l before i, l/2 at i. With first[j] = sum_i m c_ij and second[j][k] = sum_i m c_ij c_ik:
// M_xj = -first[j] sin_j, M_yj = first[j] cos_j, M_jk = second[j][k] cos(phi_j - phi_k) (+ the rod's own inertia).
void chainDynamics(const ChainParameters &p, const double *q, const double *v, double *mass, double *force) {
  const double ml = p.m * p.l, mll = ml * p.l, total = 3 * p.m;
  const double first[3] = {2.5 * ml, 1.5 * ml, 0.5 * ml};
  const double second[3][3] = {{2.25 * mll, 1.5 * mll, 0.5 * mll}, {1.5 * mll, 1.25 * mll, 0.5 * mll}, {0.5 * mll, 0.5 * mll, 0.25 * mll}};
  const double own = mll / 12;
  double c[3], s[3], ww[3];
  for (int j = 0; j < 3; ++j) {
    c[j] = std::cos(q[2 + j]);
    s[j] = std::sin(q[2 + j]);
    ww[j] = v[2 + j] * v[2 + j];
  }
  const double torque[4] = {0, p.d * (v[3] - v[2]), p.d * (v[4] - v[3]), 0};
  mass[0] = mass[6] = total;
  mass[1] = mass[5] = 0;
  force[0] = 0;
  force[1] = -total * p.g;
  for (int k = 0; k < 3; ++k) {
    mass[2 + k] = mass[10 + 5 * k] = -first[k] * s[k];
    mass[7 + k] = mass[11 + 5 * k] = first[k] * c[k];
    force[0] += first[k] * ww[k] * c[k];
    force[1] += first[k] * ww[k] * s[k];
    double f = -first[k] * p.g * c[k] + torque[k + 1] - torque[k];
    for (int j = 0; j < 3; ++j) {
      mass[12 + 5 * k + j] = j == k ? second[k][k] + own : second[k][j] * (c[k] * c[j] + s[k] * s[j]);
      f += second[k][j] * ww[j] * (c[k] * s[j] - s[k] * c[j]);
    }
    force[2 + k] = f;
  }
}

void chainContacts(const ChainParameters &p, const double *q, const double *v, double *normal, double *normalBias, double *tangent,
                   double *tangentBias) {
  for (int i = 0; i < 20; ++i) {
    normal[i] = tangent[i] = 0;
  }
  normalBias[0] = tangentBias[0] = 0;
  normal[1] = tangent[0] = 1;
  for (int node = 1; node < 4; ++node) {
    const double c = p.l * std::cos(q[1 + node]), s = p.l * std::sin(q[1 + node]), ww = v[1 + node] * v[1 + node];
    for (int below = node; below < 4; ++below) {
      normal[5 * below + 1 + node] = c;
      tangent[5 * below + 1 + node] = -s;
    }
    normal[5 * node + 1] = tangent[5 * node] = 1;
    normalBias[node] = normalBias[node - 1] - s * ww;
    tangentBias[node] = tangentBias[node - 1] - c * ww;
  }
}

}  // namespace tf::hand_written
