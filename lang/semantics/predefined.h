// The predefined classes: builtin types, mechanical elements, predefined enumerations, with their attributes (MLS 4.9, language.md 3).
#pragma once

#include "lang/semantics/flat_model.h"

#include <span>
#include <string_view>

namespace tf::semantics {

enum class PredefinedKind : std::uint8_t {
  Real,
  Integer,
  Boolean,
  String,
  Enumeration,
  Rotation,
  Body,
  Gravity,
  Force,
  Potential,
  Constraint,
  Contact,
  Friction,
};

// The shapes that an attribute may have beyond the dimensions of its element.
enum class Shape : std::uint8_t {
  Scalar,
  Planar,        // scalar or 2
  Position,      // scalar, 2 or 3
  Acceleration,  // 2 or 3
  AnyVector,     // scalar or any vector
  Inertia,       // scalar or 3 x 3
  Rotation,      // a Rotation
};

// What an attribute's value may depend on; parameters and constants always may.
struct Dependencies {
  bool coordinates = false, velocities = false, states = false, inputs = false, time = false;
};

struct AttributeSpec {
  std::string_view name;
  flat::Base base = flat::Base::Real;
  Shape shape = Shape::Scalar;
  Dependencies may = {};
  bool isKinematic = false;  // must be twice differentiable in the coordinates
  bool isAffine = false;     // affine in the velocities
  bool hasDefault = false;
  double defaultValue = 0;
  bool mayBeRotation = false;  // takes a Rotation as well
  bool isStructural = false;   // one value for all elements of an array, known before the run
  bool isSilent = false;       // no part of the flat model unless it is given
  std::string_view unit = {};
  std::string_view enumeration = {};  // name of its predefined type
};

struct ResultSpec {
  std::string_view name;
  flat::Base base = flat::Base::Real;
  // The attribute whose shape the result has, or the other one if that is not given; empty: scalar.
  std::string_view shapeOf = {};
  std::string_view orShapeOf = {};
};

struct PredefinedClass {
  std::string_view name;
  PredefinedKind kind = PredefinedKind::Real;
  std::span<const AttributeSpec> attributes;
  std::span<const ResultSpec> results = {};
  std::span<const std::string_view> literals = {};

  [[nodiscard]] const AttributeSpec *attribute(std::string_view attributeName) const;
  [[nodiscard]] const ResultSpec *result(std::string_view resultName) const;
  [[nodiscard]] bool isElement() const { return kind >= PredefinedKind::Body; }
};

// All predefined classes of the unnamed root scope.
[[nodiscard]] std::span<const PredefinedClass> predefinedClasses();
// The attributes that enumeration types share.
[[nodiscard]] const PredefinedClass &enumerationClass();
[[nodiscard]] const PredefinedClass *findPredefined(std::string_view name);

[[nodiscard]] flat::Base baseOf(PredefinedKind kind);
[[nodiscard]] flat::ElementKind elementKindOf(PredefinedKind kind);

}  // namespace tf::semantics
