// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "c3de/abi/base.h"

namespace c3de::sdk {

/// A handle with the table it came from; let go of in the destructor through Remove, a slot of the table.
template <class Table, auto Remove>
class Owned {
 public:
  Owned() noexcept = default;
  Owned(const Table *table, c3de_handle handle) noexcept : table_(table), handle_(handle) {}
  Owned(Owned &&other) noexcept : table_(other.table_), handle_(other.release()) {}
  Owned &operator=(Owned &&other) noexcept {
    if (this != &other) {
      reset();
      table_ = other.table_;
      handle_ = other.release();
    }
    return *this;
  }
  ~Owned() { reset(); }

  [[nodiscard]] c3de_handle handle() const noexcept { return handle_; }
  [[nodiscard]] const Table *table() const noexcept { return table_; }
  explicit operator bool() const noexcept { return handle_.v != 0; }
  /// The caller takes care of it from now on.
  c3de_handle release() noexcept { return std::exchange(handle_, c3de_handle{0}); }
  void reset() noexcept {
    if (table_ && handle_.v != 0) (void)(table_->*Remove)(table_->ctx, release());
  }

 private:
  const Table *table_ = nullptr;
  c3de_handle handle_{0};
};

}  // namespace c3de::sdk
