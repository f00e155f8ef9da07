// The table of quantities: names, units and descriptions of everything that a run reports or takes.
#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"
#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <optional>
#include <set>

namespace tf::mechanics {

using equations::Role;
using equations::ScalarVariable;
using ir::NodeId;
using ir::SymbolKind;

namespace {

// "m" → "m/s", "m/s" → "m/s2", "rad/s2" → "rad/s3"; no unit stays none.
std::string unitPerSecond(const std::string &unit) {
  if (unit.empty())
    return {};
  const std::size_t slash = unit.rfind("/s");
  if (slash == std::string::npos)
    return unit.find('/') == std::string::npos ? unit + "/s" : unit + ".s-1";
  const std::string power = unit.substr(slash + 2);
  if (power.empty())
    return unit + "2";
  if (power.size() == 1 && power[0] >= '2' && power[0] < '9')
    return unit.substr(0, slash + 2) + static_cast<char>(power[0] + 1);
  return unit + ".s-1";
}

class QuantityTable {
public:
  explicit QuantityTable(Derivation &derivation) : d_(derivation), system_(derivation.system), parameters_(parameterValues(system_)) {
    for (const flat::Variable &variable : d_.model.variables)
      taken_.insert(variable.name);
  }

  bool build();

private:
  struct Target {
    int kind = 0, index = 0;
    double sign = 1;
  };

  std::string freeName(std::initializer_list<const char *> candidates) {
    for (const char *candidate : candidates)
      if (taken_.insert(candidate).second)
        return candidate;
    std::string name = *(candidates.end() - 1);
    while (!taken_.insert(name).second)
      name += '_';
    return name;
  }

  Quantity &add(std::string name, int kind, int index, std::string unit = {}, std::string description = {}, Span span = {}) {
    Quantity quantity;
    quantity.name = std::move(name);
    quantity.kind = kind;
    quantity.index = index;
    quantity.unit = std::move(unit);
    quantity.description = std::move(description);
    quantity.span = span;
    system_.quantities.push_back(std::move(quantity));
    return system_.quantities.back();
  }

  Quantity &addVariable(ScalarVariable scalar, int kind, int index) {
    const flat::Variable &variable = d_.variables.variable(scalar);
    Quantity &quantity = add(d_.variables.name(scalar), kind, index, variable.attributes.unit, variable.description, variable.span);
    setBounds(quantity, variable.attributes, scalar);
    quantity.flags |= variable.isProtected ? TF_PROTECTED : 0;
    quantity.flags |= variable.causality == flat::Causality::Output ? TF_OUTPUT : 0;
    quantity.flags |= variable.type.base == flat::Base::Boolean ? TF_BOOLEAN : 0;
    quantity.flags |= variable.type.base == flat::Base::Integer || variable.type.base == flat::Base::Enumeration ? TF_INTEGER : 0;
    return quantity;
  }

  // The number that an attribute's expression has with the model's own parameter values.
  std::optional<double> number(const flat::ExprPtr &expression, ScalarVariable scalar, std::string_view what) {
    if (!expression)
      return std::nullopt;
    const std::vector<NodeId> nodes = d_.equations.resolve(d_.scalariser(*expression));
    const NodeId node = nodes[nodes.size() == 1 ? 0 : static_cast<std::size_t>(scalar.position)];
    if (ir::dependsOn(system_.graph, node, [](ir::Symbol s) { return s.kind != SymbolKind::Parameter; })) {
      d_.diagnostics.report(diag::StartNotParametric, expression->span, what, d_.variables.name(scalar));
      isFine_ = false;
      return std::nullopt;
    }
    return ir::evaluate(system_.graph, std::array{node}, [&](ir::Symbol s) { return parameters_[static_cast<std::size_t>(s.index)]; })[0];
  }

  void setBounds(Quantity &quantity, const flat::Attributes &attributes, ScalarVariable scalar) {
    quantity.min = number(attributes.min, scalar, "'min'").value_or(quantity.min);
    quantity.max = number(attributes.max, scalar, "'max'").value_or(quantity.max);
    if (const flat::Variable &variable = d_.variables.variable(scalar); variable.type.base == flat::Base::Enumeration) {
      quantity.min = std::max(quantity.min, 1.0);
      quantity.max = std::min(quantity.max, static_cast<double>(variable.literals.size()));
    }
    quantity.nominal = number(attributes.nominal, scalar, "'nominal'").value_or(quantity.nominal);
  }

