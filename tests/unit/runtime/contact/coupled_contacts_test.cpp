#include "runtime/contact/coupled_contacts.h"

#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

using Contacts = std::vector<int>;

// D of contacts with a row for friction each (normal rows 0 … n − 1, then theirs) and one friction element, all uncoupled.
class CoupledContactsTest : public ::testing::Test {
protected:
  static constexpr int n = 5;
  ContactRows rows;
  DenseMatrix delassus{2 * n + 1, 2 * n + 1};
  CoupledContacts coupled;

  void SetUp() override {
    rows.resize(n, n + 1);
    for (int i = 0; i < n; ++i)
      rows.owner[i] = i;
    for (int r = 0; r < rows.count(); ++r)
      delassus(r, r) = 1;
  }
  void couple(int r, int c) { delassus(r, c) = delassus(c, r) = -1e-20; }
  Contacts reached(Contacts contacts, const Contacts &starters) {
    coupled.find(delassus, rows);
    coupled.keepReached(contacts, starters);
    return contacts;
  }
};

TEST_F(CoupledContactsTest, AContactThatSharesNoBodyIsNotReached) {
  EXPECT_EQ(reached({0, 1, 2, 3, 4}, {2}), Contacts{2});
  EXPECT_EQ(reached({0, 1, 2, 3, 4}, {3, 1}), (Contacts{1, 3}));
}

TEST_F(CoupledContactsTest, ImpulsesGoOnFromContactToContactThroughAnyRow) {
  couple(0, 2);          // normal rows
  couple(n + 2, 4);      // friction of one and the other's normal row
  couple(n + 1, n + 3);  // frictions
  EXPECT_EQ(reached({0, 1, 2, 3, 4}, {0}), (Contacts{0, 2, 4}));
  EXPECT_EQ(reached({0, 1, 2, 3, 4}, {4}), (Contacts{0, 2, 4}));
  EXPECT_EQ(reached({0, 1, 2, 3, 4}, {3}), (Contacts{1, 3}));
}

TEST_F(CoupledContactsTest, AnOpenContactPassesNothingOn) {
  couple(0, 2);
  couple(2, 4);
  EXPECT_EQ(reached({0, 1, 4}, {0}), Contacts{0});
}

TEST_F(CoupledContactsTest, FrictionElementsCarryNoImpulse) {
  rows.owner[n] = -1;
  couple(0, 2 * n);
  couple(1, 2 * n);
  EXPECT_EQ(reached({0, 1}, {0}), Contacts{0});
}

}  // namespace
}  // namespace tf::runtime
