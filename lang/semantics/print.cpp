// Modelica-like text of a flat model.
#include "lang/semantics/expressions.h"
#include "lang/semantics/flat_model.h"
#include "lang/semantics/predefined.h"

#include <fmt/format.h>

#include <array>

namespace tf::flat {

int Type::size() const { return semantics::sizeOf(dims); }

const Attribute *Element::find(std::string_view attribute) const {
  for (const Attribute &entry : attributes)
    if (entry.name == attribute)
      return &entry;
  return nullptr;
}

namespace {

constexpr std::array<std::string_view, 18> kPadded = {"",      " + ",  " - ",   "*",   "/",    "^",   " .* ", " ./ ", ".^",
                                                      " and ", " or ", " not ", " < ", " <= ", " > ", " >= ", " == ", " <> "};
constexpr std::array<std::string_view, 6> kBases = {"Real", "Integer", "Boolean", "String", "enumeration", "Rotation"};
constexpr std::array<std::string_view, 7> kElements = {"body", "gravity", "force", "potential", "constraint", "contact", "friction"};

// How tightly an expression binds; larger binds tighter.
int precedence(const Expr &expr) {
  if (expr.kind == ExprKind::If)
    return 0;
  if (expr.kind == ExprKind::Unary)
    return expr.op == Operator::Not ? 3 : 5;
  if (expr.kind == ExprKind::Literal && expr.type.dims.empty() && !expr.values.empty() && expr.values[0] < 0)
    return 5;
  if (expr.kind == ExprKind::Call && (expr.function == Function::Rotate || expr.function == Function::RotationProduct))
    return 6;
  if (expr.kind != ExprKind::Binary)
    return 9;
  switch (expr.op) {
  case Operator::Or:
    return 1;
  case Operator::And:
    return 2;
  case Operator::Plus:
  case Operator::Minus:
    return 5;
  case Operator::Times:
  case Operator::Divide:
  case Operator::DotTimes:
  case Operator::DotDivide:
    return 6;
  case Operator::Power:
  case Operator::DotPower:
    return 7;
  default:
    return 4;
  }
}

std::string number(const Type &type, double value) {
  if (type.base == Base::Boolean)
    return value != 0 ? "true" : "false";
  return fmt::format("{}", value);
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += '\\';
    if (c == '\n')
      result += "\\n";
    else
      result += c;
  }
  return result + "\"";
}

class Printer {
public:
  explicit Printer(const FlatModel &model) : model_(model) {}

  std::string expression(const Expr &expr) const {
    switch (expr.kind) {
    case ExprKind::Literal:
      return literal(expr);
    case ExprKind::Variable:
      return model_.variables[static_cast<std::size_t>(expr.variable)].name + indices(expr.indices);
    case ExprKind::Attribute:
      return attribute(expr);
    case ExprKind::Time:
      return "time";
    case ExprKind::Unary:
      return std::string(expr.op == Operator::Not ? "not " : "-") + inside(*expr.args[0], precedence(expr) + 1);
    case ExprKind::Binary:
      return binary(expr);
    case ExprKind::If:
      return fmt::format("if {} then {} else {}", expression(*expr.args[0]), expression(*expr.args[1]), expression(*expr.args[2]));
    case ExprKind::Call:
      if (expr.function == Function::Rotate || expr.function == Function::RotationProduct)
        return inside(*expr.args[0], precedence(expr)) + "*" + inside(*expr.args[1], precedence(expr) + 1);
      if (expr.function == Function::Quaternion || expr.function == Function::AngularVelocity)
        return expression(*expr.args[0]) + "." + std::string(nameOf(expr.function));
      return fmt::format("{}({})", nameOf(expr.function), list(expr.args));
    case ExprKind::Array:
      return "{" + list(expr.args) + "}";
    case ExprKind::Concatenate:
      return fmt::format("cat({}, {})", expr.axis + 1, list(expr.args));
    case ExprKind::Index:
      return "(" + expression(*expr.args[0]) + ")" + indices(expr.indices);
    case ExprKind::Derivative:
      return "der(" + expression(*expr.args[0]) + ")";
    }
    return {};
  }

