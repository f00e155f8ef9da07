// Mechanical elements, one entry per element of an element array, as nodes of the expression graph.
#pragma once

#include "compiler/equations/equation_system.h"
#include "compiler/equations/scalariser.h"
#include "compiler/mechanics/friction_form.h"

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tf::mechanics {

struct ElementEntry {
  flat::ElementId element = -1;
  int position = 0;  // row-major in the element array
  std::string name;  // "wall[1]"
};

struct BodyEntry : ElementEntry {
  ir::NodeId mass = -1, angle = -1;                        // −1: not given
  std::vector<ir::NodeId> inertia, position, orientation;  // inertia: of the angle, or [3 × 3] in the body's frame about its place
};

struct GravityEntry : ElementEntry {
  std::vector<ir::NodeId> acceleration;
};

struct ForceEntry : ElementEntry {
  std::vector<ir::NodeId> value, at;
  bool isTorque = false;  // `at` is a rotation, `value` a torque in the world's frame
};

struct PotentialEntry : ElementEntry {
  ir::NodeId energy = -1;
};

struct ContactEntry : ElementEntry {
  ir::NodeId gap = -1, friction = -1, restitution = -1, law = -1, rate = -1, slipRadius = -1;
  std::vector<ir::NodeId> slip;
  int tangentFirst = 0;
  FrictionForm form;

  [[nodiscard]] int tangentCount() const { return form.rowCount(static_cast<int>(slip.size())); }
  [[nodiscard]] int affineCount() const { return form.affineCount(static_cast<int>(slip.size())); }
};

struct ConstraintEntry : ElementEntry {
  std::vector<ir::NodeId> residual;
  bool isHolonomic = true;  // otherwise the residual is that of velocities
  int rowFirst = 0;
};

struct FrictionEntry : ElementEntry {
  ir::NodeId bound = -1, slipRadius = -1;
  std::vector<ir::NodeId> slip;
  int tangentFirst = 0;
  FrictionForm form;

  [[nodiscard]] int tangentCount() const { return form.rowCount(static_cast<int>(slip.size())); }
  [[nodiscard]] int affineCount() const { return form.affineCount(static_cast<int>(slip.size())); }
};

struct Elements {
  std::vector<BodyEntry> bodies;
  std::vector<GravityEntry> gravities;
  std::vector<ForceEntry> forces;
  std::vector<PotentialEntry> potentials;
  std::vector<ContactEntry> contacts;
  std::vector<FrictionEntry> frictions;
  std::vector<ConstraintEntry> constraints;
  int tangents = 0;  // tangential rows: of contacts, then of friction elements

  // Calls `visit` with every node that stands in an attribute.
  void forEachNode(const std::function<void(ir::NodeId &)> &visit);
};

// True if gravity declared in the instance `scope` acts on a body declared in `bodyScope` ("" is the model itself).
[[nodiscard]] bool isWithin(const std::string &bodyScope, const std::string &scope);

// Attributes and results of elements, also while equations are not solved yet.
class ElementTable {
public:
  ElementTable(const flat::FlatModel &model, ir::Graph &graph, equations::Scalariser &scalariser, equations::SymbolNames &names,
               Diagnostics &diagnostics);

  // The whole of `element.attribute` before the reference's indices: an attribute or a result.
  [[nodiscard]] equations::Array value(const flat::Expr &reference);
  // A given attribute or its default; null if neither.
  [[nodiscard]] const equations::Array *attribute(flat::ElementId element, const std::string &name);
  // All entries, with attributes as they are before the equations are solved.
  [[nodiscard]] Elements entries();

private:
  // Tangential or constraint rows of an element: those of its entries follow one another.
  struct Rows {
    int first = 0, perEntry = 0;
  };

  void number(equations::SymbolNames &names);
  [[nodiscard]] const flat::Element &element(flat::ElementId id) const { return model_.elements[static_cast<std::size_t>(id)]; }
  [[nodiscard]] std::vector<ir::NodeId> slice(flat::ElementId id, const std::string &name, int position);
  [[nodiscard]] ir::NodeId scalar(flat::ElementId id, const std::string &name, int position);
  void addEntry(Elements &elements, flat::ElementId id, int position);
  [[nodiscard]] equations::Array result(const flat::Expr &reference);
  [[nodiscard]] equations::Array forces(const flat::Expr &reference, ir::SymbolKind kind, Rows rows);
  [[nodiscard]] ir::NodeId kineticEnergy(flat::ElementId id, int position, Span span);
  [[nodiscard]] FrictionForm::Slip slipOf(flat::ElementId id, int position);
  [[nodiscard]] ir::NodeId power(flat::ElementId id, int position, Span span);

  const flat::FlatModel &model_;
  ir::Graph &graph_;
  equations::Scalariser &scalariser_;
  Diagnostics &diagnostics_;
  std::map<std::pair<flat::ElementId, std::string>, equations::Array> attributes_;
  std::set<std::pair<flat::ElementId, std::string>> inProgress_;
  std::vector<int> contactFirst_;  // of elements
  std::vector<Rows> rows_;         // of elements
  int tangents_ = 0, multipliers_ = 0;
};

// Velocities of a body as far as it has them.
struct BodyRates {
  std::vector<ir::NodeId> position, angle, angularVelocity;  // angularVelocity: in the body's frame
};

// ½ m |p'|² + ½ J φ'² + ½ ωᵀ I ω.
[[nodiscard]] ir::NodeId kineticEnergy(ir::Graph &graph, const BodyRates &rates, ir::NodeId mass, const std::vector<ir::NodeId> &inertia);
// The symmetric tensor of `inertia`'s upper triangle times the vector.
[[nodiscard]] std::vector<ir::NodeId> tensorProduct(ir::Graph &graph, const std::vector<ir::NodeId> &inertia,
                                                    std::span<const ir::NodeId> vector);
[[nodiscard]] ir::NodeId dot(ir::Graph &graph, std::span<const ir::NodeId> a, std::span<const ir::NodeId> b);

// The attribute that gives a constraint's residual, "residual" or "velocityResidual".
[[nodiscard]] const char *residualOf(const flat::Element &element);

[[nodiscard]] inline int entryCount(const flat::Element &element) { return flat::Type{flat::Base::Real, element.dims}.size(); }

}  // namespace tf::mechanics
