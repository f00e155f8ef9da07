#include "compiler/equations/equation_system.h"

#include "compiler/equations/diagnostics.h"
#include "compiler/equations/structure.h"

#include <algorithm>
#include <cassert>

namespace tf::equations {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

// Orders of derivatives beyond this come from variables that determine one another's derivatives in a circle.
constexpr int kMaximalOrder = 6;
constexpr std::size_t kNamesInMessages = 6;

bool isForce(Symbol symbol) {
  return symbol.kind == SymbolKind::Acceleration || symbol.kind == SymbolKind::NormalForce || symbol.kind == SymbolKind::TangentForce ||
         symbol.kind == SymbolKind::Multiplier;
}

std::vector<int> unknownsOf(const ir::Graph &graph, std::initializer_list<NodeId> nodes) {
  std::vector<int> ids;
  for (const auto &symbols : ir::dependencies(graph, std::vector<NodeId>(nodes)))
    for (const Symbol symbol : symbols)
      if (symbol.kind == SymbolKind::Unknown)
        ids.push_back(symbol.index);
  std::ranges::sort(ids);
  ids.erase(std::ranges::unique(ids).begin(), ids.end());
  return ids;
}

}  // namespace

std::string EquationSystem::nameOf(int unknown) const {
  return variables_.name(variables_.scalars(Role::Unknown)[static_cast<std::size_t>(unknown)]);
}

Span EquationSystem::declarationOf(int unknown) const {
  return variables_.variable(variables_.scalars(Role::Unknown)[static_cast<std::size_t>(unknown)]).span;
}

bool EquationSystem::solve() {
  Dependencies symbols;
  symbols.reserve(equations_.size());
  for (const ScalarEquation &equation : equations_)
    symbols.push_back(unknownsOf(graph_, {equation.left, equation.right}));
  for (int unknown = 0; unknown < variables_.count(Role::Unknown); ++unknown)
    (void)provisionals_.variable(unknown, 0, declarationOf(unknown));
  if (!match(symbols))
    return false;
  Dependencies dependsOn;
  if (!completeDerivatives(dependsOn))
    return false;

  definitions_.assign(static_cast<std::size_t>(provisionals_.size()), -1);
  stateDerivatives_.assign(states_.size(), -1);
  bool isSolved = true;
  for (const std::vector<int> &component : stronglyConnectedComponents(dependsOn)) {
    const int id = component[0];
    const auto &successors = dependsOn[static_cast<std::size_t>(id)];
    if (component.size() > 1 || std::ranges::find(successors, id) != successors.end()) {
      reportLoop(component);
      isSolved = false;
    }
    // What depends on something that could not be defined is not reported again.
    const bool isBlocked = !isSolved && std::ranges::any_of(component, [&](int member) {
      return std::ranges::any_of(dependsOn[static_cast<std::size_t>(member)],
                                 [&](int other) { return definitions_[static_cast<std::size_t>(other)] < 0; });
    });
    isSolved = (isBlocked || define(id)) && isSolved;
  }
  return isSolved;
}

// Unknown k is matched through itself, or through its derivative: then it is a state. Edges to derivatives come first; a variable that is
// differentiated somewhere is determined by an equation without it only where the count of equations asks for it.
bool EquationSystem::match(const Dependencies &symbols) {
  const int count = variables_.count(Role::Unknown);
  std::vector<char> isDifferentiated(static_cast<std::size_t>(count), 0);
  for (int id = 0; id < provisionals_.size(); ++id)
    if (provisionals_[id].kind == Provisional::Kind::Variable && provisionals_[id].order > 0)
      isDifferentiated[static_cast<std::size_t>(provisionals_[id].index)] = 1;

  Matching matching(static_cast<int>(equations_.size()), count);
  std::vector<std::pair<int, int>> later[2];
  std::vector<std::vector<int>> throughDerivative(equations_.size());
  for (std::size_t e = 0; e < equations_.size(); ++e) {
    bool hasDerivatives = false;
    for (const int id : symbols[e])
      if (provisionals_[id].kind == Provisional::Kind::Variable && provisionals_[id].order > 0) {
        hasDerivatives = true;
        throughDerivative[e].push_back(provisionals_[id].index);
      }
    const auto occursDifferentiated = [&](int unknown) {
      return std::ranges::find(throughDerivative[e], unknown) != throughDerivative[e].end();
    };
    const auto equation = static_cast<int>(e);
    for (const int id : symbols[e]) {
      const Provisional &symbol = provisionals_[id];
      if (symbol.kind == Provisional::Kind::Switch)
        continue;
      if (symbol.order == 1 || (symbol.order == 0 && !isDifferentiated[static_cast<std::size_t>(symbol.index)]))
        matching.addEdge(equation, symbol.index);
      else if (symbol.order == 0 && !occursDifferentiated(symbol.index))
        later[hasDerivatives ? 1 : 0].emplace_back(equation, symbol.index);
    }
    // A declaration equation without derivatives defines its variable.
    if (const int bound = equations_[e].bound; bound >= 0 && !hasDerivatives)
      (void)matching.join(equation, bound);
  }
  int free = matching.augmentAll();
  for (const auto &edges : later) {
    if (free == 0)
      break;
    for (const auto &[equation, unknown] : edges)
      matching.addEdge(equation, unknown);
    free = matching.augmentAll();
  }

  equationOf_.resize(static_cast<std::size_t>(count));
  stateIndex_.assign(static_cast<std::size_t>(count), -1);
  for (int unknown = 0; unknown < count; ++unknown) {
    const int equation = equationOf_[static_cast<std::size_t>(unknown)] = matching.equationOf(unknown);
    if (equation < 0)
      continue;
    const auto &derivatives = throughDerivative[static_cast<std::size_t>(equation)];
    if (std::ranges::find(derivatives, unknown) != derivatives.end()) {
      stateIndex_[static_cast<std::size_t>(unknown)] = static_cast<int>(states_.size());
      states_.push_back(unknown);
    }
  }
  return reportUnmatched(symbols);
}

