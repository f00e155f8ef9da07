// The functions of a compiled model, with the argument and result layout of runtime/abi/tf_model.h.
#include "compiler/ir/deviation.h"
#include "compiler/ir/sweep.h"
#include "compiler/mechanics/derivation.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace tf {

using ir::NodeId;
using ir::SymbolKind;

namespace {

constexpr auto always = [](std::size_t) { return -1; };

// Entries of M and of the contact rows up to which the code that evaluates both at once is worth its compile time.
constexpr int mostFusedEntries = 200;
// Contacts from which on it pays not to look at all of them.
constexpr int fewContacts = 8;

// Collects the stores of one function. Structural zeros are stored too: callers see complete arrays.
class FunctionBuilder {
public:
  explicit FunctionBuilder(std::string name, int groups = 0) {
    function_.name = std::move(name);
    function_.groups = groups;
  }

  // A new buffer of `nodes`, all in `group` (−1: always stored).
  int buffer(std::span<const NodeId> nodes, int group = -1) {
    const int index = emptyBuffer(static_cast<int>(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k)
      store(index, static_cast<int>(k), nodes[k], group);
    return index;
  }

  int emptyBuffer(int size) {
    function_.bufferSizes.push_back(size);
    return static_cast<int>(function_.bufferSizes.size()) - 1;
  }

  void store(int buffer, int position, NodeId node, int group) { function_.stores.push_back({buffer, position, node, group}); }

  // Long rows that are mostly `zero` (the constant 0) are cleared as a whole first.
  void storeRow(int buffer, int row, std::span<const NodeId> nodes, int group, NodeId zero) {
    constexpr std::size_t longRow = 16, mostly = 2;
    const int length = static_cast<int>(nodes.size()), first = row * length;
    const auto zeros = static_cast<std::size_t>(std::ranges::count(nodes, zero));
    const bool isCleared = nodes.size() >= longRow && mostly * zeros >= nodes.size();
    if (isCleared)
      function_.clears.push_back({buffer, first, length, group});
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (!isCleared || nodes[k] != zero)
        store(buffer, first + static_cast<int>(k), nodes[k], group);
  }

  // Rows of equal length at `buffer` that a sweep computes, row k in group(k).
  template <class Group> static void addRows(std::vector<ir::MatrixRow> &rows, int buffer, int count, int length, Group group) {
    for (int k = 0; k < count; ++k)
      rows.push_back({buffer, k * length, group(static_cast<std::size_t>(k))});
  }

  void sweep(std::span<const NodeId> results, const std::vector<std::vector<int>> &structure, int seedCount, ir::SweepOver over,
             std::span<const ir::MatrixRow> rows) {
    ir::addSweep(function_, results, structure, seedCount, over, rows);
  }

  ir::Function take() { return std::move(function_); }

private:
  ir::Function function_;
};

class ModelFunctions {
public:
  explicit ModelFunctions(HybridSystem &system)
      : system_(system), graph_(system.graph), contacts_(static_cast<int>(system.contacts.size())),
        frictions_(static_cast<int>(system.frictions.size())), tangents_(static_cast<int>(system.tangents.size())) {
    for (const auto &[kind, count] : {std::pair{SymbolKind::Coordinate, system.nq}, std::pair{SymbolKind::Velocity, system.nv},
                                      std::pair{SymbolKind::State, system.nz}, std::pair{SymbolKind::Input, system.nu}})
      std::ranges::copy(mechanics::symbols(graph_, kind, count), std::back_inserter(x_));
    x_.push_back(graph_.symbol(SymbolKind::Time));
    rowGroup_.assign(static_cast<std::size_t>(tangents_), -1);
    for (int k = 0; k < contacts_; ++k)
      assign(system.contacts[static_cast<std::size_t>(k)].tangentFirst, system.contacts[static_cast<std::size_t>(k)].tangentCount, k);
    for (int k = 0; k < frictions_; ++k)
      assign(system.frictions[static_cast<std::size_t>(k)].tangentFirst, system.frictions[static_cast<std::size_t>(k)].tangentCount,
             contacts_ + k);
  }

