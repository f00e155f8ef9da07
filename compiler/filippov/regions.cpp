// Regions of Stewart's form, and the verifier of the sum form against them.
#include "compiler/filippov/filippov_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace tf::filippov {

using ir::NodeId;

namespace {

// Steps of friction elements and switches that a field depends on, conditions of step variables aside: in each region they are 0 or 1.
std::vector<std::set<std::size_t>> innerSteps(const FilippovSystem &filippov, const HybridSystem &system) {
  std::vector<std::set<std::size_t>> all;
  for (const Field &field : filippov.fields) {
    std::set<std::size_t> steps;
    const auto collect = [&](const std::vector<NodeId> &nodes) {
      for (const auto &symbols : ir::dependencies(system.graph, nodes))
        for (const ir::Symbol symbol : symbols)
          for (std::size_t k = 0; k < filippov.steps.size(); ++k)
            if (system.graph[filippov.steps[k].variable].symbol == symbol)
              steps.insert(k);
    };
    collect(field.force);
    collect(field.stateDerivatives);
    all.push_back(std::move(steps));
  }
  return all;
}

// The fields that add up where the signs are as given: of all contacts that push, or f_ODE.
std::vector<int> activeFields(const FilippovSystem &filippov, const std::vector<int> &signs) {
  std::vector<int> active;
  for (std::size_t f = 1; f < filippov.fields.size(); ++f) {
    const Field &field = filippov.fields[f];
    bool isActive = true;
    for (std::size_t k = 0; k < filippov.steps.size(); ++k) {
      const StepFunction &step = filippov.steps[k];
      if (step.owner != field.contact)
        continue;
      if (step.role == StepRole::Gap || step.role == StepRole::GapRate)
        isActive = isActive && signs[k] < 0;
      if (step.role == StepRole::Slip && step.direction == field.direction && field.side != 0)
        isActive = isActive && signs[k] * field.side < 0;
    }
    if (isActive)
      active.push_back(static_cast<int>(f));
  }
  return active.empty() ? std::vector<int>{0} : active;
}

std::vector<double> coefficients(const FilippovSystem &filippov, const HybridSystem &system,
                                 const std::function<double(std::size_t)> &alpha) {
  std::vector<NodeId> nodes;
  nodes.reserve(filippov.terms.size());
  for (const Term &term : filippov.terms)
    nodes.push_back(term.coefficient);
  return ir::evaluate(system.graph, nodes, [&](ir::Symbol symbol) {
    for (std::size_t k = 0; k < filippov.steps.size(); ++k)
      if (system.graph[filippov.steps[k].variable].symbol == symbol)
        return alpha(k);
    return std::nan("");
  });
}

// On the vertices of the cube of step variables, θ selects the fields of the region.
std::string verifyVertices(const FilippovSystem &filippov, HybridSystem &system) {
  for (const Region &region : regions(filippov, system)) {
    const std::vector<double> theta = coefficients(filippov, system, [&](std::size_t k) { return region.signs[k] > 0 ? 1.0 : 0.0; });
    for (std::size_t t = 0; t < theta.size(); ++t) {
      const bool isActive = std::ranges::find(region.active, filippov.terms[t].field) != region.active.end();
      if (theta[t] != (isActive ? 1 : 0))
        return fmt::format("the coefficient of {} is {} in a region where it should be {}",
                           filippov.fields[static_cast<std::size_t>(filippov.terms[t].field)].name, theta[t], isActive ? 1 : 0);
    }
  }
  return {};
}

}  // namespace

std::vector<Region> regions(const FilippovSystem &filippov, HybridSystem &system) {
  const std::size_t count = filippov.steps.size();
  if (count > static_cast<std::size_t>(kEnumerationLimit))
    return {};
  const std::vector<std::set<std::size_t>> inner = innerSteps(filippov, system);
  std::map<std::vector<int>, int> modes;
  std::vector<Region> all;
  for (std::size_t row = 0; row < std::size_t{1} << count; ++row) {
    Region region;
    for (std::size_t k = 0; k < count; ++k)
      region.signs.push_back((row >> (count - 1 - k)) % 2 == 0 ? 1 : -1);
    region.active = activeFields(filippov, region.signs);
    std::vector<int> key = region.active;
    std::set<std::size_t> relevant;
    for (const int field : region.active)
      relevant.insert(inner[static_cast<std::size_t>(field)].begin(), inner[static_cast<std::size_t>(field)].end());
    key.push_back(-1);
    for (const std::size_t k : relevant)
      key.push_back(region.signs[k]);
    region.mode = modes.try_emplace(std::move(key), static_cast<int>(modes.size())).first->second;
    all.push_back(std::move(region));
  }
  return all;
}

std::string verify(const FilippovSystem &filippov, HybridSystem &system) {
  if (filippov.fields.empty() || !filippov.fields[0].timeRuns)
    return "the first field must be f_ODE";
  for (const Field &field : filippov.fields)
    if (static_cast<int>(field.force.size()) != system.nv || static_cast<int>(field.stateDerivatives.size()) != system.nz)
      return fmt::format("{} has the wrong size", field.name);
  std::set<NodeId> variables;
  for (const StepFunction &step : filippov.steps)
    if (!variables.insert(step.variable).second)
      return fmt::format("the step variable of the {} occurs twice", step.meaning);
  for (const Term &term : filippov.terms)
    if (ir::dependsOn(system.graph, term.coefficient, [](ir::Symbol s) { return s.kind != ir::SymbolKind::StepVariable; }))
      return "a coefficient depends on more than step variables";
  if (system.contacts.size() == 1)
    for (int sample = 0; sample < 5; ++sample) {
      // Any values do: the identity is polynomial in the step variables.
      const auto alpha = [&](std::size_t k) { return std::fmod(0.618 * static_cast<double>(k + 1) + 0.377 * sample, 1.0); };
      const std::vector<double> theta = coefficients(filippov, system, alpha);
      double total = 0;
      for (std::size_t t = 0; t < theta.size(); ++t)
        total += isDirection(filippov.fields[static_cast<std::size_t>(filippov.terms[t].field)], system) ? 0 : theta[t];
      if (std::abs(total - 1) > 1e-12)
        return fmt::format("the coefficients add up to {}", total);
    }
  return verifyVertices(filippov, system);
}

}  // namespace tf::filippov
