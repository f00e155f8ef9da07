#include "lang/semantics/predefined.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace tf::semantics {

namespace {

using flat::Base;

constexpr AttributeSpec plain(std::string_view name, Base base) { return {.name = name, .base = base}; }

constexpr std::array kRealAttributes = {plain("quantity", Base::String),    plain("unit", Base::String),
                                        plain("displayUnit", Base::String), plain("min", Base::Real),
                                        plain("max", Base::Real),           plain("start", Base::Real),
                                        plain("fixed", Base::Boolean),      plain("nominal", Base::Real),
                                        plain("unbounded", Base::Boolean),  plain("stateSelect", Base::Enumeration)};
constexpr std::array kIntegerAttributes = {plain("quantity", Base::String), plain("min", Base::Integer), plain("max", Base::Integer),
                                           plain("start", Base::Integer), plain("fixed", Base::Boolean)};
constexpr std::array kBooleanAttributes = {plain("quantity", Base::String), plain("start", Base::Boolean), plain("fixed", Base::Boolean)};
constexpr std::array kStringAttributes = {plain("quantity", Base::String), plain("start", Base::String), plain("fixed", Base::Boolean)};
constexpr std::array kEnumerationAttributes = {plain("quantity", Base::String), plain("min", Base::Enumeration),
                                               plain("max", Base::Enumeration), plain("start", Base::Enumeration),
                                               plain("fixed", Base::Boolean)};
constexpr std::array kRotationAttributes = {plain("start", Base::Real), plain("fixed", Base::Boolean)};

constexpr Dependencies kParameters{};
constexpr Dependencies kConfiguration{.coordinates = true, .time = true};
constexpr Dependencies kMotion{.coordinates = true, .velocities = true, .time = true};
constexpr Dependencies kAnything{.coordinates = true, .velocities = true, .states = true, .inputs = true, .time = true};
constexpr Dependencies kNoVelocities{.coordinates = true, .states = true, .inputs = true, .time = true};

constexpr AttributeSpec kinematic(std::string_view name, Shape shape) {
  return {.name = name, .shape = shape, .may = kConfiguration, .isKinematic = true};
}
constexpr AttributeSpec slip() { return {.name = "slip", .shape = Shape::Planar, .may = kMotion, .isKinematic = true, .isAffine = true}; }

// How a slip of two components is opposed, with what the forms need.
constexpr AttributeSpec frictionForm() {
  return {.name = "frictionForm",
          .base = Base::Enumeration,
          .may = kParameters,
          .hasDefault = true,
          .defaultValue = 1,
          .isStructural = true,
          .isSilent = true,
          .enumeration = "FrictionForm"};
}
constexpr AttributeSpec directions() {
  return {.name = "directions",
          .base = Base::Integer,
          .may = kParameters,
          .hasDefault = true,
          .defaultValue = 4,
          .isStructural = true,
          .isSilent = true};
}
constexpr AttributeSpec slipRadius() {
  return {.name = "slipRadius", .may = kParameters, .hasDefault = true, .defaultValue = 1e-6, .isSilent = true};
}

constexpr std::array kBodyAttributes = {
    AttributeSpec{.name = "mass", .may = kParameters, .unit = "kg"},
    kinematic("position", Shape::Position),
    kinematic("angle", Shape::Scalar),
    AttributeSpec{.name = "inertia", .shape = Shape::Inertia, .may = kParameters, .unit = "kg.m2"},
    AttributeSpec{.name = "orientation", .base = Base::Rotation, .shape = Shape::Rotation, .may = kConfiguration, .isKinematic = true},
};
constexpr std::array kGravityAttributes = {
    AttributeSpec{.name = "acceleration", .shape = Shape::Acceleration, .may = {.time = true}, .unit = "m/s2"}};
constexpr std::array kForceAttributes = {
    AttributeSpec{.name = "value", .shape = Shape::AnyVector, .may = kAnything},
    AttributeSpec{.name = "at", .shape = Shape::AnyVector, .may = kConfiguration, .isKinematic = true, .mayBeRotation = true}};
constexpr std::array kPotentialAttributes = {AttributeSpec{.name = "energy", .may = kNoVelocities, .unit = "J"}};
constexpr std::array kConstraintAttributes = {
    kinematic("residual", Shape::AnyVector),
    AttributeSpec{.name = "velocityResidual", .shape = Shape::AnyVector, .may = kMotion, .isKinematic = true, .isAffine = true}};
constexpr std::array kContactAttributes = {
    kinematic("gap", Shape::Scalar),
    slip(),
    AttributeSpec{.name = "friction", .may = kNoVelocities, .hasDefault = true, .defaultValue = 0, .unit = "1"},
    AttributeSpec{.name = "restitution", .may = kParameters, .hasDefault = true, .defaultValue = 0, .unit = "1"},
    AttributeSpec{
        .name = "law", .base = Base::Enumeration, .may = kParameters, .hasDefault = true, .defaultValue = 1, .enumeration = "ImpactLaw"},
    AttributeSpec{.name = "rate", .may = kParameters, .hasDefault = true, .defaultValue = 1},
    frictionForm(),
    directions(),
    slipRadius(),
};
constexpr std::array kFrictionAttributes = {slip(), AttributeSpec{.name = "bound", .may = kAnything}, frictionForm(), directions(),
                                            slipRadius()};

constexpr std::array kBodyResults = {ResultSpec{"kineticEnergy"}, ResultSpec{.name = "velocity", .shapeOf = "position"}};
constexpr std::array kForceResults = {ResultSpec{"power"}};
constexpr std::array kPotentialResults = {ResultSpec{"energy"}};
constexpr std::array kConstraintResults = {ResultSpec{.name = "multiplier", .shapeOf = "residual", .orShapeOf = "velocityResidual"}};
constexpr std::array kContactResults = {ResultSpec{"gap"},
                                        ResultSpec{"normalForce"},
                                        ResultSpec{.name = "frictionForce", .shapeOf = "slip"},
                                        ResultSpec{.name = "slip", .shapeOf = "slip"},
                                        ResultSpec{.name = "closed", .base = Base::Boolean},
                                        ResultSpec{.name = "sticking", .base = Base::Boolean},
                                        ResultSpec{"impulse"}};
constexpr std::array kFrictionResults = {ResultSpec{.name = "force", .shapeOf = "slip"},
                                         ResultSpec{.name = "sticking", .base = Base::Boolean}};

constexpr std::array<std::string_view, 3> kImpactLaws = {"Poisson", "Stronge", "Newton"};
constexpr std::array<std::string_view, 3> kFrictionForms = {"Exact", "Relaxed", "Polyhedral"};
constexpr std::array<std::string_view, 5> kStateSelect = {"never", "avoid", "default", "prefer", "always"};
constexpr std::array<std::string_view, 2> kAssertionLevel = {"warning", "error"};

const std::array kClasses = {
    PredefinedClass{"Real", PredefinedKind::Real, kRealAttributes},
    PredefinedClass{"Integer", PredefinedKind::Integer, kIntegerAttributes},
    PredefinedClass{"Boolean", PredefinedKind::Boolean, kBooleanAttributes},
    PredefinedClass{"String", PredefinedKind::String, kStringAttributes},
    PredefinedClass{"Rotation", PredefinedKind::Rotation, kRotationAttributes},
    PredefinedClass{"ImpactLaw", PredefinedKind::Enumeration, kEnumerationAttributes, {}, kImpactLaws},
    PredefinedClass{"FrictionForm", PredefinedKind::Enumeration, kEnumerationAttributes, {}, kFrictionForms},
    PredefinedClass{"StateSelect", PredefinedKind::Enumeration, kEnumerationAttributes, {}, kStateSelect},
    PredefinedClass{"AssertionLevel", PredefinedKind::Enumeration, kEnumerationAttributes, {}, kAssertionLevel},
    PredefinedClass{"body", PredefinedKind::Body, kBodyAttributes, kBodyResults},
    PredefinedClass{"gravity", PredefinedKind::Gravity, kGravityAttributes},
    PredefinedClass{"force", PredefinedKind::Force, kForceAttributes, kForceResults},
    PredefinedClass{"potential", PredefinedKind::Potential, kPotentialAttributes, kPotentialResults},
    PredefinedClass{"constraint", PredefinedKind::Constraint, kConstraintAttributes, kConstraintResults},
    PredefinedClass{"contact", PredefinedKind::Contact, kContactAttributes, kContactResults},
    PredefinedClass{"friction", PredefinedKind::Friction, kFrictionAttributes, kFrictionResults},
};
const PredefinedClass kEnumeration{"enumeration", PredefinedKind::Enumeration, kEnumerationAttributes};

}  // namespace

