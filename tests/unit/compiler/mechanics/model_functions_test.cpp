// The functions of a compiled model: their layout, and all derivatives against central differences.
#include "tests/unit/compiler/mechanics/derived_model.h"
#include "tests/unit/compiler/mechanics/function_index.h"

#include <cmath>

namespace tf::test {
namespace {

using enum ir::SymbolKind;

// One model with everything: a rod with moving contact, a friction element, states, switches of all kinds, an input.
constexpr const char *kEverything = R"(
model Everything
  parameter Real m = 1.5, J = 0.2, k = 2 "stiffness", k2 = 2*k;
  input Real u(start = 0.25);
  coordinate Real x(start = 1), y(start = 2*k, der(start = -1)), th;
  Real z(start = 0.5), w(start = 1);
  Real wind = if z > 0.2 then 0.7*z else -u;
  body rod(mass = m, position = {x, y + 0.1*sin(time)*x}, angle = th, inertia = J);
  gravity weight(acceleration = {0, -9.81});
  potential spring(energy = 0.5*k2*(x^2 + y^2)*(1 + 0.1*z^2) + exp(-th^2)*u);
  force drive(value = {u + wind, abs(der(y))*x, sin(w)*der(th)}, at = {x*y, y, th + x*time});
  contact tip(gap = y - 0.5*sin(th) - 0.1*sin(3*time), slip = der(x - 0.5*cos(th)) - 2*time^2, friction = 0.3*(1 + x^2 + z*u));
  contact wall[2](gap = {x*cos(th), 2 - y});
  friction drag(slip = der(x*y)*cos(th), bound = 0.1 + z^2*u^2 + der(th)^2);
equation
  der(z) = sin(x)*der(y) - z*w + (if time > 1 then u else 0);
  der(w) = max(z, der(x))*cos(time);
end Everything;
)";

class FunctionsTest : public ::testing::Test {
protected:
  void SetUp() override {
    TF_ASSERT_DERIVED(model_);
    functions_ = modelFunctions(*model_);
    ASSERT_EQ(functions_.size(), 16U);
    for (const auto &[kind, count] :
         {std::pair{Coordinate, model_->nq}, std::pair{Velocity, model_->nv}, std::pair{State, model_->nz}, std::pair{Input, model_->nu}})
      for (int k = 0; k < count; ++k)
        columns_.push_back({kind, k});
    columns_.push_back({Time, 0});
  }

  std::vector<double> buffer(const ir::Function &function, int index, const Point &point) {
    std::vector<double> values(static_cast<std::size_t>(function.bufferSizes.at(static_cast<std::size_t>(index))), std::nan(""));
    for (const ir::Store &store : function.stores)
      if (store.buffer == index)
        values[static_cast<std::size_t>(store.position)] = point.evaluate(model_->graph, store.node);
    return values;
  }

  // `derivative` is row-major over the columns of x.
  void expectJacobian(const std::vector<ir::NodeId> &nodes, const std::vector<double> &derivative, Point point, const char *what) {
    ASSERT_EQ(derivative.size(), nodes.size() * columns_.size()) << what;
    const double h = 1e-6;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      double &variable = point(columns_[c].kind, columns_[c].index);
      const double value = variable;
      variable = value + h;
      const std::vector<double> above = point.evaluate(model_->graph, nodes);
      variable = value - h;
      const std::vector<double> below = point.evaluate(model_->graph, nodes);
      variable = value;
      for (std::size_t r = 0; r < nodes.size(); ++r)
        EXPECT_NEAR(derivative[r * columns_.size() + c], (above[r] - below[r]) / (2 * h),
                    2e-8 * (1 + std::abs(derivative[r * columns_.size() + c])))
            << what << " row " << r << " column " << c;
    }
  }

  DerivedModel model_{kEverything};
  std::vector<ir::Function> functions_;
  std::vector<ir::Symbol> columns_;
};

