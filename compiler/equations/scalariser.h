// Flat expressions to nodes of the expression graph, one per scalar.
//
// Coordinates, inputs, parameters and time become their symbols; every other variable, and its time derivatives, a symbol of kind Unknown
// until the equations are solved. A relation or sign, abs, min, max outside noEvent becomes a provisional switch: also an Unknown symbol,
// of value alpha in [0, 1], by which Select chooses (theory.md section 5). Booleans are numbers in [0, 1]: `a and b` is alpha_a·alpha_b, so
// that compositions stay multi-affine.
#pragma once

#include "compiler/equations/array_operations.h"
#include "compiler/equations/provisional.h"
#include "lang/base/diagnostics.h"

#include <functional>
#include <span>

namespace tf::equations {

class Scalariser {
public:
  // Value of `element.attribute` (an attribute or a result) without the reference's indices. Reports what is not available.
  using ElementValue = std::function<Array(const flat::Expr &reference)>;

  Scalariser(const SymbolNames &names, ir::Graph &graph, Provisionals &provisionals, const SourceManager &sources, Diagnostics &diagnostics)
      : names_(names), variables_(*names.variables), graph_(graph), provisionals_(provisionals), sources_(sources),
        diagnostics_(diagnostics) {}

  void setElementValue(ElementValue value) { elementValue_ = std::move(value); }

  // One node per scalar of the expression's type. After an error (reported) the nodes are of no use. Expressions are remembered by their
  // address: asking again makes no new switch.
  [[nodiscard]] std::vector<ir::NodeId> operator()(const flat::Expr &expression);

  // The nodes of an expression that was met before, inside noEvent or not.
  [[nodiscard]] std::vector<ir::NodeId> known(const flat::Expr &expression);

  // Total time derivative by the chain rule; `span` is where it was asked for.
  [[nodiscard]] std::vector<ir::NodeId> timeDerivative(std::span<const ir::NodeId> nodes, Span span);
  // In the body's frame, of a rotation.
  [[nodiscard]] Vector3 angularVelocity(const Quaternion &q, Span span);

private:
  enum class Events : std::uint8_t { Discontinuous, Continuous, None };  // what relations become

  const Array &array(const flat::Expr &expression);
  std::vector<Array> arrays(const std::vector<flat::ExprPtr> &expressions);
  Array compute(const flat::Expr &expression);
  Array variable(const flat::Expr &expression);
  Array unary(const flat::Expr &expression);
  Array binary(const flat::Expr &expression);
  Array power(const flat::Expr &expression);
  Array conditional(const flat::Expr &expression);
  Array call(const flat::Expr &expression);
  Array arrayCall(const flat::Expr &expression);
  Array rotationCall(const flat::Expr &expression);
  Array smooth(const flat::Expr &expression);
  Array unsupported(const flat::Expr &expression, std::string_view name);

  ir::NodeId scalarBinary(const flat::Expr &expression, ir::NodeId a, ir::NodeId b);
  ir::NodeId relation(const flat::Expr &expression, ir::NodeId a, ir::NodeId b);
  ir::NodeId equality(const flat::Expr &expression, ir::NodeId a, ir::NodeId b);
  ir::NodeId scalarCall(const flat::Expr &expression, std::span<const ir::NodeId> args);
  ir::NodeId kinked(const flat::Expr &expression, std::span<const ir::NodeId> args);
  ir::NodeId rounded(const flat::Expr &expression, std::span<const ir::NodeId> args);
  ir::NodeId switchOn(ir::NodeId condition, bool isContinuous, double atZero, const flat::Expr &expression);

  [[nodiscard]] bool isInline(const flat::Expr &expression) const;
  [[nodiscard]] bool isPlainBoolean(ir::NodeId node) const;
  [[nodiscard]] std::string textOf(const flat::Expr &expression) const;
  ir::NodeId select(ir::NodeId condition, ir::NodeId a, ir::NodeId b);
  ir::NodeId negation(ir::NodeId a);
  template <class Operation> Array elementWise(const flat::Expr &expression, const std::vector<Array> &args, Operation operation);

  const SymbolNames &names_;
  const VariableTable &variables_;
  ir::Graph &graph_;
  Provisionals &provisionals_;
  const SourceManager &sources_;
  Diagnostics &diagnostics_;
  ElementValue elementValue_;
  Events events_ = Events::Discontinuous;
  std::map<std::pair<const flat::Expr *, Events>, Array> known_;
};

}  // namespace tf::equations
