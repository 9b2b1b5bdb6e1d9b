// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/surface_conditions.h"

#include <array>
#include <cstddef>

#include "c3de/core/plugin_table.h"
#include "c3de/session/simulator_access.h"

namespace c3de {

template <>
struct TableSlots<c3de_conditions_v0> {
  using Table = c3de_conditions_v0;
  static constexpr const char *name = C3DE_IFACE_CONDITIONS_ID;
  static constexpr std::array slots = {TableSlot{"set", offsetof(Table, set), 1},
                                       TableSlot{"remove", offsetof(Table, remove), 1},
                                       TableSlot{"state", offsetof(Table, state), 1}};
};

}  // namespace c3de

namespace c3de::session {

Expected<const c3de_conditions_v0 *> conditionsTable(c3de_object *simulator) {
  const auto found = queryObject(simulator, C3DE_IFACE_CONDITIONS_ID, 1);
  if (!found) return nullptr;
  const auto *table = static_cast<const c3de_conditions_v0 *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the simulator's table of " + std::move(problem));
  return table;
}

}  // namespace c3de::session
