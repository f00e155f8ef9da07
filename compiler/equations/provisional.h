// What the symbols of kind Unknown stand for between scalarisation and the solution of the equations.
#pragma once

#include "compiler/equations/variable_table.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tf::equations {

// A switching function as it was met; alpha = 1 where condition > 0.
struct ProvisionalSwitch {
  ir::NodeId condition = -1;
  bool isContinuous = false;  // abs, min, max: both branches agree on condition = 0
  double atZero = 0;          // alpha where condition stays 0 without sliding: 1 where the relation as written holds there, 1/2 of a sign
  std::string text;           // the condition as written
  Span span;
};

struct Provisional {
  enum class Kind : std::uint8_t { Variable, Switch };
  Kind kind = Kind::Variable;
  int index = 0;  // in VariableTable::scalars(Role::Unknown), or of the switch
  int order = 0;  // of the time derivative of a variable
  Span span;      // of the first expression that needed it
};

// The Unknown symbols of one derivation; the symbol's index counts them.
class Provisionals {
public:
  int variable(int unknown, int order, Span span);
  int addSwitch(ProvisionalSwitch switching);

  [[nodiscard]] int size() const { return static_cast<int>(all_.size()); }
  [[nodiscard]] const Provisional &operator[](int id) const { return all_[static_cast<std::size_t>(id)]; }
  [[nodiscard]] const std::vector<ProvisionalSwitch> &switches() const { return switches_; }
  void makeDiscontinuous(int switching) { switches_[static_cast<std::size_t>(switching)].isContinuous = false; }

private:
  std::vector<Provisional> all_;
  std::vector<ProvisionalSwitch> switches_;
  std::map<std::pair<int, int>, int> variables_;
};

// Symbols that one node depends on, sorted.
[[nodiscard]] std::vector<ir::Symbol> symbolsOf(const ir::Graph &graph, ir::NodeId node);

// Names for messages about symbols that equations and attributes depend on.
struct SymbolNames {
  const VariableTable *variables = nullptr;
  std::vector<std::string> normalForces, tangentForces;  // "floor.normalForce", "floor.frictionForce"
  std::vector<std::string> multipliers;                  // "loop.multiplier"
  std::vector<std::string> states;                       // known after the equations are solved

  // "the velocity of 'q[1]'", "the contact force 'floor.normalForce'".
  [[nodiscard]] std::string describe(ir::Symbol symbol) const;
};

}  // namespace tf::equations