bool EquationSystem::reportUnmatched(const Dependencies &symbols) {
  std::vector<char> isMatched(equations_.size(), 0);
  bool isComplete = true;
  std::map<flat::VariableId, std::vector<int>> undetermined;
  for (int unknown = 0; unknown < variables_.count(Role::Unknown); ++unknown) {
    if (const int equation = equationOf_[static_cast<std::size_t>(unknown)]; equation >= 0)
      isMatched[static_cast<std::size_t>(equation)] = 1;
    else
      undetermined[variables_.scalars(Role::Unknown)[static_cast<std::size_t>(unknown)].variable].push_back(unknown);
  }
  for (const auto &[variable, unknowns] : undetermined) {
    const std::string others = unknowns.size() > 1 ? fmt::format(" and {} more of its elements", unknowns.size() - 1) : "";
    const Span declared = declarationOf(unknowns[0]);
    Diagnostic &report = diagnostics_.report(diag::UndeterminedVariable, declared, nameOf(unknowns[0]), others);
    const flat::Variable &whole = variables_.variable(variables_.scalars(Role::Unknown)[static_cast<std::size_t>(unknowns[0])]);
    if (whole.isComponentInput)
      report.note(declared,
                  fmt::format("it is an input of a component, which the model around gives by an equation: '{} = …', for instance "
                              "an input of its own",
                              whole.name));
    isComplete = false;
  }
  for (std::size_t e = 0; e < equations_.size(); ++e)
    if (isMatched[e] == 0) {
      reportUnmatchedEquation(equations_[e], symbols[e]);
      isComplete = false;
    }
  return isComplete;
}

void EquationSystem::reportUnmatchedEquation(const ScalarEquation &equation, const std::vector<int> &symbols) {
  std::string coordinate;
  for (const auto &side : ir::dependencies(graph_, std::array{equation.left, equation.right}))
    for (const Symbol symbol : side)
      if (coordinate.empty() && (symbol.kind == SymbolKind::Coordinate || symbol.kind == SymbolKind::Velocity))
        coordinate = symbol.kind == SymbolKind::Velocity
                         ? variables_.movingName(symbol.index)
                         : variables_.name(variables_.scalars(Role::Coordinate)[static_cast<std::size_t>(symbol.index)]);
  if (symbols.empty() && !coordinate.empty()) {
    diagnostics_.report(diag::ConstraintEquation, equation.span, coordinate);
    return;
  }
  Diagnostic &diagnostic = diagnostics_.report(diag::RedundantEquation, equation.span);
  for (const int id : symbols)
    if (const int unknown = provisionals_[id].index;
        provisionals_[id].kind == Provisional::Kind::Variable && equationOf_[static_cast<std::size_t>(unknown)] >= 0)
      diagnostic.note(equationOf(unknown).span, fmt::format("'{}' is determined here", nameOf(unknown)));
  if (!coordinate.empty())
    diagnostic.note(equation.span, fmt::format("it would restrict the coordinate '{}' (not supported yet)", coordinate));
}

