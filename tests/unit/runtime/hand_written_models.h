// Compiled models as a person would write them, with all functions of runtime/abi/tf_model.h: for tests of the runtime without the
// compiler. All are checked against finite differences (tests/unit/runtime/model/hand_written_models_test.cpp). The models live for the
// whole program.
#pragma once

#include "runtime/abi/tf_model.h"

namespace tf::runtime::test {

// Point mass above a rough floor: q = (q[1], q[2]), u = (u[1], u[2]) an applied force, contact `floor` with gap q[2] and slip der(q[1]).
// Parameters m = 1, g = 9.81, mu = 0, e = 0, weight = m*g (bound), rate = weight/m (bound to a bound one: binding depth 2). Starts (0, 1),
// (0, 0). Aliases x = q[1], vy = der(q[2]), depth = -q[2]. Output `energy` = kinetic energy.
const tf_model &particleModel();

// The same mass on a floor in three dimensions: q = (q[1], q[2], q[3]), contact `floor` with gap q[3] and slip der(q[1:2]). Parameters m =
// 1, g = 9.81, mu = 0.5, e = 0, rate = 1; input u[3]. Starts (0, 0, 0), (3, 4, 0).
const tf_model &particle3dModel();

// Mass on a spring, dragged by a belt: q = (x), friction element `dry` with slip der(x) - belt and bound mu*N; m = 1, k = 4, N = 2, mu =
// 0.5, belt = 0.3. Starts 0 and 0.3.
const tf_model &beltModel();

// z = (x, z): x' = -2 sign(x) + k cos(time), z' = sign(x), one sliding switch x > 0; k = 1, starts (1, 0).
const tf_model &relayModel();

// Planar rigid bodies q = (x, y, th) with contact points that are fixed to the body, floor y = 0, slip of a point = its horizontal
// velocity. Parameters m, J, g = 9.81, mu, e = 0, rate = 1. Of the reference trajectories: falling rod, m = 1, J = 1/12, points `left`
// (-0.5, 0) and `right` (0.5, 0), mu = 0.3; q0 = (0, 0.5 sin(pi/4) + 0.5, pi/4), v0 = (2, 0, 0).
const tf_model &rodModel();
// falling box, m = 1, J = 1.36/12, corners `corner[1]` (-0.5, -0.3), `corner[2]` (0.5, -0.3), `corner[3]` (0.5, 0.3), `corner[4]` (-0.5,
// 0.3), mu = 0.2; q0 = (0, 1, 0.9), v0 = (3, 0, 4).
const tf_model &boxModel();

}  // namespace tf::runtime::test
