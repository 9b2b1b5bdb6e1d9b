// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "c3de/abi/iface/changes.h"
#include "simulator/change_kinds.h"

namespace pointbased {

/// iface.changes: the only part that changes a simulation. Panels, tools and other plugins change it by make(). Each
/// change is reported in the order in which the changes were applied. Errors are thrown as sdk::Error; nothing has
/// changed then and nothing is reported.
class Changes {
 public:
  using Changed = void(C3DE_CALL *)(void *observer, const c3de_sim_change *change);

  explicit Changes(SimulatorParts &parts) : parts_(parts) {}

  void observe(void *observer, Changed changed);
  void apply(const c3de_sim_change *change);

  /// Any thread; what does not have prepare() is made between two steps [sim].
  /// @return the change with its results
  template <class Kind>
  Kind make(Kind change, const sdk::Progress &progress = sdk::Progress(nullptr)) {
    AnyChange any(std::move(change));
    execute(any, progress);
    return std::get<Kind>(std::move(any));
  }

 private:
  void execute(AnyChange &change, const sdk::Progress &progress);
  void report(AnyChange &change, std::uint64_t steps, bool isReset);

  SimulatorParts &parts_;
  /// Lasting changes without a key so far. A key contains it: what is set before such a change may affect it, and is
  /// not made superfluous by what is set after it.
  std::uint64_t unkeyed_ = 0;
  std::mutex observerMutex_;  // locked after that of the world
  void *observer_ = nullptr;
  Changed changed_ = nullptr;
};

}  // namespace pointbased