// The provisional symbols that the definition of `id` is made of; new ones are added where a derivative needs others' derivatives.
std::vector<int> EquationSystem::dependenciesOf(int id, const Dependencies &known) {
  const Provisional symbol = provisionals_[id];
  if (symbol.kind == Provisional::Kind::Switch)
    return unknownsOf(graph_, {provisionals_.switches()[static_cast<std::size_t>(symbol.index)].condition});
  const int base = isState(symbol.index) ? 1 : 0;
  if (symbol.order < base)
    return {};
  if (symbol.order == base) {
    const ScalarEquation &equation = equationOf(symbol.index);
    std::vector<int> ids = unknownsOf(graph_, {equation.left, equation.right});
    std::erase(ids, id);
    return ids;
  }
  const int lower = provisionals_.variable(symbol.index, symbol.order - 1, symbol.span);
  std::vector<int> ids{lower};
  const std::vector<int> &parts = static_cast<std::size_t>(lower) < known.size() && !known[static_cast<std::size_t>(lower)].empty()
                                      ? known[static_cast<std::size_t>(lower)]
                                      : dependenciesOf(lower, known);
  for (const int part : std::vector<int>(parts)) {
    const Provisional other = provisionals_[part];
    ids.push_back(part);
    if (other.kind == Provisional::Kind::Variable)
      ids.push_back(provisionals_.variable(other.index, other.order + 1, symbol.span));
  }
  return ids;
}

bool EquationSystem::completeDerivatives(Dependencies &dependsOn) {
  for (int id = 0; id < provisionals_.size(); ++id) {
    if (provisionals_[id].order > kMaximalOrder) {
      reportLoop({id});
      return false;
    }
    dependsOn.push_back(dependenciesOf(id, dependsOn));
  }
  return true;
}

void EquationSystem::reportLoop(const std::vector<int> &component) {
  std::vector<int> members = component;
  std::ranges::sort(members);
  std::string names;
  std::size_t count = 0;
  Span span;
  std::vector<std::pair<Span, std::string>> notes;
  for (const int id : members) {
    const Provisional &member = provisionals_[id];
    if (member.kind == Provisional::Kind::Switch) {
      const ProvisionalSwitch &switching = provisionals_.switches()[static_cast<std::size_t>(member.index)];
      notes.emplace_back(switching.span, fmt::format("the condition '{}' is part of the loop", switching.text));
      continue;
    }
    const std::string name = member.order == 0 ? nameOf(member.index) : fmt::format("der({})", nameOf(member.index));
    const Span where = equationOf(member.index).span;
    if (!span.valid())
      span = where;
    else if (count < kNamesInMessages)
      notes.emplace_back(where, fmt::format("this equation determines '{}'", name));
    if (count < kNamesInMessages)
      names += (count == 0 ? "'" : ", '") + name + "'";
    ++count;
  }
  if (count > kNamesInMessages)
    names += fmt::format(" and {} more", count - kNamesInMessages);
  Diagnostic &diagnostic =
      count == 1 ? diagnostics_.report(diag::ImplicitVariable, span, names) : diagnostics_.report(diag::AlgebraicLoop, span, names);
  for (auto &[where, text] : notes)
    diagnostic.note(where, std::move(text));
}

std::vector<NodeId> EquationSystem::resolve(std::span<const NodeId> nodes) {
  return ir::substitute(graph_, nodes, [&](Symbol symbol) {
    const auto index = static_cast<std::size_t>(symbol.index);
    return symbol.kind == SymbolKind::Unknown && index < definitions_.size() ? definitions_[index] : -1;
  });
}

NodeId EquationSystem::definition(int unknown) {
  return definitions_[static_cast<std::size_t>(provisionals_.variable(unknown, 0, declarationOf(unknown)))];
}

bool EquationSystem::define(int id) {
  const Provisional symbol = provisionals_[id];
  if (symbol.kind == Provisional::Kind::Switch)
    return defineSwitch(id);
  const int state = stateIndex_[static_cast<std::size_t>(symbol.index)];
  if (state >= 0 && symbol.order == 0) {
    definitions_[static_cast<std::size_t>(id)] = graph_.symbol(SymbolKind::State, state);
    return true;
  }
  return symbol.order == (state >= 0 ? 1 : 0) ? defineVariable(id) : defineDerivative(id);
}

bool EquationSystem::defineVariable(int id) {
  const Provisional symbol = provisionals_[id];
  if (!solveFor(id, equationOf(symbol.index)))
    return false;
  const int state = stateIndex_[static_cast<std::size_t>(symbol.index)];
  if (state < 0)
    return true;
  const NodeId derivative = definitions_[static_cast<std::size_t>(id)];
  stateDerivatives_[static_cast<std::size_t>(state)] = derivative;
  for (const Symbol force : symbolsOf(graph_, derivative))
    if (isForce(force)) {
      diagnostics_.report(diag::StateOnForce, equationOf(symbol.index).span, nameOf(symbol.index), names_.describe(force));
      return false;
    }
  return true;
}

