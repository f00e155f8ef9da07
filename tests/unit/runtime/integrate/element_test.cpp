// One-step methods on smooth modes of compiled models: order, Jacobians, projection.
#include "runtime/integrate/bogacki_shampine.h"
#include "runtime/integrate/dormand_prince.h"
#include "runtime/integrate/dormand_prince_8.h"
#include "runtime/integrate/element_integrator.h"
#include "runtime/integrate/radau.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <cmath>
#include <gtest/gtest.h>
#include <memory>

namespace tf::runtime {
namespace {

// A model in a given mode.
class InMode {
public:
  InMode(const tf_model &model, Mode mode, const std::vector<double> &state)
      : instance_(model), inputs_(model.nu), at(model, inputs_), dynamics(at), state_(state) {
    EXPECT_TRUE(at.setParameters(instance_.parameters().data()));
    at.setSegment(0.5);
    EXPECT_TRUE(dynamics.start(mode, 0, state_.data()));
  }

private:
  ModelInstance instance_;
  InputSignals inputs_;

public:
  ModelEvaluation at;
  ModeDynamics dynamics;

private:
  std::vector<double> state_;
};

// The belt's mass in slip: x'' = -4 x + 1 with x(0) = 0, x'(0) = -0.1.
double oscillatorError(std::unique_ptr<ElementMethod> (*make)(int), double step) {
  InMode belt(test::beltModel(), {{}, {Tangent::SlipNegative}, {}}, {0, -0.1, 0});
  IntegratorSettings settings;
  settings.fixedStep = step;
  settings.scale.assign(3, 1.0);
  ElementIntegrator integrator(belt.dynamics, settings, make(3));
  double state[] = {0, -0.1, 0}, rate[3];
  EXPECT_TRUE(belt.dynamics.evaluate(0, state, rate));
  integrator.start(0, state, rate, 0);
  for (int k = 1; integrator.endTime() < 1 - 1e-9; ++k)
    EXPECT_EQ(integrator.step(std::min(1.0, k * step)), StepStatus::Done);
  return std::hypot(integrator.end()[0] - (0.25 - 0.25 * std::cos(2.0) - 0.05 * std::sin(2.0)),
                    integrator.end()[1] - (0.5 * std::sin(2.0) - 0.1 * std::cos(2.0)));
}

template <int stages> std::unique_ptr<ElementMethod> radau(int size) { return std::make_unique<Radau>(size, stages); }
std::unique_ptr<ElementMethod> bogackiShampine(int size) { return std::make_unique<BogackiShampine>(size); }
std::unique_ptr<ElementMethod> dormandPrince(int size) { return std::make_unique<DormandPrince>(size); }
std::unique_ptr<ElementMethod> dormandPrince8(int size) { return std::make_unique<DormandPrince8>(size, 1); }

double observedOrder(std::unique_ptr<ElementMethod> (*make)(int), double step) {
  return std::log2(oscillatorError(make, step) / oscillatorError(make, step / 2));
}

TEST(Radau, HasOrderTwoStagesMinusOne) {
  EXPECT_NEAR(observedOrder(radau<1>, 0.0125), 1, 0.1);
  EXPECT_NEAR(observedOrder(radau<2>, 0.05), 3, 0.2);
  EXPECT_NEAR(observedOrder(radau<3>, 0.25), 5, 0.3);
  EXPECT_NEAR(observedOrder(radau<4>, 0.5), 7, 0.4);
}

TEST(BogackiShampineTest, HasOrderThree) { EXPECT_NEAR(observedOrder(bogackiShampine, 0.02), 3, 0.2); }

TEST(DormandPrinceTest, HasOrderFive) { EXPECT_NEAR(observedOrder(dormandPrince, 0.1), 5, 0.3); }

TEST(DormandPrince8Test, HasOrderEight) { EXPECT_NEAR(observedOrder(dormandPrince8, 0.5), 8, 0.7); }

// One step over [0, h]: the error of the continuous extension.
template <class Method, class... Tolerance> double extensionError(double step, Tolerance... tolerance) {
  InMode belt(test::beltModel(), {{}, {Tangent::SlipNegative}, {}}, {0, -0.1, 0});
  Method method(3, tolerance...);
  const double state[] = {0, -0.1, 0}, scale[] = {1, 1, 1};
  double rate[3], inside[3], worst = 0;
  EXPECT_TRUE(belt.dynamics.evaluate(0, state, rate));
  EXPECT_TRUE(method.solve(belt.dynamics, 0, state, rate, step, scale, 0));
  for (const double theta : {0.15, 0.4, 0.65, 0.9}) {
    method.interpolate(theta, inside);
    const double t = theta * step;
    worst = std::max(worst, std::abs(inside[0] - (0.25 - 0.25 * std::cos(2 * t) - 0.05 * std::sin(2 * t))));
  }
  return worst;
}

template <class Method, class... Tolerance> double extensionOrder(double step, Tolerance... tolerance) {
  return std::log2(extensionError<Method>(step, tolerance...) / extensionError<Method>(step / 2, tolerance...)) - 1;
}

TEST(BogackiShampineTest, HasAContinuousExtensionOfOrderThree) { EXPECT_NEAR(extensionOrder<BogackiShampine>(0.04), 3, 0.3); }

TEST(DormandPrince8Test, HasAContinuousExtensionOfOrderSeven) { EXPECT_NEAR(extensionOrder<DormandPrince8>(0.8, 1.0), 7, 0.7); }

// What the estimate is of: the solution of order 2, off by h³.
TEST(BogackiShampineTest, EstimatesAnErrorOfOrderTwo) {
  InMode belt(test::beltModel(), {{}, {Tangent::SlipNegative}, {}}, {0, -0.1, 0});
  const double state[] = {0, -0.1, 0}, scale[] = {1, 1, 1};
  double rate[3];
  ASSERT_TRUE(belt.dynamics.evaluate(0, state, rate));
  const auto estimate = [&](double step) {
    BogackiShampine method(3);
    EXPECT_TRUE(method.solve(belt.dynamics, 0, state, rate, step, scale, 0));
    return method.errorNorm(scale, 1);
  };
  EXPECT_NEAR(std::log2(estimate(0.04) / estimate(0.02)), 3, 0.2);
}

// The box slides on its lower left corner: q = (x, y, th), v, tau.
InMode slidingBox(std::vector<double> &state) {
  const double th = 0.3;
  state = {0.1, 0.5 * std::sin(th) + 0.3 * std::cos(th), th, 0.7, 0, 0.4, 0};
  state[4] = -0.4 * (-0.5 * std::cos(th) + 0.3 * std::sin(th));
  Mode mode;
  mode.closed = {1, 0, 0, 0};
  mode.tangent = {Tangent::SlipPositive, Tangent::None, Tangent::None, Tangent::None};
  return InMode(test::boxModel(), mode, state);
}

TEST(ModeDynamicsTest, JacobianAgreesWithDifferences) {
  std::vector<double> state;
  InMode box = slidingBox(state);
  const int n = box.dynamics.size();
  std::vector<double> rate(n), plus(n), minus(n), jacobian(static_cast<std::size_t>(n) * n);
  ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), rate.data()));
  ASSERT_TRUE(box.dynamics.jacobian(0, state.data(), jacobian.data()));
  for (int k = 0; k < n - 1; ++k) {
    const double step = 1e-6, value = state[k];
    state[k] = value + step;
    ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), plus.data()));
    state[k] = value - step;
    ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), minus.data()));
    state[k] = value;
    for (int i = 0; i < n - 1; ++i)
      EXPECT_NEAR(jacobian[k * n + i], (plus[i] - minus[i]) / (2 * step), 1e-6) << i << ", " << k;
  }
}

