// Which contacts an impact reaches: forces of a contact accelerate those with which it shares entries of D, bodies that touch neither move
// on as if nothing had happened.
#pragma once

#include "runtime/contact/contact_problem.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tf::runtime {

class CoupledContacts {
public:
  // Contacts are coupled where an entry of D (n + m) × (n + m) between rows of theirs differs from zero; friction elements couple nothing.
  void find(const DenseMatrix &delassus, const ContactRows &rows);
  // Of `contacts` (normal rows) those that impulses of `starters`, which are some of them, reach, from one to the next, in their order.
  void keepReached(std::vector<int> &contacts, std::span<const int> starters);

private:
  int count_ = 0;
  std::vector<std::uint8_t> coupled_;    // count × count
  std::vector<std::uint8_t> isReached_;  // count
  std::vector<int> reached_;
};

}  // namespace tf::runtime