bool EquationSystem::solveFor(int id, const ScalarEquation &equation) {
  const auto sides = resolve(std::array{equation.left, equation.right});
  const LinearSolution solution = solveLinear(graph_, sides[0], sides[1], {SymbolKind::Unknown, id});
  const Provisional symbol = provisionals_[id];
  const std::string name = symbol.order == 0 ? nameOf(symbol.index) : fmt::format("der({})", nameOf(symbol.index));
  switch (solution.outcome) {
  case LinearSolution::Outcome::Solved:
    definitions_[static_cast<std::size_t>(id)] = solution.value;
    return true;
  case LinearSolution::Outcome::Vanishing:
    diagnostics_.report(diag::VanishingUnknown, equation.span, name);
    return false;
  case LinearSolution::Outcome::Nonlinear:
    diagnostics_.report(diag::NonlinearEquation, equation.span, name);
    return false;
  }
  return false;
}

bool EquationSystem::defineDerivative(int id) {
  const Provisional symbol = provisionals_[id];
  const NodeId lower = definitions_[static_cast<std::size_t>(provisionals_.variable(symbol.index, symbol.order - 1, symbol.span))];
  bool isKnown = true;
  const auto seed = [&](Symbol s) -> NodeId {
    switch (s.kind) {
    case SymbolKind::Time:
      return graph_.constant(1);
    case SymbolKind::Coordinate:
      return variables_.motion().rate(graph_, s.index);
    case SymbolKind::Velocity:
      return graph_.symbol(SymbolKind::Acceleration, s.index);
    case SymbolKind::State:
      return stateDerivatives_[static_cast<std::size_t>(s.index)];
    case SymbolKind::Input:
      diagnostics_.report(diag::DerivativeOfInput, symbol.span,
                          variables_.name(variables_.scalars(Role::Input)[static_cast<std::size_t>(s.index)]));
      break;
    case SymbolKind::Acceleration:
    case SymbolKind::NormalForce:
    case SymbolKind::TangentForce:
    case SymbolKind::Multiplier:
      diagnostics_.report(diag::DerivativeOfForce, symbol.span, names_.describe(s));
      break;
    default:
      return graph_.constant(0);
    }
    isKnown = false;
    return graph_.constant(0);
  };
  makeDiscontinuous(lower);
  definitions_[static_cast<std::size_t>(id)] = ir::forwardDerivative(graph_, std::array{lower}, seed)[0];
  return isKnown;
}

void EquationSystem::makeDiscontinuous(NodeId node) {
  for (const Symbol symbol : symbolsOf(graph_, node))
    if (symbol.kind == SymbolKind::StepVariable)
      if (Switch &switching = switches_[static_cast<std::size_t>(symbol.index)]; switching.kind == SwitchKind::Continuous)
        switching.kind = SwitchKind::Sliding;
}

std::vector<NodeId> EquationSystem::inlineContinuousSwitches(std::span<const NodeId> acting) {
  const auto isKink = [](const Switch &one) { return one.kind == SwitchKind::Continuous; };
  std::vector<char> isLocated(switches_.size());
  std::ranges::transform(switches_, isLocated.begin(), [&](const Switch &one) { return isKink(one) ? 0 : 1; });
  const auto locate = [&](std::span<const NodeId> nodes) {
    (void)ir::dependsOn(graph_, nodes, [&](Symbol symbol) {
      if (symbol.kind == SymbolKind::StepVariable)
        isLocated[static_cast<std::size_t>(symbol.index)] = 1;
      return false;
    });
  };
  if (std::ranges::any_of(switches_, isKink)) {
    locate(acting);
    locate(stateDerivatives_);
  }
  // A condition depends on step variables before its own alone.
  for (std::size_t k = switches_.size(); k-- > 0;)
    if (isLocated[k] != 0)
      locate(std::array{switches_[k].condition});
  if (std::ranges::find(isLocated, 0) == isLocated.end())
    return {acting.begin(), acting.end()};

  std::vector<NodeId> steps;  // of all, in terms of those that stay
  std::vector<int> numbers;
  const auto replace = [&](std::span<const NodeId> nodes) {
    return ir::substitute(graph_, nodes, [&](Symbol symbol) {
      return symbol.kind == SymbolKind::StepVariable ? steps[static_cast<std::size_t>(symbol.index)] : -1;
    });
  };
  std::vector<Switch> located;
  for (std::size_t k = 0; k < switches_.size(); ++k) {
    Switch one = switches_[k];
    one.condition = replace(std::array{one.condition})[0];
    numbers.push_back(static_cast<int>(located.size()));
    if (isLocated[k] == 0) {
      steps.push_back(graph_.binary(one.zeroIsPositive ? ir::Op::LessEqual : ir::Op::Less, graph_.constant(0), one.condition));
      continue;
    }
    steps.push_back(graph_.symbol(SymbolKind::StepVariable, numbers.back()));
    located.push_back(std::move(one));
  }
  for (Switch &one : located) {
    one.of = one.of < 0 ? one.of : numbers[static_cast<std::size_t>(one.of)];
    one.rest = one.rest < 0 ? one.rest : numbers[static_cast<std::size_t>(one.rest)];
  }
  switches_ = std::move(located);
  definitions_ = replace(definitions_);
  stateDerivatives_ = replace(stateDerivatives_);
  return replace(acting);
}

