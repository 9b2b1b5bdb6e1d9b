// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <utility>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/progress.h"

namespace c3de::session {

/// The progress of one of several items built one after the other, as a share of all of them; also across the C
/// boundary.
class PartProgress {
 public:
  /// @param all   overall progress, of which this is item `index` of `count`; may be empty, outlives this
  /// @param name  of the item
  PartProgress(const ProgressFn &all, std::string name, std::size_t index, std::size_t count);
  PartProgress(const PartProgress &) = delete;
  PartProgress &operator=(const PartProgress &) = delete;

  /// @param fraction  of this item; below 0: unknown, counts as 0
  /// @returns  false: stop, the user has cancelled
  bool update(double fraction, const std::string &text) const;
  /// To be passed to a plugin.
  [[nodiscard]] const c3de_progress *abi() const { return &abi_; }

  /// Calls a function of a plugin's table. It is not reported as hanging while it reports progress.
  /// @param owner, what  as for PluginCall
  template <class F>
  c3de_status call(const char *owner, const char *what, F &&f) {
    return callPluginFunction(owner, what, CallKind::job, [&](const PluginCall &recorded) {
      call_ = &recorded;
      struct AtEnd {
        PartProgress &part;
        ~AtEnd() { part.call_ = nullptr; }
      } const atEnd{*this};
      return f();
    });
  }

 private:
  const ProgressFn &all_;
  std::string name_;
  double index_, count_;
  std::atomic<const PluginCall *> call_{nullptr};
  c3de_progress abi_{};
};

}  // namespace c3de::session
