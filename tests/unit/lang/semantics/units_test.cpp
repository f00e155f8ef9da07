#include "lang/semantics/units.h"

#include <gtest/gtest.h>

namespace tf::semantics {
namespace {

Unit unit(const char *text) {
  const std::optional<Unit> parsed = parseUnit(text);
  EXPECT_TRUE(parsed.has_value()) << text;
  return parsed.value_or(Unit{});
}

TEST(Units, derivedUnitsAreProductsOfBaseUnits) {
  EXPECT_TRUE(unit("N").isSame(unit("kg.m/s2")));
  EXPECT_TRUE(unit("J").isSame(unit("N.m")));
  EXPECT_TRUE(unit("W").isSame(unit("V.A")));
  EXPECT_TRUE(unit("Ohm").isSame(unit("V/A")));
  EXPECT_TRUE(unit("Wb").isSame(unit("V.s")));
  EXPECT_TRUE(unit("H").isSame(unit("Wb/A")));
  EXPECT_TRUE(unit("F").isSame(unit("C/V")));
  EXPECT_TRUE(unit("1").isSame(unit("rad")));
  EXPECT_TRUE(unit("m/(s.K)").isSame(unit("m.s-1.K-1")));
}

TEST(Units, prefixesAndScalesDistinguish) {
  EXPECT_FALSE(unit("mm").isSame(unit("m")));
  EXPECT_NEAR(unit("km/h").scale, 1000.0 / 3600.0, 1e-15);
  EXPECT_NEAR(unit("MPa").scale, 1e6, 1e-6);
  EXPECT_FALSE(unit("degC").isSame(unit("K")));
  EXPECT_FALSE(unit("deg").isSame(unit("rad")));
  // `min` is a minute, not a milli-inch; `cd` a candela, not a centi-day; `T` alone is tesla.
  EXPECT_EQ(unit("min").scale, 60);
  EXPECT_EQ(unit("cd").exponents[6], 1);
  EXPECT_TRUE(unit("T").isSame(unit("Wb/m2")));
}

TEST(Units, malformedTextIsRefused) {
  for (const char *text : {"", "kgs", "m/", "m..s", "(m", "m/s/kg", "m2 s", "blorp", "/s"})
    EXPECT_FALSE(parseUnit(text).has_value()) << text;
}

TEST(Units, textInBaseUnits) {
  EXPECT_EQ(toString(unit("N")), "kg.m/s2");
  EXPECT_EQ(toString(unit("W/(m2.K)")), "kg/(s3.K)");
  EXPECT_EQ(toString(unit("1")), "1");
  EXPECT_EQ(toString(power(unit("m"), 2)), "m2");
}

}  // namespace
}  // namespace tf::semantics
