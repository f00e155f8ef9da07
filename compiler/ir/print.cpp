#include "compiler/ir/function.h"
#include "compiler/ir/operations.h"
#include "compiler/ir/subgraph.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>
#include <variant>

namespace tf::ir {

namespace {

// Modelica's levels of binding, loosest first.
enum Level : int { Choice, Disjunction, Conjunction, Negation, Relation, Sum, Product, Power, Primary };

using Names = std::map<NodeId, std::string>;
using SymbolNames = std::function<std::string(Symbol)>;

// Writes an expression with an explicit stack of pending pieces; linear in the length of the text.
class Printer {
public:
  Printer(const Graph &graph, const SymbolNames &symbolName, const Names &names) : graph_(graph), symbolName_(symbolName), names_(names) {}

  // A node that has a name is written in full only where `expand` names it.
  std::string text(NodeId root, bool expand = false) {
    out_.clear();
    pending_.clear();
    pending_.emplace_back(Operand{root, Choice, expand});
    while (!pending_.empty()) {
      const Piece piece = pending_.back();
      pending_.pop_back();
      if (const auto *literal = std::get_if<const char *>(&piece))
        out_ += *literal;
      else if (const auto *number = std::get_if<Number>(&piece))
        out_ += fmt::format("{}", number->value);
      else
        write(std::get<Operand>(piece));
    }
    return out_;
  }

private:
  struct Operand {
    NodeId id;
    int level;  // the loosest that needs no parentheses here
    bool expand = false;
    double scale = 1;  // of a product: multiplies its constant
  };
  struct Number {
    double value;
  };
  using Piece = std::variant<const char *, Number, Operand>;

  struct Factor {
    NodeId id;
    int count;
  };
  struct FlatProduct {
    double constant = 1;
    std::vector<Factor> factors;  // in order of appearance
  };
  struct Term {
    NodeId id;
    bool isNegative;
    int count;
  };

  [[nodiscard]] bool isNegative(NodeId id) const { return graph_[id].op == Op::Constant && std::signbit(graph_[id].value); }
  [[nodiscard]] bool isInner(NodeId id, NodeId root, Op op) const { return graph_[id].op == op && (id == root || !names_.contains(id)); }

  // A product of products as one, its constants multiplied and its equal factors counted.
  [[nodiscard]] FlatProduct productOf(NodeId root) const {
    FlatProduct product;
    std::unordered_map<NodeId, std::size_t> places;
    std::vector<NodeId> pending{root};
    while (!pending.empty()) {
      const NodeId id = pending.back();
      pending.pop_back();
      if (isInner(id, root, Op::Mul)) {
        pending.insert(pending.end(), {graph_[id].operands[1], graph_[id].operands[0]});
      } else if (graph_[id].op == Op::Constant) {
        product.constant *= graph_[id].value;
      } else {
        const auto [place, isNew] = places.emplace(id, product.factors.size());
        if (isNew)
          product.factors.push_back({id, 0});
        ++product.factors[place->second].count;
      }
    }
    return product;
  }

  [[nodiscard]] bool isNegativeProduct(NodeId id) const {
    return graph_[id].op == Op::Mul && !names_.contains(id) && productOf(id).constant < 0;
  }

  // A sum of sums as one, constants last. What is subtracted is one term.
  [[nodiscard]] std::vector<Term> termsOf(NodeId root) const {
    std::vector<Term> terms, constants;
    std::map<std::pair<NodeId, bool>, std::size_t> places;
    std::vector<std::pair<NodeId, bool>> pending{{root, false}};
    while (!pending.empty()) {
      const auto [id, isSubtracted] = pending.back();
      pending.pop_back();
      const Node &node = graph_[id];
      if (!isSubtracted && isInner(id, root, Op::Add)) {
        pending.insert(pending.end(), {{node.operands[1], false}, {node.operands[0], false}});
      } else if (!isSubtracted && isInner(id, root, Op::Sub)) {
        pending.insert(pending.end(), {{node.operands[1], true}, {node.operands[0], false}});
      } else if (node.op == Op::Constant) {
        constants.push_back({id, isSubtracted, 1});
      } else {
        const auto [place, isNew] = places.emplace(std::pair(id, isSubtracted), terms.size());
        if (isNew)
          terms.push_back({id, isSubtracted, 0});
        ++terms[place->second].count;
      }
    }
    if (!terms.empty() && terms.front().isNegative && !constants.empty())
      terms.insert(terms.begin(), constants.begin(), constants.end());  // "1 - x"
    else
      terms.insert(terms.end(), constants.begin(), constants.end());
    return terms;
  }

