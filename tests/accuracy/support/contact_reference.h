// Reference solution of a system with few degrees of freedom and planar contacts (normal and one tangential direction), for any sequence of
// modes: event-driven in long double, with the mode after every event found by trying all of them. Slow, and independent of the project's
// contact solvers.
//
// A system has
//   static constexpr int size;                            degrees of freedom, q' = v
//   int count() const;                                    contacts
//   Matrix mass(y) const;  Vector force(y) const;         M v' = force + contact forces
//   Number gap(int i, y) const;
//   Vector normalRow(int i, y) const;                     gap rate = row·v
//   Vector tangentRow(int i, y) const;                    slip = row·v
//   Number normalBias(int i, y) const;                    derivative of the gap rate less row·v'
//   Number tangentBias(int i, y) const;                   the same of the slip
//   Number friction(int i) const;
//   Number restitution(int i) const;                      Newton's; positive only where no other contact takes part in the impact
// with y = (q, v) of type State<2 * size>, Eigen's matrices of Number.
#pragma once

#include "tests/accuracy/support/gauss_reference.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

namespace tf::test {

template <int N> struct ContactSolution {
  std::vector<State<2 * N>> samples;  // at the grid's times
  Number validUntil = 0;              // beyond it impacts accumulate, or the next mode is not unique
  int events = 0;
  std::vector<Number> eventTimes;
  int redundantModes = 0, reversals = 0, openings = 0, sticks = 0;  // what the motion went through
};

template <class System> class ContactReference {
public:
  static constexpr int size = System::size;
  using Vector = Eigen::Matrix<Number, size, 1>;
  using FullState = State<2 * size>;

  // `grid`: ascending times, the last one is the end; `step`: short against the motion, so that no event is missed.
  ContactReference(const System &system, const FullState &start, const std::vector<double> &grid, int mostEvents = 60, Number step = 0.01L)
      : system_(system), grid_(grid), mostEvents_(mostEvents), step_(step), y_(start), count_(system.count()),
        target_(static_cast<std::size_t>(system.count()), 0) {}

  ContactSolution<size> run() {
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
  static constexpr Number kClosed = 1e-11L;  // gaps, velocities and forces below this are zero

  // What a contact does in a mode. Held is one that is neither open nor fully pushed while time is frozen.
  enum class Normal { Open, Held, Pushed };
  enum class Tangent { None, Forward, Backward, Stick };

  struct ContactMode {
    Normal normal = Normal::Open;
    Tangent tangent = Tangent::None;
    bool operator==(const ContactMode &) const = default;
  };
  using Mode = std::vector<ContactMode>;
  using MassMatrix = Eigen::Matrix<Number, size, size>;
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  using Column = Eigen::Matrix<Number, Eigen::Dynamic, 1>;

  struct Response {
    Vector change = Vector::Zero();  // of the velocity, per unit of time or of numerical time
    Column normal, tangent;          // forces
  };

  // What ended a mode: the contact may not go on like that.
  struct Cause {
    enum class Kind { None, Force, Cone } kind = Kind::None;  // its normal force vanished; it left the friction cone
    int contact = -1;
    Tangent slips = Tangent::None;  // out of the cone: where it slips to
  };

  [[nodiscard]] static Vector velocity(const FullState &y) {
    Vector v;
    for (int k = 0; k < size; ++k)
      v[k] = y[static_cast<std::size_t>(size + k)];
    return v;
  }
  [[nodiscard]] Number gap(int i, const FullState &y) const { return system_.gap(i, y); }
  [[nodiscard]] Number approach(int i, const FullState &y) const { return normalRow(i, y).dot(velocity(y)); }
  [[nodiscard]] Number slip(int i, const FullState &y) const { return tangentRow(i, y).dot(velocity(y)); }
  [[nodiscard]] Vector normalRow(int i, const FullState &y) const { return system_.normalRow(i, y); }
  [[nodiscard]] Vector tangentRow(int i, const FullState &y) const { return system_.tangentRow(i, y); }

  // Forces and their effect in a mode. Frozen: no other forces, pushed contacts have normal force 1. Otherwise accelerations of the contact
  // rows vanish, their velocity-dependent parts included.
  [[nodiscard]] Response respond(const Mode &mode, const FullState &y, bool frozen) const {
    std::vector<int> normals, sticks;
    for (int i = 0; i < count_; ++i) {
      const ContactMode &contact = mode[static_cast<std::size_t>(i)];
      if (contact.normal == Normal::Held) {
        normals.push_back(i);
      }
      if (contact.tangent == Tangent::Stick) {
        sticks.push_back(i);
      }
    }
    const int n = static_cast<int>(normals.size()), unknowns = n + static_cast<int>(sticks.size());
    const MassMatrix inverse = system_.mass(y).inverse();
    const Vector free = frozen ? Vector(Vector::Zero()) : Vector(inverse * system_.force(y));
    Vector base = free;
    Response response{.normal = Column::Zero(count_), .tangent = Column::Zero(count_)};
    for (int i = 0; i < count_; ++i) {
      if (mode[static_cast<std::size_t>(i)].normal == Normal::Pushed) {
        response.normal[i] = 1;
        base += inverse * direction(mode, i, y);
      }
    }
    if (unknowns > 0) {
      Matrix system(unknowns, unknowns);
      Column right(unknowns);
      for (int r = 0; r < unknowns; ++r) {
        const bool isNormal = r < n;
        const int i = isNormal ? normals[static_cast<std::size_t>(r)] : sticks[static_cast<std::size_t>(r - n)];
        const Vector row = isNormal ? normalRow(i, y) : tangentRow(i, y);
        const Number bias = frozen ? 0 : isNormal ? system_.normalBias(i, y) : system_.tangentBias(i, y);
        right[r] = -row.dot(base) - bias;
        for (int c = 0; c < unknowns; ++c) {
          const Vector force =
              c < n ? direction(mode, normals[static_cast<std::size_t>(c)], y) : tangentRow(sticks[static_cast<std::size_t>(c - n)], y);
          system(r, c) = row.dot(inverse * force);
        }
      }
      Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition(system);
      decomposition.setThreshold(1e-13L);
      const Column forces = decomposition.solve(right);
      for (int c = 0; c < unknowns; ++c) {
        (c < n ? response.normal[normals[static_cast<std::size_t>(c)]] : response.tangent[sticks[static_cast<std::size_t>(c - n)]]) =
            forces[c];
      }
    }
    for (int i = 0; i < count_; ++i) {
      const Tangent tangent = mode[static_cast<std::size_t>(i)].tangent;
      if (tangent == Tangent::Forward || tangent == Tangent::Backward) {
        response.tangent[i] = (tangent == Tangent::Forward ? -1 : 1) * system_.friction(i) * response.normal[i];
      }
    }
    response.change = free;
    for (int i = 0; i < count_; ++i) {
      response.change += inverse * (normalRow(i, y) * response.normal[i] + tangentRow(i, y) * response.tangent[i]);
    }
    return response;
  }

  // Force per unit of normal force, slip friction included.
  [[nodiscard]] Vector direction(const Mode &mode, int i, const FullState &y) const {
    const Tangent tangent = mode[static_cast<std::size_t>(i)].tangent;
    const Number friction = tangent == Tangent::Forward ? -system_.friction(i) : tangent == Tangent::Backward ? system_.friction(i) : 0;
    return normalRow(i, y) + friction * tangentRow(i, y);
  }

  // Modes of one contact that its state allows.
  [[nodiscard]] std::vector<ContactMode> candidates(int i, bool frozen) const {
    const bool restores = frozen && target_[static_cast<std::size_t>(i)] > 0;
    if (!restores && (gap(i, y_) > Number(1e-10) || approach(i, y_) > kClosed)) {
      return {{}};
    }
    std::vector<Tangent> tangents;
    const Number s = slip(i, y_);
    if (cause_.kind == Cause::Kind::Force && cause_.contact == i && !frozen) {
      return {{}};
    }
    if (cause_.kind == Cause::Kind::Cone && cause_.contact == i && !frozen) {
      tangents = {cause_.slips};
    } else if (std::abs(s) > kClosed) {
      tangents = {s > 0 ? Tangent::Forward : Tangent::Backward};
    } else {
      tangents = {Tangent::Stick, Tangent::Forward, Tangent::Backward};
    }
    const bool approaches = restores || approach(i, y_) < -kClosed;
    std::vector<ContactMode> result;
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
      const ContactMode &contact = mode[static_cast<std::size_t>(i)];
      const bool touches = gap(i, y_) <= Number(1e-10) && approach(i, y_) <= kClosed;
      const Number normalRate = normalRow(i, y_).dot(response.change) + (frozen ? 0 : system_.normalBias(i, y_));
      const Number slipRate = tangentRow(i, y_).dot(response.change) + (frozen ? 0 : system_.tangentBias(i, y_));
      const bool slipIsZero = std::abs(slip(i, y_)) <= kClosed && (cause_.contact != i || frozen);
      if (contact.normal == Normal::Open && touches && normalRate < -tolerance) {
        return false;
      }
      if (contact.normal == Normal::Held && (response.normal[i] < tolerance || (frozen && response.normal[i] > 1 - tolerance))) {
        return false;
      }
      if (contact.normal == Normal::Pushed && target_[static_cast<std::size_t>(i)] == 0 && approach(i, y_) >= -kClosed && normalRate >= 0) {
        return false;
      }
      if (contact.tangent == Tangent::Stick && std::abs(response.tangent[i]) > system_.friction(i) * response.normal[i] + tolerance) {
        return false;
      }
      if (slipIsZero && contact.tangent == Tangent::Forward && slipRate <= tolerance) {
        return false;
      }
      if (slipIsZero && contact.tangent == Tangent::Backward && slipRate >= -tolerance) {
        return false;
      }
    }
    return true;
  }

  // The only mode that is consistent; nothing if there is none or if several differ in their effect.
  [[nodiscard]] std::optional<Mode> choose(bool frozen) const {
    std::vector<std::vector<ContactMode>> choices;
    for (int i = 0; i < count_; ++i) {
      choices.push_back(candidates(i, frozen));
    }
    std::vector<std::size_t> index(choices.size(), 0);
    std::optional<Mode> found;
    Vector effect = Vector::Zero();
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

  [[nodiscard]] bool touches(int i) const { return gap(i, y_) <= Number(1e-10); }
  [[nodiscard]] bool isFreezing() const {
    for (int i = 0; i < count_; ++i) {
      if (target_[static_cast<std::size_t>(i)] > 0 || (gap(i, y_) <= Number(1e-10) && approach(i, y_) < -kClosed)) {
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
      if (Number &target = target_[static_cast<std::size_t>(i)]; target > 0)
        limit(approach(i, y_) - target, normalRow(i, y_).dot(response.change));
    }
    if (!std::isfinite(length)) {
      return false;
    }
    for (int i = 0; i < count_; ++i) {
      const bool slipped = std::abs(slip(i, y_)) > kClosed;
      solution_.reversals +=
          slipped && gap(i, y_) <= Number(1e-10) && std::abs(slip(i, y_) + length * tangentRow(i, y_).dot(response.change)) <= kClosed;
    }
    for (int k = 0; k < size; ++k) {
      y_[static_cast<std::size_t>(size + k)] += length * response.change[k];
    }
    for (int i = 0; i < count_; ++i)
      if (Number &target = target_[static_cast<std::size_t>(i)]; approach(i, y_) >= target - kClosed)
        target = 0;
    return true;
  }

  // Newton's restitution: a contact pushes until its gap rate is the given share of that before the impact, reversed.
  void aim() {
    for (int i = 0; i < count_; ++i)
      if (touches(i) && approach(i, y_) < -kClosed)
        target_[static_cast<std::size_t>(i)] = -system_.restitution(i) * approach(i, y_);
  }

  // Carries the state through a freeze and finds the mode after it. False if that cannot be done in one way.
  bool settle() {
    aim();
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
    for (const ContactMode &contact : mode_) {
      sticking += contact.tangent == Tangent::Stick;
    }
    solution_.sticks += sticking > 0;
    solution_.redundantModes += sticking > 1;
    return true;
  }

  // Least distance to an event of the current mode, negative after one, and what the event is.
  [[nodiscard]] std::pair<Number, Cause> distance(const FullState &y) const {
    std::pair<Number, Cause> least{std::numeric_limits<Number>::infinity(), {}};
    const auto consider = [&](Number value, const Cause &cause) {
      if (value < least.first) {
        least = {value, cause};
      }
    };
    const Response response = respond(mode_, y, false);
    for (int i = 0; i < count_; ++i) {
      const ContactMode &contact = mode_[static_cast<std::size_t>(i)];
      if (contact.normal == Normal::Open) {
        consider(gap(i, y) > 0 || approach(i, y) < 0 ? gap(i, y) : Number(1), {});
      } else {
        consider(response.normal[i], {Cause::Kind::Force, i});
      }
      if (contact.tangent == Tangent::Stick) {
        consider(system_.friction(i) * response.normal[i] - std::abs(response.tangent[i]) + Number(1e-13),
                 {Cause::Kind::Cone, i, response.tangent[i] > 0 ? Tangent::Backward : Tangent::Forward});
      } else if (contact.tangent != Tangent::None) {
        consider(contact.tangent == Tangent::Forward ? slip(i, y) : -slip(i, y), {});
      }
    }
    return least;
  }

  // To the next event and through it, or to the end. False where the solution ends.
  bool advance(Number end) {
    const auto rhs = [&](Number, const FullState &y) {
      const Vector a = respond(mode_, y, false).change;
      FullState slope;
      for (int k = 0; k < size; ++k) {
        slope[static_cast<std::size_t>(k)] = y[static_cast<std::size_t>(size + k)];
        slope[static_cast<std::size_t>(size + k)] = a[k];
      }
      return slope;
    };
    const auto stop = [&](Number, const FullState &y) { return distance(y).first; };
    while (t_ < end) {
      // Samples stand at the ends of pieces; a piece is short against a turn of the body.
      const std::size_t next = solution_.samples.size();
      const Number target = next < grid_.size() ? std::min(end, static_cast<Number>(grid_[next])) : end;
      if (gaussUntil<2 * size>(rhs, stop, t_, y_, target, step_)) {
        const int openNow = openContacts();
        cause_ = distance(y_).second;
        solution_.eventTimes.push_back(t_);
        if (++solution_.events > mostEvents_ || (solution_.events > 3 && t_ - lastEvent_ < Number(1e-6)) || !settle()) {
          return false;
        }
        solution_.openings += openContacts() > openNow;
        lastEvent_ = t_;
        return true;
      }
      if (next < grid_.size() && t_ >= static_cast<Number>(grid_[next])) {
        solution_.samples.push_back(y_);
      }
    }
    return true;
  }

  [[nodiscard]] int openContacts() const {
    return static_cast<int>(std::ranges::count_if(mode_, [](const ContactMode &contact) { return contact.normal == Normal::Open; }));
  }

  const System &system_;
  const std::vector<double> &grid_;
  int mostEvents_;
  Number step_;
  Number t_ = 0, lastEvent_ = 0;
  FullState y_;
  int count_;
  std::vector<Number> target_;  // gap rates at which a freeze ends, 0 for none
  Mode mode_;
  Cause cause_;
  ContactSolution<size> solution_;
};

}  // namespace tf::test
