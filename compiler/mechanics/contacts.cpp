// Contacts and friction elements: rates, Jacobians with respect to the velocities and bias terms, with every ∂/∂t (moving ground, belts).
#include "compiler/ir/sweep.h"
#include "compiler/mechanics/derivation.h"

#include <algorithm>

namespace tf::mechanics {

using ir::NodeId;
using ir::SymbolKind;

namespace {

// Empty if the matrix is.
std::vector<NodeId> row(const std::vector<NodeId> &matrix, std::size_t index, std::size_t columns) {
  if (matrix.empty())
    return {};
  const auto first = matrix.begin() + static_cast<std::ptrdiff_t>(index * columns);
  return {first, first + static_cast<std::ptrdiff_t>(columns)};
}

// So few entries of Jn and Jt that they are written out in any case.
bool areFew(const Derivation &derivation) {
  const std::size_t rows = derivation.elements.contacts.size() + static_cast<std::size_t>(derivation.elements.tangents);
  return rows * static_cast<std::size_t>(derivation.system.nv) <= fewRowEntries;
}

void deriveTangents(Derivation &derivation) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  std::vector<NodeId> slips(static_cast<std::size_t>(derivation.elements.tangents), graph.constant(0));
  const auto collect = [&](const auto &entry) {
    std::ranges::copy(entry.form.rows(graph, {entry.slip, entry.slipRadius}), slips.begin() + entry.tangentFirst);
  };
  std::ranges::for_each(derivation.elements.contacts, collect);
  std::ranges::for_each(derivation.elements.frictions, collect);
  const auto columns = static_cast<std::size_t>(system.nv);
  const std::vector<NodeId> jacobian =
      areFew(derivation) ? ir::jacobian(graph, slips, symbols(graph, SymbolKind::Velocity, system.nv)) : std::vector<NodeId>{};
  const std::vector<NodeId> bias = timeDerivative(system, slips, AlongMotion::WithoutAcceleration);
  for (std::size_t k = 0; k < slips.size(); ++k)
    system.tangents.push_back({slips[k], bias[k], row(jacobian, k, columns)});
}

// Jnᵀ sn + Jtᵀ st = ∂(snᵀ gap' + stᵀ slip)/∂v if it is of less code than the rows; they are then known to be non-zero and not to depend on
// velocities.
std::vector<NodeId> contactForce(HybridSystem &system) {
  ir::Graph &graph = system.graph;
  std::vector<NodeId> rates;
  rates.reserve(system.contacts.size() + system.tangents.size());
  for (const Contact &contact : system.contacts)
    rates.push_back(contact.gapRate);
  for (const TangentRow &tangent : system.tangents)
    rates.push_back(tangent.slip);
  const auto count = static_cast<int>(rates.size());
  std::vector<NodeId> force =
      ir::reverseDerivative(graph, rates, symbols(graph, SymbolKind::Seed, count), symbols(graph, SymbolKind::Velocity, system.nv));
  const std::vector<std::vector<int>> structure = ir::seedStructure(graph, force, count);
  std::vector<char> moves(rates.size(), 0);
  std::size_t entries = 0;
  for (const std::vector<int> &seeds : structure) {
    entries += seeds.size();
    for (const int seed : seeds)
      moves[static_cast<std::size_t>(seed)] = 1;
  }
  const auto isVelocity = [](ir::Symbol symbol) { return symbol.kind == SymbolKind::Velocity; };
  const bool areShort = entries <= shortRow * rates.size();
  if (areShort || std::ranges::count(moves, 0) > 0 || ir::dependsOn(graph, force, isVelocity) ||
      !ir::isSweepSmaller(graph, force, count, fewRowEntries))
    return {};
  return force;
}

// True if no --set can change the value: it follows from constants, final and structural parameters.
bool isSettled(const Derivation &derivation, NodeId node) {
  const auto &parameters = derivation.variables.scalars(equations::Role::Parameter);
  return std::ranges::all_of(equations::symbolsOf(derivation.system.graph, node), [&](ir::Symbol symbol) {
    if (symbol.kind != SymbolKind::Parameter)
      return false;
    const auto index = static_cast<std::size_t>(symbol.index);
    const flat::Variable &variable = derivation.variables.variable(parameters[index]);
    const NodeId binding = derivation.system.parameterBindings[index];
    return (variable.isFinal || variable.isStructural) && (binding < 0 || isSettled(derivation, binding));
  });
}

// The ordinal of an impact law is compiled in; one that a parameter may change stays an expression, which checkContacts refuses.
void settleLaw(const Derivation &derivation, ContactEntry &entry) {
  ir::Graph &graph = derivation.system.graph;
  if (!isSettled(derivation, entry.law))
    return;
  const std::vector<double> parameters = parameterValues(derivation.system);
  entry.law = graph.constant(
      ir::evaluate(graph, std::array{entry.law}, [&](ir::Symbol s) { return parameters[static_cast<std::size_t>(s.index)]; })[0]);
}

int lawOf(const Derivation &derivation, const ContactEntry &entry) {
  const ir::Node &law = derivation.system.graph[entry.law];
  return law.op == ir::Op::Constant ? static_cast<int>(law.value) - 1 : 0;
}

}  // namespace

