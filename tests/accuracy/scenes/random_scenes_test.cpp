// A part of the random scenes: all of them run by ./dev scenes.
#include "tests/accuracy/scenes/random_scenes.h"

#include <gtest/gtest.h>

namespace tf::test {
namespace {

TEST(RandomScenes, RunToTheEndWithInvariantsHeld) {
  int withoutContinuation = 0;
  constexpr int count = 200;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const Scene scene = randomScene(seed);
    const SceneOutcome outcome = runScene(scene);
    if (outcome.kind == SceneOutcome::Kind::NoContinuation)
      ++withoutContinuation;
    else
      EXPECT_EQ(outcome.kind, SceneOutcome::Kind::Good) << "seed " << seed << " (" << scene.name << "): " << outcome.text;
  }
  EXPECT_LE(withoutContinuation, count / 200);
}

}  // namespace
}  // namespace tf::test
