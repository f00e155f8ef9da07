#include "tests/unit/runtime/derivative_check.h"
#include "tests/unit/runtime/hand_written_models.h"

#include "runtime/model/loaded_model.h"
#include "runtime/model/model_instance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace tf::runtime::test {

namespace {

class HandWrittenModel : public testing::TestWithParam<const tf_model *> {};

std::vector<double> parametersOf(const tf_model &model) {
  const ModelInstance instance(model);
  return {instance.parameters().begin(), instance.parameters().end()};
}

TEST_P(HandWrittenModel, KeepsTheContract) {
  const auto checked = checkModel(*GetParam());
  EXPECT_TRUE(checked.ok()) << checked.error();
}

TEST_P(HandWrittenModel, HasTheDerivativesOfItsFunctions) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed)
    EXPECT_THAT(checkDerivatives(*GetParam(), randomPoint(*GetParam(), parametersOf(*GetParam()), seed), 1e-9), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(All, HandWrittenModel,
                         testing::Values(&particleModel(), &particle3dModel(), &beltModel(), &relayModel(), &rodModel(), &boxModel()),
                         [](const auto &parameter) { return std::string(parameter.param->name); });

// The check itself must notice a wrong entry.
TEST(DerivativeCheck, NoticesAWrongSign) {
  tf_model wrong = rodModel();
  wrong.dynamics_derivatives = [](const double *const *in, double *const *out, const std::uint8_t *mask) {
    rodModel().dynamics_derivatives(in, out, mask);
    out[2][2] = -out[2][2];
  };
  EXPECT_THAT(checkDerivatives(wrong, randomPoint(wrong, parametersOf(wrong), 1), 1e-9), testing::Not(testing::IsEmpty()));
}

TEST(HandWrittenRod, StartsAsTheReferenceDoes) {
  const Starts starts = ModelInstance(rodModel()).starts(0);
  EXPECT_NEAR(starts.q[1], 0.85355339059327373, 1e-15);
  EXPECT_EQ(starts.v, (std::vector<double>{2, 0, 0}));
}

}  // namespace

}  // namespace tf::runtime::test
