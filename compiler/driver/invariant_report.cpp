#include "compiler/driver/invariant_report.h"

#include "compiler/driver/diagnostics.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>

namespace tf::driver {

namespace {

// One invariant: how it is called, its worst value (positive: a violation) and what is allowed.
struct Check {
  std::string text;
  double violation, allowed, time;
};

std::string at(const char *what, const char *element, double value) { return fmt::format("{} of {:.3g} in '{}'", what, value, element); }

std::string estimated(const tf_statistics &s) {
  return s.estimated_energy_time > 0
             ? fmt::format(", estimated over {} of time that could not be evaluated everywhere,", number(s.estimated_energy_time))
             : "";
}

}  // namespace

void reportInvariants(tf_simulation *simulation, double tolerance, Session &session) {
  constexpr double positionRounding = 1e-9, forceRounding = 1e-8;
  // Forces that begin at zero end their contacts where they pull by the tolerance.
  constexpr double pulls = 2;
  const tf_model &model = *tf_get_model(simulation);
  const tf_statistics &s = *tf_get_statistics(simulation);
  std::vector<Check> checks;
  if (s.worst_gap_contact >= 0) {
    const tf_contact &contact = model.contacts[s.worst_gap_contact];
    checks.push_back(
        {at("least gap", contact.name, s.worst_gap), -s.worst_gap, positionRounding * std::max(1.0, contact.nominal), s.worst_gap_time});
  }
  if (s.worst_normal_force_contact >= 0)
    checks.push_back({at("least normal force", model.contacts[s.worst_normal_force_contact].name, s.worst_normal_force),
                      -s.worst_normal_force, std::max(forceRounding, pulls * tolerance * s.largest_normal_force),
                      s.worst_normal_force_time});
  if (s.worst_constraint_element >= 0) {
    const tf_constraint &constraint = model.constraints[s.worst_constraint_element];
    checks.push_back({at("largest residual", constraint.name, s.worst_constraint), s.worst_constraint,
                      positionRounding * std::max(1.0, constraint.nominal), s.worst_constraint_time});
  }
  if (model.nv > 0)
    checks.push_back({fmt::format("largest error of {:.3g} in the energy balance{}", s.worst_energy_error, estimated(s)),
                      s.worst_energy_error, std::max(1e-7, 100 * tolerance), s.worst_energy_error_time});
  for (const Check &check : checks) {
    fmt::print(stderr, "{} at time = {}\n", check.text, number(check.time));
    if (!(check.violation <= check.allowed))
      session.diagnostics.report(diag::InvariantViolated, {}, check.text, number(check.time), fmt::format("{:.3g}", check.allowed));
  }
}

}  // namespace tf::driver
