// The syntax tree of Modelica 3.6 (Appendix A) with TF's additions. Nodes live in an arena, are trivially destructible and refer to the
// source text by string_view; the tree of a file with syntax errors is partial: what could not be read is an `Error` node or is absent
// (null pointers stand for absent optional parts).
#pragma once

#include "lang/base/source.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tf::ast {

// A view of arena-allocated elements.
template <class T> struct List {
  T *data = nullptr;
  std::uint32_t count = 0;

  [[nodiscard]] T *begin() const { return data; }
  [[nodiscard]] T *end() const { return data + count; }
  [[nodiscard]] std::size_t size() const { return count; }
  [[nodiscard]] bool empty() const { return count == 0; }
  T &operator[](std::size_t i) const { return data[i]; }
};

struct Expr;
struct Modification;
struct ClassDefinition;
struct ComponentClause;
struct Equation;
struct Statement;

// An identifier as written; a quoted one keeps its quotes.
struct Name {
  std::string_view text;
  Span span;
};

// ---- expressions -----------------------------------------------------------------------------------------------------------------

// One step of a component reference, `a[1, :]`.
struct ReferencePart {
  Name name;
  List<Expr *> subscripts;  // `:` is an Expr of kind Colon
  bool hasSubscripts = false;
};

// `.a.b[1].c`; also a type name (no subscripts).
struct Reference {
  bool leadingDot = false;
  List<ReferencePart> parts;
  Span span;
};

struct NamedArgument {
  Name name;
  Expr *value = nullptr;
};

// `i in range`; the range may be absent.
struct ForIndex {
  Name name;
  Expr *range = nullptr;
};

enum class ExprKind : std::uint8_t {
  Integer,          // number
  Real,             // number
  String,           // text: the literal with its quotes
  Boolean,          // number != 0
  Reference,        // reference
  Unary,            // op, operands[0]
  Binary,           // op, operands[0..1]
  Range,            // operands: start, stop or start, step, stop
  If,               // operands: condition, value, condition, value, …, else
  Call,             // reference (der, initial, pure, connect… by their names), operands = positional, named, iterators (reduction)
  PartialFunction,  // `function f(a = 1)`: reference, named
  Array,            // `{a, b}` operands; `{e for i in r}`: operands[0], iterators
  Matrix,           // `[a, b; c, d]`: operands are the rows, each a Tuple
  Tuple,            // `(a, , c)`: operands, absent ones null; a parenthesised expression is a Tuple of one
  Subscripted,      // `(e)[i]`: operands[0], rest are subscripts
  ValueAt,          // `der(q)(t)` in an optimization class: operands[0] is the Call, operands[1] the time; `q[1](t)` is a Call
  End,              // `end` in a subscript
  Colon,            // `:` as a subscript
  Error,            // could not be read
};

