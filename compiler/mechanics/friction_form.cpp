#include "compiler/mechanics/friction_form.h"

#include "runtime/abi/tf_model.h"

#include <cmath>
#include <numbers>

namespace tf::mechanics {

using ir::NodeId;

namespace {

// The value of an attribute that lang/semantics has settled.
int settledValue(const flat::Element &element, const char *name, int otherwise) {
  const flat::Attribute *given = element.find(name);
  return given == nullptr || given->value->values.empty() ? otherwise : static_cast<int>(given->value->values[0]);
}

NodeId squareOf(ir::Graph &graph, const std::vector<NodeId> &components) {
  std::vector<NodeId> squares;
  squares.reserve(components.size());
  for (const NodeId component : components)
    squares.push_back(graph.mul(component, component));
  return graph.sum(squares);
}

}  // namespace

FrictionForm FrictionForm::of(const flat::Element &element) {
  constexpr int defaultDirections = 4;
  FrictionForm form;
  form.kind = settledValue(element, "frictionForm", TF_FRICTION_EXACT + 1) - 1;
  if (form.kind == TF_FRICTION_POLYHEDRAL)
    form.directions = settledValue(element, "directions", defaultDirections);
  return form;
}

int FrictionForm::rowCount(int components) const {
  return kind == TF_FRICTION_POLYHEDRAL ? directions : kind == TF_FRICTION_RELAXED ? TF_RELAXED_ROWS : components;
}

int FrictionForm::affineCount(int components) const { return kind == TF_FRICTION_RELAXED ? components : rowCount(components); }

int FrictionForm::stickRow() const { return kind == TF_FRICTION_RELAXED ? TF_RELAXED_EDGE_ROW : 0; }

// Mirrored about the second axis and about the diagonal, so that all sides agree to the last bit and the axes are exact.
std::array<double, 2> FrictionForm::direction(int row) const {
  const double weight = std::sin(std::numbers::pi / (2 * directions));
  const bool isMirrored = 2 * row > directions;
  const int turned = isMirrored ? directions - row : row;  // angle π/directions times this, up to π/2
  const auto cosine = [this](int twice) { return std::cos(std::numbers::pi * twice / (2 * directions)); };
  const auto sine = [this](int twice) { return std::sin(std::numbers::pi * twice / (2 * directions)); };
  const bool isSteep = 4 * turned > directions;
  const double x = isSteep ? sine(directions - 2 * turned) : cosine(2 * turned);
  const double y = isSteep ? cosine(directions - 2 * turned) : sine(2 * turned);
  return 4 * turned == directions ? std::array{(isMirrored ? -weight : weight) * std::numbers::sqrt2 / 2, weight * std::numbers::sqrt2 / 2}
                                  : std::array{(isMirrored ? -weight : weight) * x, weight * y};
}

std::vector<NodeId> FrictionForm::relaxedRows(ir::Graph &graph, const Slip &slip) const {
  const NodeId square = squareOf(graph, slip.components), radius = slip.radius, limit = graph.mul(radius, radius);
  const NodeId inside = graph.div(graph.sub(square, limit), graph.mul(graph.constant(2), radius));
  const NodeId outside = graph.sub(graph.unary(ir::Op::Sqrt, square), radius);
  const NodeId s = graph.ternary(ir::Op::IfElse, graph.binary(ir::Op::Less, limit, square), outside, inside);
  return {slip.components[0], slip.components[1], graph.mul(graph.constant(TF_RELAXED_STEADY), graph.add(s, radius)),
          graph.mul(graph.constant(TF_RELAXED_EDGE), s)};
}

std::vector<NodeId> FrictionForm::relaxedComponents(ir::Graph &graph, const Slip &slip, const std::vector<NodeId> &rowForces) const {
  const NodeId square = squareOf(graph, slip.components), radius = slip.radius;
  const NodeId isOutside = graph.binary(ir::Op::Less, graph.mul(radius, radius), square);
  const NodeId length = graph.ternary(ir::Op::IfElse, isOutside, graph.unary(ir::Op::Sqrt, square), radius);
  const NodeId force = graph.add(graph.mul(graph.constant(TF_RELAXED_STEADY), rowForces[TF_RELAXED_STEADY_ROW]),
                                 graph.mul(graph.constant(TF_RELAXED_EDGE), rowForces[TF_RELAXED_EDGE_ROW]));
  std::vector<NodeId> components;
  components.reserve(slip.components.size());
  for (const NodeId component : slip.components)
    components.push_back(graph.mul(force, graph.div(component, length)));
  return components;
}

std::vector<NodeId> FrictionForm::rows(ir::Graph &graph, const Slip &slip) const {
  if (kind == TF_FRICTION_RELAXED)
    return relaxedRows(graph, slip);
  if (kind != TF_FRICTION_POLYHEDRAL)
    return slip.components;
  std::vector<NodeId> rows;
  for (int k = 0; k < directions; ++k) {
    const auto [x, y] = direction(k);
    rows.push_back(graph.add(graph.mul(graph.constant(x), slip.components[0]), graph.mul(graph.constant(y), slip.components[1])));
  }
  return rows;
}

std::vector<NodeId> FrictionForm::components(ir::Graph &graph, const Slip &slip, const std::vector<NodeId> &rowForces) const {
  if (kind == TF_FRICTION_RELAXED)
    return relaxedComponents(graph, slip, rowForces);
  if (kind != TF_FRICTION_POLYHEDRAL)
    return rowForces;
  std::vector<NodeId> components;
  for (const std::size_t axis : {0, 1}) {
    std::vector<NodeId> terms;
    terms.reserve(static_cast<std::size_t>(directions));
    for (int k = 0; k < directions; ++k)
      terms.push_back(graph.mul(graph.constant(direction(k)[axis]), rowForces[static_cast<std::size_t>(k)]));
    components.push_back(graph.sum(terms));
  }
  return components;
}

}  // namespace tf::mechanics