  int startFlags(const flat::Attributes &attributes, ScalarVariable scalar, bool isFixedByDefault) {
    const double fixed = number(attributes.fixed, scalar, "'fixed'").value_or(isFixedByDefault ? 1 : 0);
    return (fixed != 0 ? TF_FIXED : 0) | (d_.variables.variable(scalar).isFinal ? 0 : TF_SETTABLE);
  }

  void addCoordinates();
  void addStates();
  void addInputs();
  void addUnknowns();
  void addElement(const flat::Element &element, flat::ElementId id);
  void addBody(const BodyEntry &body, const flat::Element &element);
  template <class Entry> void addTangentRows(const Entry &entry, const char *force, const char *slip);
  template <class Entry> void addSlipSteps(const Entry &entry, const std::string &name, int firstNumber);
  void addConstraint(const ConstraintEntry &constraint, const flat::Element &element);
  void addEnergies();
  void addSwitches();
  void addParameters();
  void addOutput(std::string name, NodeId node, std::string unit, std::string description, Span span);
  [[nodiscard]] std::optional<Target> aliasOf(NodeId node) const;

  Derivation &d_;
  HybridSystem &system_;
  std::vector<double> parameters_;
  std::set<std::string> taken_;
  std::vector<std::pair<Alias, Target>> aliases_;
  bool isFine_ = true;
};

void QuantityTable::addCoordinates() {
  const auto &coordinates = d_.variables.scalars(Role::Coordinate);
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    Quantity &quantity = addVariable(coordinates[k], TF_KIND_COORDINATE, static_cast<int>(k));
    quantity.flags |= startFlags(d_.variables.variable(coordinates[k]).attributes, coordinates[k], true);
  }
  std::vector<std::string> units;
  for (int k = 0; k < system_.nv; ++k) {
    const ScalarVariable scalar = d_.variables.velocity(k);
    const flat::Variable &variable = d_.variables.variable(scalar);
    const flat::Attributes &attributes = variable.isAngularVelocity ? variable.attributes : variable.derAttributes;
    const std::string unit = variable.isAngularVelocity ? "rad/s" : unitPerSecond(variable.attributes.unit);
    units.push_back(attributes.unit.empty() ? unit : attributes.unit);
    Quantity &quantity =
        add(d_.variables.velocityName(k), TF_KIND_VELOCITY, k, units.back(),
            (variable.isAngularVelocity ? "angular velocity of " : "velocity of ") + d_.variables.movingName(k), variable.span);
    setBounds(quantity, attributes, scalar);
    quantity.flags |= startFlags(attributes, scalar, true) | (variable.isProtected ? TF_PROTECTED : 0);
  }
  for (int k = 0; k < system_.nv; ++k) {
    const flat::Variable &variable = d_.variables.variable(d_.variables.velocity(k));
    add("der(" + d_.variables.velocityName(k) + ")", TF_KIND_ACCELERATION, k, unitPerSecond(units[static_cast<std::size_t>(k)]),
        (variable.isAngularVelocity ? "angular acceleration of " : "acceleration of ") + d_.variables.movingName(k), variable.span);
  }
}

void QuantityTable::addStates() {
  const auto &unknowns = d_.variables.scalars(Role::Unknown);
  const std::vector<int> &states = d_.equations.states();
  for (std::size_t k = 0; k < states.size(); ++k) {
    const ScalarVariable scalar = unknowns[static_cast<std::size_t>(states[k])];
    Quantity &quantity = addVariable(scalar, TF_KIND_STATE, static_cast<int>(k));
    quantity.flags |= startFlags(d_.variables.variable(scalar).attributes, scalar, false);
  }
  for (std::size_t k = 0; k < states.size(); ++k) {
    const ScalarVariable scalar = unknowns[static_cast<std::size_t>(states[k])];
    const flat::Variable &variable = d_.variables.variable(scalar);
    const std::string name = d_.variables.name(scalar);
    add("der(" + name + ")", TF_KIND_STATE_DERIVATIVE, static_cast<int>(k), unitPerSecond(variable.attributes.unit),
        "derivative of " + name, variable.span);
  }
}

void QuantityTable::addInputs() {
  const auto &inputs = d_.variables.scalars(Role::Input);
  for (std::size_t k = 0; k < inputs.size(); ++k)
    addVariable(inputs[k], TF_KIND_INPUT, static_cast<int>(k)).flags |= TF_SETTABLE;
}

std::optional<QuantityTable::Target> QuantityTable::aliasOf(NodeId node) const {
  const ir::Node *definition = &system_.graph[node];
  const double sign = definition->op == ir::Op::Neg ? -1 : 1;
  if (sign < 0)
    definition = &system_.graph[definition->operands[0]];
  if (definition->op != ir::Op::Symbol)
    return std::nullopt;
  const int index = definition->symbol.index;
  switch (definition->symbol.kind) {
  case SymbolKind::Time:
    return Target{TF_KIND_TIME, 0, sign};
  case SymbolKind::Coordinate:
    return Target{TF_KIND_COORDINATE, index, sign};
  case SymbolKind::Velocity:
    return Target{TF_KIND_VELOCITY, index, sign};
  case SymbolKind::Acceleration:
    return Target{TF_KIND_ACCELERATION, index, sign};
  case SymbolKind::State:
    return Target{TF_KIND_STATE, index, sign};
  case SymbolKind::Input:
    return Target{TF_KIND_INPUT, index, sign};
  case SymbolKind::NormalForce:
    return Target{TF_KIND_NORMAL_FORCE, index, sign};
  case SymbolKind::TangentForce:
    return Target{TF_KIND_TANGENT_FORCE, index, sign};
  case SymbolKind::Multiplier:
    return Target{TF_KIND_MULTIPLIER, index, sign};
  default:
    return std::nullopt;
  }
}

void QuantityTable::addOutput(std::string name, NodeId node, std::string unit, std::string description, Span span) {
  add(std::move(name), TF_KIND_OUTPUT, static_cast<int>(system_.outputs.size()), std::move(unit), std::move(description), span);
  system_.outputs.push_back(node);
}

void QuantityTable::addUnknowns() {
  const auto &unknowns = d_.variables.scalars(Role::Unknown);
  const std::set<int> states(d_.equations.states().begin(), d_.equations.states().end());
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (states.contains(static_cast<int>(k)))
      continue;
    const NodeId definition = d_.equations.definition(static_cast<int>(k));
    const flat::Variable &variable = d_.variables.variable(unknowns[k]);
    // Outputs get a column of their own; other plain second names only another name.
    if (const auto target = aliasOf(definition); target && variable.causality != flat::Causality::Output) {
      aliases_.push_back({{d_.variables.name(unknowns[k]), variable.description, 0, target->sign}, *target});
      continue;
    }
    addVariable(unknowns[k], TF_KIND_OUTPUT, static_cast<int>(system_.outputs.size()));
    system_.outputs.push_back(definition);
  }
}

