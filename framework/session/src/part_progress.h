// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <string>
#include <utility>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/foreign_call.h"
#include "c3de/core/progress.h"

namespace c3de::session {

/// The progress of one of several things that are made one after the other, as a share of all of them; through the C
/// boundary as well.
class PartProgress {
 public:
  /// @param all   of which this is number `index` of `count`; may be empty, outlives this
  /// @param name  what is made
  PartProgress(const ProgressFn &all, std::string name, std::size_t index, std::size_t count);
  PartProgress(const PartProgress &) = delete;
  PartProgress &operator=(const PartProgress &) = delete;

  /// @param fraction  of this one; below 0: unknown, counts as 0
  /// @returns  false: stop, the person has cancelled
  bool update(double fraction, const std::string &text) const;
  /// For a call of a plugin.
  [[nodiscard]] const c3de_progress *abi() const { return &abi_; }

  /// Calls a function of a plugin's table; it is not taken for one that hangs while it says that it goes on.
  /// @param owner, what  as of ForeignCall
  template <class F>
  c3de_status call(const char *owner, const char *what, F &&f) {
    return callForeign(owner, what, CallKind::job, [&](const ForeignCall &recorded) {
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
  std::atomic<const ForeignCall *> call_{nullptr};
  c3de_progress abi_{};
};

}  // namespace c3de::session
