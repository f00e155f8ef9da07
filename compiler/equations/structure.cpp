#include "compiler/equations/structure.h"

#include <algorithm>

namespace tf::equations {

Matching::Matching(int equations, int variables)
    : edges_(static_cast<std::size_t>(equations)), variableOf_(static_cast<std::size_t>(equations), -1),
      equationOf_(static_cast<std::size_t>(variables), -1), visited_(static_cast<std::size_t>(variables), 0) {}

void Matching::addEdge(int equation, int variable) { edges_[static_cast<std::size_t>(equation)].push_back(variable); }

bool Matching::join(int equation, int variable) {
  if (variableOf(equation) >= 0 || equationOf(variable) >= 0)
    return false;
  variableOf_[static_cast<std::size_t>(equation)] = variable;
  equationOf_[static_cast<std::size_t>(variable)] = equation;
  return true;
}

int Matching::augmentAll() {
  int free = 0;
  for (int equation = 0; equation < static_cast<int>(variableOf_.size()); ++equation)
    if (variableOf(equation) < 0 && !augment(equation))
      ++free;
  return free;
}

bool Matching::augment(int root) {
  struct Frame {
    int equation;
    std::size_t next = 0;
    int variable = -1;  // through which the path goes on
  };
  ++search_;
  std::vector<Frame> path{{root}};
  while (!path.empty()) {
    Frame &frame = path.back();
    const auto &edges = edges_[static_cast<std::size_t>(frame.equation)];
    const auto free = std::find_if(edges.begin(), edges.end(), [&](int variable) { return equationOf(variable) < 0; });
    if (free != edges.end()) {
      frame.variable = *free;
      for (const Frame &step : path) {
        variableOf_[static_cast<std::size_t>(step.equation)] = step.variable;
        equationOf_[static_cast<std::size_t>(step.variable)] = step.equation;
      }
      return true;
    }
    while (frame.next < edges.size() && visited_[static_cast<std::size_t>(edges[frame.next])] == search_)
      ++frame.next;
    if (frame.next == edges.size()) {
      path.pop_back();
      continue;
    }
    frame.variable = edges[frame.next++];
    visited_[static_cast<std::size_t>(frame.variable)] = search_;
    path.push_back({equationOf(frame.variable)});
  }
  return false;
}

std::vector<std::vector<int>> stronglyConnectedComponents(const std::vector<std::vector<int>> &successors) {
  struct Frame {
    int vertex;
    std::size_t next = 0;
  };
  const std::size_t count = successors.size();
  std::vector<int> order(count, -1), low(count, 0);
  std::vector<char> isOpen(count, 0);
  std::vector<int> open;
  std::vector<std::vector<int>> components;
  int clock = 0;
  std::vector<Frame> frames;
  const auto enter = [&](int vertex) {
    order[static_cast<std::size_t>(vertex)] = low[static_cast<std::size_t>(vertex)] = clock++;
    isOpen[static_cast<std::size_t>(vertex)] = 1;
    open.push_back(vertex);
    frames.push_back({vertex});
  };
  const auto leave = [&](int vertex) {
    if (low[static_cast<std::size_t>(vertex)] != order[static_cast<std::size_t>(vertex)])
      return;
    const auto first = std::find(open.rbegin(), open.rend(), vertex).base() - 1;
    components.emplace_back(first, open.end());
    for (const int member : components.back())
      isOpen[static_cast<std::size_t>(member)] = 0;
    open.erase(first, open.end());
  };
  for (std::size_t root = 0; root < count; ++root) {
    if (order[root] < 0)
      enter(static_cast<int>(root));
    while (!frames.empty()) {
      Frame &frame = frames.back();
      const auto vertex = static_cast<std::size_t>(frame.vertex);
      if (frame.next < successors[vertex].size()) {
        const int successor = successors[vertex][frame.next++];
        if (order[static_cast<std::size_t>(successor)] < 0)
          enter(successor);
        else if (isOpen[static_cast<std::size_t>(successor)])
          low[vertex] = std::min(low[vertex], order[static_cast<std::size_t>(successor)]);
        continue;
      }
      const int done = frame.vertex;
      frames.pop_back();
      leave(done);
      if (!frames.empty()) {
        int &parent = low[static_cast<std::size_t>(frames.back().vertex)];
        parent = std::min(parent, low[static_cast<std::size_t>(done)]);
      }
    }
  }
  return components;
}

}  // namespace tf::equations
