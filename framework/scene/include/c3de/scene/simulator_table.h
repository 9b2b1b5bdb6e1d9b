// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"

namespace c3de::scene {

/// The simulator's table, with every slot of revision 1 within its size and none of those null that may not be. The error
/// (ErrorCode::plugin) says what the object lacks. Any thread.
[[nodiscard]] Expected<const c3de_simulator_v1 *> simulatorTable(c3de_object *simulator);

}  // namespace c3de::scene
