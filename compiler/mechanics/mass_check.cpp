// A mass matrix that is singular whatever the configuration is a mistake of the model.
#include "compiler/ir/sweep.h"
#include "compiler/mechanics/derivation.h"
#include "compiler/mechanics/diagnostics.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <set>

namespace tf::mechanics {

using ir::NodeId;
using ir::Symbol;
using ir::SymbolKind;

namespace {

constexpr int kSamples = 3;
constexpr double kSingular = 1e-12;  // of the smallest to the largest magnitude of the scaled matrix' eigenvalues
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

// M at a generic point.
Eigen::MatrixXd massAt(const HybridSystem &system, const std::vector<double> &parameters, int round) {
  const auto value = [&](Symbol symbol) { return sample(symbol, round, parameters); };
  const std::vector<double> values = system.massProduct.empty() ? ir::evaluate(system.graph, system.mass, value)
                                                                : ir::evaluateMatrix(system.graph, system.massProduct, system.nv, value);
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), system.nv, system.nv);
}

// Beyond doubt, by inverse iteration with the Cholesky factor: cheaper than the eigenvalues by far.
bool isWellConditioned(const Eigen::MatrixXd &scaledMass) {
  const Eigen::LLT<Eigen::MatrixXd> factor(scaledMass);
  if (factor.info() != Eigen::Success)
    return false;
  Eigen::VectorXd direction(scaledMass.rows());
  for (Eigen::Index k = 0; k < direction.size(); ++k)
    direction(k) = 0.5 + std::fmod(0.6180339887498949 * static_cast<double>(k + 1), 1.0);
  double growth = 0;
  for (int iteration = 0; iteration < 3; ++iteration) {
    direction.normalize();
    direction = factor.solve(direction);
    growth = direction.norm();
  }
  return growth < 1e-4 / kSingular;
}

// The direction in which M is singular at a generic point; empty if it is regular there. It may be indefinite, as where products of inertia
// that are zero are positive parameters for once.
std::vector<double> masslessMotion(const HybridSystem &system, const std::vector<double> &parameters, int round) {
  const int n = system.nv;
  Eigen::MatrixXd mass = massAt(system, parameters, round);
  if (!mass.allFinite() || (mass.diagonal().array() <= 0).any())
    return {};
  const Eigen::VectorXd scale = mass.diagonal().array().sqrt().inverse();
  mass = scale.asDiagonal() * mass * scale.asDiagonal();
  if (isWellConditioned(mass))
    return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass);
  Eigen::Index least = 0;
  const double smallest = solver.eigenvalues().cwiseAbs().minCoeff(&least);
  if (smallest > kSingular * solver.eigenvalues().cwiseAbs().maxCoeff())
    return {};
  const Eigen::VectorXd motion = solver.eigenvectors().col(least);
  return {motion.data(), motion.data() + n};
}

// Coordinates whose velocity no inertia resists.
std::vector<std::size_t> masslessCoordinates(const HybridSystem &system) {
  const auto n = static_cast<std::size_t>(system.nv);
  std::vector<std::size_t> massless;
  if (system.massProduct.empty()) {
    for (std::size_t k = 0; k < n; ++k)
      if (system.graph.isConstant(system.mass[k * n + k], 0))
        massless.push_back(k);
    return massless;
  }
  const std::vector<std::vector<int>> structure = ir::seedStructure(system.graph, system.massProduct, system.nv);
  for (std::size_t k = 0; k < n; ++k)
    if (!std::ranges::binary_search(structure[k], static_cast<int>(k)))
      massless.push_back(k);
  return massless;
}

}  // namespace

bool checkInertia(Derivation &derivation) {
  constexpr double kRoundOff = 1e-12;
  const std::vector<double> parameters = parameterValues(derivation.system);
  const int errors = derivation.diagnostics.errorCount();
  for (const BodyEntry &body : derivation.elements.bodies) {
    if (body.inertia.size() != 9)
      continue;
    const Span span = derivation.model.elements[static_cast<std::size_t>(body.element)].find("inertia")->value->span;
    const std::vector<double> values = ir::evaluate(derivation.system.graph, body.inertia,
                                                    [&](Symbol symbol) { return parameters[static_cast<std::size_t>(symbol.index)]; });
    const Eigen::Matrix3d tensor = Eigen::Map<const Eigen::Matrix3d>(values.data());
    const double scale = tensor.cwiseAbs().maxCoeff();
    bool isSymmetric = true;
    for (int i = 0; i < 3; ++i)
      for (int j = i + 1; j < 3 && isSymmetric; ++j)
        if (!(std::abs(tensor(i, j) - tensor(j, i)) <= kRoundOff * scale)) {
          isSymmetric = false;
          derivation.diagnostics.report(diag::InertiaNotSymmetric, span, body.name, j + 1, i + 1, i + 1, j + 1, tensor(i, j), tensor(j, i));
        }
    if (!isSymmetric)
      continue;
    // Principal moments A <= B <= C of masses satisfy 0 <= A and C <= A + B.
    const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor).eigenvalues();
    if (!(moments(0) >= -kRoundOff * scale && moments(2) <= (moments(0) + moments(1)) * (1 + kRoundOff)))
      derivation.diagnostics.report(diag::InertiaNotPositive, span, body.name, moments(0), moments(1), moments(2));
  }
  return derivation.diagnostics.errorCount() == errors;
}

bool checkMass(Derivation &derivation) {
  const HybridSystem &system = derivation.system;
  const auto n = static_cast<std::size_t>(system.nv);
  std::set<std::string> reported;  // a rotation is reported once
  const std::vector<std::size_t> massless = masslessCoordinates(system);
  for (const std::size_t k : massless)
    if (std::string name = derivation.variables.movingName(static_cast<int>(k)); reported.insert(name).second)
      derivation.diagnostics.report(diag::MasslessCoordinate,
                                    derivation.variables.variable(derivation.variables.velocity(static_cast<int>(k))).span, name);
  if (!massless.empty() || n == 0)
    return massless.empty();
  const std::vector<double> parameters = parameterValues(system);
  std::vector<double> motion;
  for (int round = 0; round < kSamples; ++round)
    if (motion = masslessMotion(system, parameters, round); motion.empty())
      return true;
  std::string names;
  Span span;
  std::set<std::string> named;
  for (std::size_t k = 0; k < n; ++k) {
    const std::string name = derivation.variables.movingName(static_cast<int>(k));
    if (std::abs(motion[k]) <= kMoving || !named.insert(name).second)
      continue;
    names += (names.empty() ? "'" : ", '") + name + "'";
    if (!span.valid())
      span = derivation.variables.variable(derivation.variables.velocity(static_cast<int>(k))).span;
  }
  derivation.diagnostics.report(diag::SingularMass, span, names);
  return false;
}

}  // namespace tf::mechanics
