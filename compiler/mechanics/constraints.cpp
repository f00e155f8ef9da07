// Constraints: rates, Jacobians with respect to the velocities and bias terms, with every ∂/∂t.
#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"
#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <cmath>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

double nominalOf(const HybridSystem &system, NodeId node) {
  double nominal = 0;
  const std::vector<Symbol> moving = equations::symbolsOf(system.graph, node);
  for (const Quantity &quantity : system.quantities) {
    const bool isCoordinate = quantity.kind == TF_KIND_COORDINATE && system.motion.rotationOf(quantity.index) == nullptr;
    if (!isCoordinate && quantity.kind != TF_KIND_VELOCITY)
      continue;
    const Symbol symbol{isCoordinate ? SymbolKind::Coordinate : SymbolKind::Velocity, quantity.index};
    if (std::ranges::find(moving, symbol) != moving.end())
      nominal = std::max(nominal, std::abs(quantity.nominal));
  }
  return nominal > 0 ? nominal : 1;
}

void deriveConstraints(Derivation &derivation) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  const std::vector<NodeId> velocities = symbols(graph, SymbolKind::Velocity, system.nv);
  for (const ConstraintEntry &entry : derivation.elements.constraints) {
    const std::vector<NodeId> rates = ratesOf(system, entry);
    const std::vector<NodeId> jacobian = ir::jacobian(graph, rates, velocities);
    const std::vector<NodeId> biases = timeDerivative(system, rates, AlongMotion::WithoutAcceleration);
    Constraint constraint{entry.name,        derivation.model.elements[static_cast<std::size_t>(entry.element)].span,
                          entry.rowFirst,    static_cast<int>(rates.size()),
                          entry.isHolonomic, 0};
    for (std::size_t k = 0; k < rates.size(); ++k) {
      const auto first = jacobian.begin() + static_cast<std::ptrdiff_t>(k * velocities.size());
      system.constraintRows.push_back(
          {entry.residual[k], rates[k], biases[k], {first, first + static_cast<std::ptrdiff_t>(velocities.size())}});
      constraint.nominal = std::max(constraint.nominal, nominalOf(system, entry.residual[k]));
    }
    system.constraints.push_back(std::move(constraint));
  }
}

bool checkConstraints(Derivation &derivation) {
  const HybridSystem &system = derivation.system;
  const ir::Graph &graph = system.graph;
  const int errors = derivation.diagnostics.errorCount();
  for (const ConstraintEntry &entry : derivation.elements.constraints) {
    const flat::Element &element = derivation.model.elements[static_cast<std::size_t>(entry.element)];
    const char *residual = residualOf(element);
    const Span span = element.find(residual)->value->span;
    for (std::size_t k = 0; k < entry.residual.size(); ++k) {
      const std::vector<NodeId> &row = system.constraintRows[static_cast<std::size_t>(entry.rowFirst) + k].jacobian;
      if (std::ranges::all_of(row, [&](NodeId node) { return graph.isConstant(node, 0); }))
        derivation.diagnostics.report(diag::ImmovableConstraint, span, residual, entry.name, entry.isHolonomic ? "coordinate" : "velocity");
      for (const NodeId node : row)
        if (ir::dependsOn(graph, node, [](Symbol s) { return s.kind == SymbolKind::Velocity; })) {
          derivation.diagnostics.report(diag::ConstraintNotAffine, span, entry.name);
          break;
        }
    }
  }
  return derivation.diagnostics.errorCount() == errors;
}

}  // namespace tf::mechanics