  ir::Function bindings();
  ir::Function starts();
  ir::Function kinematics();
  ir::Function kinematicsDerivatives();
  ir::Function dynamics();
  ir::Function switching();
  ir::Function contactTerms();
  ir::Function contactParameters();
  ir::Function constraintTerms();
  ir::Function switchGradients();
  ir::Function stepDerivatives();
  ir::Function dynamicsDerivatives();
  ir::Function outputs();
  ir::Function energies();
  ir::Function contactDynamics();
  ir::Function gapBounds();

private:
  void addDynamics(FunctionBuilder &builder);
  void addContactTerms(FunctionBuilder &builder);
  void assign(int first, int count, int group) { std::fill_n(rowGroup_.begin() + first, count, group); }

  // Nodes of all tangential rows' bounds: 0 on contacts' rows.
  std::vector<NodeId> bounds() {
    std::vector<NodeId> nodes(static_cast<std::size_t>(tangents_), graph_.constant(0));
    for (const FrictionElement &friction : system_.frictions)
      std::fill_n(nodes.begin() + friction.tangentFirst, friction.tangentCount, friction.bound);
    return nodes;
  }

  // N v.
  std::vector<NodeId> coordinateRates() {
    std::vector<NodeId> rates;
    rates.reserve(static_cast<std::size_t>(system_.nq));
    for (int k = 0; k < system_.nq; ++k)
      rates.push_back(system_.motion.rate(graph_, k));
    return rates;
  }

  // J a + bias.
  NodeId acceleration(const std::vector<NodeId> &row, NodeId bias) {
    std::vector<NodeId> terms{bias};
    for (std::size_t k = 0; k < row.size(); ++k)
      terms.push_back(graph_.mul(row[k], graph_.symbol(SymbolKind::Acceleration, static_cast<int>(k))));
    return graph_.sum(terms);
  }

  // d rate/dt in terms of the accelerations, of rows with rate' = jacobian · v' + bias.
  template <class Row>
  std::vector<NodeId> accelerations(const std::vector<Row> &rows, std::vector<NodeId> Row::*jacobian, NodeId Row::*rate) {
    std::vector<NodeId> nodes;
    if (system_.contactForce.empty()) {
      for (const Row &row : rows)
        nodes.push_back(acceleration(row.*jacobian, row.bias));
      return nodes;
    }
    for (const Row &row : rows)
      nodes.push_back(row.*rate);
    return mechanics::timeDerivative(system_, nodes, mechanics::AlongMotion::WithAcceleration);
  }

  bool jacobianSweep(FunctionBuilder &builder, const std::vector<NodeId> &nodes, const std::vector<ir::MatrixRow> &rows, int buffers);