void QuantityTable::addBody(const BodyEntry &body, const flat::Element &element) {
  const std::vector<NodeId> velocity = timeDerivative(system_, body.position, AlongMotion::WithoutAcceleration);
  addOutput(body.name + ".kineticEnergy", kineticEnergyOf(system_, body), "J", "kinetic energy of " + body.name, element.span);
  const flat::Attribute *position = element.find("position");
  const bool isScalar = position == nullptr || position->value->type.dims.size() == element.dims.size();
  for (std::size_t k = 0; k < velocity.size(); ++k)
    addOutput(equations::elementName(body.name + ".velocity",
                                     isScalar ? std::vector<int>{} : std::vector{static_cast<int>(velocity.size())}, static_cast<int>(k)),
              velocity[k], "m/s", "velocity of " + body.name, element.span);
}

// Slips and forces of the components: those of the rows, or what the rows of another form than the exact one add up to.
template <class Entry> void QuantityTable::addTangentRows(const Entry &entry, const char *force, const char *slip) {
  const flat::Element &element = d_.model.elements[static_cast<std::size_t>(entry.element)];
  const std::size_t count = entry.slip.size();
  const bool isScalar = count == 1 && element.find("slip")->value->type.dims.size() == element.dims.size();
  const bool hasOwnRows = entry.form.kind != TF_FRICTION_EXACT;
  std::vector<NodeId> rowForces;
  rowForces.reserve(static_cast<std::size_t>(entry.tangentCount()));
  for (int k = 0; k < entry.tangentCount(); ++k)
    rowForces.push_back(system_.graph.symbol(SymbolKind::TangentForce, entry.tangentFirst + k));
  const auto addAll = [&](const char *result, int kind, const std::vector<NodeId> &nodes, const char *unit, const char *description) {
    for (std::size_t k = 0; k < count; ++k) {
      std::string name = equations::elementName(entry.name + "." + result,
                                                isScalar ? std::vector<int>{} : std::vector{static_cast<int>(count)}, static_cast<int>(k));
      if (hasOwnRows)
        addOutput(std::move(name), nodes[k], unit, description + entry.name, element.span);
      else
        add(std::move(name), kind, entry.tangentFirst + static_cast<int>(k), unit, description + entry.name, element.span);
    }
  };
  addAll(force, TF_KIND_TANGENT_FORCE, entry.form.components(system_.graph, {entry.slip, entry.slipRadius}, rowForces), "N",
         "friction force of ");
  addAll(slip, TF_KIND_SLIP, entry.slip, "m/s", "slip velocity of ");
}