TEST_F(FunctionsTest, AreCompleteAndWellFormed) {
  EXPECT_TRUE(functions_[Kinematics].name.empty());
  for (const ir::Function &function : functions_) {
    if (function.name.empty())
      continue;
    EXPECT_EQ(ir::verify(function, model_->graph), "") << function.name;
    std::vector<int> stored(function.bufferSizes.size(), 0);
    for (const ir::Store &store : function.stores)
      ++stored[static_cast<std::size_t>(store.buffer)];
    EXPECT_EQ(stored, function.bufferSizes) << function.name;
  }
  const int nx = 3 + 3 + 2 + 1 + 1;
  EXPECT_EQ(functions_[Dynamics].bufferSizes, (std::vector<int>{9, 3, 2}));
  EXPECT_EQ(functions_[Switching].bufferSizes, (std::vector<int>{3, 3, 2, static_cast<int>(model_->switches.size())}));
  EXPECT_EQ(functions_[ContactTerms].bufferSizes, (std::vector<int>{9, 3, 6, 2, 3, 2}));
  EXPECT_EQ(functions_[ContactTerms].groups, 4);
  EXPECT_EQ(functions_[DynamicsDerivatives].bufferSizes, (std::vector<int>{3 * nx, 2 * nx, 3 * nx, 2 * nx, 3 * nx, 2 * nx, 0}));
  EXPECT_EQ(functions_[Energies].bufferSizes, (std::vector<int>{1, 1, 1}));
  EXPECT_EQ(functions_[ContactDynamics].bufferSizes, (std::vector<int>{9, 3, 2, 9, 3, 6, 2, 3, 2}));
  EXPECT_EQ(functions_[ContactDynamics].groups, 4);
}

TEST_F(FunctionsTest, RowsBelongToTheGroupOfTheirContact) {
  // Tangential rows: of the contact `tip` (group 0), then of the friction element (group 3 after three contacts).
  for (const ir::Store &store : functions_[ContactTerms].stores) {
    if (store.buffer == 0) {
      EXPECT_EQ(store.group, store.position / 3);
    }
    if (store.buffer == 3) {
      EXPECT_EQ(store.group, store.position == 0 ? 0 : 3);
    }
  }
  for (const ir::Store &store : functions_[DynamicsDerivatives].stores)
    if (store.buffer < 2) {
      EXPECT_EQ(store.group, -1);
    }
}

TEST_F(FunctionsTest, StartsAndBindings) {
  const Point point(*model_, 1);
  EXPECT_EQ(buffer(functions_[Starts], 0, point), (std::vector<double>{1, 4, 0}));
  EXPECT_EQ(buffer(functions_[Starts], 1, point), (std::vector<double>{0, -1, 0}));
  EXPECT_EQ(buffer(functions_[Starts], 2, point), (std::vector<double>{0.5, 1}));
  EXPECT_EQ(buffer(functions_[Starts], 3, point), (std::vector<double>{0.25}));
  EXPECT_EQ(buffer(functions_[Bindings], 0, point), (std::vector<double>{1.5, 0.2, 2, 4}));
}

TEST_F(FunctionsTest, DerivativesOfTheDynamics) {
  for (unsigned seed = 1; seed < 4; ++seed) {
    Point point(*model_, seed, 0.1, 1);
    point(Parameter, 3) = 4;
    const ir::Function &function = functions_[DynamicsDerivatives];
    expectJacobian(model_->residual, buffer(function, 0, point), point, "residual");
    expectJacobian(model_->stateDerivatives, buffer(function, 1, point), point, "z'");
    std::vector<ir::NodeId> normal, tangent, friction, bound(model_->tangents.size(), model_->graph.constant(0));
    const auto acceleration = [&](const std::vector<ir::NodeId> &row, ir::NodeId sum) {
      for (std::size_t k = 0; k < row.size(); ++k)
        sum = model_->graph.add(sum, model_->graph.mul(row[k], model_->graph.symbol(Acceleration, static_cast<int>(k))));
      return sum;
    };
    for (const Contact &contact : model_->contacts) {
      normal.push_back(acceleration(contact.normal, contact.bias));
      friction.push_back(contact.friction);
    }
    for (const TangentRow &row : model_->tangents)
      tangent.push_back(acceleration(row.jacobian, row.bias));
    bound[1] = model_->frictions[0].bound;
    expectJacobian(normal, buffer(function, 2, point), point, "gap''");
    expectJacobian(tangent, buffer(function, 3, point), point, "slip'");
    expectJacobian(friction, buffer(function, 4, point), point, "mu");
    expectJacobian(bound, buffer(function, 5, point), point, "bound");
  }
}