  // A buffer of d nodes/dx, row i in group(i).
  template <class Group> void jacobianBuffer(FunctionBuilder &builder, const std::vector<NodeId> &nodes, Group group) {
    const std::vector<NodeId> matrix = ir::jacobian(graph_, nodes, x_);
    const int buffer = builder.emptyBuffer(static_cast<int>(matrix.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i)
      builder.storeRow(buffer, static_cast<int>(i), std::span(matrix).subspan(i * x_.size(), x_.size()), group(i), graph_.constant(0));
  }

  HybridSystem &system_;
  ir::Graph &graph_;
  int contacts_, frictions_, tangents_;
  std::vector<NodeId> x_;      // columns of derivative matrices: q, v, z, u, t
  std::vector<int> rowGroup_;  // of tangential rows: contacts, then friction elements
};

ir::Function ModelFunctions::bindings() {
  std::vector<NodeId> nodes = system_.parameterBindings;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    if (nodes[k] < 0)
      nodes[k] = graph_.symbol(SymbolKind::Parameter, static_cast<int>(k));
  FunctionBuilder builder("bindings");
  builder.buffer(nodes);
  return builder.take();
}

ir::Function ModelFunctions::starts() {
  FunctionBuilder builder("starts");
  builder.buffer(system_.coordinateStarts);
  builder.buffer(system_.velocityStarts);
  builder.buffer(system_.stateStarts);
  builder.buffer(system_.inputStarts);
  return builder.take();
}

ir::Function ModelFunctions::kinematics() {
  if (system_.motion.rotations().empty())
    return {};
  FunctionBuilder builder("kinematics");
  builder.buffer(coordinateRates());
  return builder.take();
}

ir::Function ModelFunctions::kinematicsDerivatives() {
  if (system_.motion.rotations().empty())
    return {};
  const std::vector<NodeId> rates = coordinateRates();
  FunctionBuilder builder("kinematics_derivatives");
  builder.buffer(ir::jacobian(graph_, rates, mechanics::symbols(graph_, SymbolKind::Velocity, system_.nv)));
  builder.buffer(ir::jacobian(graph_, rates, mechanics::symbols(graph_, SymbolKind::Coordinate, system_.nq)));
  return builder.take();
}

void ModelFunctions::addDynamics(FunctionBuilder &builder) {
  if (system_.massProduct.empty()) {
    builder.buffer(system_.mass);
  } else {
    std::vector<ir::MatrixRow> rows;
    builder.addRows(rows, builder.emptyBuffer(system_.nv * system_.nv), system_.nv, system_.nv, always);
    builder.sweep(system_.massProduct, ir::seedStructure(graph_, system_.massProduct, system_.nv), system_.nv, ir::SweepOver::Columns,
                  rows);
  }
  builder.buffer(system_.force);
  builder.buffer(system_.stateDerivatives);
}

ir::Function ModelFunctions::dynamics() {
  FunctionBuilder builder("dynamics");
  addDynamics(builder);
  return builder.take();
}

ir::Function ModelFunctions::switching() {
  const int slips = contacts_, conditions = contacts_ + contacts_ + frictions_;
  FunctionBuilder builder("switching", conditions + 1);
  const int gap = builder.emptyBuffer(contacts_), rate = builder.emptyBuffer(contacts_), slip = builder.emptyBuffer(tangents_);
  for (int k = 0; k < contacts_; ++k) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(k)];
    builder.store(gap, k, contact.gap, k);
    builder.store(rate, k, contact.gapRate, k);
  }
  for (int k = 0; k < tangents_; ++k) {
    const auto row = static_cast<std::size_t>(k);
    builder.store(slip, k, system_.tangents[row].slip, slips + rowGroup_[row]);
  }
  std::vector<NodeId> nodes;
  nodes.reserve(system_.switches.size());
  for (const SwitchingFunction &switching : system_.switches)
    nodes.push_back(switching.condition);
  builder.buffer(nodes, conditions);
  return builder.take();
}

void ModelFunctions::addContactTerms(FunctionBuilder &builder) {
  const int normal = builder.emptyBuffer(contacts_ * system_.nv), normalBias = builder.emptyBuffer(contacts_);
  const int tangent = builder.emptyBuffer(tangents_ * system_.nv), tangentBias = builder.emptyBuffer(tangents_);
  const int friction = builder.emptyBuffer(contacts_), bound = builder.emptyBuffer(tangents_);
  const NodeId zero = graph_.constant(0);
  for (int k = 0; k < contacts_; ++k) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(k)];
    if (system_.contactForce.empty())
      builder.storeRow(normal, k, contact.normal, k, zero);
    builder.store(normalBias, k, contact.bias, k);
    builder.store(friction, k, contact.friction, k);
  }
  const std::vector<NodeId> bounds = this->bounds();
  for (int k = 0; k < tangents_; ++k) {
    const auto row = static_cast<std::size_t>(k);
    if (system_.contactForce.empty())
      builder.storeRow(tangent, k, system_.tangents[row].jacobian, rowGroup_[row], zero);
    builder.store(tangentBias, k, system_.tangents[row].bias, rowGroup_[row]);
    builder.store(bound, k, bounds[row], rowGroup_[row]);
  }
  if (!system_.contactForce.empty()) {
    std::vector<ir::MatrixRow> rows;
    builder.addRows(rows, normal, contacts_, system_.nv, [](std::size_t k) { return static_cast<int>(k); });
    builder.addRows(rows, tangent, tangents_, system_.nv, [&](std::size_t k) { return rowGroup_[k]; });
    const int seeds = contacts_ + tangents_;
    builder.sweep(system_.contactForce, ir::seedStructure(graph_, system_.contactForce, seeds), seeds, ir::SweepOver::Rows, rows);
  }
}

ir::Function ModelFunctions::contactTerms() {
  FunctionBuilder builder("contact_terms", contacts_ + frictions_);
  addContactTerms(builder);
  return builder.take();
}

