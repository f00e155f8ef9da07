#include "compiler/codegen/model_facts.h"

#include "compiler/ir/sweep.h"
#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <vector>

namespace tf::codegen {

namespace {

// Of every node; operands come before what they are operands of.
std::vector<int> variationOfNodes(const ir::Graph &graph) {
  std::vector<int> all(static_cast<std::size_t>(graph.size()), 0);
  for (ir::NodeId id = 0; id < graph.size(); ++id) {
    const ir::Node &node = graph[id];
    int &own = all[static_cast<std::size_t>(id)];
    if (node.op == ir::Op::Symbol)
      own = node.symbol.kind == ir::SymbolKind::Time    ? TF_VARIES_WITH_TIME
            : node.symbol.kind == ir::SymbolKind::Input ? TF_VARIES_WITH_INPUTS
                                                        : 0;
    for (int j = 0; j < node.arity; ++j)
      own |= all[static_cast<std::size_t>(node.operands[j])];
  }
  return all;
}

// Functions that may be the same on both sides of a place and change there. What a switch selects does so too, but the switch is located.
bool isLocal(ir::Op op) {
  switch (op) {
  case ir::Op::Exp:
  case ir::Op::Tanh:
  case ir::Op::Atan:
  case ir::Op::Abs:
  case ir::Op::Sign:
  case ir::Op::Min:
  case ir::Op::Max:
  case ir::Op::Floor:
  case ir::Op::Ceil:
  case ir::Op::IfElse:
    return true;
  default:
    return false;
  }
}

// Of every node: a local function of coordinates is part of it.
std::vector<bool> localNodes(const ir::Graph &graph) {
  const auto size = static_cast<std::size_t>(graph.size());
  std::vector<bool> moves(size), local(size);
  for (ir::NodeId id = 0; id < graph.size(); ++id) {
    const ir::Node &node = graph[id];
    const auto k = static_cast<std::size_t>(id);
    moves[k] = node.op == ir::Op::Symbol && node.symbol.kind == ir::SymbolKind::Coordinate;
    for (int j = 0; j < node.arity; ++j) {
      const auto operand = static_cast<std::size_t>(node.operands[j]);
      const bool decides = isLocal(node.op) && (node.op != ir::Op::IfElse || j == 0);
      moves[k] = moves[k] || moves[operand];
      local[k] = local[k] || local[operand] || (decides && moves[operand]);
    }
  }
  return local;
}

// As a function of the coordinates, with coefficients that are parameters'.
enum class Form : std::uint8_t { Constant, Affine, Other };

Form formOf(const ir::Node &node, Form a, Form b) {
  switch (node.op) {
  case ir::Op::Neg:
    return a;
  case ir::Op::Add:
  case ir::Op::Sub:
    return std::max(a, b);
  case ir::Op::Mul:
    return std::min(a, b) == Form::Constant ? std::max(a, b) : Form::Other;
  case ir::Op::Div:
    return b == Form::Constant ? a : Form::Other;
  default:
    return Form::Other;
  }
}

std::vector<Form> formsOfNodes(const ir::Graph &graph) {
  std::vector<Form> all(static_cast<std::size_t>(graph.size()), Form::Constant);
  for (ir::NodeId id = 0; id < graph.size(); ++id) {
    const ir::Node &node = graph[id];
    Form &own = all[static_cast<std::size_t>(id)];
    if (node.op == ir::Op::Symbol && node.symbol.kind != ir::SymbolKind::Parameter)
      own = node.symbol.kind == ir::SymbolKind::Coordinate ? Form::Affine : Form::Other;
    const auto of = [&](int j) { return j < node.arity ? all[static_cast<std::size_t>(node.operands[j])] : Form::Constant; };
    if (std::max({of(0), of(1), of(2)}) != Form::Constant)
      own = formOf(node, of(0), of(1));
  }
  return all;
}

bool variesInARun(ir::Symbol symbol) { return symbol.kind != ir::SymbolKind::Parameter && symbol.kind != ir::SymbolKind::Seed; }

}  // namespace

int bindingDepth(const HybridSystem &system) {
  const auto count = system.parameterBindings.size();
  std::vector<std::vector<std::size_t>> needs(count);
  std::vector<int> depth(count, 0);
  for (std::size_t p = 0; p < count; ++p) {
    if (system.parameterBindings[p] < 0)
      continue;
    depth[p] = 1;
    const auto symbols = ir::dependencies(system.graph, std::span(&system.parameterBindings[p], 1));
    for (const ir::Symbol symbol : symbols.front())
      if (symbol.kind == ir::SymbolKind::Parameter && system.parameterBindings[static_cast<std::size_t>(symbol.index)] >= 0)
        needs[p].push_back(static_cast<std::size_t>(symbol.index));
  }
  // Bindings are acyclic and mostly in order; at most one sweep per level.
  for (std::size_t sweep = 0; sweep < count; ++sweep) {
    bool changed = false;
    for (std::size_t p = 0; p < count; ++p)
      for (const std::size_t other : needs[p])
        if (depth[p] < depth[other] + 1) {
          depth[p] = depth[other] + 1;
          changed = true;
        }
    if (!changed)
      break;
  }
  return count == 0 ? 0 : *std::max_element(depth.begin(), depth.end());
}

bool massIsConstant(const HybridSystem &system) {
  return !ir::dependsOn(system.graph, system.massProduct.empty() ? system.mass : system.massProduct, variesInARun);
}

int locality(const HybridSystem &system) {
  const std::vector<bool> all = localNodes(system.graph);
  int result = 0;
  const auto add = [&](int bit, const std::vector<ir::NodeId> &nodes) {
    for (const ir::NodeId node : nodes)
      if (node >= 0 && all[static_cast<std::size_t>(node)])
        result |= bit;
  };
  for (const Contact &contact : system.contacts) {
    add(TF_LOCAL_GUARDS, {contact.gap});
    add(TF_LOCAL_FORCES, {contact.bias, contact.friction});
    add(TF_LOCAL_FORCES, contact.normal);
  }
  for (const TangentRow &row : system.tangents) {
    add(TF_LOCAL_FORCES, {row.bias});
    add(TF_LOCAL_FORCES, row.jacobian);
  }
  for (const SwitchingFunction &entry : system.switches)
    add(TF_LOCAL_GUARDS, {entry.condition});
  for (const FrictionElement &element : system.frictions)
    add(TF_LOCAL_FORCES, {element.bound});
  for (const ConstraintRow &row : system.constraintRows) {
    add(TF_LOCAL_FORCES, {row.bias});
    add(TF_LOCAL_FORCES, row.jacobian);
  }
  for (const auto *nodes : {&system.mass, &system.massProduct, &system.contactForce, &system.force, &system.stateDerivatives})
    add(TF_LOCAL_FORCES, *nodes);
  return result;
}

bool flightIsUniform(const HybridSystem &system) {
  return system.nz == 0 && system.constraintRows.empty() && system.motion.rotations().empty() && massIsConstant(system) &&
         !ir::dependsOn(system.graph, system.force, variesInARun);
}

bool frictionVaries(const HybridSystem &system, const Contact &contact) {
  return contact.friction >= 0 && ir::dependsOn(system.graph, contact.friction, variesInARun);
}

std::vector<bool> affineGaps(const HybridSystem &system) {
  std::vector<bool> result(system.contacts.size(), false);
  if (!system.motion.rotations().empty())
    return result;
  const std::vector<Form> forms = formsOfNodes(system.graph);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = system.contacts[i].gap >= 0 && forms[static_cast<std::size_t>(system.contacts[i].gap)] != Form::Other;
  return result;
}

bool dependsOnVelocity(const HybridSystem &system, const FrictionElement &friction) {
  return ir::dependsOn(system.graph, friction.bound, [](ir::Symbol symbol) { return symbol.kind == ir::SymbolKind::Velocity; });
}

bool MassStructure::isFull() const {
  const std::size_t n = rows.size() - 1;
  return columns.size() == n * (n - (n > 0 ? 1 : 0)) / 2;
}

MassStructure massStructure(const HybridSystem &system) {
  const auto n = static_cast<std::size_t>(system.nv);
  MassStructure result;
  result.rows.push_back(0);
  std::vector<std::vector<int>> swept;
  if (system.massProduct.empty())
    assert(system.mass.size() == n * n);
  else
    swept = ir::seedStructure(system.graph, system.massProduct, system.nv);
  for (std::size_t i = 0; i < n; ++i) {
    if (!swept.empty())
      std::ranges::copy_if(swept[i], std::back_inserter(result.columns), [i](int j) { return static_cast<std::size_t>(j) < i; });
    for (std::size_t j = 0; j < i && swept.empty(); ++j)
      if (!system.graph.isConstant(system.mass[i * n + j], 0))
        result.columns.push_back(static_cast<int>(j));
    result.rows.push_back(static_cast<int>(result.columns.size()));
  }
  return result;
}

std::vector<int> variation(const HybridSystem &system) {
  const std::vector<int> all = variationOfNodes(system.graph);
  int forces = 0;
  const auto of = [&all](ir::NodeId node) { return node < 0 ? 0 : all[static_cast<std::size_t>(node)]; };
  const auto add = [&](const std::vector<ir::NodeId> &nodes) {
    for (const ir::NodeId node : nodes)
      forces |= of(node);
  };
  std::vector<int> result;
  result.reserve(system.contacts.size() + system.tangents.size() + system.switches.size() + 1);
  for (const Contact &contact : system.contacts) {
    result.push_back(of(contact.gap));
    forces |= of(contact.bias) | of(contact.friction);
    add(contact.normal);
  }
  for (const TangentRow &row : system.tangents) {
    result.push_back(of(row.slip));
    forces |= of(row.bias);
    add(row.jacobian);
  }
  for (const SwitchingFunction &entry : system.switches)
    result.push_back(of(entry.condition));
  for (const FrictionElement &element : system.frictions)
    forces |= of(element.bound);
  for (const ConstraintRow &row : system.constraintRows) {
    forces |= of(row.bias);
    add(row.jacobian);
  }
  for (const auto *nodes : {&system.mass, &system.massProduct, &system.contactForce, &system.force, &system.stateDerivatives})
    add(*nodes);
  result.push_back(forces);
  return std::ranges::all_of(result, [](int bits) { return bits == 0; }) ? std::vector<int>() : result;
}

}  // namespace tf::codegen
