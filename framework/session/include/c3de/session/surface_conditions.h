// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/abi/iface/conditions.h"
#include "c3de/core/expected.h"

namespace c3de::session {

/// Null: the simulator sets no supports and loads while it runs. Errors (plugin): its table is malformed.
[[nodiscard]] Expected<const c3de_conditions_v0 *> conditionsTable(c3de_object *simulator);

}  // namespace c3de::session
