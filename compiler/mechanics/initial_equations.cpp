// Initial equations: each determines one start value in which it is linear; what is fixed counts as known.
#include "compiler/mechanics/derivation.h"

#include "compiler/equations/diagnostics.h"
#include "compiler/equations/structure.h"
#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <array>

namespace tf::mechanics {

using equations::LinearSolution;
using equations::Role;
using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

// A start that initial equations may determine.
struct FreeStart {
  Symbol symbol;
  NodeId *start = nullptr;
  std::string name;
};

class InitialSystem {
public:
  InitialSystem(Derivation &derivation, const std::vector<InitialEquation> &equations) : d_(derivation), graph_(derivation.system.graph) {
    for (const InitialEquation &equation : equations)
      equations_.push_back({atStart(d_.equations.resolve(equation.left)), atStart(d_.equations.resolve(equation.right)), equation.span});
  }

  bool solve() {
    collectFreeStarts();
    const std::vector<std::vector<int>> unknowns = unknownsOfEquations();
    equations::Matching matching(static_cast<int>(equations_.size()), static_cast<int>(free_.size()));
    for (std::size_t e = 0; e < equations_.size(); ++e)
      for (const int unknown : unknowns[e])
        matching.addEdge(static_cast<int>(e), unknown);
    (void)matching.augmentAll();
    std::vector<std::vector<int>> needs(equations_.size());
    bool isFine = true;
    for (std::size_t e = 0; e < equations_.size(); ++e) {
      if (matching.variableOf(static_cast<int>(e)) < 0)
        isFine = report(equations_[e], "all variables in it have start values already");
      for (const int unknown : unknowns[e])
        if (const int other = matching.equationOf(unknown); other >= 0 && other != static_cast<int>(e))
          needs[e].push_back(other);
    }
    for (const std::vector<int> &component : equations::stronglyConnectedComponents(needs)) {
      const InitialEquation &equation = equations_[static_cast<std::size_t>(component[0])];
      if (!isFine)
        break;
      isFine = component.size() > 1 ? report(equation, "it depends on others in a circle (not supported yet)")
                                    : determine(equation, free_[static_cast<std::size_t>(matching.variableOf(component[0]))]);
    }
    return isFine;
  }

private:
  bool report(const InitialEquation &equation, const std::string &why) {
    d_.diagnostics.report(equations::diag::InitialEquation, equation.span, why);
    return false;
  }

  // Step variables by the Booleans that they are at the start.
  NodeId atStart(NodeId node) {
    for (std::size_t round = 0; round <= d_.system.switches.size(); ++round)
      node = ir::substitute(graph_, std::array{node}, [&](Symbol symbol) {
        if (symbol.kind != SymbolKind::StepVariable)
          return NodeId{-1};
        const SwitchingFunction &switching = d_.system.switches[static_cast<std::size_t>(symbol.index)];
        const NodeId isPositive = graph_.binary(ir::Op::Less, graph_.constant(0), switching.condition);
        const NodeId isNotNegative = graph_.binary(ir::Op::LessEqual, graph_.constant(0), switching.condition);
        if (switching.kind == TF_SWITCH_REST)
          return graph_.sub(isNotNegative, isPositive);
        return switching.zeroIsPositive ? isNotNegative : isPositive;
      })[0];
    return node;
  }

  bool isFixed(const flat::ExprPtr &fixed, std::size_t position, bool byDefault) {
    if (!fixed)
      return byDefault;
    const std::vector<NodeId> nodes = d_.scalariser(*fixed);
    const ir::Node &value = graph_[nodes[nodes.size() == 1 ? 0 : position]];
    return value.op != ir::Op::Constant || value.value != 0;
  }

