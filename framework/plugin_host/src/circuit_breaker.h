// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "plugin_context.h"

namespace c3de::plugin_host {

/// Switches off a callback that fails repeatedly, so that it does not fill the log in every frame. The user is informed
/// once and can switch it on again. Main thread.
class CircuitBreaker : public std::enable_shared_from_this<CircuitBreaker> {
 public:
  static constexpr int kMaxFailures = 3;  ///< in succession

  /// @param name  display name of the callback: "panel 'Hello'"
  CircuitBreaker(PluginContext &plugin, std::string name) : plugin_(plugin), name_(std::move(name)) {}

  /// Calls the plugin unless it is switched off; f returns a status. False: it was not called, or failed.
  /// @param what  a literal, for messages
  template <class F>
  bool call(const char *what, F &&f, CallKind kind = CallKind::prompt) {
    if (isOff_) return false;
    c3de_status status = C3DE_OK;
    const bool isDone = callPlugin(
        plugin_, what, [&] { status = f(); }, kind);
    if (isDone && status >= 0) {
      failures_ = 0;
      return true;
    }
    noteFailure(what, isDone, status);
    return false;
  }
  [[nodiscard]] bool isOff() const { return isOff_; }
  /// "panel 'Hello' is switched off, because …"
  [[nodiscard]] const std::string &reason() const { return reason_; }
  void switchOn();

 private:
  void noteFailure(const char *what, bool isDone, c3de_status status);

  PluginContext &plugin_;
  const std::string name_;
  std::atomic<int> failures_{0};
  std::atomic<bool> isOff_{false};
  std::string reason_;
};

}  // namespace c3de::plugin_host
