// Impacts while physical time is frozen (theory.md section 3): the velocities of all contacts in the active set follow the sum of the
// auxiliary fields of the contacts that push. v' is constant between the zeros of c2_i, c3_i and of what contacts store for their
// restitution (restitution.h), so the path is piecewise linear and is followed from breakpoint to breakpoint without step size or
// tolerance.
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/restitution.h"

#include <memory>
#include <span>
#include <vector>

namespace tf::runtime {

// Rows of the contacts with gap ≤ tol only. Friction elements have no impulse and do not take part: owner[j] ≥ 0. slipSign and bound of
// ContactRows are not used.
struct FrozenProblem : ContactRows {
  DenseMatrix delassus;                // D: (n + m) × (n + m)
  std::vector<double> normalVelocity;  // n: c2
  std::vector<double> slipVelocity;    // m: c3
  std::vector<double> rate;            // n: a_n > 0
  std::vector<double> restitution;     // n: ε ≥ 0
  std::vector<ImpactLaw> law;          // n
  double resolution = 0;               // velocities below are rounding

  void resize(int normals, int tangents);  // rates are 1, the law is Poisson's, all else 0
};

enum class FrozenEvent : std::uint8_t {
  Start,
  Separation,     // the contact of the row pushes no longer: c2 has reached 0 (Newton: its target), or nothing is stored any more
  Restitution,    // c2 of the row has reached 0, the contact goes on pushing by what it has stored
  Held,           // c2 of the row has reached 0 and stays there, held between other contacts (push fractional)
  Recompression,  // c2 of the row falls below 0 again, or for the first time
  Stick,          // c3 of the row has reached 0 and stays
  Reversal,       // c3 of the row has changed its sign, or leaves 0
  Discard,        // nothing moves any more: what contacts have stored is of no use to them
  Turn,           // a step along a curved part of the path (spatial_frozen_phase.h)
  Accumulation    // very many breakpoints have been summed, infinitely many where they accumulate
};

// The state where a piece of the path begins.
struct FrozenBreakpoint {
  double tau = 0;  // from the begin of the phase
  FrozenEvent event = FrozenEvent::Start;
  int row = -1;                  // 0 .. n + m − 1
  std::vector<double> velocity;  // n + m: c2, c3
  std::vector<double> impulse;   // n + m: since the begin
  std::vector<double> force;     // n + m: on the piece that begins here (push_i a_i, and tangential)
};

enum class FrozenStatus : std::uint8_t {
  Finished,
  Cycle,      // breakpoints repeat without end and without contraction, or exceed the limit (see `rows`)
  Unbounded,  // contacts push forever: they have no mobility left, as between closing walls (see `rows`)
  Unsettled   // no successor of a breakpoint was found (see `rows`)
};

struct FrozenResult {
  FrozenStatus status = FrozenStatus::Finished;
  double duration = 0;           // numerical time of the phase
  std::vector<double> impulse;   // n + m: total
  std::vector<double> velocity;  // n + m: final c2, c3; exactly 0 where held
  std::vector<int> rows;         // normal rows that do not come to an end
  int breakpointCount = 0;       // of the path; `breakpoints` keeps the first 1000
  bool leavesApproach = false;   // contacts that no impulse can part still approach, slowly; their final c2 is 0 all the same
};

class FrozenPhase {
public:
  struct Settings {
    bool sumTails = true;  // sum repeating breakpoints; else they are followed one by one, down to rounding
    int breakpointLimit = 100000;
  };

  FrozenPhase();
  explicit FrozenPhase(const Settings &settings);
  ~FrozenPhase();
  FrozenPhase(FrozenPhase &&) noexcept;
  FrozenPhase &operator=(FrozenPhase &&) noexcept;

  // Follows the path to its end: all c2 ≥ 0, nothing pushes and nothing is stored. `forced` ≥ 0 is a normal row whose contact pushes
  // although its c2 is 0: the frictional impulse of Painlevé's paradox, D_s < 0 (theory.md section 3); nothing happens if that would not
  // press it in further. The reference is valid until the next call.
  const FrozenResult &run(const FrozenProblem &problem, int forced = -1);

  // The path of the last run, its begin first; linear between neighbours.
  [[nodiscard]] std::span<const FrozenBreakpoint> breakpoints() const;

private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace tf::runtime
