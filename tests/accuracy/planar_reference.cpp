#include "tests/accuracy/planar_reference.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace tf::test {

namespace {

using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
using Column = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
using Velocity = Eigen::Matrix<Number, 3, 1>;

constexpr Number kClosed = 1e-11L;  // gaps, velocities and forces below this are zero
constexpr int kMostEvents = 60;

// What a corner does in a mode. Held is a corner that is neither open nor fully pushed while time is frozen.
enum class Normal { Open, Held, Pushed };
enum class Tangent { None, Forward, Backward, Stick };

struct CornerMode {
  Normal normal = Normal::Open;
  Tangent tangent = Tangent::None;
  bool operator==(const CornerMode &) const = default;
};

using Mode = std::vector<CornerMode>;

struct Response {
  Velocity change = Velocity::Zero();  // of the velocity, per unit of time or of numerical time
  Column normal, tangent;              // forces
};

// What ended a mode: the corner may not go on like that.
struct Cause {
  enum class Kind { None, Force, Cone } kind = Kind::None;  // its normal force vanished; it left the friction cone
  int corner = -1;
  Tangent slips = Tangent::None;  // out of the cone: where it slips to
};

class Solver {
public:
  Solver(const FloorBody &body, const std::vector<double> &grid)
      : body_(body), grid_(grid), y_(body.start), count_(static_cast<int>(body.corners.size())) {}

  FloorSolution run() {
    const Number end = grid_.back();
    solution_.validUntil = end;
    if (settle()) {
      while (t_ < end && advance(end)) {
      }
    }
    if (t_ < end) {
      solution_.validUntil = t_ - Number(1e-9);
    }
    while (solution_.samples.size() < grid_.size()) {
      solution_.samples.push_back(y_);
    }
    return solution_;
  }

private:
  struct Arm {
    Number x, y;
  };

  [[nodiscard]] Arm arm(int i, Number phi) const {
    const auto &[px, py] = body_.corners[static_cast<std::size_t>(i)];
    return {std::cos(phi) * px - std::sin(phi) * py, std::sin(phi) * px + std::cos(phi) * py};
  }
  [[nodiscard]] Number gap(int i, const State<6> &y) const { return y[1] + arm(i, y[2]).y; }
  [[nodiscard]] Number approach(int i, const State<6> &y) const { return y[4] + y[5] * arm(i, y[2]).x; }
  [[nodiscard]] Number slip(int i, const State<6> &y) const { return y[3] - y[5] * arm(i, y[2]).y; }
  [[nodiscard]] Velocity normalRow(int i, const State<6> &y) const { return {0, 1, arm(i, y[2]).x}; }
  [[nodiscard]] Velocity tangentRow(int i, const State<6> &y) const { return {1, 0, -arm(i, y[2]).y}; }
  [[nodiscard]] Velocity divideByMass(const Velocity &force) const {
    return {force[0] / body_.mass, force[1] / body_.mass, force[2] / body_.inertia};
  }

