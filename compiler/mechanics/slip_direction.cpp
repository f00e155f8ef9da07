// Bounds of friction that depend on the direction of their own slip.
#include "compiler/mechanics/slip_direction.h"

#include "runtime/abi/tf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

// A point at which expressions are evaluated: numbers of no regularity for all symbols, velocities apart.
class Sample {
public:
  Sample(const HybridSystem &system, int seed) : system_(system), seed_(seed) {
    for (int k = 0; k < system.nv; ++k)
      velocities_.push_back(number({SymbolKind::Velocity, k}));
  }

  [[nodiscard]] std::vector<double> values(std::span<const NodeId> nodes, int step = -1, double alpha = 0) const {
    return ir::evaluate(system_.graph, nodes, [&](Symbol symbol) {
      if (symbol.kind == SymbolKind::StepVariable)
        return symbol.index == step ? alpha : static_cast<double>((symbol.index + seed_) % 2);
      return symbol.kind == SymbolKind::Velocity ? velocities_[static_cast<std::size_t>(symbol.index)] : number(symbol);
    });
  }
  [[nodiscard]] double value(NodeId node, int step = -1, double alpha = 0) const { return values(std::array{node}, step, alpha)[0]; }
  void move(const std::vector<double> &direction, double length) {
    for (std::size_t k = 0; k < velocities_.size(); ++k)
      velocities_[k] += length * direction[k];
  }

  // Of a slip, which is affine in the velocities.
  [[nodiscard]] std::vector<double> gradient(NodeId slip) {
    const double here = value(slip);
    std::vector<double> result(velocities_.size());
    for (std::size_t k = 0; k < velocities_.size(); ++k) {
      velocities_[k] += 1;
      result[k] = value(slip) - here;
      velocities_[k] -= 1;
    }
    return result;
  }

private:
  [[nodiscard]] double number(Symbol symbol) const {
    const double x = std::sin(1.0 + 12.9898 * symbol.index + 78.233 * static_cast<int>(symbol.kind) + 37.719 * seed_) * 43758.5453;
    return 0.2 + 0.7 * (x - std::floor(x));
  }

  const HybridSystem &system_;
  int seed_;
  std::vector<double> velocities_;
};

double product(const std::vector<double> &a, const std::vector<double> &b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += a[k] * b[k];
  return sum;
}

// Moves the sample to where all components of the slip are zero. The directions that it returns are orthogonal, one for each component that
// is not determined by those before.
std::vector<std::vector<double>> stop(Sample &sample, const std::vector<NodeId> &slip) {
  constexpr double dependent = 1e-9;
  std::vector<std::vector<double>> directions;
  for (const NodeId component : slip) {
    std::vector<double> direction = sample.gradient(component);
    const double size = product(direction, direction);
    for (const std::vector<double> &other : directions) {
      const double share = product(direction, other) / product(other, other);
      for (std::size_t k = 0; k < direction.size(); ++k)
        direction[k] -= share * other[k];
    }
    const double squares = product(direction, direction);
    if (!(squares > dependent * size))
      continue;
    sample.move(direction, -sample.value(component) / squares);
    directions.push_back(std::move(direction));
  }
  return directions;
}

// At this sample the condition is zero with the slip, has another sign on its other side, and the bound has another value there.
bool tellsDirection(const HybridSystem &system, const FrictionEntry &friction, int step, int seed) {
  constexpr double rounding = 1e-9, aside = 0.125;
  const NodeId condition = system.switches[static_cast<std::size_t>(step)].condition;
  Sample sample(system, seed);
  const double away = std::abs(sample.value(condition));
  const std::vector<std::vector<double>> directions = stop(sample, friction.slip);
  if (!(std::abs(sample.value(condition)) <= rounding * std::max(1.0, away)))
    return false;
  const double low = sample.value(friction.bound, step, 0), high = sample.value(friction.bound, step, 1);
  if (!(std::abs(high - low) > rounding * std::max({1e-3, std::abs(low), std::abs(high)})))
    return false;
  return std::ranges::any_of(directions, [&](const std::vector<double> &direction) {
    const double length = aside / std::sqrt(product(direction, direction));
    sample.move(direction, length);
    const double ahead = sample.value(condition);
    sample.move(direction, -2 * length);
    const double behind = sample.value(condition);
    sample.move(direction, length);
    return ahead * behind < 0;
  });
}

}  // namespace

int switchOnSlipDirection(const HybridSystem &system, const FrictionEntry &friction) {
  constexpr int samples = 4;
  for (const Symbol symbol : equations::symbolsOf(system.graph, friction.bound)) {
    if (symbol.kind != SymbolKind::StepVariable)
      continue;
    const SwitchingFunction &one = system.switches[static_cast<std::size_t>(symbol.index)];
    if (one.kind == TF_SWITCH_REST || !ir::dependsOn(system.graph, one.condition, [](Symbol s) { return s.kind == SymbolKind::Velocity; }))
      continue;
    for (int seed = 0; seed < samples; ++seed)
      if (tellsDirection(system, friction, symbol.index, seed))
        return symbol.index;
  }
  return -1;
}

}  // namespace tf::mechanics
