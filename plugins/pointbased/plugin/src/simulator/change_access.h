// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace pointbased {

/// Argument of every function that changes the simulation. Only Changes creates it, while it holds the mutex of the
/// world: no panel, tool or call can make a change that is not reported.
class ChangeAccess {
  friend class Changes;
  ChangeAccess() = default;
};

}  // namespace pointbased
