// Bump allocation for syntax nodes, and lists that grow on a shared stack before they are copied into the arena.
#pragma once

#include "lang/syntax/ast.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

namespace tf::ast {

class Arena {
public:
  // Uninitialised memory; it lives as long as the arena.
  void *allocate(std::size_t size, std::size_t alignment) {
    const std::size_t begin = (used_ + alignment - 1) & ~(alignment - 1);
    if (begin + size > capacity_)
      return grow(size);
    used_ = begin + size;
    return block_ + begin;
  }

  template <class T> T *make() {
    static_assert(std::is_trivially_destructible_v<T>);
    return new (allocate(sizeof(T), alignof(T))) T();
  }

private:
  void *grow(std::size_t size) {
    capacity_ = std::max(size, std::min<std::size_t>(std::max<std::size_t>(2 * capacity_, smallestBlock), largestBlock));
    blocks_.push_back(std::make_unique_for_overwrite<std::byte[]>(capacity_));
    block_ = blocks_.back().get();
    used_ = size;
    return block_;
  }

  static constexpr std::size_t smallestBlock = 16 * 1024;
  static constexpr std::size_t largestBlock = 1024 * 1024;

  std::vector<std::unique_ptr<std::byte[]>> blocks_;
  std::byte *block_ = nullptr;
  std::size_t used_ = 0, capacity_ = 0;
};

// Elements of a list under construction lie on top of a stack that all lists of their type share, so that building allocates nothing in
// the steady state; lists of one type must end in the reverse order of their start.
template <class T> class ListBuilder {
public:
  explicit ListBuilder(std::vector<T> &stack) : stack_(stack), base_(stack.size()) {}
  ~ListBuilder() { stack_.resize(base_); }
  ListBuilder(const ListBuilder &) = delete;
  ListBuilder &operator=(const ListBuilder &) = delete;

  void push(const T &element) {
    assert(stack_.size() == base_ + count_ && "another list of this type is being built on top");
    stack_.push_back(element);
    ++count_;
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] T &back() { return stack_.back(); }

  [[nodiscard]] List<T> finish(Arena &arena) const {
    static_assert(std::is_trivially_copyable_v<T>);
    if (empty())
      return {};
    // NOLINTNEXTLINE(bugprone-sizeof-expression): T may be a pointer
    T *data = static_cast<T *>(arena.allocate(size() * sizeof(T), alignof(T)));
    std::uninitialized_copy_n(stack_.begin() + static_cast<std::ptrdiff_t>(base_), count_, data);
    return {data, static_cast<std::uint32_t>(size())};
  }

private:
  std::vector<T> &stack_;
  std::size_t base_;
  std::size_t count_ = 0;
};

}  // namespace tf::ast
