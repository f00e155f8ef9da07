#include "runtime/integrate/byte_flags.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

namespace tf::runtime {
namespace {

enum class Side : std::int8_t { Left = -1, None = 2 };

// Every place of a word, before, in and behind it, and two at once.
TEST(ByteFlags, FindsTheOnesThatAreSet) {
  for (int count = 0; count <= 20; ++count)
    for (int first = 0; first < count; ++first)
      for (int second = first; second < count; ++second) {
        std::vector<std::uint8_t> flags(count, 0);
        flags[first] = 1;
        flags[second] = 255;
        std::vector<int> found;
        forEachSet(flags.data(), count, [&found](int i) { found.push_back(i); });
        EXPECT_EQ(found, first == second ? std::vector{first} : (std::vector{first, second})) << count;
      }
}

TEST(ByteFlags, FindsWhatIsNotOrdinary) {
  std::vector<Side> sides(19, Side::None);
  sides[0] = sides[9] = sides[18] = Side::Left;
  std::vector<int> found;
  forEachOther(sides.data(), 19, Side::None, [&found](int i) { found.push_back(i); });
  EXPECT_EQ(found, (std::vector{0, 9, 18}));
}

// No byte behind the last one is read as a flag.
TEST(ByteFlags, EndsWithTheCount) {
  const std::vector<std::uint8_t> flags(16, 1);
  int visits = 0;
  forEachSet(flags.data(), 11, [&visits](int /*i*/) { ++visits; });
  EXPECT_EQ(visits, 11);
}

}  // namespace
}  // namespace tf::runtime
