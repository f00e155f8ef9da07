// The contract of hybrid_system.h.
#include "compiler/mechanics/hybrid_system.h"

#include "compiler/equations/provisional.h"
#include "runtime/abi/tf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace tf {

namespace {

using ir::NodeId;
using ir::SymbolKind;

// Which symbols a part of the system may refer to.
enum class Scope : std::uint8_t { Parameters, Motion, Direction, Everything };

class SystemVerifier {
public:
  explicit SystemVerifier(const HybridSystem &system) : s_(system) {}

  std::string run() {
    size("mass", s_.mass, s_.massProduct.empty() ? s_.nv * s_.nv : 0);
    size("force", s_.force, s_.nv);
    size("residual", s_.residual, s_.nv);
    size("state derivatives", s_.stateDerivatives, s_.nz);
    size("coordinate starts", s_.coordinateStarts, s_.nq);
    size("velocity starts", s_.velocityStarts, s_.nv);
    size("state starts", s_.stateStarts, s_.nz);
    size("input starts", s_.inputStarts, s_.nu);
    size("parameter bindings", s_.parameterBindings, s_.np);
    if (s_.motion.coordinates() != s_.nq || s_.motion.velocities() != s_.nv)
      fail(fmt::format("motion: {} coordinates and {} velocities", s_.motion.coordinates(), s_.motion.velocities()));
    if (!error_.empty())
      return error_;
    nodes("mass", s_.mass, Scope::Motion);
    nodes("mass product", s_.massProduct, Scope::Direction);
    nodes("contact force", s_.contactForce, Scope::Direction);
    nodes("force", s_.force, Scope::Motion);
    nodes("state derivatives", s_.stateDerivatives, Scope::Motion);
    nodes("residual", s_.residual, Scope::Everything);
    nodes("outputs", s_.outputs, Scope::Everything);
    nodes("energies", {s_.kineticEnergy, s_.potentialEnergy}, Scope::Motion);
    nodes("power", {s_.power}, Scope::Everything);
    for (const std::vector<NodeId> *starts : {&s_.coordinateStarts, &s_.velocityStarts, &s_.stateStarts, &s_.inputStarts})
      nodes("starts", *starts, Scope::Parameters);
    for (const NodeId binding : s_.parameterBindings)
      if (binding >= 0)
        nodes("parameter bindings", {binding}, Scope::Parameters);
    contacts();
    constraints();
    switches();
    quantities();
    return error_;
  }

private:
  void fail(std::string message) {
    if (error_.empty())
      error_ = std::move(message);
  }

  void size(const char *what, const std::vector<NodeId> &nodes, int expected) {
    if (static_cast<int>(nodes.size()) != expected)
      fail(fmt::format("{}: {} nodes instead of {}", what, nodes.size(), expected));
  }

  [[nodiscard]] int countOf(SymbolKind kind, Scope scope) const {
    const bool moves = scope != Scope::Parameters;
    const bool isResult = scope == Scope::Everything;
    switch (kind) {
    case SymbolKind::Time:
      return 1;
    case SymbolKind::Parameter:
      return s_.np;
    case SymbolKind::Coordinate:
      return moves ? s_.nq : 0;
    case SymbolKind::Velocity:
      return moves ? s_.nv : 0;
    case SymbolKind::State:
      return moves ? s_.nz : 0;
    case SymbolKind::Input:
      return moves ? s_.nu : 0;
    case SymbolKind::StepVariable:
      return moves ? static_cast<int>(s_.switches.size()) : 0;
    case SymbolKind::Acceleration:
      return isResult ? s_.nv : 0;
    case SymbolKind::NormalForce:
      return isResult ? static_cast<int>(s_.contacts.size()) : 0;
    case SymbolKind::TangentForce:
      return isResult ? static_cast<int>(s_.tangents.size()) : 0;
    case SymbolKind::Multiplier:
      return isResult ? static_cast<int>(s_.constraintRows.size()) : 0;
    case SymbolKind::StateDerivative:
      return isResult ? s_.nz : 0;
    case SymbolKind::Seed:
      return scope == Scope::Direction ? std::max(s_.nv, static_cast<int>(s_.contacts.size() + s_.tangents.size())) : 0;
    case SymbolKind::Radius:
    case SymbolKind::Unknown:
      return 0;
    }
    return 0;
  }