  // Forces and their effect in a mode. Frozen: no other forces, pushed corners have normal force 1. Otherwise accelerations of the contact
  // rows vanish, their velocity-dependent parts included.
  [[nodiscard]] Response respond(const Mode &mode, const State<6> &y, bool frozen) const {
    std::vector<int> normals, sticks;
    for (int i = 0; i < count_; ++i) {
      const CornerMode &corner = mode[static_cast<std::size_t>(i)];
      if (corner.normal == Normal::Held) {
        normals.push_back(i);
      }
      if (corner.tangent == Tangent::Stick) {
        sticks.push_back(i);
      }
    }
    const int n = static_cast<int>(normals.size()), size = n + static_cast<int>(sticks.size());
    Velocity base = frozen ? Velocity(Velocity::Zero()) : Velocity(0, -body_.g, 0);
    Response response{.normal = Column::Zero(count_), .tangent = Column::Zero(count_)};
    for (int i = 0; i < count_; ++i) {
      if (mode[static_cast<std::size_t>(i)].normal == Normal::Pushed) {
        response.normal[i] = 1;
        base += divideByMass(direction(mode, i, y));
      }
    }
    if (size > 0) {
      Matrix system(size, size);
      Column right(size);
      for (int r = 0; r < size; ++r) {
        const bool isNormal = r < n;
        const int i = isNormal ? normals[static_cast<std::size_t>(r)] : sticks[static_cast<std::size_t>(r - n)];
        const Velocity row = isNormal ? normalRow(i, y) : tangentRow(i, y);
        const Arm a = arm(i, y[2]);
        const Number bias = frozen ? 0 : -y[5] * y[5] * (isNormal ? a.y : a.x);
        right[r] = -row.dot(base) - bias;
        for (int c = 0; c < size; ++c) {
          const Velocity force =
              c < n ? direction(mode, normals[static_cast<std::size_t>(c)], y) : tangentRow(sticks[static_cast<std::size_t>(c - n)], y);
          system(r, c) = row.dot(divideByMass(force));
        }
      }
      Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition(system);
      decomposition.setThreshold(1e-13L);
      const Column forces = decomposition.solve(right);
      for (int c = 0; c < size; ++c) {
        (c < n ? response.normal[normals[static_cast<std::size_t>(c)]] : response.tangent[sticks[static_cast<std::size_t>(c - n)]]) =
            forces[c];
      }
    }
    for (int i = 0; i < count_; ++i) {
      const Tangent tangent = mode[static_cast<std::size_t>(i)].tangent;
      if (tangent == Tangent::Forward || tangent == Tangent::Backward) {
        response.tangent[i] = (tangent == Tangent::Forward ? -body_.mu : body_.mu) * response.normal[i];
      }
    }
    response.change = frozen ? Velocity(Velocity::Zero()) : Velocity(0, -body_.g, 0);
    for (int i = 0; i < count_; ++i) {
      response.change += divideByMass(normalRow(i, y) * response.normal[i] + tangentRow(i, y) * response.tangent[i]);
    }
    return response;
  }

  // Force per unit of normal force, slip friction included.
  [[nodiscard]] Velocity direction(const Mode &mode, int i, const State<6> &y) const {
    const Tangent tangent = mode[static_cast<std::size_t>(i)].tangent;
    const Number friction = tangent == Tangent::Forward ? -body_.mu : tangent == Tangent::Backward ? body_.mu : 0;
    return normalRow(i, y) + friction * tangentRow(i, y);
  }

  // Modes of one corner that its state allows.
  [[nodiscard]] std::vector<CornerMode> candidates(int i, bool frozen) const {
    if (gap(i, y_) > Number(1e-10) || approach(i, y_) > kClosed) {
      return {{}};
    }
    std::vector<Tangent> tangents;
    const Number s = slip(i, y_);
    if (cause_.kind == Cause::Kind::Force && cause_.corner == i && !frozen) {
      return {{}};
    }
    if (cause_.kind == Cause::Kind::Cone && cause_.corner == i && !frozen) {
      tangents = {cause_.slips};
    } else if (std::abs(s) > kClosed) {
      tangents = {s > 0 ? Tangent::Forward : Tangent::Backward};
    } else {
      tangents = {Tangent::Stick, Tangent::Forward, Tangent::Backward};
    }
    const bool approaches = approach(i, y_) < -kClosed;
    std::vector<CornerMode> result;
    if (!approaches) {
      result.push_back({});
    }
    for (const Tangent tangent : tangents) {
      if (!approaches) {
        result.push_back({Normal::Held, tangent});
      }
      if (frozen) {
        result.push_back({Normal::Pushed, tangent});
      }
    }
    return result;
  }

