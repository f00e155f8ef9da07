#include "runtime/integrate/contact_scales.h"

#include "tests/unit/runtime/model_tables.h"

#include <gtest/gtest.h>

#include <array>

namespace {

using namespace tf::runtime;
using namespace tf::runtime::test;

// A height and an angle, a contact with a slip and one without.
struct Corner {
  ModelTables tables{"Corner", ""};

  Corner(double length, double speed, double turning) {
    tables.variable({"y", TF_KIND_COORDINATE, 0, 0, "m", "", -infinity, infinity, length});
    tables.variable({"phi", TF_KIND_COORDINATE, 1});
    tables.variable({"der(y)", TF_KIND_VELOCITY, 0, 0, "m/s", "", -infinity, infinity, speed});
    tables.variable({"der(phi)", TF_KIND_VELOCITY, 1, 0, "rad/s", "", -infinity, infinity, turning});
    tables.model().nq = tables.model().nv = 2;
    tables.contact("corner", 1);
    tables.contact("stop", 0);
    tables.finish();
    tables.model().nq = tables.model().nv = 2;
  }
};

TEST(ContactScales, AreWhatNominalsMoveAGapBy) {
  Corner corner(1e-6, 1e-3, 1e3);
  ContactScales scales(corner.tables.model());
  const std::array normal = {1.0, 3e-6, 0.0, 2e-7}, flat = {1.0, 0.0, 0.0, 1e-7};
  const std::array tangent = {0.0, 4e-6};
  scales.start();
  for (const auto &rows : {flat, normal})
    scales.include(rows.data(), tangent.data(), nullptr);
  scales.finish();
  const std::array<double, 2> zero = {}, far = {1.0, 0.0};
  EXPECT_DOUBLE_EQ(scales.gap(0, zero.data()), 3e-6);
  EXPECT_DOUBLE_EQ(scales.gap(1, zero.data()), 2e-7);
  // Where the height is a metre, a gap is not known better.
  EXPECT_GT(1e-12 * scales.gap(0, far.data()), 2e-16);
  EXPECT_DOUBLE_EQ(scales.gap(1, far.data()), 2e-7);
  for (const auto &q : {zero, far})
    for (const int contact : {0, 1})
      EXPECT_EQ(scales.gap(contact, q.data(), scales.farthest(q.data())), scales.gap(contact, q.data()));
}

TEST(ContactScales, FastVelocitiesCountAsFarAsTheyMoveTheRow) {
  Corner corner(1e-6, 1e-3, 1);
  ContactScales scales(corner.tables.model());
  const std::array normal = {1.0, 1e-6, 0.0, 1e-6};
  const std::array tangent = {0.0, 0.0};
  scales.start();
  scales.include(normal.data(), tangent.data(), nullptr);
  scales.finish();
  const std::array<double, 2> rest = {}, turning = {0.0, 4e3};
  EXPECT_DOUBLE_EQ(scales.gapRate(0, rest.data(), 1), 1e-3);
  // 4 mm/s and the nominal speed, not 4 m/s, nor 4000 times the nominal speed.
  EXPECT_DOUBLE_EQ(scales.gapRate(0, turning.data(), 1), 5e-3);
  EXPECT_DOUBLE_EQ(scales.gapRate(1, turning.data(), 1), 4e-3);
  // No velocity moves this row: the largest nominal one stands for it.
  EXPECT_DOUBLE_EQ(scales.slip(0, rest.data()), 1);
}

}  // namespace
