// The reference trajectories of tests/accuracy/reference over their whole grids and at their events, by every integrator.
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>
#include <vector>

namespace tf::test {
namespace {

struct Reference {
  const char *name, *file;
  std::vector<const char *> columns, variables;
  double bound;
};

const Reference kRod{
    "S06a_rod", "falling_rod.tf", {"x", "y", "th", "vx", "vy", "om"}, {"r[1]", "r[2]", "phi", "der(r[1])", "der(r[2])", "der(phi)"}, 1e-7};
const Reference kBox{
    "S07b_box", "falling_box.tf", {"x", "y", "th", "vx", "vy", "om"}, {"r[1]", "r[2]", "phi", "der(r[1])", "der(r[2])", "der(phi)"}, 1e-7};
const Reference kChain{
    "S15_chain3",
    "chain.tf",
    {"x0", "y0", "th0", "th1", "th2", "vx0", "vy0", "w0", "w1", "w2"},
    {"r[1]", "r[2]", "phi[1]", "phi[2]", "phi[3]", "der(r[1])", "der(r[2])", "der(phi[1])", "der(phi[2])", "der(phi[3])"},
    1e-6};

const Reference kSlider{"S11_slidercrank_e0",
                        "slider_crank.tf",
                        {"th1", "th2", "th3", "w1", "w2", "w3"},
                        {"phi[1]", "phi[2]", "phi[3]", "der(phi[1])", "der(phi[2])", "der(phi[3])"},
                        1e-6};

struct TrajectoryCase {
  const Reference *reference;
  tf_integrator integrator;
  const char *integratorName;
};

std::ostream &operator<<(std::ostream &out, const TrajectoryCase &c) { return out << c.reference->name << " by " << c.integratorName; }

class ReferenceTrajectory : public testing::TestWithParam<TrajectoryCase> {};

std::string path(const Reference &reference, const char *suffix) {
  return std::string(TF_SOURCE_DIR "/tests/accuracy/reference/") + reference.name + suffix;
}

TEST_P(ReferenceTrajectory, MatchesOnTheWholeGrid) {
  const Reference &reference = *GetParam().reference;
  const CsvTable grid(path(reference, ".csv"));
  CompiledModel model(example(reference.file));
  model.tolerance(1e-9).integrator(GetParam().integrator).initialise();
  double worst = 0;
  std::string where;
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    const double time = grid["t"][row];
    model.advance(time);
    for (std::size_t i = 0; i < reference.columns.size(); ++i) {
      const double expected = grid[reference.columns[i]][row];
      const double error = std::abs(model[reference.variables[i]] - expected) / std::max(1.0, std::abs(expected));
      if (!(error <= worst)) {
        worst = error;
        where = std::string(reference.variables[i]) + " at t = " + std::to_string(time);
      }
    }
  }
  EXPECT_LE(worst, reference.bound) << where;
}

TEST_P(ReferenceTrajectory, EveryEventIsFoundAtItsTime) {
  const Reference &reference = *GetParam().reference;
  const CsvTable events(path(reference, "_events.csv"));
  CompiledModel model(example(reference.file));
  model.tolerance(1e-9).integrator(GetParam().integrator).run(model.model().stop_time);
  for (std::size_t row = 1; row < events.rows(); ++row) {
    const double expected = events["t"][row];
    double nearest = INFINITY;
    for (const Event &event : model.events()) {
      nearest = std::min(nearest, std::abs(event.time - expected));
    }
    EXPECT_LE(nearest, reference.bound) << "event at t = " << expected;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ReferenceTrajectory,
                         testing::Values(TrajectoryCase{&kRod, TF_AUTO, "auto"}, TrajectoryCase{&kRod, TF_STEP, "step"},
                                         TrajectoryCase{&kRod, TF_EXPLICIT, "explicit"}, TrajectoryCase{&kRod, TF_CVODE, "cvode"},
                                         TrajectoryCase{&kBox, TF_AUTO, "auto"}, TrajectoryCase{&kBox, TF_STEP, "step"},
                                         TrajectoryCase{&kBox, TF_EXPLICIT, "explicit"}, TrajectoryCase{&kBox, TF_CVODE, "cvode"},
                                         TrajectoryCase{&kChain, TF_AUTO, "auto"}, TrajectoryCase{&kChain, TF_STEP, "step"},
                                         TrajectoryCase{&kChain, TF_EXPLICIT, "explicit"}, TrajectoryCase{&kChain, TF_CVODE, "cvode"},
                                         TrajectoryCase{&kSlider, TF_AUTO, "auto"}, TrajectoryCase{&kSlider, TF_STEP, "step"},
                                         TrajectoryCase{&kSlider, TF_EXPLICIT, "explicit"}, TrajectoryCase{&kSlider, TF_CVODE, "cvode"}),
                         [](const testing::TestParamInfo<TrajectoryCase> &testCase) {
                           return std::string(testCase.param.reference->name) + "_" + testCase.param.integratorName;
                         });

}  // namespace
}  // namespace tf::test
