#include "runtime/contact/coupled_contacts.h"

#include "runtime/contact/coupling.h"

namespace tf::runtime {

void CoupledContacts::find(const DenseMatrix &delassus, const ContactRows &rows) {
  count_ = rows.normalCount;
  coupled_.assign(static_cast<std::size_t>(count_) * count_, 0);
  const auto contactOf = [&rows](int r) { return r < rows.normalCount ? r : rows.owner[r - rows.normalCount]; };
  for (int c = 0; c < rows.count(); ++c)
    for (int r = 0; r < rows.count(); ++r)
      if (const int a = contactOf(r), b = contactOf(c); a >= 0 && b >= 0 && delassus(r, c) != 0)
        coupled_[static_cast<std::size_t>(a) * count_ + b] = 1;
}

void CoupledContacts::keepReached(std::vector<int> &contacts, std::span<const int> starters) {
  isReached_.assign(count_, 0);
  reached_.assign(starters.begin(), starters.end());
  for (const int i : starters)
    isReached_[i] = 1;
  addCoupled(reached_, isReached_, contacts, [this](int a, int b) { return coupled_[static_cast<std::size_t>(a) * count_ + b] != 0; });
  std::erase_if(contacts, [this](int i) { return !isReached_[i]; });
}

}  // namespace tf::runtime
