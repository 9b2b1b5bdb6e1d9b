// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace c3de {

/// Memory for arrays that are lent to code from outside: whoever runs on beyond its end is stopped there by the system,
/// and named (crash_journal.h), before anything of the program is overwritten.
class GuardedMemory {
 public:
  GuardedMemory() = default;
  /// Zeros. Throws std::bad_alloc.
  explicit GuardedMemory(std::size_t bytes);
  GuardedMemory(GuardedMemory &&other) noexcept;
  GuardedMemory &operator=(GuardedMemory &&other) noexcept;
  ~GuardedMemory();

  [[nodiscard]] unsigned char *data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }  ///< at least what was asked for, whole pages

 private:
  static constexpr std::size_t kGuard = std::size_t{1} << 20;  ///< that cannot be accessed, before and behind; bytes

  unsigned char *data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace c3de
