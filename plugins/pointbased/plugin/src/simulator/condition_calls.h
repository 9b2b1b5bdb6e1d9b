// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/conditions.h"
#include "simulator/changes.h"

namespace pointbased {

/// iface.conditions: the supports and loads of the load tool, for the host and other plugins.
class ConditionCalls {
 public:
  explicit ConditionCalls(SimulatorParts &parts) : parts_(parts) {}

  void set(const c3de_sim_condition *condition, std::uint64_t *number);
  void remove(std::uint64_t number);
  void state(std::uint64_t number, c3de_sim_condition_state *out, c3de_sink warning);

 private:
  [[nodiscard]] ConditionSnapshot existing(std::uint64_t number);

  SimulatorParts &parts_;
};

}  // namespace pointbased
