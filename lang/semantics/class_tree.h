// Classes and components between syntax and flat model.
//
// A `Class` is a class definition in an enclosing scope under a modification. It is elaborated on demand: its own elements are indexed,
// its base classes are looked up and elaborated under the merged modification, and their members are spliced in (MLS 5.6). Every component
// instance has its own Class, so that redeclarations and modified nested classes need no further rule; a Class without an owner is a
// name space (package) or the template that instances are made of. Everything lives in the Context's arenas; pointers are stable.
#pragma once

#include "lang/semantics/flat_model.h"
#include "lang/syntax/ast.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tf::semantics {

struct Class;
struct Component;
struct Modifier;
struct PredefinedClass;
using ModifierPtr = std::shared_ptr<const Modifier>;

// One step from a value to the part of it that belongs to an array element (1-based index) or to a field of a record.
struct Projection {
  std::vector<int> index;
  std::string_view field;
  std::vector<int> sizes = {};  // of the array that the index is into
};

// The value of a modification or declaration, not yet typed. The value covers the target's dimensions from `outerDims` on; with `each` it
// is one element's value.
struct Binding {
  const ast::Expr *expression = nullptr;
  Class *scope = nullptr;  // where its names are looked up
  Span span;               // of the modification
  bool isEach = false;
  bool isWithinArray = false;  // an array around the modified component was split: `each` may refer to that one
  int outerDims = 0;
  std::vector<Projection> projections;
};

// `redeclare Type name` / `redeclare class name`, as an argument or as an element.
struct Redeclaration {
  const ast::ComponentClause *clause = nullptr;
  const ast::Component *component = nullptr;
  const ast::ClassDefinition *classDefinition = nullptr;
  Class *scope = nullptr;
  bool isReplaceable = false;
};

// A node of a modification: what is written about the element `name` of the modified class. Immutable, shared.
struct Modifier {
  std::string_view name;
  Span nameSpan;
  Span span;
  bool isEach = false;
  bool isFinal = false;
  std::optional<Binding> binding;
  std::optional<Redeclaration> redeclaration;
  std::vector<ModifierPtr> children;

  [[nodiscard]] const ModifierPtr *find(std::string_view child) const;
};

enum class Progress : std::uint8_t { Fresh, Running, Done };

struct Member {
  std::string_view name;
  Span span;
  const ast::Element *element = nullptr;
  Component *component = nullptr;                    // of a component
  const ast::ClassDefinition *definition = nullptr;  // of a nested class
  Class *scope = nullptr;   // the class (maybe a base) that declares it; a redeclared class: where that was written
  ModifierPtr modifier;     // of a nested class
  Class *nested = nullptr;  // made on demand
  bool isProtected = false;
};

// Dimensions of an array type, `Real[3]`, with the scope of their expressions.
struct Dimension {
  const ast::Expr *size = nullptr;
  Class *scope = nullptr;
};

struct Class {
  const ast::ClassDefinition *definition = nullptr;  // null: predefined
  const PredefinedClass *predefined = nullptr;       // itself, or what it specialises (`type Angle = Real(…)`)
  std::string_view name;
  Class *parent = nullptr;                          // lexically enclosing
  Component *owner = nullptr;                       // the component whose type this is
  std::string path;                                 // instance path, "" at the top
  ModifierPtr modifier;                             // of its elements; may be null
  int arrayDepth = 0;                               // dimensions outside, where it is the type of a variable or element
  Class *derived = nullptr;                         // the class that this is a base of
  std::optional<Binding> value;                     // of a record with a binding: its fields take theirs from it
  ast::Causality causality = ast::Causality::None;  // `connector RealInput = input Real`
  Progress progress = Progress::Fresh;
  std::vector<Member> members;  // own and inherited, in order
  std::unordered_map<std::string_view, std::size_t> index;
  std::vector<const ast::Import *> imports;
  std::vector<Class *> bases;
  std::vector<std::string> literals;  // of an enumeration
  std::vector<Dimension> dimensions;  // of an array type
  ModifierPtr leafModifier;           // merged attributes, where predefined
  bool isModel = false;               // the model that is instantiated
  bool isFailed = false;              // a base class is missing: errors about unknown members would be cascades

  [[nodiscard]] Member *find(std::string_view member);
};

// The prefixes that a component passes on to the variables inside it.
struct Prefixes {
  flat::Variability variability = flat::Variability::Continuous;
  bool isVariabilityGiven = false;
  flat::Causality causality = flat::Causality::Local;
  bool isFinal = false;
  bool isProtected = false;
};

struct Component {
  std::string_view name;
  std::string path;
  const ast::Element *element = nullptr;
  const ast::ComponentClause *clause = nullptr;
  const ast::Component *declaration = nullptr;
  Class *scope = nullptr;                     // where its type is looked up
  Class *container = nullptr;                 // the instance that it is a part of
  std::vector<Dimension> declaredDimensions;  // those before the type's
  ModifierPtr modifier;                       // outer modifications merged over its own
  Prefixes prefixes;

  Progress typeProgress = Progress::Fresh;
  Progress dimensionsProgress = Progress::Fresh;
  Progress conditionProgress = Progress::Fresh;
  Progress bindingProgress = Progress::Fresh;
  Progress valueProgress = Progress::Fresh;
  bool isPresent = true;        // its condition holds
  bool isFailed = false;        // an error was reported about its type or dimensions
  bool isBindingWrong = false;  // and one about its binding
  Class *type = nullptr;        // template
  Class *leaf = nullptr;        // of a variable or element: its elaborated type
  Component *inner = nullptr;   // what an outer component stands for
  Component *sameAs = nullptr;  // the first of several inherited declarations that are the same
  std::vector<int> dimensions;
  std::vector<Class *> instances;  // of a composite: one per array element, row-major
  flat::VariableId variable = -1;
  flat::ElementId elementId = -1;
  flat::ExprPtr binding;                     // typed, broadcast
  std::optional<std::vector<double>> value;  // of a constant or structural parameter

  [[nodiscard]] bool isLeaf() const { return leaf != nullptr; }
};

}  // namespace tf::semantics