  void collectFreeStarts() {
    HybridSystem &system = d_.system;
    for (int k = 0; k < system.nv; ++k) {
      const auto scalar = d_.variables.velocity(k);
      const flat::Variable &variable = d_.variables.variable(scalar);
      const auto position = static_cast<std::size_t>(scalar.position);
      const flat::ExprPtr &fixed = variable.isAngularVelocity ? variable.attributes.fixed : variable.derAttributes.fixed;
      if (!isFixed(fixed, position, true))
        free_.push_back({{SymbolKind::Velocity, k}, &system.velocityStarts[static_cast<std::size_t>(k)], d_.variables.velocityName(k)});
    }
    // Equations for parts of quaternions would not keep their length.
    const auto &coordinates = d_.variables.scalars(Role::Coordinate);
    for (int k = 0; k < system.nq; ++k) {
      const auto scalar = coordinates[static_cast<std::size_t>(k)];
      if (system.motion.rotationOf(k) == nullptr &&
          !isFixed(d_.variables.variable(scalar).attributes.fixed, static_cast<std::size_t>(scalar.position), true))
        free_.push_back({{SymbolKind::Coordinate, k}, &system.coordinateStarts[static_cast<std::size_t>(k)], d_.variables.name(scalar)});
    }
    for (std::size_t k = 0; k < d_.equations.states().size(); ++k) {
      const auto scalar = d_.variables.scalars(Role::Unknown)[static_cast<std::size_t>(d_.equations.states()[k])];
      if (!isFixed(d_.variables.variable(scalar).attributes.fixed, static_cast<std::size_t>(scalar.position), false))
        free_.push_back({{SymbolKind::State, static_cast<int>(k)}, &system.stateStarts[k], d_.variables.name(scalar)});
    }
  }

  std::vector<std::vector<int>> unknownsOfEquations() {
    std::vector<std::vector<int>> all;
    for (const InitialEquation &equation : equations_) {
      std::vector<int> unknowns;
      for (const NodeId side : {equation.left, equation.right})
        for (const Symbol symbol : equations::symbolsOf(graph_, side))
          for (std::size_t k = 0; k < free_.size(); ++k)
            if (free_[k].symbol == symbol && std::ranges::find(unknowns, static_cast<int>(k)) == unknowns.end())
              unknowns.push_back(static_cast<int>(k));
      all.push_back(std::move(unknowns));
    }
    return all;
  }

  // Known starts into a side of an equation; `unknown` stays.
  NodeId withStarts(NodeId node, Symbol unknown) {
    const HybridSystem &system = d_.system;
    return ir::substitute(graph_, std::array{node}, [&](Symbol symbol) {
      const auto index = static_cast<std::size_t>(symbol.index);
      if (symbol == unknown)
        return NodeId{-1};
      switch (symbol.kind) {
      case SymbolKind::Coordinate:
        return system.coordinateStarts[index];
      case SymbolKind::Velocity:
        return system.velocityStarts[index];
      case SymbolKind::State:
        return system.stateStarts[index];
      case SymbolKind::Input:
        return system.inputStarts[index];
      default:
        return NodeId{-1};
      }
    })[0];
  }

  bool determine(const InitialEquation &equation, const FreeStart &unknown) {
    const NodeId left = withStarts(equation.left, unknown.symbol), right = withStarts(equation.right, unknown.symbol);
    for (const NodeId side : {left, right})
      for (const Symbol symbol : equations::symbolsOf(graph_, side))
        if (symbol != unknown.symbol && symbol.kind != SymbolKind::Time && symbol.kind != SymbolKind::Parameter)
          return report(equation, fmt::format("it depends on {} (not supported yet)", d_.names.describe(symbol)));
    const LinearSolution solution = equations::solveLinear(graph_, left, right, unknown.symbol);
    if (solution.outcome == LinearSolution::Outcome::Vanishing)
      return report(equation, fmt::format("'{}' cancels out", unknown.name));
    if (solution.outcome == LinearSolution::Outcome::Nonlinear)
      return report(equation, fmt::format("it is not linear in '{}' (not supported yet)", unknown.name));
    *unknown.start = solution.value;
    return true;
  }

  Derivation &d_;
  ir::Graph &graph_;
  std::vector<InitialEquation> equations_;
  std::vector<FreeStart> free_;
};

}  // namespace

bool solveInitialEquations(Derivation &derivation, const std::vector<InitialEquation> &equations) {
  return equations.empty() || InitialSystem(derivation, equations).solve();
}

}  // namespace tf::mechanics
