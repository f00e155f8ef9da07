// A part of the random scenes that ./dev scenes runs: those in the plane, and spheres and boxes in space.
#include "tests/accuracy/scenes/random_scenes.h"

#include <gtest/gtest.h>

namespace tf::test {
namespace {

// Of `count` scenes that are `wanted`, at most one in two hundred may have no consistent continuation.
void expectGood(int count, bool (*wanted)(const Scene &)) {
  int withoutContinuation = 0, run = 0;
  for (std::uint64_t seed = 1; run < count; ++seed) {
    const Scene scene = randomScene(seed);
    if (!wanted(scene))
      continue;
    ++run;
    const SceneOutcome outcome = runScene(scene);
    if (outcome.kind == SceneOutcome::Kind::NoContinuation)
      ++withoutContinuation;
    else
      EXPECT_EQ(outcome.kind, SceneOutcome::Kind::Good) << "seed " << seed << " (" << scene.name << "): " << outcome.text;
  }
  EXPECT_LE(withoutContinuation, count / 200);
}

TEST(RandomScenes, InThePlaneRunToTheEndWithInvariantsHeld) { expectGood(200, isPlanar); }

TEST(RandomScenes, OfSpheresRunToTheEndWithInvariantsHeld) {
  expectGood(40, [](const Scene &scene) { return !isPlanar(scene) && !hasBoxes(scene); });
}

TEST(RandomScenes, OfBoxesInSpaceRunToTheEndWithInvariantsHeld) { expectGood(40, hasBoxes); }

}  // namespace
}  // namespace tf::test
