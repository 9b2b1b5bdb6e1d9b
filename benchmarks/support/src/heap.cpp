// SPDX-License-Identifier: Apache-2.0
// Operators new and delete that count: each block carries its size in front.
#include "bench/heap.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> &total() {
  static std::atomic<std::size_t> bytes{0};
  return bytes;
}

constexpr std::size_t kFront = alignof(std::max_align_t) > sizeof(std::size_t) ? alignof(std::max_align_t) : sizeof(std::size_t);

void *take(std::size_t size) {
  void *block = std::malloc(size + kFront);
  if (!block) return nullptr;
  *static_cast<std::size_t *>(block) = size;
  total().fetch_add(size, std::memory_order_relaxed);
  return static_cast<char *>(block) + kFront;
}

void give(void *pointer) {
  if (!pointer) return;
  void *block = static_cast<char *>(pointer) - kFront;
  total().fetch_sub(*static_cast<std::size_t *>(block), std::memory_order_relaxed);
  std::free(block);
}

}  // namespace

namespace bench {

std::size_t heapBytes() { return total().load(); }

}  // namespace bench

void *operator new(std::size_t size) {
  if (void *pointer = take(size)) return pointer;
  throw std::bad_alloc();
}
void *operator new[](std::size_t size) { return operator new(size); }
void *operator new(std::size_t size, const std::nothrow_t &) noexcept { return take(size); }
void *operator new[](std::size_t size, const std::nothrow_t &) noexcept { return take(size); }
void operator delete(void *pointer) noexcept { give(pointer); }
void operator delete[](void *pointer) noexcept { give(pointer); }
void operator delete(void *pointer, std::size_t) noexcept { give(pointer); }
void operator delete[](void *pointer, std::size_t) noexcept { give(pointer); }
void operator delete(void *pointer, const std::nothrow_t &) noexcept { give(pointer); }
void operator delete[](void *pointer, const std::nothrow_t &) noexcept { give(pointer); }
