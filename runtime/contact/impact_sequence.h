// Contacts near the accumulation point of their impacts (theory.md section 3, Zeno): D, the accelerations φ without contact forces,
// friction and bounds are those of one instant, so that flights are parabolas and impacts are frozen phases, exactly. The motion scales:
// with all speeds and times multiplied by a factor it is a motion again. A sequence of impacts that repeats with a contracting factor
// therefore ends after a finite time, the sum of a geometric series.
#pragma once

#include "runtime/contact/contact_problem.h"
#include "runtime/contact/restitution.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tf::runtime {

// All contacts (n), and the tangential rows (m) of those with friction and of friction elements, of which slips of two
// components are no pairs here: partner and slipSign are not used. Rows without friction are never reported as sticking.
struct SequenceProblem : ContactRows {
  DenseMatrix delassus;                   // D: (n + m) × (n + m)
  std::vector<double> bias;               // φ: n + m
  std::vector<double> gap;                // n: exactly 0 where closed
  std::vector<double> velocity;           // n + m: c2 and c3; exactly 0 where closed, where sticking
  std::vector<double> rate, restitution;  // n
  std::vector<ImpactLaw> law;             // n

  void resize(int normals, int tangents);  // rates are 1, the law is Poisson's, all else 0
};

// Where infinitely many impacts end: gap and c2 of the contacts are zero from then on.
struct AccumulationPoint {
  std::vector<int> contacts;          // normal rows, ascending
  std::vector<int> sticking;          // tangential rows (0 .. m − 1) of closed contacts whose slip has ended too
  double time = 0;                    // from the begin
  double tau = 0;                     // numerical time from the begin
  std::vector<double> impulse;        // n + m: of impacts and forces since the begin
  std::vector<double> impulseMoment;  // n + m: ∫ impulse dt up to the point
  std::vector<double> frozenImpulse;  // n + m: the share of the impacts
  double loss = 0;                    // of energy in impacts: −Λᵀ(c⁻ + c⁺)/2 of each
};

// Which accumulation point of a sequence: the first one, where impacts end, or the first one where such ends accumulate in turn, each of
// whose contacts open again (a contact that comes to rest in each of the hops of another one).
enum class Accumulation : std::uint8_t { OfImpacts, OfAccumulations };

class ImpactSequence {
public:
  ImpactSequence();
  ~ImpactSequence();
  ImpactSequence(ImpactSequence &&) noexcept;
  ImpactSequence &operator=(ImpactSequence &&) noexcept;

  // The first accumulation point after which its contacts stay closed, null if there is none nearby (or an impact has no solution).
  // The pointer is valid until the next call.
  const AccumulationPoint *follow(const SequenceProblem &problem, Accumulation wanted = Accumulation::OfImpacts);

private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace tf::runtime