  std::string model() const {
    std::string text = "model " + model_.name + description(model_.description) + "\n";
    for (const Variable &variable : model_.variables)
      if (!variable.isAngularVelocity)
        text += "  " + declaration(variable) + ";\n";
    for (const Element &element : model_.elements)
      text += "  " + declaration(element) + ";\n";
    text += equations(true) + equations(false);
    text += experiment();
    return text + "end " + model_.name + ";\n";
  }

private:
  std::string inside(const Expr &expr, int outer) const {
    return precedence(expr) < outer ? "(" + expression(expr) + ")" : expression(expr);
  }

  std::string binary(const Expr &expr) const {
    const int own = precedence(expr);
    const bool isPower = own == 7;
    return inside(*expr.args[0], isPower ? own + 1 : own) + std::string(kPadded[static_cast<std::size_t>(expr.op)]) +
           inside(*expr.args[1], own + 1);
  }

  static std::string literal(const Expr &expr) {
    if (expr.type.base == Base::String)
      return quoted(expr.text);
    if (expr.type.base == Base::Enumeration && !expr.text.empty())
      return expr.text;
    std::size_t next = 0;
    return nestedLiteral(expr, 0, next);
  }

  static std::string nestedLiteral(const Expr &expr, std::size_t level, std::size_t &next) {
    if (level == expr.type.dims.size())
      return number(expr.type, expr.values[next++]);
    if (expr.type.size() == 0)
      return fmt::format("fill(0, {})", fmt::join(expr.type.dims, ", "));
    std::string text = "{";
    for (int i = 0; i < expr.type.dims[level]; ++i)
      text += (i == 0 ? "" : ", ") + nestedLiteral(expr, level + 1, next);
    return text + "}";
  }

  static std::string indices(const std::vector<Selection> &selections) {
    if (selections.empty())
      return {};
    std::string text = "[";
    for (std::size_t i = 0; i < selections.size(); ++i) {
      const std::vector<int> &positions = selections[i].positions;
      text += i == 0 ? "" : ", ";
      const bool isRange = positions.size() > 1 && positions.back() - positions.front() + 1 == static_cast<int>(positions.size());
      if (selections[i].scalar)
        text += std::to_string(positions[0]);
      else if (isRange)
        text += fmt::format("{}:{}", positions.front(), positions.back());
      else
        text += fmt::format("{{{}}}", fmt::join(positions, ", "));
    }
    return text + "]";
  }

  std::string attribute(const Expr &expr) const {
    const Element &element = model_.elements[static_cast<std::size_t>(expr.element)];
    const std::size_t own = std::min(element.dims.size(), expr.indices.size());
    const std::vector<Selection> first(expr.indices.begin(), expr.indices.begin() + static_cast<std::ptrdiff_t>(own));
    const std::vector<Selection> rest(expr.indices.begin() + static_cast<std::ptrdiff_t>(own), expr.indices.end());
    return element.name + indices(first) + "." + expr.attribute + indices(rest);
  }

  std::string list(const std::vector<ExprPtr> &args) const {
    std::string text;
    for (std::size_t i = 0; i < args.size(); ++i)
      text += (i == 0 ? "" : ", ") + expression(*args[i]);
    return text;
  }

  static std::string description(const std::string &text) { return text.empty() ? "" : " " + quoted(text); }

  static std::string dimensions(const std::vector<int> &dims) { return dims.empty() ? "" : fmt::format("[{}]", fmt::join(dims, ", ")); }

  std::string modifiers(const Attributes &attributes) const {
    std::string text;
    const auto add = [&](std::string_view name, const std::string &value) {
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, value);
    };
    const std::pair<std::string_view, const ExprPtr *> values[] = {{"start", &attributes.start},
                                                                   {"fixed", &attributes.fixed},
                                                                   {"min", &attributes.min},
                                                                   {"max", &attributes.max},
                                                                   {"nominal", &attributes.nominal}};
    for (const auto &[name, value] : values)
      if (*value != nullptr)
        add(name, expression(**value));
    const std::pair<std::string_view, const std::string *> texts[] = {
        {"unit", &attributes.unit}, {"displayUnit", &attributes.displayUnit}, {"quantity", &attributes.quantity}};
    for (const auto &[name, value] : texts)
      if (!value->empty())
        add(name, quoted(*value));
    return text;
  }

