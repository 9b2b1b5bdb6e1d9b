// SPDX-License-Identifier: Apache-2.0
#include "simulator/checkpoints.h"

#include <algorithm>
#include <utility>

namespace pointbased {

void Checkpoints::store(ChangeAccess, std::uint64_t &number) {
  // Those of an earlier history can no longer be restored.
  if (const std::uint64_t now = world_.simulator.archive().historyEpoch(); std::exchange(epoch_, now) != now)
    stored_.clear();
  if (number == 0) number = lastNumber_ + 1;
  lastNumber_ = std::max(lastNumber_, number);
  stored_.insert_or_assign(number, grasps_.checkpoint());
}

bool Checkpoints::exchange(ChangeAccess access, std::uint64_t number) {
  const auto found = stored_.find(number);
  return found != stored_.end() && grasps_.exchange(access, found->second);
}

}  // namespace pointbased
