#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"
#include "runtime/abi/tf_model.h"

#include <cassert>

namespace tf {

namespace {

using equations::Role;
using ir::NodeId;

void addEquation(const flat::Expr &left, const flat::Expr &right, int bound, Span span, equations::Scalariser &scalariser,
                 equations::EquationSystem &system) {
  const std::vector<NodeId> lefts = scalariser(left);
  const std::vector<NodeId> rights = scalariser(right);
  for (std::size_t k = 0; k < lefts.size(); ++k) {
    const NodeId value = rights[rights.size() == 1 ? 0 : k];
    system.add({lefts[k], value, bound >= 0 ? bound + static_cast<int>(k) : -1, span, &left, &right});
  }
}

// Declaration equations as left sides need a reference to the variable; these live as long as the derivation.
class DeclarationReferences {
public:
  const flat::Expr &to(const flat::FlatModel &model, flat::VariableId id) {
    const flat::Variable &variable = model.variables[static_cast<std::size_t>(id)];
    auto reference = std::make_unique<flat::Expr>();
    reference->kind = flat::ExprKind::Variable;
    reference->type = variable.type;
    reference->variability = variable.variability;
    reference->span = variable.span;
    reference->variable = id;
    all_.push_back(std::move(reference));
    return *all_.back();
  }

private:
  std::vector<std::unique_ptr<flat::Expr>> all_;
};

void addEquations(const flat::FlatModel &model, const equations::VariableTable &variables, DeclarationReferences &references,
                  equations::Scalariser &scalariser, equations::EquationSystem &system, std::vector<mechanics::InitialEquation> &initial) {
  for (std::size_t k = 0; k < model.variables.size(); ++k) {
    const auto id = static_cast<flat::VariableId>(k);
    const flat::Variable &variable = model.variables[k];
    const equations::Place place = variables.place(id);
    if (place.role == Role::Unknown && variable.binding)
      addEquation(references.to(model, id), *variable.binding, place.first, variable.binding->span, scalariser, system);
  }
  for (const flat::Equation &equation : model.equations) {
    if (equation.left->type.base == flat::Base::String)
      continue;
    if (!equation.isInitial) {
      addEquation(*equation.left, *equation.right, -1, equation.span, scalariser, system);
      continue;
    }
    const std::vector<NodeId> lefts = scalariser(*equation.left), rights = scalariser(*equation.right);
    for (std::size_t k = 0; k < lefts.size(); ++k)
      initial.push_back({lefts[k], rights[k], equation.span});
  }
}

int switchKind(equations::SwitchKind kind) {
  switch (kind) {
  case equations::SwitchKind::Sliding:
    return TF_SWITCH_SLIDING;
  case equations::SwitchKind::Continuous:
    return TF_SWITCH_CONTINUOUS;
  case equations::SwitchKind::Rest:
    return TF_SWITCH_REST;
  default:
    return TF_SWITCH_TIME;
  }
}

// What the solved equations say, into the system; elements' nodes in terms of its symbols.
void takeOver(mechanics::Derivation &d) {
  HybridSystem &system = d.system;
  system.motion = d.variables.motion();
  system.nq = system.motion.coordinates();
  system.nv = system.motion.velocities();
  system.nz = static_cast<int>(d.equations.states().size());
  system.nu = d.variables.count(Role::Input);
  system.np = d.variables.count(Role::Parameter);
  std::vector<NodeId> nodes;
  d.elements.forEachNode([&](NodeId &node) { nodes.push_back(node); });
  const auto become = [&](std::vector<NodeId> others) {
    nodes = std::move(others);
    std::size_t next = 0;
    d.elements.forEachNode([&](NodeId &node) { node = nodes[next++]; });
  };
  become(d.equations.resolve(nodes));
  for (const mechanics::PotentialEntry &potential : d.elements.potentials)
    d.equations.makeDiscontinuous(potential.energy);  // its gradient acts
  become(d.equations.inlineContinuousSwitches(nodes));
  system.stateDerivatives = d.equations.stateDerivatives();
  for (const equations::Switch &switching : d.equations.switches())
    system.switches.push_back(
        {switching.text, switching.span, switching.condition, switchKind(switching.kind), switching.zeroIsPositive, switching.of});
  for (const int state : d.equations.states())
    d.names.states.push_back(d.variables.name(d.variables.scalars(Role::Unknown)[static_cast<std::size_t>(state)]));
}

}  // namespace

std::optional<HybridSystem> derive(const flat::FlatModel &model, const SourceManager &sources, Diagnostics &diagnostics) {
  const int errorsBefore = diagnostics.errorCount();
  HybridSystem system;
  system.name = model.name;
  system.description = model.description;
  system.experiment = model.experiment;

  const equations::VariableTable variables(model);
  equations::SymbolNames names{&variables, {}, {}, {}, {}};
  equations::Provisionals provisionals;
  equations::Scalariser scalariser(names, system.graph, provisionals, sources, diagnostics);
  mechanics::ElementTable table(model, system.graph, scalariser, names, diagnostics);
  scalariser.setElementValue([&](const flat::Expr &reference) { return table.value(reference); });
  equations::EquationSystem equations(names, system.graph, provisionals, diagnostics);
  DeclarationReferences references;
  std::vector<mechanics::InitialEquation> initial;
  addEquations(model, variables, references, scalariser, equations, initial);
  for (const flat::Assertion &assertion : model.assertions)
    diagnostics.report(mechanics::diag::UncheckedAssertion, assertion.span);
  mechanics::Elements elements = table.entries();
  if (diagnostics.errorCount() > errorsBefore || !equations.solve())
    return std::nullopt;

  mechanics::Derivation derivation{model, variables, names, scalariser, equations, table, elements, system, diagnostics};
  takeOver(derivation);
  const bool areElementsRight = mechanics::checkElements(derivation);
  const bool areParametersRight = mechanics::tabulateParameters(derivation);
  if (!areElementsRight || !areParametersRight || !mechanics::solveInitialEquations(derivation, initial) ||
      !mechanics::tabulateQuantities(derivation))
    return std::nullopt;
  mechanics::deriveDynamics(derivation);
  mechanics::deriveEnergies(derivation);
  mechanics::deriveContacts(derivation);
  mechanics::deriveConstraints(derivation);
  const bool areContactsRight = mechanics::checkContacts(derivation);
  const bool areConstraintsRight = mechanics::checkConstraints(derivation);
  const bool areTensorsRight = mechanics::checkInertia(derivation);
  if (!areTensorsRight || !mechanics::checkMass(derivation) || !areContactsRight || !areConstraintsRight)
    return std::nullopt;
  assert(verify(system).empty());
  return system;
}

}  // namespace tf