  std::string declaration(const Variable &variable) const {
    std::string text;
    if (variable.isProtected)
      text += "protected ";
    if (variable.isFinal)
      text += "final ";
    if (variable.variability == Variability::Constant)
      text += "constant ";
    if (variable.variability == Variability::Parameter)
      text += variable.isStructural ? "structural parameter " : "parameter ";
    if (variable.variability == Variability::Discrete && variable.type.base == Base::Real)
      text += "discrete ";
    if (variable.causality != Causality::Local)
      text += variable.causality == Causality::Input ? "input " : "output ";
    if (variable.isCoordinate)
      text += "coordinate ";
    text += type(variable) + " " + variable.name + dimensions(semantics::visibleDims(variable.type));
    std::string modifications = modifiers(variable.attributes);
    if (const std::string der = modifiers(variable.derAttributes); !der.empty())
      modifications += std::string(modifications.empty() ? "" : ", ") + "der(" + der + ")";
    if (variable.isCoordinate && variable.type.base == Base::Rotation)
      if (const std::string w = modifiers((&variable + 1)->attributes); !w.empty())
        modifications += std::string(modifications.empty() ? "" : ", ") + "w(" + w + ")";
    if (!modifications.empty())
      text += "(" + modifications + ")";
    if (variable.binding != nullptr)
      text += " = " + expression(*variable.binding);
    return text + description(variable.description);
  }

  static std::string type(const Variable &variable) {
    if (variable.type.base != Base::Enumeration)
      return std::string(kBases[static_cast<std::size_t>(variable.type.base)]);
    return fmt::format("enumeration({})", fmt::join(variable.literals, ", "));
  }

  std::string declaration(const Element &element) const {
    const semantics::PredefinedClass &predefined = *semantics::findPredefined(kElements[static_cast<std::size_t>(element.kind)]);
    std::string text = std::string(kElements[static_cast<std::size_t>(element.kind)]) + " " + element.name + dimensions(element.dims) + "(";
    for (std::size_t i = 0; i < element.attributes.size(); ++i)
      text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", element.attributes[i].name, attributeValue(element.attributes[i], predefined));
    return text + ")" + description(element.description);
  }

  // Ordinals of enumerations by their names.
  std::string attributeValue(const Attribute &attribute, const semantics::PredefinedClass &predefined) const {
    const Expr &value = *attribute.value;
    if (value.kind != ExprKind::Literal || value.type.base != Base::Enumeration)
      return expression(value);
    const std::string_view type = predefined.attribute(attribute.name)->enumeration;
    const auto literals = semantics::findPredefined(type)->literals;
    std::string text;
    for (const double ordinal : value.values)
      text += fmt::format("{}{}.{}", text.empty() ? "" : ", ", type, literals[static_cast<std::size_t>(ordinal) - 1]);
    return value.type.dims.empty() ? text : "{" + text + "}";
  }

  std::string equations(bool isInitial) const {
    std::string text;
    for (const Equation &equation : model_.equations)
      if (equation.isInitial == isInitial)
        text += fmt::format("  {} = {};\n", expression(*equation.left), expression(*equation.right));
    if (!isInitial)
      for (const Assertion &assertion : model_.assertions)
        text += fmt::format("  assert({}, {}{});\n", expression(*assertion.condition), quoted(assertion.message),
                            assertion.isWarning ? ", AssertionLevel.warning" : "");
    return text.empty() ? "" : std::string(isInitial ? "initial equation\n" : "equation\n") + text;
  }

  std::string experiment() const {
    std::string text;
    const auto add = [&](std::string_view name, const std::optional<double> &value) {
      if (value)
        text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", name, *value);
    };
    add("StartTime", model_.experiment.startTime);
    add("StopTime", model_.experiment.stopTime);
    add("Tolerance", model_.experiment.tolerance);
    add("Interval", model_.experiment.interval);
    return text.empty() ? "" : "  annotation(experiment(" + text + "));\n";
  }

  const FlatModel &model_;
};

}  // namespace

std::string print(const FlatModel &model) { return Printer(model).model(); }

std::string print(const Expr &expression, const FlatModel &model) { return Printer(model).expression(expression); }

}  // namespace tf::flat
