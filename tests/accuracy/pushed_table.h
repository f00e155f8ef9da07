// A table on four feet of which a growing force pushes one corner: it stands, then slides.
#pragma once

#include <string>

namespace tf::test {

// `frictionForm`: Exact or Polyhedral.
[[nodiscard]] inline std::string pushedTable(const std::string &frictionForm) {
  return R"(model PushedTable
  parameter Real mu = 0.4, F = 30;
  parameter Real feet[4, 3] = {{-0.6, -0.4, -0.7}, {-0.6, 0.4, -0.7}, {0.6, -0.4, -0.7}, {0.6, 0.4, -0.7}};
  coordinate Real p[3](start = {0, 0, 0.7});
  coordinate Rotation Q;
  body table(mass = 10, position = p, orientation = Q, inertia = diagonal({0.53, 1.2, 1.7}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real foot[4, 3] = {p + Q*feet[i, :] for i in 1:4};
  contact leg[4](gap = foot[:, 3], slip = der(foot[:, 1:2]), each friction = mu, each frictionForm = FrictionForm.)" +
         frictionForm + R"();
  force push(value = {F*time, 0, 0}, at = p + Q*{-0.6, 0.4, 0});
end PushedTable;
)";
}

}  // namespace tf::test