enum class Operator : std::uint8_t {
  None,
  Plus,
  Minus,
  Times,
  Divide,
  Power,
  DotPlus,
  DotMinus,
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

// The parser bounds the height of expressions and the nesting of everything else, so that recursive walks are safe.
inline constexpr int maxExpressionHeight = 2000;
inline constexpr int maxNesting = 250;

struct Expr {
  ExprKind kind = ExprKind::Error;
  Operator op = Operator::None;
  std::uint16_t height = 1;  // of the tree below, at most maxExpressionHeight
  Span span;
  Span operatorSpan;      // Unary, Binary
  double number = 0;      // Integer, Real, Boolean
  std::string_view text;  // String: with quotes; Integer, Real: as written
  Reference reference;
  List<Expr *> operands;
  List<NamedArgument> named;
  List<ForIndex> iterators;
};

// ---- modification ----------------------------------------------------------------------------------------------------------------

// A description string: `"a" + "b"`.
struct Comment {
  List<std::string_view> strings;      // with quotes
  Modification *annotation = nullptr;  // the class modification of `annotation(…)`
  Span span;
};

enum class ArgumentKind : std::uint8_t {
  Element,         // `each final name.path modification "description"`
  Der,             // `der(start = …)` inside a coordinate's modification: modification holds its arguments
  RedeclareClass,  // `redeclare/replaceable` class
  RedeclareComponent,
  BreakComponent,  // `break name` in an extends clause: path
  BreakConnect,    // `break connect(a, b)` in an extends clause: connect
};

struct Argument {
  ArgumentKind kind = ArgumentKind::Element;
  bool isEach = false, isFinal = false, isRedeclare = false, isReplaceable = false;
  Reference path;                        // Element
  Modification *modification = nullptr;  // Element (may be null), Der
  ClassDefinition *classDefinition = nullptr;
  ComponentClause *component = nullptr;  // Redeclare…: one component
  Equation *connect = nullptr;           // BreakConnect
  Comment comment;
  Span span;
};

// `(a = 1, b(c = 2)) = e`, `= e`, `:= e`
struct Modification {
  bool hasArguments = false;
  List<Argument> arguments;
  Expr *value = nullptr;
  bool isAssignment = false;  // `:=`
  bool isBreak = false;       // `= break`
  Span span;
};

// ---- declarations ----------------------------------------------------------------------------------------------------------------

struct Component {
  Name name;
  List<Expr *> subscripts;
  bool hasSubscripts = false;
  Modification *modification = nullptr;
  Expr *condition = nullptr;  // `if …`
  Comment comment;
  Span span;
};

enum class Flow : std::uint8_t { None, Flow, Stream };
enum class Variability : std::uint8_t { None, Discrete, Parameter, Constant };
enum class Causality : std::uint8_t { None, Input, Output };

// `[flow|stream] [discrete|parameter|constant] [input|output] [coordinate] Type[subscripts] a, b;`
struct ComponentClause {
  Flow flow = Flow::None;
  Variability variability = Variability::None;
  Causality causality = Causality::None;
  bool isCoordinate = false;
  Span prefixSpan;
  Reference type;
  List<Expr *> subscripts;
  bool hasSubscripts = false;
  List<Component> components;
  // constrainedby
  bool hasConstraint = false;
  Reference constraint;
  Modification *constraintModification = nullptr;
  Comment constraintComment;
  Span span;
};

enum class ImportKind : std::uint8_t { Qualified, Renaming, Unqualified, List };

struct Import {
  ImportKind kind = ImportKind::Qualified;
  Name alias;        // Renaming
  Reference name;    // the package, or the imported name
  List<Name> names;  // List
  Comment comment;
  Span span;
};

struct Extends {
  Reference base;
  Modification *modification = nullptr;
  Modification *annotation = nullptr;
  Span span;
};

enum class ElementKind : std::uint8_t { Import, Extends, Class, Component };

struct Element {
  ElementKind kind = ElementKind::Component;
  bool isProtected = false;
  bool isRedeclare = false, isFinal = false, isInner = false, isOuter = false, isReplaceable = false;
  Import *import = nullptr;
  Extends *extends = nullptr;
  ClassDefinition *classDefinition = nullptr;
  ComponentClause *component = nullptr;
  Span span;
};

// ---- equations and statements ----------------------------------------------------------------------------------------------------

template <class Body> struct Branch {
  Expr *condition = nullptr;  // null: else
  List<Body *> body;
};

enum class EquationKind : std::uint8_t { Equality, If, For, When, Connect, Call, Constraint, Error };

struct Equation {
  EquationKind kind = EquationKind::Error;
  Expr *left = nullptr, *right = nullptr;  // Equality, Connect (two references); Constraint: left `op` right
  Operator op = Operator::None;            // Constraint: Equal, LessEqual, GreaterEqual…
  Expr *call = nullptr;                    // Call
  List<Branch<Equation>> branches;         // If, When
  List<ForIndex> iterators;                // For
  List<Equation *> body;                   // For
  Comment comment;
  Span span;
};

enum class StatementKind : std::uint8_t { Assignment, MultiAssignment, Call, If, For, While, When, Break, Return, Error };

struct Statement {
  StatementKind kind = StatementKind::Error;
  Expr *left = nullptr;              // Assignment: a Reference; MultiAssignment: a Tuple
  Expr *right = nullptr;             // Assignment, MultiAssignment, Call
  List<Branch<Statement>> branches;  // If, When
  List<ForIndex> iterators;          // For
  Expr *condition = nullptr;         // While
  List<Statement *> body;            // For, While
  Comment comment;
  Span span;
};

enum class SectionKind : std::uint8_t { Equation, InitialEquation, Algorithm, InitialAlgorithm, Constraint };

struct Section {
  SectionKind kind = SectionKind::Equation;
  List<Equation *> equations;
  List<Statement *> statements;
  Span span;
};

// ---- classes ---------------------------------------------------------------------------------------------------------------------

enum class Restriction : std::uint8_t {
  Class,
  Model,
  Record,
  Block,
  Connector,
  Type,
  Package,
  Function,
  OperatorFunction,
  Operator,
  OperatorRecord,
  Optimization,
};

enum class ClassForm : std::uint8_t {
  Long,         // elements and sections
  LongExtends,  // `model extends X(mods) … end X`
  Short,        // `= prefix Base[subscripts](mods)`
  Enumeration,  // `= enumeration(a, b)` or `enumeration(:)`
  Der,          // `= der(f, x, y)`
};

struct EnumerationLiteral {
  Name name;
  Comment comment;
};

struct External {
  std::string_view language;  // with quotes
  Reference output;
  bool hasOutput = false;
  Name function;
  List<Expr *> arguments;
  Modification *annotation = nullptr;
  Span span;
};

struct ClassDefinition {
  ClassForm form = ClassForm::Long;
  Restriction restriction = Restriction::Class;
  bool isEncapsulated = false, isPartial = false, isFinal = false, isExpandable = false, isPure = false, isImpure = false;
  Name name;
  Name endName;                        // `end X`
  Comment comment;                     // description; Short, Enumeration, Der: with its annotation
  Modification *annotation = nullptr;  // Long: `annotation(…)` of the class
  List<Element> elements;
  List<Section> sections;
  External *external = nullptr;
  // LongExtends: the modification; Short: base, subscripts, modification, causality
  Reference base;
  List<Expr *> subscripts;
  bool hasSubscripts = false;
  Causality causality = Causality::None;
  Modification *modification = nullptr;  // also an optimization's heading
  List<EnumerationLiteral> literals;
  bool isOpenEnumeration = false;  // `enumeration(:)`
  List<Name> derivativeVariables;  // Der
  // constrainedby of a replaceable class
  bool hasConstraint = false;
  Reference constraint;
  Modification *constraintModification = nullptr;
  Comment constraintComment;
  Span span;
};

// One source file.
struct File {
  bool hasWithin = false;
  Reference within;
  List<ClassDefinition *> classes;
  List<Span> comments;  // every `//` and `/* */`, in order
};

}  // namespace tf::ast