  [[nodiscard]] bool isConsistent(const Mode &mode, const Response &response, bool frozen) const {
    constexpr Number tolerance = 1e-9L;
    for (int i = 0; i < count_; ++i) {
      const CornerMode &corner = mode[static_cast<std::size_t>(i)];
      const bool touches = gap(i, y_) <= Number(1e-10) && approach(i, y_) <= kClosed;
      const Arm a = arm(i, y_[2]);
      const Number normalRate = normalRow(i, y_).dot(response.change) - (frozen ? 0 : y_[5] * y_[5] * a.y);
      const Number slipRate = tangentRow(i, y_).dot(response.change) - (frozen ? 0 : y_[5] * y_[5] * a.x);
      const bool slipIsZero = std::abs(slip(i, y_)) <= kClosed && (cause_.corner != i || frozen);
      if (corner.normal == Normal::Open && touches && normalRate < -tolerance) {
        return false;
      }
      if (corner.normal == Normal::Held && (response.normal[i] < tolerance || (frozen && response.normal[i] > 1 - tolerance))) {
        return false;
      }
      if (corner.normal == Normal::Pushed && approach(i, y_) >= -kClosed && normalRate >= 0) {
        return false;
      }
      if (corner.tangent == Tangent::Stick && std::abs(response.tangent[i]) > body_.mu * response.normal[i] + tolerance) {
        return false;
      }
      if (slipIsZero && corner.tangent == Tangent::Forward && slipRate <= tolerance) {
        return false;
      }
      if (slipIsZero && corner.tangent == Tangent::Backward && slipRate >= -tolerance) {
        return false;
      }
    }
    return true;
  }

  // The only mode that is consistent; nothing if there is none or if several differ in their effect.
  [[nodiscard]] std::optional<Mode> choose(bool frozen) const {
    std::vector<std::vector<CornerMode>> choices;
    for (int i = 0; i < count_; ++i) {
      choices.push_back(candidates(i, frozen));
    }
    std::vector<std::size_t> index(choices.size(), 0);
    std::optional<Mode> found;
    Velocity effect = Velocity::Zero();
    for (;;) {
      Mode mode;
      for (std::size_t i = 0; i < choices.size(); ++i) {
        mode.push_back(choices[i][index[i]]);
      }
      const Response response = respond(mode, y_, frozen);
      if (isConsistent(mode, response, frozen)) {
        if (found && (effect - response.change).norm() > Number(1e-8)) {
          return std::nullopt;
        }
        if (!found) {
          found = mode;
          effect = response.change;
        }
      }
      std::size_t digit = 0;
      while (digit < index.size() && ++index[digit] == choices[digit].size()) {
        index[digit++] = 0;
      }
      if (digit == index.size()) {
        return found;
      }
    }
  }

  [[nodiscard]] bool isFreezing() const {
    for (int i = 0; i < count_; ++i) {
      if (gap(i, y_) <= Number(1e-10) && approach(i, y_) < -kClosed) {
        return true;
      }
    }
    return false;
  }

  // One straight piece of the velocity's path while time is frozen.
  bool frozenPiece() {
    const std::optional<Mode> mode = choose(true);
    if (!mode) {
      return false;
    }
    const Response response = respond(*mode, y_, true);
    Number length = std::numeric_limits<Number>::infinity();
    const auto limit = [&](Number value, Number rate) {
      if (std::abs(value) > kClosed && value * rate < 0) {
        length = std::min(length, -value / rate);
      }
    };
    for (int i = 0; i < count_; ++i) {
      if (gap(i, y_) <= Number(1e-10)) {
        limit(approach(i, y_), normalRow(i, y_).dot(response.change));
        limit(slip(i, y_), tangentRow(i, y_).dot(response.change));
      }
    }
    if (!std::isfinite(length)) {
      return false;
    }
    for (int i = 0; i < count_; ++i) {
      const bool slipped = std::abs(slip(i, y_)) > kClosed;
      solution_.reversals +=
          slipped && gap(i, y_) <= Number(1e-10) && std::abs(slip(i, y_) + length * tangentRow(i, y_).dot(response.change)) <= kClosed;
    }
    for (int k = 0; k < 3; ++k) {
      y_[static_cast<std::size_t>(3 + k)] += length * response.change[k];
    }
    return true;
  }

