// A mass matrix that is singular whatever the configuration is a mistake of the model.
#include "compiler/mechanics/derivation.h"

#include "compiler/mechanics/diagnostics.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

constexpr int kSamples = 3;
constexpr double kSingular = 1e-12;  // of the smallest to the largest eigenvalue of the scaled matrix
constexpr double kMoving = 1e-3;     // least share of a coordinate in the motion without mass that is named

// A generic point: positive parameters, as masses and lengths are, and irrational-looking coordinates.
double sample(Symbol symbol, int round, const std::vector<double> &parameters) {
  const double spread = std::fmod(0.6180339887498949 * (symbol.index + 1) + 0.3247179572447460 * (round + 1), 1.0);
  if (symbol.kind == SymbolKind::Parameter) {
    const double value = parameters[static_cast<std::size_t>(symbol.index)];
    return value != 0 && std::isfinite(value) ? value * (1 + 0.1 * spread) : 0.5 + spread;
  }
  return 0.3 + spread;
}

// The direction in which M is singular at a generic point; empty if it is regular there.
std::vector<double> masslessMotion(const HybridSystem &system, const std::vector<double> &parameters, int round) {
  const std::vector<double> values = ir::evaluate(system.graph, system.mass, [&](Symbol s) { return sample(s, round, parameters); });
  const int n = system.nv;
  Eigen::MatrixXd mass = Eigen::Map<const Eigen::MatrixXd>(values.data(), n, n);
  if (!mass.allFinite() || (mass.diagonal().array() <= 0).any())
    return {};
  const Eigen::VectorXd scale = mass.diagonal().array().sqrt().inverse();
  mass = scale.asDiagonal() * mass * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass);
  if (solver.eigenvalues()(0) > kSingular * solver.eigenvalues()(n - 1))
    return {};
  const Eigen::VectorXd motion = solver.eigenvectors().col(0);
  return {motion.data(), motion.data() + n};
}

}  // namespace

bool checkMass(Derivation &derivation) {
  const HybridSystem &system = derivation.system;
  const auto &coordinates = derivation.variables.scalars(equations::Role::Coordinate);
  const auto n = static_cast<std::size_t>(system.nv);
  bool isFine = true;
  for (std::size_t k = 0; k < n; ++k)
    if (system.graph.isConstant(system.mass[k * n + k], 0)) {
      derivation.diagnostics.report(diag::MasslessCoordinate, derivation.variables.variable(coordinates[k]).span,
                                    derivation.variables.name(coordinates[k]));
      isFine = false;
    }
  if (!isFine || n == 0)
    return isFine;
  const std::vector<double> parameters = parameterValues(system);
  std::vector<double> motion;
  for (int round = 0; round < kSamples; ++round)
    if (motion = masslessMotion(system, parameters, round); motion.empty())
      return true;
  std::string names;
  Span span;
  for (std::size_t k = 0; k < n; ++k)
    if (std::abs(motion[k]) > kMoving) {
      names += (names.empty() ? "'" : ", '") + derivation.variables.name(coordinates[k]) + "'";
      if (!span.valid())
        span = derivation.variables.variable(coordinates[k]).span;
    }
  derivation.diagnostics.report(diag::SingularMass, span, names);
  return false;
}

}  // namespace tf::mechanics
