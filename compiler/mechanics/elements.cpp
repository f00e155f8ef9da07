#include "compiler/mechanics/elements.h"

#include "compiler/equations/diagnostics.h"
#include <algorithm>
#include <cassert>

namespace tf::mechanics {

using equations::Array;
using flat::ElementKind;
using ir::NodeId;
using ir::SymbolKind;

namespace {

int sizePerEntry(const flat::Element &element, const std::string &attribute) {
  const flat::Attribute *given = element.find(attribute);
  const int entries = entryCount(element);
  return given == nullptr || entries == 0 ? 0 : given->value->type.size() / entries;
}

double defaultValue(const std::string &attribute) {
  constexpr double slipRadius = 1e-6;
  return attribute == "slipRadius" ? slipRadius : attribute == "rate" || attribute == "law" ? 1 : 0;
}

bool isTorque(const flat::Element &force) {
  const flat::Attribute *at = force.find("at");
  return at != nullptr && at->value->type.base == flat::Base::Rotation;
}

bool hasDefault(ElementKind kind, const std::string &attribute) {
  if (attribute == "slipRadius")
    return true;
  return kind == ElementKind::Contact &&
         (attribute == "friction" || attribute == "restitution" || attribute == "law" || attribute == "rate");
}

}  // namespace

void Elements::forEachNode(const std::function<void(NodeId &)> &visit) {
  const auto one = [&](NodeId &node) {
    if (node >= 0)
      visit(node);
  };
  const auto all = [&](std::vector<NodeId> &nodes) { std::ranges::for_each(nodes, visit); };
  for (BodyEntry &body : bodies) {
    one(body.mass), one(body.angle);
    all(body.inertia), all(body.position), all(body.orientation);
  }
  for (GravityEntry &gravity : gravities)
    all(gravity.acceleration);
  for (ForceEntry &force : forces)
    all(force.value), all(force.at);
  for (PotentialEntry &potential : potentials)
    one(potential.energy);
  for (ContactEntry &contact : contacts) {
    one(contact.gap), one(contact.friction), one(contact.restitution), one(contact.law), one(contact.rate);
    one(contact.slipRadius);
    all(contact.slip);
  }
  for (ConstraintEntry &constraint : constraints)
    all(constraint.residual);
  for (FrictionEntry &friction : frictions) {
    one(friction.bound), one(friction.slipRadius);
    all(friction.slip);
  }
}

const char *residualOf(const flat::Element &element) { return element.find("residual") != nullptr ? "residual" : "velocityResidual"; }

bool isWithin(const std::string &bodyScope, const std::string &scope) {
  if (scope.empty() || bodyScope == scope)
    return true;
  return bodyScope.starts_with(scope) && (bodyScope[scope.size()] == '.' || bodyScope[scope.size()] == '[');
}

ElementTable::ElementTable(const flat::FlatModel &model, ir::Graph &graph, equations::Scalariser &scalariser, equations::SymbolNames &names,
                           Diagnostics &diagnostics)
    : model_(model), graph_(graph), scalariser_(scalariser), diagnostics_(diagnostics), contactFirst_(model.elements.size(), 0),
      rows_(model.elements.size()) {
  number(names);
}

void ElementTable::number(equations::SymbolNames &names) {
  for (const ElementKind kind : {ElementKind::Contact, ElementKind::Friction})
    for (std::size_t k = 0; k < model_.elements.size(); ++k) {
      const flat::Element &owner = model_.elements[k];
      if (owner.kind != kind)
        continue;
      rows_[k] = {tangents_, FrictionForm::of(owner).rowCount(sizePerEntry(owner, "slip"))};
      if (kind == ElementKind::Contact)
        contactFirst_[k] = static_cast<int>(names.normalForces.size());
      for (int position = 0; position < entryCount(owner); ++position) {
        const std::string name = equations::elementName(owner.name, owner.dims, position);
        if (kind == ElementKind::Contact)
          names.normalForces.push_back(name + ".normalForce");
        for (int row = 0; row < rows_[k].perEntry; ++row, ++tangents_)
          names.tangentForces.push_back(name + (kind == ElementKind::Contact ? ".frictionForce" : ".force"));
      }
    }
  for (std::size_t k = 0; k < model_.elements.size(); ++k) {
    const flat::Element &owner = model_.elements[k];
    if (owner.kind != ElementKind::Constraint)
      continue;
    rows_[k] = {multipliers_, sizePerEntry(owner, residualOf(owner))};
    for (int position = 0; position < entryCount(owner); ++position)
      for (int row = 0; row < rows_[k].perEntry; ++row, ++multipliers_)
        names.multipliers.push_back(equations::elementName(owner.name, owner.dims, position) + ".multiplier");
  }
}

const Array *ElementTable::attribute(flat::ElementId id, const std::string &name) {
  const std::pair key{id, name};
  if (const auto known = attributes_.find(key); known != attributes_.end())
    return &known->second;
  const flat::Element &owner = element(id);
  const flat::Attribute *given = owner.find(name);
  if (given == nullptr) {
    if (!hasDefault(owner.kind, name))
      return nullptr;
    const NodeId value = graph_.constant(defaultValue(name));
    return &(attributes_[key] = {owner.dims, std::vector<NodeId>(static_cast<std::size_t>(entryCount(owner)), value)});
  }
  [[maybe_unused]] const bool isNew = inProgress_.insert(key).second;
  assert(isNew && "attributes in a circle are refused before");
  Array value{given->value->type.dims, scalariser_(*given->value)};
  inProgress_.erase(key);
  return &(attributes_[key] = std::move(value));
}

std::vector<NodeId> ElementTable::slice(flat::ElementId id, const std::string &name, int position) {
  const Array *whole = attribute(id, name);
  if (whole == nullptr)
    return {};
  const std::size_t size = whole->nodes.size() / static_cast<std::size_t>(entryCount(element(id)));
  const auto first = whole->nodes.begin() + static_cast<std::ptrdiff_t>(size) * position;
  return {first, first + static_cast<std::ptrdiff_t>(size)};
}

NodeId ElementTable::scalar(flat::ElementId id, const std::string &name, int position) {
  const std::vector<NodeId> nodes = slice(id, name, position);
  return nodes.empty() ? -1 : nodes[0];
}

Elements ElementTable::entries() {
  Elements elements;
  for (std::size_t k = 0; k < model_.elements.size(); ++k) {
    for (int position = 0; position < entryCount(model_.elements[k]); ++position)
      addEntry(elements, static_cast<flat::ElementId>(k), position);
  }
  elements.tangents = tangents_;
  return elements;
}

void ElementTable::addEntry(Elements &elements, flat::ElementId id, int position) {
  const flat::Element &owner = element(id);
  const ElementEntry entry{id, position, equations::elementName(owner.name, owner.dims, position)};
  const auto one = [&](const char *name) { return scalar(id, name, position); };
  const auto all = [&](const char *name) { return slice(id, name, position); };
  const Rows &rows = rows_[static_cast<std::size_t>(id)];
  switch (owner.kind) {
  case ElementKind::Body:
    elements.bodies.push_back({entry, one("mass"), one("angle"), all("inertia"), all("position"), all("orientation")});
    break;
  case ElementKind::Gravity:
    elements.gravities.push_back({entry, all("acceleration")});
    break;
  case ElementKind::Force:
    elements.forces.push_back({entry, all("value"), all("at"), isTorque(owner)});
    break;
  case ElementKind::Potential:
    elements.potentials.push_back({entry, one("energy")});
    break;
  case ElementKind::Contact:
    elements.contacts.push_back({entry, one("gap"), one("friction"), one("restitution"), one("law"), one("rate"), one("slipRadius"),
                                 all("slip"), rows.first + position * rows.perEntry, FrictionForm::of(owner)});
    break;
  case ElementKind::Friction:
    elements.frictions.push_back(
        {entry, one("bound"), one("slipRadius"), all("slip"), rows.first + position * rows.perEntry, FrictionForm::of(owner)});
    break;
  case ElementKind::Constraint:
    elements.constraints.push_back(
        {entry, all(residualOf(owner)), owner.find("residual") != nullptr, rows.first + position * rows.perEntry});
    break;
  }
}

Array ElementTable::value(const flat::Expr &reference) {
  if (const Array *given = attribute(reference.element, reference.attribute))
    return *given;
  return result(reference);
}

Array ElementTable::result(const flat::Expr &reference) {
  const flat::ElementId id = reference.element;
  const flat::Element &owner = element(id);
  const std::string &name = reference.attribute;
  const Rows rows = rows_[static_cast<std::size_t>(id)];
  if (name == "velocity")
    if (const Array *position = attribute(id, "position")) {
      const Array place = *position;
      return {place.dims, scalariser_.timeDerivative(place.nodes, reference.span)};
    }
  if (name == "normalForce")
    return forces(reference, SymbolKind::NormalForce, {contactFirst_[static_cast<std::size_t>(id)], 1});
  if (name == "multiplier")
    return forces(reference, SymbolKind::Multiplier, rows);
  if (name == "frictionForce" || name == "force")
    return forces(reference, SymbolKind::TangentForce, rows);
  Array result{owner.dims, {}};
  if (name != "kineticEnergy" && name != "power") {
    diagnostics_.report(equations::diag::UnsupportedResult, reference.span, owner.name + "." + name);
    result.nodes.assign(static_cast<std::size_t>(entryCount(owner)), graph_.constant(0));
    return result;
  }
  for (int position = 0; position < entryCount(owner); ++position)
    result.nodes.push_back(name == "power" ? power(id, position, reference.span) : kineticEnergy(id, position, reference.span));
  return result;
}

Array ElementTable::forces(const flat::Expr &reference, SymbolKind kind, Rows rows) {
  const flat::Element &owner = element(reference.element);
  const flat::Attribute *shape = owner.find(kind == SymbolKind::Multiplier ? residualOf(owner) : "slip");
  Array result{kind != SymbolKind::NormalForce && shape != nullptr ? shape->value->type.dims : owner.dims, {}};
  // A contact without slip has no friction force.
  if (rows.perEntry == 0)
    result.nodes.assign(static_cast<std::size_t>(entryCount(owner)), graph_.constant(0));
  const FrictionForm form = kind == SymbolKind::TangentForce ? FrictionForm::of(owner) : FrictionForm{};
  for (int position = 0; position < entryCount(owner); ++position) {
    std::vector<NodeId> own;
    own.reserve(static_cast<std::size_t>(rows.perEntry));
    for (int k = 0; k < rows.perEntry; ++k)
      own.push_back(graph_.symbol(kind, rows.first + position * rows.perEntry + k));
    const std::vector<NodeId> components =
        kind == SymbolKind::TangentForce && rows.perEntry > 0 ? form.components(graph_, slipOf(reference.element, position), own) : own;
    result.nodes.insert(result.nodes.end(), components.begin(), components.end());
  }
  return result;
}

FrictionForm::Slip ElementTable::slipOf(flat::ElementId id, int position) {
  return {slice(id, "slip", position), scalar(id, "slipRadius", position)};
}

// Rates of the place or angle, or the angular velocity in the body's frame.
NodeId ElementTable::kineticEnergy(flat::ElementId id, int position, Span span) {
  BodyRates rates;
  const std::vector<NodeId> orientation = slice(id, "orientation", position);
  rates.position = scalariser_.timeDerivative(slice(id, "position", position), span);
  rates.angle = scalariser_.timeDerivative(slice(id, "angle", position), span);
  if (!orientation.empty()) {
    const equations::Vector3 w = scalariser_.angularVelocity(equations::quaternion(orientation), span);
    rates.angularVelocity.assign(w.begin(), w.end());
  }
  return mechanics::kineticEnergy(graph_, rates, scalar(id, "mass", position), slice(id, "inertia", position));
}

NodeId ElementTable::power(flat::ElementId id, int position, Span span) {
  const std::vector<NodeId> value = slice(id, "value", position), at = slice(id, "at", position);
  std::vector<NodeId> rate;
  if (isTorque(element(id))) {
    const equations::Quaternion q = equations::quaternion(at);
    const equations::Vector3 w = equations::rotate(graph_, q, scalariser_.angularVelocity(q, span));
    rate.assign(w.begin(), w.end());
  } else {
    rate = scalariser_.timeDerivative(at, span);
  }
  return dot(graph_, value, rate);
}

NodeId dot(ir::Graph &graph, std::span<const NodeId> a, std::span<const NodeId> b) {
  std::vector<NodeId> terms;
  terms.reserve(a.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    terms.push_back(graph.mul(a[k], b[k]));
  return graph.sum(terms);
}

NodeId kineticEnergy(ir::Graph &graph, const BodyRates &rates, NodeId mass, const std::vector<NodeId> &inertia) {
  std::vector<NodeId> terms;
  if (mass >= 0)
    for (const NodeId rate : rates.position)
      terms.push_back(graph.mul(mass, graph.mul(rate, rate)));
  if (!inertia.empty())
    for (const NodeId rate : rates.angle)
      terms.push_back(graph.mul(inertia[0], graph.mul(rate, rate)));
  if (!rates.angularVelocity.empty() && inertia.size() == 9)
    terms.push_back(dot(graph, rates.angularVelocity, tensorProduct(graph, inertia, rates.angularVelocity)));
  return graph.mul(graph.constant(0.5), graph.sum(terms));
}

std::vector<NodeId> tensorProduct(ir::Graph &graph, const std::vector<NodeId> &inertia, std::span<const NodeId> vector) {
  const std::size_t n = vector.size();
  std::vector<NodeId> result;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<NodeId> terms;
    terms.reserve(n);
    for (std::size_t j = 0; j < n; ++j)
      terms.push_back(graph.mul(inertia[std::min(i, j) * n + std::max(i, j)], vector[j]));
    result.push_back(graph.sum(terms));
  }
  return result;
}

}  // namespace tf::mechanics
