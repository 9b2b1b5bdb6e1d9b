// SPDX-License-Identifier: Apache-2.0
// Base of the wrappers of services: a value over a table that may be absent.
#pragma once

#include <string>

#include "c3de/sdk/host.hpp"

namespace c3de::sdk {

/// Base of the wrappers.
template <class Table>
class Service {
 public:
  Service() noexcept = default;
  explicit Service(Host host, std::uint32_t minRev = 1) noexcept : host_(host), table_(host.service<Table>(minRev)) {}
  explicit operator bool() const noexcept { return table_ != nullptr; }
  [[nodiscard]] const Table *table() const noexcept { return table_; }
  [[nodiscard]] Host host() const noexcept { return host_; }

 protected:
  /// Calls a slot; the failure carries the host's text.
  template <auto Slot, class... Args>
  [[nodiscard]] Result<void> call(Args... args) const {
    if (!table_) return absent();
    return host_.check((table_->*Slot)(table_->ctx, args...));
  }
  /// The same for a slot whose last argument is a handle to be owned.
  template <auto Slot, class Owner, class... Args>
  [[nodiscard]] Result<Owner> own(Args... args) const {
    c3de_handle handle{0};
    if (auto done = call<Slot>(args..., &handle); !done) return done.failure();
    return Owner(table_, handle);
  }
  [[nodiscard]] Failure absent() const {
    return {C3DE_E_UNSUPPORTED, std::string(kTableId<Table>) + " is not served in this run"};
  }

  Host host_;
  const Table *table_ = nullptr;
};

}  // namespace c3de::sdk