  [[nodiscard]] int levelOf(NodeId id) const {
    const Node &node = graph_[id];
    if (names_.contains(id))
      return Primary;
    switch (node.op) {
    case Op::Constant:
      return isNegative(id) ? Sum : Primary;
    case Op::IfElse:
      return Choice;
    case Op::Or:
      return Disjunction;
    case Op::And:
      return Conjunction;
    case Op::Not:
      return relation(node) != nullptr ? Relation : Negation;
    case Op::Less:
    case Op::LessEqual:
    case Op::Equal:
      return Relation;
    case Op::Neg:
      return isNegativeProduct(node.operands[0]) ? Product : Sum;
    case Op::Add:
    case Op::Sub:
      return Sum;
    case Op::Mul: {
      const FlatProduct product = productOf(id);
      return product.constant < 0 ? Sum : product.factors.size() == 1 && product.constant == 1 ? Power : Product;
    }
    case Op::Div:
      return isNegative(node.operands[0]) ? Sum : Product;
    case Op::Pow:
      return Power;
    default:
      return Primary;
    }
  }

  // The relation's sign; of a negated relation its opposite.
  [[nodiscard]] const char *relation(const Node &node) const {
    const bool negated = node.op == Op::Not;
    const Op op = negated ? graph_[node.operands[0]].op : node.op;
    if (negated && names_.contains(node.operands[0]))
      return nullptr;
    switch (op) {
    case Op::Less:
      return negated ? " >= " : " < ";
    case Op::LessEqual:
      return negated ? " > " : " <= ";
    case Op::Equal:
      return negated ? " <> " : " == ";
    default:
      return nullptr;
    }
  }

  // Pieces are written first to last.
  void push(std::initializer_list<Piece> pieces) { pending_.insert(pending_.end(), std::rbegin(pieces), std::rend(pieces)); }

  void write(Operand operand) {
    if (const auto found = names_.find(operand.id); found != names_.end() && !operand.expand) {
      out_ += found->second;
      return;
    }
    const bool parentheses = operand.scale == 1 && levelOf(operand.id) < operand.level;
    if (parentheses) {
      push({"(", Operand{operand.id, Choice, operand.expand}, ")"});
      return;
    }
    writeBare(operand);
  }

  void writeSum(NodeId id) {
    std::vector<Piece> pieces;
    for (const Term &term : termsOf(id)) {
      const bool isProduct = graph_[term.id].op == Op::Mul && !names_.contains(term.id);
      const bool flips = isProduct && productOf(term.id).constant < 0;
      const bool isNegative = term.isNegative != flips;
      const int level = pieces.empty() && !isNegative && term.count == 1 ? Sum : Product;
      if (!pieces.empty())
        pieces.emplace_back(isNegative ? " - " : " + ");
      else if (isNegative)
        pieces.emplace_back("-");
      if (term.count > 1 && !isProduct) {
        pieces.emplace_back(Number{static_cast<double>(term.count)});
        pieces.emplace_back("*");
      }
      pieces.emplace_back(Operand{term.id, level, false, isProduct ? (flips ? -term.count : term.count) : 1.0});
    }
    pending_.insert(pending_.end(), pieces.rbegin(), pieces.rend());
  }

  void writeProduct(NodeId id, double scale) {
    const FlatProduct product = productOf(id);
    std::vector<Piece> pieces;
    const double constant = scale * product.constant;
    if (constant == -1)
      pieces.emplace_back("-");
    else if (constant != 1 || product.factors.empty())
      pieces.emplace_back(Number{constant});
    for (std::size_t k = 0; k < product.factors.size(); ++k) {
      const auto [factor, count] = product.factors[k];
      if (!pieces.empty() && !(k == 0 && constant == -1))
        pieces.emplace_back("*");
      const bool isQuotient = graph_[factor].op == Op::Div && (k == 0 || k + 1 == product.factors.size());
      pieces.emplace_back(Operand{factor, count > 1 ? Primary : isQuotient ? Product : Power});
      if (count > 1) {
        pieces.emplace_back("^");
        pieces.emplace_back(Number{static_cast<double>(count)});
      }
    }
    pending_.insert(pending_.end(), pieces.rbegin(), pieces.rend());
  }

  void writeBare(const Operand &operand) {
    const Node &node = graph_[operand.id];
    const NodeId a = node.operands[0];
    const NodeId b = node.operands[1];
    switch (node.op) {
    case Op::Constant:
      out_ += fmt::format("{}", node.value);
      return;
    case Op::Symbol:
      out_ += symbolName_(node.symbol);
      return;
    case Op::Neg:
      return isNegativeProduct(a) ? writeProduct(a, -1) : push({"-", Operand{a, Product}});
    case Op::Add:
    case Op::Sub:
      return writeSum(operand.id);
    case Op::Mul:
      return writeProduct(operand.id, operand.scale);
    case Op::Div:
      return push({Operand{a, isNegative(a) ? Sum : Product}, "/", Operand{b, Power}});
    case Op::Pow:
      return push({Operand{a, Primary}, "^", Operand{b, Primary}});
    default:
      writeLogical(node);
    }
  }

