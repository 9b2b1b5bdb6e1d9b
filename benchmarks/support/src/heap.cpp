// SPDX-License-Identifier: Apache-2.0
// Counting operators new and delete, aligned ones included: each block stores its size in front.
#include "bench/heap.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> &total() {
  static std::atomic<std::size_t> bytes{0};
  return bytes;
}

// Header in front of each allocated block.
struct Front {
  void *block;
  std::size_t size;
};

void *take(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) {
  void *block = std::malloc(size + sizeof(Front) + alignment);
  if (!block) return nullptr;
  const auto first = reinterpret_cast<std::uintptr_t>(block) + sizeof(Front);
  const std::uintptr_t aligned = (first + alignment - 1) / alignment * alignment;
  *reinterpret_cast<Front *>(aligned - sizeof(Front)) = {block, size};
  total().fetch_add(size, std::memory_order_relaxed);
  return reinterpret_cast<void *>(aligned);
}

void give(void *pointer) {
  if (!pointer) return;
  const Front front = *reinterpret_cast<Front *>(reinterpret_cast<std::uintptr_t>(pointer) - sizeof(Front));
  total().fetch_sub(front.size, std::memory_order_relaxed);
  std::free(front.block);
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

void *operator new(std::size_t size, std::align_val_t alignment) {
  if (void *pointer = take(size, static_cast<std::size_t>(alignment))) return pointer;
  throw std::bad_alloc();
}
void *operator new[](std::size_t size, std::align_val_t alignment) { return operator new(size, alignment); }
void operator delete(void *pointer, std::align_val_t) noexcept { give(pointer); }
void operator delete[](void *pointer, std::align_val_t) noexcept { give(pointer); }
void operator delete(void *pointer, std::size_t, std::align_val_t) noexcept { give(pointer); }
void operator delete[](void *pointer, std::size_t, std::align_val_t) noexcept { give(pointer); }