const AttributeSpec *PredefinedClass::attribute(std::string_view attributeName) const {
  const auto found = std::ranges::find(attributes, attributeName, &AttributeSpec::name);
  return found == attributes.end() ? nullptr : &*found;
}

const ResultSpec *PredefinedClass::result(std::string_view resultName) const {
  const auto found = std::ranges::find(results, resultName, &ResultSpec::name);
  return found == results.end() ? nullptr : &*found;
}

std::span<const PredefinedClass> predefinedClasses() { return kClasses; }

const PredefinedClass &enumerationClass() { return kEnumeration; }

const PredefinedClass *findPredefined(std::string_view name) {
  const auto found = std::ranges::find(kClasses, name, &PredefinedClass::name);
  return found == kClasses.end() ? nullptr : &*found;
}

flat::Base baseOf(PredefinedKind kind) {
  switch (kind) {
  case PredefinedKind::Integer:
    return Base::Integer;
  case PredefinedKind::Boolean:
    return Base::Boolean;
  case PredefinedKind::String:
    return Base::String;
  case PredefinedKind::Enumeration:
    return Base::Enumeration;
  case PredefinedKind::Rotation:
    return Base::Rotation;
  default:
    return Base::Real;
  }
}

flat::ElementKind elementKindOf(PredefinedKind kind) {
  assert(kind >= PredefinedKind::Body);
  return static_cast<flat::ElementKind>(static_cast<int>(kind) - static_cast<int>(PredefinedKind::Body));
}

}  // namespace tf::semantics
