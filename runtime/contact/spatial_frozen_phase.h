// Impacts while physical time is frozen, with slips of two components (theory.md sections 3 and 4): friction opposes v_t/‖v_t‖, which turns
// while D_tt is not isotropic, so that the velocities move on curves in contact space. Parts on which no direction turns are straight and
// followed exactly, as in the planar FrozenPhase; the others are integrated to rounding by extrapolation, in the impulses
//     P' = λ(v),   v = v⁻ + D P,
// with the zeros of c2, ‖v_t‖, force margins and stored impulses located inside the steps. At ‖v_t‖ = 0 the frictional contact problem with
// the forces that push decides: the slip stays zero, or restarts along the unit u with D_tn − μ D_tt u = k u, k > 0.
#pragma once

#include "runtime/contact/frozen_phase.h"

#include <memory>
#include <span>

namespace tf::runtime {

class SpatialFrozenPhase {
public:
  SpatialFrozenPhase();
  ~SpatialFrozenPhase();
  SpatialFrozenPhase(SpatialFrozenPhase &&) noexcept;
  SpatialFrozenPhase &operator=(SpatialFrozenPhase &&) noexcept;

  // As FrozenPhase::run; rows with a partner are slips of two components in any frame.
  const FrozenResult &run(const FrozenProblem &problem, int forced = -1);

  // The path of the last run: its breakpoints, and (FrozenEvent::Turn) the steps along its curved parts.
  [[nodiscard]] std::span<const FrozenBreakpoint> breakpoints() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace tf::runtime
