// Flags of many elements, a byte each, of which few are set: read eight at a time.
#pragma once

#include <cstdint>
#include <cstring>

namespace tf::runtime {

// visit(i) for each byte [count] that is not `ordinary`, ascending. The flags may be changed on the way, but not those that come later.
template <class Byte, class Visit> void forEachOther(const Byte *bytes, int count, Byte ordinary, Visit visit) {
  static_assert(sizeof(Byte) == 1);
  constexpr int width = sizeof(std::uint64_t);
  std::uint64_t allOrdinary = 0, word = 0;
  std::memset(&allOrdinary, static_cast<std::uint8_t>(ordinary), width);
  int i = 0;
  for (; i + width <= count; i += width) {
    std::memcpy(&word, bytes + i, width);
    for (int k = i; word != allOrdinary && k < i + width; ++k)
      if (bytes[k] != ordinary)
        visit(k);
  }
  for (; i < count; ++i)
    if (bytes[i] != ordinary)
      visit(i);
}

// As well, of flags that are set or zero.
template <class Visit> void forEachSet(const std::uint8_t *flags, int count, Visit visit) {
  forEachOther(flags, count, std::uint8_t{0}, visit);
}

}  // namespace tf::runtime