  // Carries the state through a freeze and finds the mode after it. False if that cannot be done in one way.
  bool settle() {
    for (int piece = 0; isFreezing(); ++piece) {
      if (piece > 200 || !frozenPiece()) {
        return false;
      }
    }
    const std::optional<Mode> mode = choose(false);
    cause_ = {};
    if (!mode) {
      return false;
    }
    mode_ = *mode;
    int sticking = 0;
    for (const CornerMode &corner : mode_) {
      sticking += corner.tangent == Tangent::Stick;
    }
    solution_.sticks += sticking > 0;
    solution_.redundantModes += sticking > 1;
    return true;
  }

  // Least distance to an event of the current mode, negative after one, and what the event is.
  [[nodiscard]] std::pair<Number, Cause> distance(const State<6> &y) const {
    std::pair<Number, Cause> least{std::numeric_limits<Number>::infinity(), {}};
    const auto consider = [&](Number value, const Cause &cause) {
      if (value < least.first) {
        least = {value, cause};
      }
    };
    const Response response = respond(mode_, y, false);
    for (int i = 0; i < count_; ++i) {
      const CornerMode &corner = mode_[static_cast<std::size_t>(i)];
      if (corner.normal == Normal::Open) {
        consider(gap(i, y) > 0 || approach(i, y) < 0 ? gap(i, y) : Number(1), {});
      } else {
        consider(response.normal[i], {Cause::Kind::Force, i});
      }
      if (corner.tangent == Tangent::Stick) {
        consider(body_.mu * response.normal[i] - std::abs(response.tangent[i]) + Number(1e-13),
                 {Cause::Kind::Cone, i, response.tangent[i] > 0 ? Tangent::Backward : Tangent::Forward});
      } else if (corner.tangent != Tangent::None) {
        consider(corner.tangent == Tangent::Forward ? slip(i, y) : -slip(i, y), {});
      }
    }
    return least;
  }

  // To the next event and through it, or to the end. False where the solution ends.
  bool advance(Number end) {
    const auto rhs = [&](Number, const State<6> &y) {
      const Velocity a = respond(mode_, y, false).change;
      return State<6>{y[3], y[4], y[5], a[0], a[1], a[2]};
    };
    const auto stop = [&](Number, const State<6> &y) { return distance(y).first; };
    while (t_ < end) {
      // Samples stand at the ends of pieces; a piece is short against a turn of the body.
      const std::size_t next = solution_.samples.size();
      const Number target = next < grid_.size() ? std::min(end, static_cast<Number>(grid_[next])) : end;
      if (gaussUntil<6>(rhs, stop, t_, y_, target, Number(0.01))) {
        const int openNow = openCorners();
        cause_ = distance(y_).second;
        solution_.eventTimes.push_back(t_);
        if (++solution_.events > kMostEvents || (solution_.events > 3 && t_ - lastEvent_ < Number(1e-6)) || !settle()) {
          return false;
        }
        solution_.openings += openCorners() > openNow;
        lastEvent_ = t_;
        return true;
      }
      if (next < grid_.size() && t_ >= static_cast<Number>(grid_[next])) {
        solution_.samples.push_back(y_);
      }
    }
    return true;
  }

  [[nodiscard]] int openCorners() const {
    return static_cast<int>(std::ranges::count_if(mode_, [](const CornerMode &corner) { return corner.normal == Normal::Open; }));
  }

  const FloorBody &body_;
  const std::vector<double> &grid_;
  Number t_ = 0, lastEvent_ = 0;
  State<6> y_;
  int count_;
  Mode mode_;
  Cause cause_;
  FloorSolution solution_;
};

}  // namespace

FloorSolution solve(const FloorBody &body, const std::vector<double> &grid) { return Solver(body, grid).run(); }

}  // namespace tf::test
