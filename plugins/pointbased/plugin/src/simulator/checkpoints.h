// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "simulator/grasps.h"

namespace pointbased {

/// States before interactions, by number, for undo. The mutex of the world is held.
class Checkpoints {
 public:
  Checkpoints(SimulatedWorld &world, Grasps &grasps) : world_(world), grasps_(grasps) {}

  /// @param number  0: the next one is assigned
  void store(ChangeAccess access, std::uint64_t &number);
  /// Restores the stored state, and stores the present one in its place. False, with nothing changed, if there is none,
  /// or the simulation has been restarted since.
  bool exchange(ChangeAccess access, std::uint64_t number);
  /// False if there is none.
  bool drop(ChangeAccess, std::uint64_t number) { return stored_.erase(number) > 0; }

 private:
  SimulatedWorld &world_;
  Grasps &grasps_;
  std::map<std::uint64_t, InteractionState> stored_;
  std::uint64_t lastNumber_ = 0, epoch_ = 0;  // epoch_: of the stored states
};

}  // namespace pointbased