void writeOutRows(HybridSystem &system) {
  std::vector<NodeId> rates, slips;
  for (const Contact &contact : system.contacts)
    rates.push_back(contact.gapRate);
  for (const TangentRow &tangent : system.tangents)
    slips.push_back(tangent.slip);
  const auto columns = static_cast<std::size_t>(system.nv);
  const std::vector<NodeId> velocities = symbols(system.graph, SymbolKind::Velocity, system.nv);
  const std::vector<NodeId> normals = ir::jacobian(system.graph, rates, velocities);
  const std::vector<NodeId> tangents = ir::jacobian(system.graph, slips, velocities);
  for (std::size_t k = 0; k < rates.size(); ++k)
    system.contacts[k].normal = row(normals, k, columns);
  for (std::size_t k = 0; k < slips.size(); ++k)
    system.tangents[k].jacobian = row(tangents, k, columns);
}

void deriveContacts(Derivation &derivation) {
  HybridSystem &system = derivation.system;
  ir::Graph &graph = system.graph;
  deriveTangents(derivation);
  std::vector<NodeId> gaps;
  gaps.reserve(derivation.elements.contacts.size());
  for (const ContactEntry &entry : derivation.elements.contacts)
    gaps.push_back(entry.gap);
  const auto columns = static_cast<std::size_t>(system.nv);
  const std::vector<NodeId> rates = timeDerivative(system, gaps, AlongMotion::WithoutAcceleration);
  const std::vector<NodeId> normals =
      areFew(derivation) ? ir::jacobian(graph, rates, symbols(graph, SymbolKind::Velocity, system.nv)) : std::vector<NodeId>{};
  const std::vector<NodeId> biases = timeDerivative(system, rates, AlongMotion::WithoutAcceleration);
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    ContactEntry &entry = derivation.elements.contacts[k];
    settleLaw(derivation, entry);
    Contact contact;
    contact.name = entry.name;
    contact.span = derivation.model.elements[static_cast<std::size_t>(entry.element)].span;
    contact.gap = gaps[k];
    contact.gapRate = rates[k];
    contact.bias = biases[k];
    contact.normal = row(normals, k, columns);
    contact.tangentFirst = entry.tangentFirst;
    contact.tangentCount = entry.tangentCount();
    contact.affineCount = entry.affineCount();
    contact.frictionForm = entry.form.kind;
    contact.slipRadius = entry.slipRadius;
    contact.friction = entry.friction;
    contact.restitution = entry.restitution;
    contact.rate = entry.rate;
    contact.law = lawOf(derivation, entry);
    contact.nominal = nominalOf(system, gaps[k]);
    system.contacts.push_back(std::move(contact));
  }
  for (const FrictionEntry &entry : derivation.elements.frictions)
    system.frictions.push_back({entry.name, derivation.model.elements[static_cast<std::size_t>(entry.element)].span, entry.tangentFirst,
                                entry.tangentCount(), entry.bound, entry.form.kind, entry.slipRadius, entry.affineCount()});
  if (areFew(derivation))
    return;
  system.contactForce = contactForce(system);
  if (system.contactForce.empty())
    writeOutRows(system);
}

}  // namespace tf::mechanics
