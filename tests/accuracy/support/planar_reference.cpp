#include "tests/accuracy/support/planar_reference.h"

#include <cmath>

namespace tf::test {

namespace {

class FloorSystem {
public:
  static constexpr int size = 3;
  using Vector = Eigen::Matrix<Number, 3, 1>;

  explicit FloorSystem(const FloorBody &body) : body_(body) {}

  [[nodiscard]] int count() const { return static_cast<int>(body_.corners.size()); }
  [[nodiscard]] Eigen::Matrix<Number, 3, 3> mass(const State<6> &) const {
    return Vector(body_.mass, body_.mass, body_.inertia).asDiagonal();
  }
  [[nodiscard]] Vector force(const State<6> &) const { return {0, -body_.mass * body_.g, 0}; }
  [[nodiscard]] Number gap(int i, const State<6> &y) const { return y[1] + arm(i, y[2]).y; }
  [[nodiscard]] Vector normalRow(int i, const State<6> &y) const { return {0, 1, arm(i, y[2]).x}; }
  [[nodiscard]] Vector tangentRow(int i, const State<6> &y) const { return {1, 0, -arm(i, y[2]).y}; }
  [[nodiscard]] Number normalBias(int i, const State<6> &y) const { return -y[5] * y[5] * arm(i, y[2]).y; }
  [[nodiscard]] Number tangentBias(int i, const State<6> &y) const { return -y[5] * y[5] * arm(i, y[2]).x; }
  [[nodiscard]] Number friction(int) const { return body_.mu; }
  [[nodiscard]] Number restitution(int) const { return 0; }

private:
  struct Arm {
    Number x, y;
  };
  [[nodiscard]] Arm arm(int i, Number phi) const {
    const auto &[px, py] = body_.corners[static_cast<std::size_t>(i)];
    return {std::cos(phi) * px - std::sin(phi) * py, std::sin(phi) * px + std::cos(phi) * py};
  }

  const FloorBody &body_;
};

}  // namespace

FloorSolution solve(const FloorBody &body, const std::vector<double> &grid) {
  const FloorSystem system(body);
  return ContactReference<FloorSystem>(system, body.start, grid).run();
}

}  // namespace tf::test
