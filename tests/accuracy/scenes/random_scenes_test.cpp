// A part of the random scenes that ./dev scenes runs: those in the plane, and spheres and boxes in space.
#include "tests/accuracy/scenes/random_scenes.h"

#include <gtest/gtest.h>

#include <initializer_list>

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

void expectGood(std::initializer_list<std::uint64_t> seeds) {
  for (const std::uint64_t seed : seeds) {
    const Scene scene = randomScene(seed);
    const SceneOutcome outcome = runScene(scene);
    EXPECT_EQ(outcome.kind, SceneOutcome::Kind::Good) << "seed " << seed << " (" << scene.name << "): " << outcome.text;
  }
}

TEST(RandomScenes, InThePlaneRunToTheEndWithInvariantsHeld) { expectGood(200, isPlanar); }

TEST(RandomScenes, OfSpheresRunToTheEndWithInvariantsHeld) {
  expectGood(40, [](const Scene &scene) { return !isPlanar(scene) && !hasBoxes(scene); });
}

TEST(RandomScenes, OfBoxesInSpaceRunToTheEndWithInvariantsHeld) { expectGood(40, hasBoxes); }

// The slips of corners that have closed at different instants agree with a motion of the face although their gaps differ by rounding.
TEST(RandomScenes, WhereCornersOfOneFaceStopTogether) { expectGood({2820, 3484, 4020, 6368, 8036, 9152, 9544, 15328}); }

// The contact problem has no solution because of two contacts, of which one cannot start the impulse.
TEST(RandomScenes, WhereTwoContactsTogetherNeedAFrictionalImpulse) { expectGood({3884, 11732, 17460}); }

// In space the response of a contact to its own force reaches zero by a turn of its slip.
TEST(RandomScenes, WhereTurningSlipsJam) { expectGood({7420, 16376, 26728, 45844}); }

// A slip turns on its way to zero by more within one step than the step with a held direction leaves.
TEST(RandomScenes, WhereATurningSlipEndsInsideALongStep) { expectGood({16456, 154828, 185096, 189252}); }

// A slip restarts within an impact, hardly faster than it would stick.
TEST(RandomScenes, WhereASlipRestartsSlowly) { expectGood({69448, 73572, 121648}); }

// The slip of a third corner is all but zero where two of a face stick, by rounding errors that no friction can take from it.
TEST(RandomScenes, WhereTheSlipOfARedundantCornerIsARoundingError) { expectGood({138276}); }

// A corner slides on as slowly as the tolerance allows, about a rest that explicit steps do not see.
TEST(RandomScenes, WhereASlowSlipComesToRest) { expectGood({14268}); }

// The least forces of redundant corners that stick are outside their cones, others of the same motion are not.
TEST(RandomScenes, WhereRedundantCornersStickWhileAnotherSlipTurns) { expectGood({46844}); }

// A step over what is nearly zero is as long as the whole impact of a corner beside it.
TEST(RandomScenes, WhereACornerBouncesBesideOneThatHardlyMoves) { expectGood({11576}); }

TEST(RandomScenes, WhereOnlyFrictionHoldsTwoSpheres) { expectGood({45984}); }

// A gap that is within its tolerance of zero goes on falling while the slip of another contact turns.
TEST(RandomScenes, WhereACornerBouncesLowBesideOneThatTurns) { expectGood({7728}); }

TEST(RandomScenes, WhereAStepThatEndsAtAnEventHasNoSolution) { expectGood({3144, 8068, 9720, 16072}); }

// The force that a corner sticks with is beyond its limit by a part of 1e-5 of the forces: its slip starts as slowly.
TEST(RandomScenes, WhereASlipHardlyStartsInAnImpact) { expectGood({172800}); }

// Friction turns by a right angle where a slip comes as near to zero as rounding, and takes it round again and again.
TEST(RandomScenes, WhereASlipCirclesAboutZeroInAnImpact) { expectGood({206396}); }

// A step in which a slow slip turns round moves what contacts hold far: it ends before that, at the stop.
TEST(RandomScenes, WhereASlipStopsInAStepThatIsMuchTooLong) { expectGood({179508}); }

}  // namespace
}  // namespace tf::test