  void nodes(const char *what, const std::vector<NodeId> &roots, Scope scope) {
    for (const NodeId root : roots)
      if (root < 0 || root >= s_.graph.size())
        return fail(fmt::format("{}: node {} does not exist", what, root));
    for (const auto &symbols : ir::dependencies(s_.graph, roots))
      for (const ir::Symbol symbol : symbols)
        if (symbol.index < 0 || symbol.index >= countOf(symbol.kind, scope))
          fail(fmt::format("{}: refers to symbol {} of kind {}", what, symbol.index, static_cast<int>(symbol.kind)));
  }

  void contacts() {
    const auto rows = static_cast<int>(s_.tangents.size());
    for (const Contact &contact : s_.contacts) {
      size("normal", contact.normal, s_.contactForce.empty() ? s_.nv : 0);
      nodes("normal", contact.normal, Scope::Motion);
      nodes("gap", {contact.gap, contact.gapRate, contact.bias, contact.friction}, Scope::Motion);
      nodes("contact parameters", {contact.restitution, contact.rate}, Scope::Parameters);
      if (contact.tangentFirst < 0 || contact.tangentFirst + contact.tangentCount > rows)
        fail(fmt::format("{}: tangential rows out of range", contact.name));
    }
    for (const FrictionElement &friction : s_.frictions) {
      nodes("bound", {friction.bound}, Scope::Motion);
      if (friction.tangentFirst < 0 || friction.tangentFirst + friction.tangentCount > rows)
        fail(fmt::format("{}: tangential rows out of range", friction.name));
    }
    for (const TangentRow &row : s_.tangents) {
      size("tangent", row.jacobian, s_.contactForce.empty() ? s_.nv : 0);
      nodes("tangent", row.jacobian, Scope::Motion);
      nodes("slip", {row.slip, row.bias}, Scope::Motion);
    }
  }

  void constraints() {
    int rows = 0;
    for (const Constraint &constraint : s_.constraints) {
      if (constraint.rowFirst != rows)
        fail(fmt::format("{}: constraint rows out of order", constraint.name));
      rows += constraint.rowCount;
    }
    if (rows != static_cast<int>(s_.constraintRows.size()))
      fail(fmt::format("{} constraint rows instead of {}", s_.constraintRows.size(), rows));
    for (const ConstraintRow &row : s_.constraintRows) {
      size("constraint", row.jacobian, s_.nv);
      nodes("constraint", row.jacobian, Scope::Motion);
      nodes("constraint", {row.residual, row.rate, row.bias}, Scope::Motion);
    }
  }

  void switches() {
    for (std::size_t k = 0; k < s_.switches.size(); ++k) {
      const NodeId condition = s_.switches[k].condition;
      nodes("condition", {condition}, Scope::Motion);
      for (const ir::Symbol symbol : equations::symbolsOf(s_.graph, condition))
        if (symbol.kind == SymbolKind::StepVariable && symbol.index >= static_cast<int>(k))
          fail(fmt::format("the condition '{}' depends on its own or a later step variable", s_.switches[k].text));
      const int of = s_.switches[k].of;
      if ((s_.switches[k].kind == TF_SWITCH_REST) != (of >= 0 && of < static_cast<int>(k)))
        fail(fmt::format("the switch '{}' is the rest of switch {}", s_.switches[k].text, of));
    }
  }

  void quantities() {
    std::set<std::string> names;
    for (const Quantity &quantity : s_.quantities)
      if (!names.insert(quantity.name).second)
        fail(fmt::format("two quantities are called '{}'", quantity.name));
    for (const Alias &alias : s_.aliases) {
      if (!names.insert(alias.name).second)
        fail(fmt::format("two quantities are called '{}'", alias.name));
      if (alias.quantity < 0 || alias.quantity >= static_cast<int>(s_.quantities.size()))
        fail(fmt::format("'{}' is another name of nothing", alias.name));
    }
  }

  const HybridSystem &s_;
  std::string error_;
};

}  // namespace

std::string verify(const HybridSystem &system) {
  if (std::string error = ir::verify(system.graph); !error.empty())
    return error;
  return SystemVerifier(system).run();
}

}  // namespace tf