// Of the planar rows: a slip of one component, each direction of a polyhedral form, the edge of a relaxed one. `name` has the number after
// it where there are several.
template <class Entry> void QuantityTable::addSlipSteps(const Entry &entry, const std::string &name, int firstNumber) {
  const flat::Element &element = d_.model.elements[static_cast<std::size_t>(entry.element)];
  const int first = entry.form.stickRow(), count = entry.tangentCount() - first;
  for (int k = 0; k < count; ++k)
    add(firstNumber == 0 && count == 1 ? name : fmt::format("{}[{}]", name, std::max(firstNumber, 1) + k), TF_KIND_SLIP_STEP,
        entry.tangentFirst + first + k, "", "step variable of the slip of " + entry.name, element.span);
}

void QuantityTable::addElement(const flat::Element &element, flat::ElementId id) {
  const auto isOurs = [&](const ElementEntry &entry) { return entry.element == id; };
  for (const BodyEntry &body : d_.elements.bodies)
    if (isOurs(body))
      addBody(body, element);
  for (const ForceEntry &force : d_.elements.forces)
    if (isOurs(force))
      addOutput(force.name + ".power", powerOf(system_, force), "W", "power of " + force.name, element.span);
  for (const PotentialEntry &potential : d_.elements.potentials)
    if (isOurs(potential))
      addOutput(potential.name + ".energy", potential.energy, "J", "energy of " + potential.name, element.span);
  for (std::size_t k = 0; k < d_.elements.contacts.size(); ++k) {
    const ContactEntry &contact = d_.elements.contacts[k];
    if (!isOurs(contact))
      continue;
    const auto index = static_cast<int>(k);
    add(contact.name + ".gap", TF_KIND_GAP, index, "m", "gap of " + contact.name, element.span);
    add(contact.name + ".normalForce", TF_KIND_NORMAL_FORCE, index, "N", "normal force of " + contact.name, element.span);
    addTangentRows(contact, "frictionForce", "slip");
    add(contact.name + ".closed", TF_KIND_CLOSED, index, "", contact.name + " is closed", element.span).flags |= TF_BOOLEAN;
    if (!contact.slip.empty())
      add(contact.name + ".sticking", TF_KIND_STICKING, contact.tangentFirst + contact.form.stickRow(), "", contact.name + " sticks",
          element.span)
          .flags |= TF_BOOLEAN;
    add(contact.name + ".alpha[1]", TF_KIND_GAP_STEP, index, "", "step variable of the gap of " + contact.name, element.span);
    add(contact.name + ".alpha[2]", TF_KIND_GAP_RATE_STEP, index, "", "step variable of the gap's rate of " + contact.name, element.span);
    const bool isPlanar = contact.slip.size() == 1;
    if (isPlanar || contact.form.kind != TF_FRICTION_EXACT)
      addSlipSteps(contact, contact.name + ".alpha", 3);
    if (isPlanar) {
      add(contact.name + ".theta[1]", TF_KIND_THETA_BACKWARD, contact.tangentFirst, "",
          "weight of the auxiliary field against positive slip of " + contact.name, element.span);
      add(contact.name + ".theta[2]", TF_KIND_THETA_FORWARD, contact.tangentFirst, "",
          "weight of the auxiliary field against negative slip of " + contact.name, element.span);
    } else {
      add(contact.name + ".theta[1]", TF_KIND_PUSH, index, "", "weight of the auxiliary field of " + contact.name, element.span);
    }
    add(contact.name + ".impulse", TF_KIND_IMPULSE, index, "N.s", "accumulated normal impulse of impacts of " + contact.name, element.span);
  }
  for (const ConstraintEntry &constraint : d_.elements.constraints)
    if (isOurs(constraint))
      addConstraint(constraint, element);
  for (const FrictionEntry &friction : d_.elements.frictions)
    if (isOurs(friction)) {
      addTangentRows(friction, "force", "slip");
      if (friction.slip.size() == 1 || friction.form.kind != TF_FRICTION_EXACT)
        addSlipSteps(friction, friction.name + ".alpha", 0);
      add(friction.name + ".sticking", TF_KIND_STICKING, friction.tangentFirst + friction.form.stickRow(), "", friction.name + " sticks",
          element.span)
          .flags |= TF_BOOLEAN;
    }
}

