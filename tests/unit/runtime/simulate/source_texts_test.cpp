#include "runtime/simulate/source_texts.h"

#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <string>

namespace tf::runtime {
namespace {

TEST(SourceTexts, NameTheElementOfAnEvent) {
  const tf_model &box = test::boxModel(), &belt = test::beltModel(), &relay = test::relayModel();
  ASSERT_GT(box.nc, 1);
  EXPECT_EQ(elementText(box, 1), std::string("contact '") + box.contacts[1].name + "' " + sourceOf(box.contacts[1].location));
  ASSERT_GT(belt.nf, 0);
  EXPECT_EQ(elementText(belt, belt.nc),
            std::string("friction element '") + belt.frictions[0].name + "' " + sourceOf(belt.frictions[0].location));
  ASSERT_GT(relay.ns, 0);
  EXPECT_EQ(elementText(relay, relay.nc + relay.nf),
            std::string("switch '") + relay.switches[0].text + "' " + sourceOf(relay.switches[0].location));
}

}  // namespace
}  // namespace tf::runtime
