// Ordinary equations: matched with their unknowns, sorted, and solved one by one for explicit definitions.
//
// Afterwards every Unknown symbol stands for a node in terms of time, coordinates, velocities, states, inputs, parameters and step
// variables (results that follow a contact force or an acceleration: also NormalForce, TangentForce, Acceleration). A variable whose
// derivative occurs is a state if no equation defines it from other quantities; otherwise its derivative follows by the chain rule
// (language.md section 3). Switches are found once: conditions equal up to a non-zero constant factor share one step variable (theory.md
// section 5).
#pragma once

#include "compiler/equations/provisional.h"
#include "lang/base/diagnostics.h"

#include <map>
#include <optional>
#include <span>

namespace tf::equations {

struct ScalarEquation {
  ir::NodeId left = -1, right = -1;
  int bound = -1;  // the unknown whose declaration it stands in; −1: an equation of its own
  Span span;
  const flat::Expr *leftExpression = nullptr, *rightExpression = nullptr;
};

// Rest: not a switching function of its own, but a step variable that is 1 while the condition of another one stays 0 without sliding.
enum class SwitchKind : std::uint8_t { Sliding, Continuous, Time, Rest };

struct Switch {
  ir::NodeId condition = -1;
  SwitchKind kind = SwitchKind::Sliding;
  bool zeroIsPositive = false;
  std::string text;
  Span span;
  int of = -1;    // Rest: the other one
  int rest = -1;  // the step variable of its rest, where there is one
};

class EquationSystem {
public:
  EquationSystem(const SymbolNames &names, ir::Graph &graph, Provisionals &provisionals, Diagnostics &diagnostics)
      : names_(names), variables_(*names.variables), graph_(graph), provisionals_(provisionals), diagnostics_(diagnostics) {}

  void add(const ScalarEquation &equation) { equations_.push_back(equation); }

  // Defines every provisional symbol; false after errors (reported).
  bool solve();

  // The same nodes with every Unknown symbol replaced by its definition; symbols met only after solve() stay.
  [[nodiscard]] std::vector<ir::NodeId> resolve(std::span<const ir::NodeId> nodes);
  [[nodiscard]] ir::NodeId resolve(ir::NodeId node) { return resolve(std::span<const ir::NodeId>(&node, 1))[0]; }

  [[nodiscard]] const std::vector<int> &states() const { return states_; }  // unknowns, in the order of State symbols
  [[nodiscard]] ir::NodeId definition(int unknown);
  [[nodiscard]] const std::vector<ir::NodeId> &stateDerivatives() const { return stateDerivatives_; }
  [[nodiscard]] const std::vector<Switch> &switches() const { return switches_; }
  // The derivative of `node` is used: where abs, min or max in it has a kink, its derivative jumps, and sliding is possible.
  void makeDiscontinuous(ir::NodeId node);
  // Continuous switches that neither the resolved nodes `acting` nor states depend on become relations: results have kinks there, no motion
  // has, and no step need end. The same nodes in terms of the step variables as they are numbered then.
  [[nodiscard]] std::vector<ir::NodeId> inlineContinuousSwitches(std::span<const ir::NodeId> acting);
  // The equation that determines an unknown.
  [[nodiscard]] const ScalarEquation &equationOf(int unknown) const {
    return equations_[static_cast<std::size_t>(equationOf_[static_cast<std::size_t>(unknown)])];
  }

private:
  using Dependencies = std::vector<std::vector<int>>;

  bool match(const Dependencies &symbols);
  bool reportUnmatched(const Dependencies &symbols);
  void reportUnmatchedEquation(const ScalarEquation &equation, const std::vector<int> &symbols);
  bool completeDerivatives(Dependencies &dependsOn);
  std::vector<int> dependenciesOf(int id, const Dependencies &symbols);
  bool define(int id);
  bool defineVariable(int id);
  bool defineDerivative(int id);
  bool defineSwitch(int id);
  ir::NodeId parametricStep(const ProvisionalSwitch &provisional, ir::NodeId condition);
  ir::NodeId restOf(int index);
  bool solveFor(int id, const ScalarEquation &equation);
  void reportLoop(const std::vector<int> &component);
  [[nodiscard]] bool isState(int unknown) const { return stateIndex_[static_cast<std::size_t>(unknown)] >= 0; }
  [[nodiscard]] std::string nameOf(int unknown) const;
  [[nodiscard]] Span declarationOf(int unknown) const;

  const SymbolNames &names_;
  const VariableTable &variables_;
  ir::Graph &graph_;
  Provisionals &provisionals_;
  Diagnostics &diagnostics_;
  std::vector<ScalarEquation> equations_;
  std::vector<int> equationOf_;  // of unknowns
  std::vector<int> stateIndex_;  // of unknowns; −1: no state
  std::vector<int> states_;
  std::vector<ir::NodeId> definitions_;  // of provisional symbols; −1: not yet
  std::vector<ir::NodeId> stateDerivatives_;
  std::vector<Switch> switches_;
  std::map<std::vector<std::pair<ir::NodeId, double>>, std::pair<int, double>> sharedSwitches_;  // normal form → switch, its scale
};

// left = right solved for `unknown`, in which it must be linear.
struct LinearSolution {
  enum class Outcome : std::uint8_t { Solved, Vanishing, Nonlinear };
  Outcome outcome = Outcome::Solved;
  ir::NodeId value = -1;
};
[[nodiscard]] LinearSolution solveLinear(ir::Graph &graph, ir::NodeId left, ir::NodeId right, ir::Symbol unknown);

// A condition as scale · Σ coefficient · term: the normal form has coefficient 1 on its first term; terms are sorted, the constant is term
// −1. Two conditions are equal up to a constant factor iff their normal forms are equal. Scale 0: the condition is the constant 0.
struct LinearForm {
  double scale = 0;
  std::vector<std::pair<ir::NodeId, double>> terms;
};
[[nodiscard]] LinearForm normalForm(const ir::Graph &graph, ir::NodeId node);

}  // namespace tf::equations
