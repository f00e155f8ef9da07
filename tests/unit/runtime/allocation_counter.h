// Counts what a test program allocates. It replaces operator new and delete, so that one source of a program includes it.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace tf::runtime::test {

inline std::atomic<long> allocations{0};

}  // namespace tf::runtime::test

// Not inlined: GCC would see the memory of one function given back by another's part.
[[gnu::noinline]] void *operator new(std::size_t size) {
  ++tf::runtime::test::allocations;
  if (void *memory = std::malloc(size > 0 ? size : 1))
    return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void *memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }
