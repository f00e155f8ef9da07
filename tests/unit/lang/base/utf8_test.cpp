#include "lang/base/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace tf {
namespace {

TEST(Utf8, DecodesSequencesOfEachLength) {
  EXPECT_EQ(decode("a").value, 0x61U);
  EXPECT_EQ(decode("\xC3\xA9").value, 0xE9U);
  EXPECT_EQ(decode("\xE2\x82\xAC").value, 0x20ACU);
  EXPECT_EQ(decode("\xF0\x9F\x98\x80").value, 0x1F600U);
  EXPECT_EQ(decode("\xF0\x9F\x98\x80").length, 4U);
}

TEST(Utf8, RefusesWhatRfc3629Refuses) {
  for (const char *text : {"\x80", "\xC0\x80", "\xC3", "\xC3(", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xF8\x88\x80\x80"})
    EXPECT_EQ(decode(text).length, 0U) << text;
}

TEST(Utf8, FindsTheFirstInvalidByte) {
  const std::string valid = "an ASCII prefix longer than a word, \xC3\xA9, \xE2\x82\xAC";
  EXPECT_EQ(findInvalid(valid), valid.size());
  EXPECT_EQ(findInvalid(valid + "\xFF more"), valid.size());
  EXPECT_EQ(findInvalid(valid + "\xFF more", valid.size() + 1), valid.size() + 6);
  EXPECT_EQ(findInvalid(""), 0U);
}

}  // namespace
}  // namespace tf
