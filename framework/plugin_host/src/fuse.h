// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "plugin_context.h"

namespace c3de::plugin_host {

/// Switches a callback off that fails again and again, so that it does not fill the log at every frame. People are told
/// once, with the choice to switch it on again. Main thread.
class Fuse : public std::enable_shared_from_this<Fuse> {
 public:
  static constexpr int kMostFailures = 3;  ///< one after the other

  /// @param name  of what is switched, for people: "panel 'Hello'"
  Fuse(PluginContext &plugin, std::string name) : plugin_(plugin), name_(std::move(name)) {}

  /// Calls the plugin, unless it is off: f returns a status. False: it was not called, or failed.
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
