// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulator_table.h"

#include <fmt/format.h>

#include "c3de/core/first_size.h"
#include "c3de/core/plugin_table.h"

namespace c3de::scene {

Expected<const c3de_simulator_v1 *> simulatorTable(c3de_object *simulator) {
  const auto found = queryTable<c3de_simulator_v1>(simulator, C3DE_IFACE_SIMULATOR_ID);
  if (!found) return found;
  const c3de_simulator_v1 *table = *found;
  // Optional entries are within the required size, too.
  if (const std::string problem = sizeProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, fmt::format("the table of {}: {}", C3DE_IFACE_SIMULATOR_ID, problem));
  // These three functions belong together.
  const bool holds = table->hold != nullptr;
  if ((table->pull != nullptr) != holds || (table->hold_state != nullptr) != holds)
    return fail(
        ErrorCode::plugin,
        fmt::format("hold(), pull() and hold_state() in the table of {} are only partly set; accepted: all or none",
                    C3DE_IFACE_SIMULATOR_ID));
  if ((table->save_state == nullptr) != (table->load_state == nullptr))
    return fail(ErrorCode::plugin, fmt::format("of save_state() and load_state() in the table of {} one is null; "
                                               "accepted: both or none",
                                               C3DE_IFACE_SIMULATOR_ID));
  return table;
}

}  // namespace c3de::scene