  void writeLogical(const Node &node) {
    const NodeId a = node.operands[0];
    const NodeId b = node.operands[1];
    switch (node.op) {
    case Op::Less:
    case Op::LessEqual:
    case Op::Equal:
      return push({Operand{a, Sum}, relation(node), Operand{b, Sum}});
    case Op::Not:
      if (const char *sign = relation(node); sign != nullptr)
        return push({Operand{graph_[a].operands[0], Sum}, sign, Operand{graph_[a].operands[1], Sum}});
      return push({"not ", Operand{a, Relation}});
    case Op::And:
      return push({Operand{a, Conjunction}, " and ", Operand{b, Negation}});
    case Op::Or:
      return push({Operand{a, Disjunction}, " or ", Operand{b, Conjunction}});
    case Op::IfElse:
      return push({"if ", Operand{a, Disjunction}, " then ", Operand{b, Disjunction}, " else ", Operand{node.operands[2], Choice}});
    default:
      writeCall(node);
    }
  }

  void writeCall(const Node &node) {
    out_ += functionName(node.op);
    out_ += '(';
    pending_.emplace_back(")");
    for (int k = node.arity - 1; k >= 0; --k) {
      pending_.emplace_back(Operand{node.operands[k], Choice});
      if (k > 0)
        pending_.emplace_back(", ");
    }
  }

  const Graph &graph_;
  const SymbolNames &symbolName_;
  const Names &names_;
  std::string out_;
  std::vector<Piece> pending_;
};

// Names t1, t2, … for operations that are used more than once, in topological order. `roots` count as uses.
Names nameShared(const Graph &graph, const Subgraph &reached, std::span<const NodeId> roots) {
  std::vector<int> uses(static_cast<std::size_t>(reached.size()), 0);
  const auto use = [&](NodeId id) { ++uses[static_cast<std::size_t>(reached.position(id))]; };
  for (const NodeId root : roots)
    use(root);
  for (const NodeId id : reached.nodes()) {
    const Node &node = graph[id];
    for (int k = 0; k < node.arity; ++k)
      if (k == 0 || node.operands[k] != node.operands[0])
        use(node.operands[k]);
  }
  Names names;
  for (const NodeId id : reached.nodes()) {
    const Node &node = graph[id];
    const bool trivial = node.arity == 0 || (node.op == Op::Neg && graph[node.operands[0]].arity == 0);
    if (!trivial && uses[static_cast<std::size_t>(reached.position(id))] > 1)
      names.emplace(id, fmt::format("t{}", names.size() + 1));
  }
  return names;
}

// Number of nodes of the expression written out as a tree.
double treeSize(const Graph &graph, const Subgraph &reached) {
  std::vector<double> sizes(static_cast<std::size_t>(reached.size()), 1);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const Node &node = graph[reached.node(static_cast<int>(k))];
    for (int j = 0; j < node.arity; ++j)
      sizes[k] += sizes[static_cast<std::size_t>(reached.position(node.operands[j]))];
  }
  return sizes.back();
}

}  // namespace

std::string print(const Graph &graph, NodeId root, const SymbolNames &name) {
  const Subgraph reached(graph, std::array{root});
  const bool isMuchShared = treeSize(graph, reached) > 200 + 3.0 * reached.size();
  const Names names = isMuchShared ? nameShared(graph, reached, {}) : Names{};
  Printer printer(graph, name, names);
  std::string text = printer.text(root, true);
  const char *separator = " where ";
  for (const auto &[id, shared] : names) {
    if (id == root)
      continue;
    text += fmt::format("{}{} = {}", separator, shared, printer.text(id, true));
    separator = ", ";
  }
  return text;
}

std::string print(const Function &function, const Graph &graph, const SymbolNames &name) {
  std::vector<NodeId> roots;
  for (const std::vector<Store> *stores : {&function.stores, &function.additions})
    for (const Store &store : *stores)
      roots.push_back(store.node);
  if (function.sweep)
    for (const Sweep::Result &result : function.sweep->results)
      roots.push_back(result.node);
  const Subgraph reached(graph, roots);
  const Names names = nameShared(graph, reached, roots);
  Printer printer(graph, name, names);
  std::string text = fmt::format("function {}\n", function.name);
  for (const auto &[id, shared] : names)
    text += fmt::format("  {} = {}\n", shared, printer.text(id, true));
  const auto list = [&](const std::vector<Store> &stores, const char *sign) {
    for (const Store &store : stores) {
      const std::string guard = store.group < 0 ? "" : fmt::format("  if mask[{}]", store.group);
      text += fmt::format("  out[{}][{}] {} {}{}\n", store.buffer, store.position, sign, printer.text(store.node), guard);
    }
  };
  list(function.stores, "=");
  if (function.sweep)
    for (std::size_t k = 0; k < function.sweep->results.size(); ++k)
      text += fmt::format("  result[{}] = {}\n", k, printer.text(function.sweep->results[k].node));
  if (function.sweep && function.sweep->products >= 0)
    text += fmt::format("  out[{}] = results along the caller's directions if mask\n", function.sweep->products);
  list(function.additions, "+=");
  return text;
}

}  // namespace tf::ir
