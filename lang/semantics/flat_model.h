// FlatModel: one model after lookup, modification and instantiation, typed, with arrays and spans kept.
//
// Contract. Every expression is typed; all dimensions are constants; structural parameters and constants are folded (kind Literal);
// for-equations, conditional components, connections, function inlining and inheritance are gone. Variable references carry explicit
// indices. No name occurs twice. Attributes of elements have the element's dimensions followed by the attribute's own shape
// (`each` and broadcasting are resolved). Relations stay relations: the lowering decides what is a switch.
#pragma once

#include "lang/base/source.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tf::flat {

// A Rotation is a unit quaternion (w, x, y, z): its last dimension is 4.
enum class Base : std::uint8_t { Real, Integer, Boolean, String, Enumeration, Rotation };

struct Type {
  Base base = Base::Real;
  std::vector<int> dims;  // empty: scalar

  [[nodiscard]] int size() const;  // number of scalars
  bool operator==(const Type &) const = default;
};

// Ordered: an expression's variability is the largest of its parts'.
enum class Variability : std::uint8_t { Constant, Parameter, Discrete, Continuous };

using VariableId = int;
using ElementId = int;

enum class ExprKind : std::uint8_t {
  Literal,    // values: one number per scalar, row-major (Booleans 0/1, enumerations their ordinal); strings in text
  Variable,   // variable, indices
  Attribute,  // element, attribute, indices: an attribute or result of an element read as `floor.normalForce`
  Time,
  Unary,        // op: Minus, Not; element-wise
  Binary,       // op; Plus, Minus and relations element-wise; Times is scalar·array, or the matrix product where both are arrays; Dot…
                // element-wise
  If,           // args: condition, value, else
  Call,         // function (see Function), args
  Array,        // args stacked along a new first dimension
  Concatenate,  // args concatenated along dimension `axis` (from 0)
  Index,        // args[0] selected by indices
  Derivative,   // der(args[0])
};

enum class Operator : std::uint8_t {
  None,
  Plus,
  Minus,
  Times,
  Divide,
  Power,
  DotTimes,
  DotDivide,
  DotPower,
  And,
  Or,
  Not,
  Less,
  LessEqual,
  Greater,
  GreaterEqual,
  Equal,
  NotEqual,
};

// Built-in functions that remain in expressions. Vectorised calls on arrays keep one node (element-wise).
enum class Function : std::uint8_t {
  Abs,
  Sign,
  Sqrt,
  Sin,
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Atan2,
  Sinh,
  Cosh,
  Tanh,
  Exp,
  Log,
  Log10,
  Div,
  Mod,
  Rem,
  Floor,
  Ceil,
  Integer,
  Min,
  Max,  // of two scalars (the array forms are unfolded to nested calls)
  Sum,
  Product,
  Transpose,
  Cross,
  Skew,
  Diagonal,
  Identity,
  OuterProduct,
  Symmetric,
  Fill,
  Scalar,
  Vector,
  Matrix,
  Rotate,           // Rotation, vector: the vector in the world's frame
  RotationProduct,  // of two Rotations: first the right one
  Inverse,          // of a Rotation
  RotationAbout,    // axis, angle
  Quaternion,       // of a Rotation: Real[4]
  AngularVelocity,  // of a Rotation, in the body's frame
  NoEvent,
  Smooth,
  Initial,
  Terminal,
  Pre,
  Edge,
  Change,
  Sample,
  String,
};

// As it is written in a call.
[[nodiscard]] std::string_view nameOf(Function function);
// Kinks and jumps: not twice differentiable everywhere.
[[nodiscard]] bool hasSeams(Function function);

// One dimension's selection: 1-based positions; `scalar` drops the dimension.
struct Selection {
  std::vector<int> positions;
  bool scalar = false;
};

struct Expr;
using ExprPtr = std::shared_ptr<const Expr>;

struct Expr {
  ExprKind kind = ExprKind::Literal;
  Type type;
  Variability variability = Variability::Constant;
  Span span;
  Operator op = Operator::None;
  Function function = Function::Abs;
  std::vector<double> values;
  std::string text;
  VariableId variable = -1;
  ElementId element = -1;
  std::string attribute;
  std::vector<Selection> indices;  // empty: the whole
  int axis = 0;
  std::vector<ExprPtr> args;
  // As a tree; bounded, so that recursive walks of what the front end makes are safe and end.
  int height = 1;
  double nodes = 1;
};

enum class Causality : std::uint8_t { Local, Input, Output };

// Attributes of Real variables; each null when not given, otherwise with the variable's dimensions (scalars broadcast).
struct Attributes {
  ExprPtr start, fixed, min, max, nominal;
  std::string unit, displayUnit, quantity;
};

struct Variable {
  std::string name;  // full instance path: "arm.phi"
  Type type;
  Variability variability = Variability::Continuous;
  Causality causality = Causality::Local;
  bool isComponentInput = false;  // Local: declared as an input of a component
  bool isCoordinate = false;
  bool isAngularVelocity = false;  // "R.w": of the rotation coordinate that is the variable before this one, in the body's frame
  bool isStructural = false;       // parameter whose value is folded into sizes, conditions or Evaluate = true
  bool isFinal = false, isProtected = false;
  Attributes attributes;
  Attributes derAttributes;  // coordinates: of the velocity
  ExprPtr binding;           // declaration equation; for parameters the value (null: attributes.start, else 0 and a warning)
  std::string description;
  std::vector<std::string> literals;  // of an enumeration
  Span span;                          // of the name in its declaration
};

enum class ElementKind : std::uint8_t { Body, Gravity, Force, Potential, Constraint, Contact, Friction };

struct Attribute {
  std::string name;
  ExprPtr value;
  Span span;  // of the modification
};

struct Element {
  ElementKind kind = ElementKind::Body;
  std::string name;                   // full instance path
  std::vector<int> dims;              // of an element array
  std::string scope;                  // instance path of the component that declares it ("" at top): what `gravity` acts on
  std::vector<Attribute> attributes;  // given ones and defaults that the reference fixes
  std::string description;
  Span span;  // of the name in its declaration

  [[nodiscard]] const Attribute *find(std::string_view attribute) const;
};

// left = right, types equal (arrays element by element).
struct Equation {
  ExprPtr left, right;
  bool isInitial = false;
  Span span;
};

struct Assertion {
  ExprPtr condition;
  std::string message;
  bool isWarning = false;
  Span span;
};

struct Experiment {
  std::optional<double> startTime, stopTime, tolerance, interval;
};

struct FlatModel {
  std::string name;
  std::string description;
  Span span;
  std::vector<Variable> variables;
  std::vector<Element> elements;
  std::vector<Equation> equations;
  std::vector<Assertion> assertions;
  Experiment experiment;
};

// Readable Modelica-like text (`--emit flat`).
[[nodiscard]] std::string print(const FlatModel &model);
[[nodiscard]] std::string print(const Expr &expression, const FlatModel &model);

// Checks the contract above; returns the first violation, empty if none.
[[nodiscard]] std::string verify(const FlatModel &model);

}  // namespace tf::flat
