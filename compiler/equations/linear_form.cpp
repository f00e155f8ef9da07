#include "compiler/equations/equation_system.h"

#include <algorithm>

namespace tf::equations {

namespace {

using ir::NodeId;
using ir::Op;

constexpr NodeId kConstantTerm = -1;

struct Weighted {
  NodeId node;
  double factor;
};

}  // namespace

LinearForm normalForm(const ir::Graph &graph, NodeId root) {
  std::map<NodeId, double> terms;
  std::vector<Weighted> stack{{root, 1}};
  const auto valueOf = [&](NodeId id) { return graph[id].value; };
  const auto isConstant = [&](NodeId id) { return graph[id].op == Op::Constant; };
  while (!stack.empty()) {
    const auto [id, factor] = stack.back();
    stack.pop_back();
    const ir::Node &node = graph[id];
    const NodeId a = node.operands[0], b = node.operands[1];
    if (node.op == Op::Constant) {
      terms[kConstantTerm] += factor * node.value;
    } else if (node.op == Op::Neg) {
      stack.push_back({a, -factor});
    } else if (node.op == Op::Add || node.op == Op::Sub) {
      stack.push_back({b, node.op == Op::Add ? factor : -factor});
      stack.push_back({a, factor});
    } else if (node.op == Op::Mul && isConstant(a)) {
      stack.push_back({b, factor * valueOf(a)});
    } else if (node.op == Op::Mul && isConstant(b)) {
      stack.push_back({a, factor * valueOf(b)});
    } else if (node.op == Op::Div && isConstant(b) && valueOf(b) != 0) {
      stack.push_back({a, factor / valueOf(b)});
    } else {
      terms[id] += factor;
    }
  }
  LinearForm form;
  for (const auto &[id, coefficient] : terms)
    if (coefficient != 0 && id != kConstantTerm)
      form.terms.emplace_back(id, coefficient);
  if (const auto constant = terms.find(kConstantTerm); constant != terms.end() && constant->second != 0)
    form.terms.emplace_back(kConstantTerm, constant->second);
  if (form.terms.empty())
    return form;
  form.scale = form.terms[0].second;
  for (auto &term : form.terms)
    term.second /= form.scale;
  return form;
}

}  // namespace tf::equations
