// The frictional contact problem in contact space, at acceleration level: contacts with slips of one or two components.
//
// Rows: n normal rows, then m tangential rows. Forces λ = (λ_n, λ_t), row accelerations w = D λ + φ with D = J W Jᵀ symmetric positive
// semidefinite (theory.md section 1). The conditions:
//   normal row i:      0 ≤ λ_n,i ⟂ w_i ≥ 0
//   tangential row j:  limit_j = μ_j λ_n,owner (of a contact) or bound_j (owner −1: a friction element)
//     slipSign_j ≠ 0:  λ_t = −slipSign·limit
//     slipSign_j = 0:  |λ_t| ≤ limit with w_t = 0, or λ_t = −limit·sign(w_t)
//   pair of rows (partner_j ≥ 0), the slip of two components:
//     slipSign_j ≠ 0 of both: the first row lies along the slip (slipSign 1), the second across it carries no force (friction, bound 0)
//     slipSign_j = 0 of both: ‖λ_t‖ ≤ limit with w_t = 0, or λ_t = −limit·w_t/‖w_t‖ (theory.md section 4)
// Units are the model's own; all tolerances are relative to the scale of the problem in the metric of D.
#pragma once

#include "runtime/contact/dense.h"

#include <cstdint>
#include <vector>

namespace tf::runtime {

// Whether a slip hardly depends on any velocity (its gradient vanishes at the point), from the diagonal of D in its row and in the normal
// row of its contact: no force that friction may have changes its acceleration.
[[nodiscard]] constexpr bool isInertSlip(double ownResponse, double normalResponse) {
  constexpr double vanishing = 1e-18;
  return ownResponse <= vanishing * normalResponse;
}

// A slip of a friction element whose acceleration would take forces to hold it that are so many times larger than those of all other rows,
// in the metric of D, is at a dead centre: its derivative by the velocities is zero but for rounding.
inline constexpr double deadCentre = 1e6;

// Which rows there are and what their friction is.
struct ContactRows {
  int normalCount = 0;           // n
  int tangentCount = 0;          // m
  std::vector<int> owner;        // m: normal row of the contact, or −1 for a friction element
  std::vector<double> friction;  // m: μ ≥ 0 where owner ≥ 0
  std::vector<double> bound;     // m: ≥ 0 where owner = −1
  std::vector<int> slipSign;     // m: sign of the slip velocity: −1, 0, 1
  std::vector<int> partner;      // m: the other row of a pair (the next or the previous one), or −1

  [[nodiscard]] int count() const { return normalCount + tangentCount; }
  [[nodiscard]] double limit(int j, const double *forces) const { return owner[j] >= 0 ? friction[j] * forces[owner[j]] : bound[j]; }
  // Row j begins a pair whose slip is zero, so that the direction of its friction is open.
  [[nodiscard]] bool isDisk(int j) const { return partner[j] > j && slipSign[j] == 0; }
  // Row j lies across the slip of its pair: it carries no friction, whatever becomes of the coefficient.
  [[nodiscard]] bool isAcross(int j) const { return partner[j] >= 0 && partner[j] < j && slipSign[j] != 0; }
  [[nodiscard]] bool hasDisks() const;
  [[nodiscard]] bool hasPairs() const;
  // New rows have owner −1, no friction, bound 0, no slip and no partner.
  void resize(int normals, int tangents);
};

struct ContactProblem : ContactRows {
  DenseMatrix delassus;      // D: (n + m) × (n + m)
  std::vector<double> bias;  // φ: n + m
  // √(aᵀ M a), a the acceleration without the forces, in the units of φ_r/√D_rr: the part of these that a makes is no larger
  // (Cauchy–Schwarz), and where loads cancel the rest is rounded relative to it. 0: not known.
  double load = 0;

  // D and φ are zero afterwards, and there is no load.
  void resize(int normals, int tangents);
  // No force changes the acceleration of tangential row j, the slip's only one, noticeably: isInertSlip, or, of friction
  // elements, a dead centre.
  [[nodiscard]] bool isInert(int j) const;
  // Turns the frame of the pair that begins with tangential row j: the new first row is c·first + s·second, c² + s² = 1.
  void turnPair(int j, double c, double s);
};

// Which inequalities hold as equations. A tangential row of an open contact carries no force; its entry is ignored.
struct ContactMode {
  std::vector<std::uint8_t> closed;    // n: 1 closed (w_n = 0), 0 open (λ_n = 0)
  std::vector<std::int8_t> slip;       // m: 0 stick (w_t = 0), ±1 slip in that direction (λ_t = ∓limit); both rows of a pair have the same
  std::vector<double> direction = {};  // m: of slipping pairs, the unit vector of the slip in their frame; else undefined

  void resize(int normals, int tangents);  // new rows are open and stick
  bool operator==(const ContactMode &other) const { return closed == other.closed && slip == other.slip; }
};

// A side of a force's admissible set. Normal row: λ_n ≥ 0 (side 0). Tangential row: limit − λ_t ≥ 0 (side 1), limit + λ_t ≥ 0 (side −1).
// First row of a pair: limit − ‖λ_t‖ ≥ 0 (side 2).
struct ForceLimit {
  static constexpr int disk = 2;
  int row = 0;  // 0 .. n + m − 1
  int side = 0;
  bool operator==(const ForceLimit &) const = default;
};

enum class ContactStatus : std::uint8_t {
  Solved,
  Inconsistent,  // no solution, or none that could be found: Painlevé; see ContactSolution::forced
  Indeterminate  // solutions with different accelerations; the most open one is taken
};

struct ContactSolution {
  ContactStatus status = ContactStatus::Solved;
  ContactMode mode;
  std::vector<double> forces;         // λ: n + m
  std::vector<double> accelerations;  // w: n + m
  // Certificate: the largest violation of any of the conditions, relative to the scale of the problem.
  double violation = 0;
  double scale = 0;                   // of forces times √D_rr and accelerations divided by it: what `degeneracy` is relative to
  bool redundant = false;             // D is singular on the active rows: λ is the least-norm one
  std::vector<ForceLimit> saturated;  // redundant: limits on which the least-norm λ lies within the mode
  std::vector<int> degenerate;        // rows decided by the next derivative only (ContactSolver::resolve)
  // Inconsistent: the normal row whose contact would start a frictional impulse. Indeterminate: the first one with D_s < 0.
  int forced = -1;
};

}  // namespace tf::runtime
