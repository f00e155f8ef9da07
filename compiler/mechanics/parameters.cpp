// Parameters, their values and bindings, and starts.
#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"
#include "runtime/abi/tf_model.h"

#include <algorithm>

namespace tf::mechanics {

using equations::Role;
using equations::ScalarVariable;
using ir::NodeId;
using ir::SymbolKind;

namespace {

// `value` at one scalar of a variable's attribute, in terms of parameters (and time for starts); −1 if not given. Reports what varies.
class ParametricValues {
public:
  explicit ParametricValues(Derivation &derivation) : d_(derivation) {}

  NodeId at(const flat::ExprPtr &expression, ScalarVariable scalar, std::string_view what) {
    if (!expression)
      return -1;
    const std::vector<NodeId> nodes = d_.equations.resolve(d_.scalariser(*expression));
    const NodeId node = nodes[nodes.size() == 1 ? 0 : static_cast<std::size_t>(scalar.position)];
    const auto varies = [](ir::Symbol s) { return s.kind != SymbolKind::Parameter && s.kind != SymbolKind::Time; };
    if (!ir::dependsOn(d_.system.graph, node, varies))
      return node;
    d_.diagnostics.report(diag::StartNotParametric, expression->span, what, d_.variables.name(scalar));
    isFine_ = false;
    return -1;
  }

  NodeId atOrZero(const flat::ExprPtr &expression, ScalarVariable scalar, std::string_view what) {
    const NodeId node = at(expression, scalar, what);
    return node >= 0 ? node : d_.system.graph.constant(0);
  }

  [[nodiscard]] bool isFine() const { return isFine_; }

private:
  Derivation &d_;
  bool isFine_ = true;
};

// Start values that a plain other name carries: `Real v(start = 1) = der(x)`, by symbol kind and index.
NodeId startOfAlias(Derivation &d, ParametricValues &values, ir::Symbol symbol) {
  const auto &unknowns = d.variables.scalars(Role::Unknown);
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const flat::Variable &variable = d.variables.variable(unknowns[k]);
    if (!variable.attributes.start)
      continue;
    const ir::Node &definition = d.system.graph[d.equations.definition(static_cast<int>(k))];
    if (definition.op == ir::Op::Symbol && definition.symbol == symbol)
      return values.at(variable.attributes.start, unknowns[k], "the start");
  }
  return -1;
}

// Starts of rotations are normalised: what is given has the right direction only, be it by round-off or by intention.
void normaliseRotations(Derivation &d) {
  HybridSystem &system = d.system;
  const std::vector<double> parameters = parameterValues(system);
  for (const equations::RotationCoordinate &rotation : system.motion.rotations()) {
    const auto start = std::span(system.coordinateStarts).subspan(static_cast<std::size_t>(rotation.coordinate), 4);
    const auto valueOf = [&](ir::Symbol s) {
      return s.kind == SymbolKind::Parameter ? parameters[static_cast<std::size_t>(s.index)] : d.model.experiment.startTime.value_or(0);
    };
    if (std::ranges::all_of(ir::evaluate(system.graph, start, valueOf), [](double value) { return value == 0; })) {
      const ScalarVariable scalar = d.variables.scalars(Role::Coordinate)[static_cast<std::size_t>(rotation.coordinate)];
      const flat::Variable &variable = d.variables.variable(scalar);
      d.diagnostics.report(diag::ZeroRotation, variable.attributes.start->span, variable.name);
      return;
    }
    std::ranges::copy(equations::normalised(system.graph, equations::quaternion(start)), start.begin());
  }
}

void tabulateMotion(Derivation &d, ParametricValues &values) {
  HybridSystem &system = d.system;
  const auto start = [&](const flat::ExprPtr &given, ScalarVariable scalar, ir::Symbol symbol, std::string_view what) {
    NodeId node = values.at(given, scalar, what);
    if (node < 0)
      node = startOfAlias(d, values, symbol);
    return node >= 0 ? node : system.graph.constant(0);
  };
  for (int k = 0; k < system.nq; ++k) {
    const ScalarVariable scalar = d.variables.scalars(Role::Coordinate)[static_cast<std::size_t>(k)];
    const flat::Attributes &attributes = d.variables.variable(scalar).attributes;
    if (system.motion.rotationOf(k) != nullptr && !attributes.start)
      system.coordinateStarts.push_back(system.graph.constant(scalar.position % 4 == 0 ? 1 : 0));
    else
      system.coordinateStarts.push_back(start(attributes.start, scalar, {SymbolKind::Coordinate, k}, "the start"));
  }
  for (int k = 0; k < system.nv; ++k) {
    const ScalarVariable scalar = d.variables.velocity(k);
    const flat::Variable &variable = d.variables.variable(scalar);
    const flat::ExprPtr &given = variable.isAngularVelocity ? variable.attributes.start : variable.derAttributes.start;
    system.velocityStarts.push_back(start(given, scalar, {SymbolKind::Velocity, k}, "the start of the velocity"));
  }
}

}  // namespace

bool tabulateParameters(Derivation &d) {
  HybridSystem &system = d.system;
  ParametricValues values(d);
  for (const ScalarVariable scalar : d.variables.scalars(Role::Parameter)) {
    const flat::Variable &variable = d.variables.variable(scalar);
    const flat::ExprPtr &expression = variable.binding ? variable.binding : variable.attributes.start;
    const NodeId node = values.atOrZero(expression, scalar, "the value");
    const bool isConstant = system.graph[node].op == ir::Op::Constant;
    system.parameterValues.push_back(isConstant ? system.graph[node].value : 0);
    system.parameterBindings.push_back(isConstant ? -1 : node);
  }
  tabulateMotion(d, values);
  for (const int state : d.equations.states()) {
    const ScalarVariable scalar = d.variables.scalars(Role::Unknown)[static_cast<std::size_t>(state)];
    system.stateStarts.push_back(values.atOrZero(d.variables.variable(scalar).attributes.start, scalar, "the start"));
  }
  for (const ScalarVariable scalar : d.variables.scalars(Role::Input)) {
    const flat::Variable &variable = d.variables.variable(scalar);
    system.inputStarts.push_back(values.atOrZero(variable.binding ? variable.binding : variable.attributes.start, scalar, "the start"));
  }
  const int errors = d.diagnostics.errorCount();
  normaliseRotations(d);
  return values.isFine() && d.diagnostics.errorCount() == errors;
}

std::vector<double> parameterValues(const HybridSystem &system) {
  std::vector<double> values = system.parameterValues;
  const auto valueOf = [&](ir::Symbol symbol) {
    return symbol.kind == SymbolKind::Parameter ? values[static_cast<std::size_t>(symbol.index)] : 0.0;
  };
  // Bindings may refer to one another in any order; a chain is no longer than the number of parameters.
  for (std::size_t round = 0; round < values.size(); ++round) {
    bool isChanged = false;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (system.parameterBindings[k] < 0)
        continue;
      const double value = ir::evaluate(system.graph, std::array{system.parameterBindings[k]}, valueOf)[0];
      isChanged = isChanged || (value != values[k] && value == value);
      values[k] = value;
    }
    if (!isChanged)
      break;
  }
  return values;
}

}  // namespace tf::mechanics
