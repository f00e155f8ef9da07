// A slip that changes its sign because its derivative by the velocities does, as that of a crosshead where the crank is in line with its
// rod. No force changes the acceleration of such a slip there; the forces of all other rows are what they were.
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

// A block on a floor, lifted by 10 N/s from t = 2 s on, has no part in the motion of a crank with friction on its crosshead.
TEST(DeadCentre, LeavesOtherContactsAlone) {
  const std::string file = sourceFile("crank_and_block.tf", R"(
model CrankAndBlock
  parameter Real T = 3, mu = 0.01;
  coordinate Real p(start = 1, der(start = -1)), z;
  body crank(angle = p, inertia = 1);
  body block(mass = 1, position = {z, 0});
  force torque(value = -T, at = p);
  force lift(value = 10*(time - 2), at = z);
  contact floor(gap = z);
  friction guide(slip = der(cos(p)), bound = mu);
end CrankAndBlock;
)");
  const std::vector<Settings> cases = {{}, {{"mu", 0}}, {{"T", 0}}, {{"T", 0}, {"mu", 0}}, {{"T", -0.2}, {"mu", 0.5}}};
  for (const Settings &settings : cases)
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-6, 1e-9}) {
        CompiledModel model(file, settings);
        // Worst values are those of all steps then.
        ASSERT_EQ(tf_set_energy_balance(model.simulation(), 1), TF_OK);
        ASSERT_NO_THROW(model.tolerance(tolerance).integrator(integrator).run(3)) << integrator << ", tolerance " << tolerance;
        ASSERT_EQ(model.count(TF_EVENT_OPENING), 1) << integrator << ", tolerance " << tolerance;
        EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), 2, tolerance) << integrator;
        EXPECT_NEAR(model["z"], 10.0 / 6, 10 * tolerance) << integrator;
        EXPECT_EQ(model.count(TF_EVENT_IMPACT), 0) << integrator;
        EXPECT_GT(tf_get_statistics(model.simulation())->worst_normal_force, -100 * tolerance);
      }
}

// A sprung mass on a pusher that the crank drives: with friction whose bound is zero it flies as without it.
TEST(DeadCentre, OfThePusherThatCarriesAMass) {
  const auto source = [](const std::string &friction) {
    return R"(
model Pusher
  parameter Real l = 0.2, m = 0.07, k = 8765, x0 = 0.194, c = 10, T = 3, p0 = 0.04, w0 = -54;
  coordinate Real p(start = p0, der(start = w0)), w(start = l*cos(p0), der(start = -l*sin(p0)*w0));
  Real x = l*cos(p);
  body crank(angle = p, inertia = 0.002);
  body mass(mass = m, position = {w, 0});
  potential s(energy = 0.5*k*(w - x0)^2);
  force d(value = -c*der(w), at = w);
  force torque(value = -T, at = p);
  contact work(gap = w - x);
)" + friction +
           "end Pusher;\n";
  };
  const std::string with = sourceFile("pusher_with_friction.tf", source("  friction guide(slip = der(x), bound = 0);\n"));
  const std::string without = sourceFile("pusher.tf", source(""));
  CompiledModel reference(without);
  reference.tolerance(1e-11).run(0.005);
  EXPECT_NEAR(reference.eventTime(TF_EVENT_OPENING), 0.00157450994, 1e-10);
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(with);
    model.tolerance(1e-9).integrator(integrator).run(0.005);
    ASSERT_EQ(model.count(TF_EVENT_OPENING), 1) << integrator;
    EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), reference.eventTime(TF_EVENT_OPENING), 1e-9) << integrator;
    EXPECT_NEAR(model["w"], reference["w"], 1e-9) << integrator;
  }
}

}  // namespace
}  // namespace tf::test
