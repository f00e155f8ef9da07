#include "runtime/integrate/row_system.h"

#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tf::runtime {
namespace {

TEST(RowSystem, RowsThatAreNoMoreExertNoForces) {
  const tf_model &model = test::boxModel();
  const ModelInstance instance(model);
  const InputSignals inputs(model.nu);
  ModelEvaluation at(model, inputs);
  ASSERT_TRUE(at.setParameters(instance.parameters().data()));
  at.setSegment(0.5);
  const std::vector<double> state = {0, 0.3, 0, 0.7, 0, 0, 0}, forces = {1, 2, 3, 4};
  at.setPoint(0, state.data());
  ASSERT_TRUE(at.dynamics());
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(model.nc) + model.nf, 1);
  at.contactTerms(all.data());
  RowSystem rows;
  ContactProblem problem;
  problem.resize(2, 2);
  rows.choose(model, {0, 1}, {0, 1}, problem);
  rows.assemble(at, problem.delassus, problem);
  std::vector<double> acceleration(model.nv, 0.0);
  rows.accelerate(forces.data(), acceleration.data());
  EXPECT_TRUE(std::any_of(acceleration.begin(), acceleration.end(), [](double a) { return a != 0; }));
  problem.resize(0, 0);
  rows.choose(model, {}, {}, problem);
  const std::vector<double> before = acceleration;
  rows.accelerate(forces.data(), acceleration.data());
  EXPECT_EQ(acceleration, before);
}

}  // namespace
}  // namespace tf::runtime
