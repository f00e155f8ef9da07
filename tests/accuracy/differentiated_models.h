// Models whose runs are differentiated by several tests.
#pragma once

#include "tests/accuracy/support/compiled_model.h"

#include <functional>
#include <string>

namespace tf::test {

// A model's text, or (without spaces) the name of an example.
inline std::string fileOf(const char *model) {
  const std::string text = model;
  return text.find(' ') == std::string::npos ? example(text)
                                             : sourceFile("sensitivity" + std::to_string(std::hash<std::string>()(text)) + ".tf", text);
}

// df/dx at x, of order 4 in the step.
template <class Function> double differenceQuotient(const Function &f, double x, double step) {
  return (8 * (f(x + step) - f(x - step)) - (f(x + 2 * step) - f(x - 2 * step))) / (12 * step);
}

inline constexpr const char *kBounds =
    R"(model Bounds "a table on four legs: the least forces lie on bounds while its load goes to one end, until it tips"
  parameter Real mu[4] = {0.2, 0.45, 0.1, 0.3}, m = 1, x1 = 0.5, x4 = 0.6, vx = 3, v2 = 0.8;
  parameter Real at[4] = {-x1, 0.1, 0.4, x4};
  coordinate Real x(der(start = vx)), y, phi, d(der(start = v2));
  body table(mass = m, position = {x, y}, angle = phi, inertia = 0.2);
  body load(mass = 4, position = {x + d*cos(phi), y + d*sin(phi)}, angle = phi, inertia = 0.01);
  gravity weight(acceleration = {0, -9.81});
  contact floor[4](gap = {y + at[i]*sin(phi) - 0.5*cos(phi) + 0.5 for i in 1:4},
                   slip = {der(x + at[i]*cos(phi) + 0.5*sin(phi)) for i in 1:4}, friction = mu);
end Bounds;
)";

inline constexpr const char *kLanding = R"(model Landing "a box that slides on one corner and falls flat"
  parameter Real mu = 0.4, e = 0, v = 0.3, J = 0.1;
  parameter Real tilt = 0.05, turn = -0.2;
  coordinate Real x(der(start = v)), a(start = tilt, der(start = turn));
  coordinate Real y(start = 0.5*sin(tilt) + 0.2*cos(tilt), der(start = (0.5*cos(tilt) - 0.2*sin(tilt))*turn));
  body box(mass = 1, position = {x, y}, angle = a, inertia = J);
  gravity weight(acceleration = {0, -9.81});
  Real corner[2, 2] = {{x + s*0.5*cos(a) + 0.2*sin(a), y + s*0.5*sin(a) - 0.2*cos(a)} for s in {-1, 1}};
  contact floor[2](gap = corner[:, 2], slip = der(corner[:, 1]), each friction = mu, each restitution = e);
end Landing;
)";

}  // namespace tf::test
