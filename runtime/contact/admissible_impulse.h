// Impulses of contacts that stick are not unique where the contacts are redundant: the motion needs only their sum. Each piece of an impact
// has impulses within the cones (theory.md sections 3 and 6), so their sum has, too; the representative that the path was computed with
// need not have. It is replaced by the least-norm one of those that do.
#pragma once

#include "runtime/contact/conic_forces.h"
#include "runtime/contact/frozen_phase.h"

#include <vector>

namespace tf::runtime {

class AdmissibleImpulse {
public:
  // `impulse` [n + m] is that of an impact with this problem, `velocity` [n + m] that at its end. Contacts that slide at the end or have no
  // impulse keep theirs. Nothing is changed where no impulse is outside its cone by more than rounding, or where no admissible one is
  // found.
  void choose(const FrozenProblem &problem, const std::vector<double> &velocity, std::vector<double> &impulse);

private:
  struct Friction {
    int owner = 0, first = 0, second = -1;  // rows
    double coefficient = 0;
  };

  [[nodiscard]] bool leavesCones(const FrozenProblem &problem, const std::vector<double> &impulse) const;
  void chooseRows(const FrozenProblem &problem, const std::vector<double> &velocity, const std::vector<double> &impulse);

  double allowed_ = 0;  // impulses below are rounding
  std::vector<std::uint8_t> changes_;
  std::vector<int> rows_;  // that may change, ascending
  std::vector<Friction> frictions_;
  ConicForces forces_;
};

}  // namespace tf::runtime
