// What is coupled to something, directly or over others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tf::runtime {

// Adds to `reached` those of `candidates` that are coupled to one of its members, from one to the next, and marks them in `isReached`,
// where the members are marked already. `isCoupled(a, b)`: b is reached from a.
template <class Candidates, class IsCoupled>
void addCoupled(std::vector<int> &reached, std::vector<std::uint8_t> &isReached, const Candidates &candidates, IsCoupled isCoupled) {
  for (std::size_t k = 0; k < reached.size(); ++k)
    for (const int i : candidates)
      if (!isReached[i] && isCoupled(reached[k], i)) {
        isReached[i] = 1;
        reached.push_back(i);
      }
}

}  // namespace tf::runtime