TEST_F(FunctionsTest, DerivativesOfSwitches) {
  Point point(*model_, 5, 0.1, 1);
  std::vector<ir::NodeId> conditions;
  for (const SwitchingFunction &switching : model_->switches)
    conditions.push_back(switching.condition);
  expectJacobian(conditions, buffer(functions_[SwitchGradients], 0, point), point, "c");
}

TEST_F(FunctionsTest, DerivativesWithRespectToStepVariables) {
  Point point(*model_, 6, 0.1, 1);
  point(Parameter, 3) = 4;
  const std::size_t ns = model_->switches.size();
  const std::vector<double> force = buffer(functions_[StepDerivatives], 0, point), state = buffer(functions_[StepDerivatives], 1, point);
  for (std::size_t j = 0; j < ns; ++j) {
    double &alpha = point(StepVariable, static_cast<int>(j));
    const double value = alpha;
    const auto at = [&](double a) {
      alpha = a;
      return std::pair{point.evaluate(model_->graph, model_->force), point.evaluate(model_->graph, model_->stateDerivatives)};
    };
    const auto [forceAbove, stateAbove] = at(value + 1e-6);
    const auto [forceBelow, stateBelow] = at(value - 1e-6);
    alpha = value;
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(force[k * ns + j], (forceAbove[k] - forceBelow[k]) / 2e-6, 1e-8);
    for (std::size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(state[k * ns + j], (stateAbove[k] - stateBelow[k]) / 2e-6, 1e-8);
  }
}

// Rates and biases along the motion: gap' and gap'' are derivatives of the gap for q(t) = q + v t + a t²/2.
TEST_F(FunctionsTest, RatesAlongTheMotion) {
  Point point(*model_, 8);
  const double h = 1e-4;
  const auto along = [&](ir::NodeId node, double t) {
    Point moved = point;
    for (int k = 0; k < model_->nq; ++k) {
      moved(Coordinate, k) += t * point(Velocity, k) + t * t / 2 * point(Acceleration, k);
      moved(Velocity, k) += t * point(Acceleration, k);
    }
    moved(Time) += t;
    return moved.evaluate(model_->graph, node);
  };
  const auto second = [&](const std::vector<ir::NodeId> &row, ir::NodeId bias) {
    double sum = point.evaluate(model_->graph, bias);
    for (std::size_t k = 0; k < row.size(); ++k)
      sum += point.evaluate(model_->graph, row[k]) * point(Acceleration, static_cast<int>(k));
    return sum;
  };
  for (const Contact &contact : model_->contacts) {
    const double above = along(contact.gap, h), here = along(contact.gap, 0), below = along(contact.gap, -h);
    EXPECT_NEAR(point.evaluate(model_->graph, contact.gapRate), (above - below) / (2 * h), 1e-6);
    EXPECT_NEAR(second(contact.normal, contact.bias), (above - 2 * here + below) / (h * h), 1e-5);
  }
  for (const TangentRow &row : model_->tangents)
    EXPECT_NEAR(second(row.jacobian, row.bias), (along(row.slip, h) - along(row.slip, -h)) / (2 * h), 1e-6);
}

}  // namespace
}  // namespace tf::test