void QuantityTable::addConstraint(const ConstraintEntry &constraint, const flat::Element &element) {
  const bool isScalar = element.find(residualOf(element))->value->type.dims.size() == element.dims.size();
  const int size = static_cast<int>(constraint.residual.size());
  for (int k = 0; k < size; ++k)
    add(equations::elementName(constraint.name + ".multiplier", isScalar ? std::vector<int>{} : std::vector{size}, k), TF_KIND_MULTIPLIER,
        constraint.rowFirst + k, "", "force of " + constraint.name + " along its residual", element.span);
}

// Of the system as a whole, where it moves masses: "energy.kinetic"…, unless the model has something of that name.
void QuantityTable::addEnergies() {
  if (system_.nv == 0)
    return;
  const auto isTaken = [&](const std::string &prefix) {
    const auto is = [&](const std::string &name) {
      return name.starts_with(prefix) && (name.size() == prefix.size() || name[prefix.size()] == '.' || name[prefix.size()] == '[');
    };
    return std::ranges::any_of(d_.model.variables, is, &flat::Variable::name) ||
           std::ranges::any_of(d_.model.elements, is, &flat::Element::name);
  };
  std::string prefix = isTaken("energy") ? "energies" : "energy";
  while (isTaken(prefix))
    prefix += '_';
  const auto one = [&](const char *name, int kind, const char *description) { add(prefix + name, kind, 0, "J", description); };
  one(".kinetic", TF_KIND_KINETIC_ENERGY, "kinetic energy of all bodies");
  one(".potential", TF_KIND_POTENTIAL_ENERGY, "potential energy of gravity and of all potential elements");
  one(".frictionLoss", TF_KIND_FRICTION_LOSS, "energy dissipated by friction while time runs");
  one(".impactLoss", TF_KIND_IMPACT_LOSS, "energy lost in impacts");
  one(".work", TF_KIND_WORK, "work of inputs, applied forces, moving boundaries and time-dependent constraints");
}

void QuantityTable::addSwitches() {
  const std::string step = system_.switches.empty() ? "" : freeName({"alpha", "stepVariable"});
  for (std::size_t k = 0; k < system_.switches.size(); ++k) {
    const SwitchingFunction &one = system_.switches[k];
    const std::string meaning =
        one.kind == TF_SWITCH_REST ? "1 while the condition of " + one.text + " stays zero" : "step variable of " + one.text;
    add(fmt::format("{}[{}]", step, k + 1), TF_KIND_STEP_VARIABLE, static_cast<int>(k), "", meaning, one.span);
  }
  add(freeName({"timeSpeed", "numericalTimeSpeed"}), TF_KIND_TIME_SPEED, 0, "", "physical time per numerical time");
}

void QuantityTable::addParameters() {
  const auto &parameters = d_.variables.scalars(Role::Parameter);
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const flat::Variable &variable = d_.variables.variable(parameters[k]);
    Quantity &quantity = addVariable(parameters[k], TF_KIND_PARAMETER, static_cast<int>(k));
    quantity.flags |= TF_FIXED;
    quantity.flags |= variable.isStructural ? TF_STRUCTURAL : 0;
    quantity.flags |= system_.parameterBindings[k] >= 0 ? TF_BOUND : 0;
    quantity.flags |= variable.isFinal || variable.isProtected || variable.isStructural ? 0 : TF_SETTABLE;
  }
}

bool QuantityTable::build() {
  add("time", TF_KIND_TIME, 0, "s", "physical time");
  add(freeName({"tau", "numericalTime"}), TF_KIND_NUMERICAL_TIME, 0, "", "numerical time");
  addCoordinates();
  addStates();
  addInputs();
  addUnknowns();
  for (std::size_t k = 0; k < d_.model.elements.size(); ++k)
    addElement(d_.model.elements[k], static_cast<flat::ElementId>(k));
  addEnergies();
  addSwitches();
  addParameters();
  for (auto &[alias, target] : aliases_) {
    const auto found =
        std::ranges::find_if(system_.quantities, [&](const Quantity &q) { return q.kind == target.kind && q.index == target.index; });
    alias.quantity = static_cast<int>(found - system_.quantities.begin());
    system_.aliases.push_back(alias);
  }
  return isFine_;
}

}  // namespace

bool tabulateQuantities(Derivation &derivation) { return QuantityTable(derivation).build(); }

}  // namespace tf::mechanics
