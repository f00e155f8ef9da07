// Systems derived from models given as text, and their numbers at a point, for tests.
#pragma once

#include "compiler/mechanics/hybrid_system.h"
#include "tests/unit/lang/semantics/instantiate_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace tf::test {

// Values of all symbols.
class Point {
public:
  Point() = default;
  // Values in [lower, upper] for everything that the system has; quaternions have length 1, parameters their own values.
  Point(const HybridSystem &system, unsigned seed, double lower = -1, double upper = 1) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> number(lower, upper);
    const auto fill = [&](ir::SymbolKind kind, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k)
        values_[{kind, static_cast<int>(k)}] = number(generator);
    };
    using enum ir::SymbolKind;
    const auto nq = static_cast<std::size_t>(system.nq), nv = static_cast<std::size_t>(system.nv);
    for (const auto &[kind, count] :
         {std::pair{Time, std::size_t{1}}, std::pair{Coordinate, nq}, std::pair{Velocity, nv}, std::pair{Acceleration, nv},
          std::pair{State, static_cast<std::size_t>(system.nz)}, std::pair{StateDerivative, static_cast<std::size_t>(system.nz)},
          std::pair{Input, static_cast<std::size_t>(system.nu)}, std::pair{NormalForce, system.contacts.size()},
          std::pair{TangentForce, system.tangents.size()}, std::pair{Multiplier, system.constraintRows.size()}})
      fill(kind, count);
    for (const equations::RotationCoordinate &rotation : system.motion.rotations()) {
      double square = 0;
      for (int k = 0; k < 4; ++k)
        square += std::pow(values_[{Coordinate, rotation.coordinate + k}], 2);
      for (int k = 0; k < 4; ++k)
        values_[{Coordinate, rotation.coordinate + k}] /= std::sqrt(square);
    }
    for (std::size_t k = 0; k < system.switches.size(); ++k)
      values_[{StepVariable, static_cast<int>(k)}] = std::uniform_real_distribution<double>(0, 1)(generator);
    for (std::size_t k = 0; k < system.parameterValues.size(); ++k)
      values_[{Parameter, static_cast<int>(k)}] = system.parameterValues[k];
  }

  double &operator()(ir::SymbolKind kind, int index = 0) { return values_[{kind, index}]; }
  [[nodiscard]] double at(ir::Symbol symbol) const { return values_.at({symbol.kind, symbol.index}); }

  [[nodiscard]] std::vector<double> evaluate(const ir::Graph &graph, std::span<const ir::NodeId> nodes) const {
    return ir::evaluate(graph, nodes, [&](ir::Symbol symbol) { return at(symbol); });
  }
  [[nodiscard]] double evaluate(const ir::Graph &graph, ir::NodeId node) const {
    return evaluate(graph, std::span<const ir::NodeId>(&node, 1))[0];
  }

private:
  std::map<std::pair<ir::SymbolKind, int>, double> values_;
};

struct DerivedModel {
  explicit DerivedModel(const std::string &text) {
    instantiateText(outcome, workspace, text);
    derive();
  }
  // A file of the repository.
  static std::unique_ptr<DerivedModel> ofFile(const std::string &path) {
    return std::make_unique<DerivedModel>(readFile(std::string(TF_SOURCE_DIR) + "/" + path));
  }

  [[nodiscard]] std::string errors() const { return outcome.rendered(workspace); }
  HybridSystem &operator*() { return *system; }
  HybridSystem *operator->() { return &*system; }

  [[nodiscard]] const Quantity *quantity(const std::string &name) const {
    for (const Quantity &one : system->quantities)
      if (one.name == name)
        return &one;
    return nullptr;
  }

  Workspace workspace;
  Outcome outcome;
  std::optional<HybridSystem> system;

private:
  void derive() {
    if (!outcome.instantiation.model)
      return;
    system = tf::derive(*outcome.instantiation.model, outcome.sources, outcome.diagnostics);
    if (system) {
      EXPECT_EQ(verify(*system), "");
    }
  }
};

// Fails and leaves the test where the model has errors.
#define TF_ASSERT_DERIVED(model) ASSERT_TRUE((model).system.has_value()) << (model).errors()

}  // namespace tf::test
