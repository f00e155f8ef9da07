// An example at tolerances from 1e-4 to 1e-10 against its reference. The promise (theory: "Accuracy promise"): errors of states, relative
// to max(1, |x|), and of event times are at most 10·tolerance·max(1, κ), κ the norm of the sensitivity with the jumps at events.
#pragma once

#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/tolerances/reference.h"

#include <functional>
#include <ostream>

namespace tf::test {

struct SweepCase {
  std::string name, file;
  std::function<Reference()> reference;
  Settings settings = {};
  std::function<void(CompiledModel &)> setUp = {};  // inputs
  // Starts that are parameters, where the starts themselves cannot change one by one without leaving the contacts.
  std::vector<std::string> parameters = {};
};

inline std::ostream &operator<<(std::ostream &out, const SweepCase &c) { return out << c.name; }

// The largest ratio of an error to its bound, over states and event times, of a run.
struct SweepResult {
  double stateRatio = 0, eventRatio = 0;
  std::string state = "-", event = "-";  // where that is
  std::string failure;                   // events without counterpart, a run that ended early; empty: none
};

// Sensitivities of one example by its starts, by differences of runs at a tight tolerance.
struct Sensitivity {
  std::vector<double> states;      // per sample: largest norm so far, in the scaling of the promise
  std::vector<double> events;      // per event of the reference: of its time, or of the states before it
  std::vector<double> eventTimes;  // of its time alone
};

[[nodiscard]] Sensitivity sensitivityOf(const SweepCase &sweepCase, const Reference &reference);
// The runtime's own sensitivities by every start against differences of runs: where they differ by more than the differences can be wrong,
// empty if nowhere. Runs that cannot be continued with sensitivities (through points of rest) are compared as far as they go. Starts that
// part events which coincide are left out: the solution has no derivative by them.
[[nodiscard]] std::string sensitivityMismatch(const SweepCase &sweepCase, const Reference &reference);
[[nodiscard]] SweepResult compare(const SweepCase &sweepCase, const Reference &reference, const Sensitivity &sensitivity, double tolerance,
                                  tf_integrator integrator);

}  // namespace tf::test
