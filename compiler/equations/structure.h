// Structural analysis: matching of equations and unknowns, sorting into strongly connected components.
#pragma once

#include <vector>

namespace tf::equations {

// A matching of equations (rows) and variables (columns) that grows along augmenting paths; edges may be added between calls. Both searches
// are iterative, so that the size of a model does not bound the depth of the stack.
class Matching {
public:
  Matching(int equations, int variables);

  void addEdge(int equation, int variable);
  // Joins two that are both free; false if one is not.
  bool join(int equation, int variable);
  // Tries to match every free equation along an augmenting path; returns the number of equations that stay free.
  int augmentAll();

  [[nodiscard]] int variableOf(int equation) const { return variableOf_[static_cast<std::size_t>(equation)]; }  // −1: free
  [[nodiscard]] int equationOf(int variable) const { return equationOf_[static_cast<std::size_t>(variable)]; }  // −1: free

private:
  bool augment(int equation);

  std::vector<std::vector<int>> edges_;  // variables of each equation, in order of preference
  std::vector<int> variableOf_, equationOf_;
  std::vector<int> visited_;  // of variables: the search that saw them last
  int search_ = 0;
};

// Strongly connected components of the directed graph `successors` (Tarjan 1972), each after all components that it points to: with edges
// from a thing to what it depends on, the order of evaluation. Roots are tried in the order 0, 1, ….
[[nodiscard]] std::vector<std::vector<int>> stronglyConnectedComponents(const std::vector<std::vector<int>> &successors);

}  // namespace tf::equations
