// The functions of a compiled model, with the argument and result layout of runtime/abi/tf_model.h.
#include "compiler/ir/deviation.h"
#include "compiler/ir/sweep.h"
#include "compiler/mechanics/derivation.h"

#include <algorithm>
#include <functional>
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
      clear(buffer, first, length, group);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (!isCleared || nodes[k] != zero)
        store(buffer, first + static_cast<int>(k), nodes[k], group);
  }

  void add(int buffer, int position, NodeId node, int group) { function_.additions.push_back({buffer, position, node, group}); }

  void clear(int buffer, int position, int length, int group) { function_.clears.push_back({buffer, position, length, group}); }

  // Rows of equal length at `buffer` that a sweep computes, row k in group(k).
  template <class Group> static void addRows(std::vector<ir::MatrixRow> &rows, int buffer, int count, int length, const Group &group) {
    for (int k = 0; k < count; ++k)
      rows.push_back({buffer, k * length, group(static_cast<std::size_t>(k))});
  }

  void sweep(std::span<const NodeId> results, const std::vector<std::vector<int>> &structure, int seedCount, ir::SweepOver over,
             std::span<const ir::MatrixRow> rows) {
    ir::addSweep(function_, results, structure, seedCount, over, rows);
  }

  // The sweep gives the products of its matrix with directions as well.
  void addProducts() {
    ir::Sweep &sweep = *function_.sweep;
    sweep.products = emptyBuffer(static_cast<int>(sweep.results.size()) * ir::Sweep::directions);
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
    for (std::size_t k = 0; k < x_.size(); ++k)
      columnOf_[{graph_[x_[k]].symbol.kind, graph_[x_[k]].symbol.index}] = static_cast<int>(k);
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

  // Of dynamics_derivatives.
  enum DerivativeBuffer : int { Residual, StateDerivatives, NormalRows, TangentRows, Frictions, Bounds, ConstraintRows };
  // Jn A + bias and Jt A + bias.
  struct ContactRates {
    std::vector<NodeId> normal, tangent;
  };

  bool jacobianSweep(FunctionBuilder &builder, const std::vector<NodeId> &nodes, const std::vector<ir::MatrixRow> &rows);
  [[nodiscard]] bool areContactsApart() const;
  std::vector<NodeId> residualOfBodies();
  template <class Entry> void derivatives(const std::vector<NodeId> &nodes, const Entry &entry);
  void storeDerivatives(FunctionBuilder &builder, int buffer, int first, const std::vector<NodeId> &nodes, int group);
  void addForceDerivatives(FunctionBuilder &builder, const Contact &contact, int number);
  void addContactDerivatives(FunctionBuilder &builder, const ContactRates &rates);

  // A buffer of d nodes/dx, row i in group(i).
  template <class Group> void jacobianBuffer(FunctionBuilder &builder, const std::vector<NodeId> &nodes, Group group) {
    storeJacobian(builder, builder.emptyBuffer(static_cast<int>(nodes.size() * x_.size())), nodes, group);
  }
  template <class Group> void storeJacobian(FunctionBuilder &builder, int buffer, const std::vector<NodeId> &nodes, const Group &group) {
    const std::vector<NodeId> matrix = ir::jacobian(graph_, nodes, x_);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      builder.storeRow(buffer, static_cast<int>(i), std::span(matrix).subspan(i * x_.size(), x_.size()), group(i), graph_.constant(0));
  }

  HybridSystem &system_;
  ir::Graph &graph_;
  int contacts_, frictions_, tangents_;
  std::map<std::pair<SymbolKind, int>, int> columnOf_;
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
  if (!system_.massProduct.empty())
    builder.addProducts();
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

// Derivatives of contacts whose rows are short are written out by contact, so that code of like contacts is there once, and run for those
// that are selected only.
bool ModelFunctions::areContactsApart() const {
  // Few contacts are no more code than what they are added to.
  constexpr int many = 16;
  if (contacts_ < many || !system_.contactForce.empty())
    return false;
  const NodeId zero = graph_.constant(0);
  std::size_t entries = 0;
  const auto count = [&](const std::vector<NodeId> &row) {
    entries += row.size() - static_cast<std::size_t>(std::ranges::count(row, zero));
  };
  for (const Contact &contact : system_.contacts)
    count(contact.normal);
  for (const TangentRow &tangent : system_.tangents)
    count(tangent.jacobian);
  return entries <= mechanics::shortRow * static_cast<std::size_t>(contacts_ + tangents_);
}

// M v' − f − Jᵀλ without what belongs to contacts.
std::vector<NodeId> ModelFunctions::residualOfBodies() {
  return ir::substitute(graph_, system_.residual, [this](ir::Symbol symbol) {
    const bool isOfContact = symbol.kind == SymbolKind::NormalForce ||
                             (symbol.kind == SymbolKind::TangentForce && rowGroup_[static_cast<std::size_t>(symbol.index)] < contacts_);
    return isOfContact ? graph_.constant(0) : NodeId{-1};
  });
}

// Calls entry(k, column, node) for each derivative of nodes[k] by a variable of x that may differ from zero.
template <class Entry> void ModelFunctions::derivatives(const std::vector<NodeId> &nodes, const Entry &entry) {
  std::vector<NodeId> variables;
  std::vector<int> columns;
  std::map<int, NodeId> used;  // by column
  for (const std::vector<ir::Symbol> &symbols : ir::dependencies(graph_, nodes))
    for (const ir::Symbol symbol : symbols)
      if (const auto column = columnOf_.find({symbol.kind, symbol.index}); column != columnOf_.end())
        used.emplace(column->second, x_[static_cast<std::size_t>(column->second)]);
  for (const auto &[column, variable] : used) {
    columns.push_back(column);
    variables.push_back(variable);
  }
  const std::vector<NodeId> matrix = ir::jacobian(graph_, nodes, variables);
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (std::size_t j = 0; j < columns.size(); ++j)
      if (const NodeId node = matrix[k * columns.size() + j]; !graph_.isConstant(node, 0))
        entry(k, columns[j], node);
}

// Rows of derivatives of `nodes`, from row `first` of a buffer on.
void ModelFunctions::storeDerivatives(FunctionBuilder &builder, int buffer, int first, const std::vector<NodeId> &nodes, int group) {
  const int length = static_cast<int>(x_.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    builder.clear(buffer, (first + static_cast<int>(k)) * length, length, group);
  derivatives(nodes, [&](std::size_t k, int column, NodeId node) {
    builder.store(buffer, (first + static_cast<int>(k)) * length + column, node, group);
  });
}

// What the rows of a contact add to the derivatives of the residual: those of −Jᵀλ.
void ModelFunctions::addForceDerivatives(FunctionBuilder &builder, const Contact &contact, int number) {
  const int length = static_cast<int>(x_.size());
  std::map<int, std::vector<NodeId>> terms;  // by velocities
  const auto collect = [&](const std::vector<NodeId> &row, SymbolKind kind, int index) {
    for (std::size_t k = 0; k < row.size(); ++k)
      if (!graph_.isConstant(row[k], 0))
        terms[static_cast<int>(k)].push_back(graph_.mul(row[k], graph_.symbol(kind, index)));
  };
  collect(contact.normal, SymbolKind::NormalForce, number);
  for (int j = contact.tangentFirst; j < contact.tangentFirst + contact.tangentCount; ++j)
    collect(system_.tangents[static_cast<std::size_t>(j)].jacobian, SymbolKind::TangentForce, j);
  std::vector<int> velocities;
  std::vector<NodeId> forces;
  for (const auto &[velocity, summands] : terms) {
    velocities.push_back(velocity);
    forces.push_back(graph_.neg(graph_.sum(summands)));
  }
  derivatives(forces,
              [&](std::size_t k, int column, NodeId node) { builder.add(Residual, velocities[k] * length + column, node, number); });
}

void ModelFunctions::addContactDerivatives(FunctionBuilder &builder, const ContactRates &rates) {
  const std::vector<NodeId> bounds = this->bounds();
  for (int i = 0; i < contacts_; ++i) {
    const Contact &contact = system_.contacts[static_cast<std::size_t>(i)];
    storeDerivatives(builder, NormalRows, i, {rates.normal[static_cast<std::size_t>(i)]}, i);
    storeDerivatives(builder, Frictions, i, {contact.friction}, i);
    addForceDerivatives(builder, contact, i);
  }
  for (int j = 0; j < tangents_; ++j) {
    const auto row = static_cast<std::size_t>(j);
    storeDerivatives(builder, TangentRows, j, {rates.tangent[row]}, rowGroup_[row]);
    storeDerivatives(builder, Bounds, j, {bounds[row]}, rowGroup_[row]);
  }
}

// Output 0 holds the terms of all contacts' forces: those of unselected contacts are passed as 0.
ir::Function ModelFunctions::dynamicsDerivatives() {
  std::vector<NodeId> friction;
  friction.reserve(system_.contacts.size());
  for (const Contact &contact : system_.contacts)
    friction.push_back(contact.friction);
  const auto ofContact = [](std::size_t row) { return static_cast<int>(row); };
  const auto ofRow = [&](std::size_t row) { return rowGroup_[row]; };
  const ContactRates rates = {accelerations(system_.contacts, &Contact::normal, &Contact::gapRate),
                              accelerations(system_.tangents, &TangentRow::jacobian, &TangentRow::slip)};
  const std::vector<NodeId> constraint = accelerations(system_.constraintRows, &ConstraintRow::jacobian, &ConstraintRow::rate);
  const bool apart = areContactsApart();
  struct Part {
    std::vector<NodeId> nodes;
    std::function<int(std::size_t)> group;
    bool isOfContacts = false;
  };
  const std::vector<Part> parts = {{apart ? residualOfBodies() : system_.residual, always},
                                   {system_.stateDerivatives, always},
                                   {rates.normal, ofContact, true},
                                   {rates.tangent, ofRow, true},
                                   {friction, ofContact, true},
                                   {bounds(), ofRow, true},
                                   {constraint, always}};
  FunctionBuilder builder("dynamics_derivatives", contacts_ + frictions_);
  const int columns = static_cast<int>(x_.size());
  std::vector<NodeId> nodes;
  std::vector<ir::MatrixRow> rows;
  for (const Part &part : parts) {
    const int buffer = builder.emptyBuffer(static_cast<int>(part.nodes.size()) * columns);
    if (apart && part.isOfContacts)
      continue;
    nodes.insert(nodes.end(), part.nodes.begin(), part.nodes.end());
    builder.addRows(rows, buffer, static_cast<int>(part.nodes.size()), columns, part.group);
  }
  if (!jacobianSweep(builder, nodes, rows))
    for (int buffer = 0; buffer < static_cast<int>(parts.size()); ++buffer)
      if (const Part &part = parts[static_cast<std::size_t>(buffer)]; !(apart && part.isOfContacts))
        storeJacobian(builder, buffer, part.nodes, part.group);
  if (apart)
    addContactDerivatives(builder, rates);
  return builder.take();
}

// d nodes/dx by a loop over directions; false, and nothing done, if it is better written out.
bool ModelFunctions::jacobianSweep(FunctionBuilder &builder, const std::vector<NodeId> &nodes, const std::vector<ir::MatrixRow> &rows) {
  const int columns = static_cast<int>(x_.size());
  if (nodes.size() * x_.size() <= mechanics::fewEntries)
    return false;
  const std::vector<NodeId> results = ir::forwardDerivative(graph_, nodes, [&](ir::Symbol symbol) {
    const auto column = columnOf_.find({symbol.kind, symbol.index});
    return column == columnOf_.end() ? graph_.constant(0) : graph_.symbol(SymbolKind::Seed, column->second);
  });
  if (!ir::isSweepSmaller(graph_, results, columns, mechanics::fewEntries))
    return false;
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