TEST(ModeDynamicsTest, ClosedContactNeitherPullsNorMoves) {
  std::vector<double> state;
  InMode box = slidingBox(state);
  std::vector<double> rate(box.dynamics.size());
  ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), rate.data()));
  EXPECT_GT(box.at.normalForce[0], 0);
  EXPECT_NEAR(box.at.tangentForce[0], -0.2 * box.at.normalForce[0], 1e-12);
  EXPECT_NEAR(rate.back(), 1 + box.at.normalForce[0] / box.at.rate[0], 1e-12);
}

TEST(ModeDynamicsTest, ProjectionReturnsToTheContact) {
  std::vector<double> state;
  InMode box = slidingBox(state);
  std::vector<double> rate(box.dynamics.size());
  const std::vector<double> scale(state.size(), 1.0);
  state[1] += 1e-7;
  state[4] -= 1e-7;
  ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), rate.data()));
  EXPECT_GT(box.dynamics.project(0, state.data(), scale.data()), 1e-8);
  box.at.setPoint(0, state.data());
  box.at.switching();
  EXPECT_NEAR(box.at.gap[0], 0, 1e-13);
  EXPECT_NEAR(box.at.gapRate[0], 0, 1e-13);
}

TEST(ModeDynamicsTest, ResidualIsWhatProjectionRemoves) {
  std::vector<double> state;
  InMode box = slidingBox(state);
  std::vector<double> rate(box.dynamics.size());
  const std::vector<double> scale(state.size(), 1.0);
  const auto residual = [&](const std::vector<double> &at) { return box.dynamics.heldResidual(0, at.data()); };
  EXPECT_LE(residual(state), 1e-14);
  // Along the slip nothing is held.
  std::vector<double> moved = state;
  moved[0] += 0.1;
  moved[3] += 0.1;
  EXPECT_LE(residual(moved), 1e-14);
  const double gapScale = box.at.scales.gap(0, state.data()), rateScale = box.at.scales.gapRate(0, state.data() + 3);
  moved[1] += 3e-7;
  EXPECT_NEAR(residual(moved), 3e-7 / gapScale, 1e-12);
  moved[4] -= 5e-6;
  EXPECT_NEAR(residual(moved), std::max(3e-7 / gapScale, 5e-6 / rateScale), 1e-9);
  for (int pass = 0; pass < 2; ++pass) {
    ASSERT_TRUE(box.dynamics.evaluate(0, moved.data(), rate.data()));
    box.dynamics.project(0, moved.data(), scale.data());
  }
  EXPECT_LE(residual(moved), 1e-14);
  moved[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(residual(moved)));
}

}  // namespace
}  // namespace tf::runtime