ir::Function ModelFunctions::contactDynamics() {
  const int rows = contacts_ + tangents_;
  if (rows == 0 || system_.nv * (system_.nv + rows) > mostFusedEntries || !system_.massProduct.empty() || !system_.contactForce.empty())
    return {};
  FunctionBuilder builder("contact_dynamics", contacts_ + frictions_);
  addDynamics(builder);
  addContactTerms(builder);
  return builder.take();
}

ir::Function ModelFunctions::contactParameters() {
  std::vector<NodeId> rates, restitutions;
  for (const Contact &contact : system_.contacts) {
    rates.push_back(contact.rate);
    restitutions.push_back(contact.restitution);
  }
  FunctionBuilder builder("contact_parameters");
  builder.buffer(rates);
  builder.buffer(restitutions);
  return builder.take();
}

ir::Function ModelFunctions::constraintTerms() {
  if (system_.constraintRows.empty())
    return {};
  std::vector<NodeId> residuals, rates, jacobian, biases;
  for (const ConstraintRow &row : system_.constraintRows) {
    residuals.push_back(row.residual);
    rates.push_back(row.rate);
    jacobian.insert(jacobian.end(), row.jacobian.begin(), row.jacobian.end());
    biases.push_back(row.bias);
  }
  FunctionBuilder builder("constraint_terms", 2);
  builder.buffer(residuals, 0);
  builder.buffer(rates, 0);
  builder.buffer(jacobian, 1);
  builder.buffer(biases, 1);
  return builder.take();
}

ir::Function ModelFunctions::switchGradients() {
  std::vector<NodeId> conditions;
  conditions.reserve(system_.switches.size());
  for (const SwitchingFunction &switching : system_.switches)
    conditions.push_back(switching.condition);
  FunctionBuilder builder("switch_gradients", static_cast<int>(conditions.size()));
  jacobianBuffer(builder, conditions, [](std::size_t row) { return static_cast<int>(row); });
  return builder.take();
}

ir::Function ModelFunctions::stepDerivatives() {
  const std::vector<NodeId> steps = mechanics::symbols(graph_, SymbolKind::StepVariable, static_cast<int>(system_.switches.size()));
  FunctionBuilder builder("step_derivatives");
  builder.buffer(ir::jacobian(graph_, system_.force, steps));
  builder.buffer(ir::jacobian(graph_, system_.stateDerivatives, steps));
  return builder.take();
}

// Output 0 holds the terms of all contacts' forces: those of unselected contacts are passed as 0.
ir::Function ModelFunctions::dynamicsDerivatives() {
  std::vector<NodeId> friction;
  friction.reserve(system_.contacts.size());
  for (const Contact &contact : system_.contacts)
    friction.push_back(contact.friction);
  const auto ofContact = [](std::size_t row) { return static_cast<int>(row); };
  const auto ofRow = [&](std::size_t row) { return rowGroup_[row]; };
  const std::vector<NodeId> normal = accelerations(system_.contacts, &Contact::normal, &Contact::gapRate);
  const std::vector<NodeId> tangent = accelerations(system_.tangents, &TangentRow::jacobian, &TangentRow::slip);
  const std::vector<NodeId> constraint = accelerations(system_.constraintRows, &ConstraintRow::jacobian, &ConstraintRow::rate);
  const std::vector<NodeId> bounds = this->bounds();
  FunctionBuilder builder("dynamics_derivatives", contacts_ + frictions_);
  std::vector<NodeId> nodes;
  std::vector<ir::MatrixRow> rows;
  const auto add = [&](const std::vector<NodeId> &some, int buffer, auto group) {
    nodes.insert(nodes.end(), some.begin(), some.end());
    builder.addRows(rows, buffer, static_cast<int>(some.size()), static_cast<int>(x_.size()), group);
  };
  int buffer = 0;
  add(system_.residual, buffer++, always);
  add(system_.stateDerivatives, buffer++, always);
  add(normal, buffer++, ofContact);
  add(tangent, buffer++, ofRow);
  add(friction, buffer++, ofContact);
  add(bounds, buffer++, ofRow);
  add(constraint, buffer++, always);
  if (jacobianSweep(builder, nodes, rows, buffer))
    return builder.take();
  jacobianBuffer(builder, system_.residual, always);
  jacobianBuffer(builder, system_.stateDerivatives, always);
  jacobianBuffer(builder, normal, ofContact);
  jacobianBuffer(builder, tangent, ofRow);
  jacobianBuffer(builder, friction, ofContact);
  jacobianBuffer(builder, bounds, ofRow);
  jacobianBuffer(builder, constraint, always);
  return builder.take();
}

