// A box in space with a contact on each corner, for the forms of friction in two directions.
#pragma once

#include "tests/accuracy/support/compiled_model.h"

#include <string>

namespace tf::test {

// `parameters`: more of them, with a comma before each; `form`: attributes of the contacts' friction. `name`: of the file.
inline std::string tumblingBox(const std::string &name, const std::string &parameters, const std::string &form) {
  return sourceFile(name, "model Box\n  parameter Real h[3] = {0.3, 0.2, 0.1}, mu = 0.4, e = 0.3, v[3] = {1, 0.5, 0}, w[3] = {1, 2, 3}" +
                              parameters +
                              R"(;
  parameter Real s[8, 3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}};
  coordinate Real p[3](start = {0, 0, 1}, der(start = v));
  coordinate Rotation R(w(start = w));
  body box(mass = 2, position = p, orientation = R, inertia = 2/3*diagonal({h[2]^2 + h[3]^2, h[1]^2 + h[3]^2, h[1]^2 + h[2]^2}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real corner[8, 3] = {p + R*{s[i, 1]*h[1], s[i, 2]*h[2], s[i, 3]*h[3]} for i in 1:8};
  contact floor[8](gap = corner[:, 3], slip = {der(corner[i, 1:2]) for i in 1:8}, each friction = mu, each restitution = e, )" +
                              form + ");\nend Box;\n");
}

}  // namespace tf::test
