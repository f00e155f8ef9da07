// The mass matrix of oblique coordinates is constant, but not diagonal: a rod that falls, slides and tips over moves as in those of its
// own.
#include "tests/accuracy/each_integrator.h"
#include "tests/accuracy/support/compiled_model.h"

#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

std::string rod(const std::string &name, const std::string &start, const std::string &x, const std::string &y) {
  return sourceFile(name + ".tf", "model Rod\n  coordinate Real a(start = " + start +
                                      ", der(start = 1)), b(start = 0.8), phi(start = 0.9);\n  Real x = " + x + ", y = " + y + R"(;
  body rod(mass = 2, position = {x, y}, angle = phi, inertia = 0.2);
  gravity weight(acceleration = {0, -9.81});
  contact tip[2](gap = {y - 0.5*sin(phi), y + 0.5*sin(phi)}, slip = {der(x) + 0.5*sin(phi)*der(phi), der(x) - 0.5*sin(phi)*der(phi)},
                 each friction = 0.2, each restitution = 0.4);
end Rod;
)");
}

TEST(ObliqueCoordinates, GiveTheSameMotion) {
  const std::string own = rod("rod", "0", "a", "b"), oblique = rod("oblique_rod", "-0.4", "a + b/2", "b + phi/4 - 0.225");
  CompiledModel reference(own);
  reference.tolerance(1e-11).run(0.7);
  ASSERT_GT(reference.count(TF_EVENT_IMPACT), 2);
  withEachIntegrator(oblique, 1e-9, 0.7, [&](CompiledModel &model) {
    EXPECT_EQ(model.count(TF_EVENT_CLOSING), reference.count(TF_EVENT_CLOSING));
    for (const char *variable : {"x", "y", "phi", "der(phi)"})
      EXPECT_NEAR(model[variable], reference[variable], 1e-7) << variable;
  });
}

}  // namespace
}  // namespace tf::test