// d nodes/dx by a loop over directions, in `buffers` buffers; false, and nothing done, if it is better written out.
bool ModelFunctions::jacobianSweep(FunctionBuilder &builder, const std::vector<NodeId> &nodes, const std::vector<ir::MatrixRow> &rows,
                                   int buffers) {
  const int columns = static_cast<int>(x_.size());
  if (nodes.size() * x_.size() <= mechanics::fewEntries)
    return false;
  std::map<std::pair<SymbolKind, int>, int> columnOf;
  for (int k = 0; k < columns; ++k) {
    const ir::Symbol symbol = graph_[x_[static_cast<std::size_t>(k)]].symbol;
    columnOf[{symbol.kind, symbol.index}] = k;
  }
  const std::vector<NodeId> results = ir::forwardDerivative(graph_, nodes, [&](ir::Symbol symbol) {
    const auto column = columnOf.find({symbol.kind, symbol.index});
    return column == columnOf.end() ? graph_.constant(0) : graph_.symbol(SymbolKind::Seed, column->second);
  });
  if (!ir::isSweepSmaller(graph_, results, columns, mechanics::fewEntries))
    return false;
  std::vector<int> sizes(static_cast<std::size_t>(buffers), 0);
  for (const ir::MatrixRow &row : rows)
    sizes[static_cast<std::size_t>(row.buffer)] += columns;
  for (const int size : sizes)
    builder.emptyBuffer(size);
  builder.sweep(results, ir::seedStructure(graph_, results, columns), columns, ir::SweepOver::Columns, rows);
  return true;
}

ir::Function ModelFunctions::outputs() {
  FunctionBuilder builder("outputs");
  builder.buffer(system_.outputs);
  return builder.take();
}

ir::Function ModelFunctions::energies() {
  FunctionBuilder builder("energies");
  builder.buffer(std::array{system_.kineticEnergy});
  builder.buffer(std::array{system_.potentialEnergy});
  builder.buffer(std::array{system_.power});
  return builder.take();
}

// Step variables are those of switches that time turns over: they may take any value. Inputs are not known beforehand.
ir::Function ModelFunctions::gapBounds() {
  if (contacts_ < fewContacts)
    return {};
  std::vector<NodeId> gaps;
  gaps.reserve(system_.contacts.size());
  for (const Contact &contact : system_.contacts)
    gaps.push_back(contact.gap);
  const std::vector<NodeId> bounds = ir::deviationBounds(graph_, gaps, [this](ir::Symbol symbol) {
    switch (symbol.kind) {
    case SymbolKind::Parameter:
      return graph_.constant(0);
    case SymbolKind::Coordinate:
      return graph_.symbol(SymbolKind::Radius, symbol.index);
    case SymbolKind::Time:
      return graph_.symbol(SymbolKind::Radius, system_.nq);
    case SymbolKind::StepVariable:
      return graph_.constant(1);
    default:
      return graph_.constant(std::numeric_limits<double>::infinity());
    }
  });
  FunctionBuilder builder("gap_bounds");
  builder.buffer(gaps);
  builder.buffer(bounds);
  return builder.take();
}

}  // namespace

std::vector<ir::Function> modelFunctions(HybridSystem &system) {
  ModelFunctions functions(system);
  std::vector<ir::Function> all;
  all.push_back(functions.bindings());
  all.push_back(functions.starts());
  all.push_back(functions.kinematics());
  all.push_back(functions.kinematicsDerivatives());
  all.push_back(functions.dynamics());
  all.push_back(functions.switching());
  all.push_back(functions.contactTerms());
  all.push_back(functions.contactParameters());
  all.push_back(functions.constraintTerms());
  all.push_back(functions.switchGradients());
  all.push_back(functions.stepDerivatives());
  all.push_back(functions.dynamicsDerivatives());
  all.push_back(functions.outputs());
  all.push_back(functions.energies());
  all.push_back(functions.contactDynamics());
  all.push_back(functions.gapBounds());
  return all;
}

}  // namespace tf
