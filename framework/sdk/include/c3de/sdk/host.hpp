// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <string_view>

#include "c3de/abi/entry.h"
#include "c3de/sdk/ids.hpp"
#include "c3de/sdk/result.hpp"
#include "c3de/sdk/text.hpp"

namespace c3de::sdk {

/// What the plugin got at create; a value, cheap to copy, valid until destroy.
class Host {
 public:
  Host() noexcept = default;
  explicit Host(const c3de_host *host) noexcept : host_(host) {}

  explicit operator bool() const noexcept { return host_ != nullptr; }
  [[nodiscard]] const c3de_host *abi() const noexcept { return host_; }

  /// The table of a service, or null when it is unknown, too old or not served in this run. Any thread.
  template <class Table>
  [[nodiscard]] const Table *service(std::uint32_t minRev = 1) const noexcept {
    const void *table = nullptr;
    if (!host_ || host_->get_service(host_->ctx, str(kTableId<Table>), minRev, &table) < 0) {
      (void)takeError();
      return nullptr;
    }
    return static_cast<const Table *>(table);
  }

  /// As above, with the reason.
  template <class Table>
  [[nodiscard]] Result<const Table *> require(std::uint32_t minRev = 1) const {
    const void *table = nullptr;
    if (!host_) return Failure{C3DE_E_STATE, "no host"};
    const c3de_status status = host_->get_service(host_->ctx, str(kTableId<Table>), minRev, &table);
    if (status < 0) return failure(status);
    return static_cast<const Table *>(table);
  }

  /// Says why the call that is about to return an error failed.
  void setError(c3de_status status, std::string_view message) const noexcept {
    if (host_) host_->set_error(host_->ctx, status, str(message));
  }
  /// The same, with what the message is about; in front of it with a host of revision 1.
  void setErrorAt(c3de_status status, const std::string &message, const ErrorPlace &place) const {
    if (!host_) return;
    if (host_->rev < 2 || !C3DE_HAS(c3de_host, host_, set_error_at)) {
      const std::string table = place.table.empty() ? "" : place.table + " " + std::to_string(place.index) + ": ";
      return setError(status, table + (place.key.empty() ? "" : place.key + ": ") + message);
    }
    const c3de_error_place abi{sizeof(c3de_error_place), place.index, str(place.table), str(place.key)};
    host_->set_error_at(host_->ctx, status, str(message), &abi);
  }
  /// The callback that is running has failed as the error says that was set; false: the host does not take it.
  bool callbackFailed() const noexcept {
    if (!host_ || host_->rev < 3 || !C3DE_HAS(c3de_host, host_, callback_failed)) return false;
    host_->callback_failed(host_->ctx);
    return true;
  }
  /// The text that was left last on this thread; empty when there is none.
  [[nodiscard]] std::string takeError() const noexcept {
    TextSink text;
    if (host_) (void)host_->take_error(host_->ctx, text.sink());
    return text.take();
  }
  /// The failure of a call that returned `status`, with the text that was left.
  [[nodiscard]] Failure failure(c3de_status status) const {
    std::string message = takeError();
    if (message.empty()) message = "status " + std::to_string(status);
    return {status, std::move(message)};
  }
  /// Positive remarks count as done.
  [[nodiscard]] Result<void> check(c3de_status status) const {
    if (status < 0) return failure(status);
    return {};
  }

 private:
  const c3de_host *host_ = nullptr;
};

namespace detail {
/// The one static of the SDK: thunks of objects have nowhere else to leave their text. Each plugin binary has its own.
inline std::atomic<const c3de_host *> hostOfThisPlugin{nullptr};
}  // namespace detail

/// The host of this plugin binary, empty before create and after destroy.
[[nodiscard]] inline Host currentHost() noexcept { return Host(detail::hostOfThisPlugin.load()); }

}  // namespace c3de::sdk