// A number; no event.
NodeId EquationSystem::parametricStep(const ProvisionalSwitch &provisional, NodeId condition) {
  const NodeId isPositive = graph_.binary(ir::Op::Less, graph_.constant(0), condition);
  const NodeId isNotNegative = graph_.binary(ir::Op::LessEqual, graph_.constant(0), condition);
  if (provisional.atZero == 0)
    return isPositive;
  if (provisional.atZero == 1)
    return isNotNegative;
  return graph_.mul(graph_.constant(0.5), graph_.add(isPositive, isNotNegative));
}

NodeId EquationSystem::restOf(int index) {
  Switch &shared = switches_[static_cast<std::size_t>(index)];
  if (shared.rest >= 0)
    return graph_.symbol(SymbolKind::StepVariable, shared.rest);
  shared.rest = static_cast<int>(switches_.size());
  const NodeId variable = graph_.symbol(SymbolKind::StepVariable, shared.rest);
  const Switch added = {shared.condition, SwitchKind::Rest, false, shared.text, shared.span, index};
  switches_.push_back(added);
  return variable;
}

bool EquationSystem::defineSwitch(int id) {
  const ProvisionalSwitch &provisional = provisionals_.switches()[static_cast<std::size_t>(provisionals_[id].index)];
  const NodeId condition = resolve(provisional.condition);
  SwitchKind kind = provisional.isContinuous ? SwitchKind::Continuous : SwitchKind::Sliding;
  bool isParametric = true, isTime = true;
  for (const Symbol symbol : symbolsOf(graph_, condition)) {
    if (isForce(symbol)) {
      diagnostics_.report(diag::ConditionOnForce, provisional.span, provisional.text, names_.describe(symbol));
      return false;
    }
    // A step variable moves with its own condition.
    const bool isTimeStep =
        symbol.kind == SymbolKind::StepVariable && switches_[static_cast<std::size_t>(symbol.index)].kind == SwitchKind::Time;
    isParametric = isParametric && symbol.kind == SymbolKind::Parameter;
    isTime = isTime && (symbol.kind == SymbolKind::Parameter || symbol.kind == SymbolKind::Time || isTimeStep);
  }
  NodeId &definition = definitions_[static_cast<std::size_t>(id)];
  if (isParametric) {
    definition = parametricStep(provisional, condition);
    return true;
  }
  const LinearForm form = normalForm(graph_, condition);
  const auto [entry, isNew] = sharedSwitches_.try_emplace(form.terms, std::pair{static_cast<int>(switches_.size()), form.scale});
  const auto [index, scale] = entry->second;
  if (isNew)
    switches_.push_back({condition, isTime ? SwitchKind::Time : kind, provisional.atZero > 0, provisional.text, provisional.span});
  else if (Switch &shared = switches_[static_cast<std::size_t>(index)]; shared.kind == SwitchKind::Continuous)
    shared.kind = kind;
  const NodeId alpha = graph_.symbol(SymbolKind::StepVariable, index);
  const bool isSame = form.scale * scale > 0;
  definition = isSame ? alpha : graph_.sub(graph_.constant(1), alpha);
  // Where the condition stays 0, relations that share the step variable need not all be what it is.
  const double shared = switches_[static_cast<std::size_t>(index)].zeroIsPositive == isSame ? 1 : 0;
  if (const double differs = provisional.atZero - shared; differs != 0 && !provisional.isContinuous && !isTime)
    definition = graph_.add(definition, graph_.mul(graph_.constant(differs), restOf(index)));
  return true;
}

}  // namespace tf::equations
