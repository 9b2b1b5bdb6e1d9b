// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"

namespace c3de::scene {

/// The simulator's table. Its size is checked to cover every entry of revision 1, and required entries are not null.
/// The error (ErrorCode::plugin) states what is missing. Any thread.
[[nodiscard]] Expected<const c3de_simulator_v1 *> simulatorTable(c3de_object *simulator);

}  // namespace c3de::scene
