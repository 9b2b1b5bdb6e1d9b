// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace c3de {

/// Memory for arrays lent to plugins. An access beyond its ends is stopped by the system, and attributed to its code
/// (crash_journal.h), before memory of the program is overwritten.
class GuardedMemory {
 public:
  GuardedMemory() = default;
  /// Zero-initialised. Throws std::bad_alloc.
  explicit GuardedMemory(std::size_t bytes);
  GuardedMemory(GuardedMemory &&other) noexcept;
  GuardedMemory &operator=(GuardedMemory &&other) noexcept;
  ~GuardedMemory();

  [[nodiscard]] unsigned char *data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }  ///< at least the requested size, whole pages

 private:
  static constexpr std::size_t kGuard = std::size_t{1} << 20;  ///< inaccessible bytes before and after

  unsigned char *data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace c3de
