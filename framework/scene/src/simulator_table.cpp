// SPDX-License-Identifier: Apache-2.0
#include "c3de/scene/simulator_table.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "c3de/core/text.h"

namespace c3de::scene {
namespace {

struct Slot {
  const char *name;
  std::size_t offset;
};

#define C3DE_SLOT(name) \
  Slot { #name, offsetof(c3de_simulator_v1, name) }
constexpr std::array kRequired{
    C3DE_SLOT(attach),       C3DE_SLOT(declarations), C3DE_SLOT(set_world),      C3DE_SLOT(add_body),
    C3DE_SLOT(add_obstacle), C3DE_SLOT(add_probe),    C3DE_SLOT(set_body_param), C3DE_SLOT(get_body_param),
    C3DE_SLOT(remove),       C3DE_SLOT(clear),        C3DE_SLOT(step),           C3DE_SLOT(reset),
    C3DE_SLOT(publish),      C3DE_SLOT(status),       C3DE_SLOT(state_hash),     C3DE_SLOT(report),
    C3DE_SLOT(body_at),      C3DE_SLOT(body_info),    C3DE_SLOT(enum_fields),    C3DE_SLOT(read_field),
    C3DE_SLOT(triangles),    C3DE_SLOT(enum_probes)};
#undef C3DE_SLOT

/// Of revision 1; later ones only grow.
constexpr std::size_t kFirstSize = 8 + 31 * 8;
static_assert(sizeof(c3de_simulator_v1) >= kFirstSize);

bool isNull(const c3de_simulator_v1 *table, const Slot &slot) {
  void *function = nullptr;
  std::memcpy(&function, reinterpret_cast<const unsigned char *>(table) + slot.offset, sizeof function);
  return function == nullptr;
}

}  // namespace

Expected<const c3de_simulator_v1 *> simulatorTable(c3de_object *simulator) {
  const void *answered = nullptr;
  const c3de_status code = simulator->vt->query(simulator, toAbi(C3DE_IFACE_SIMULATOR_ID), 1, &answered);
  if (code < 0 || answered == nullptr)
    return fail(ErrorCode::plugin,
                fmt::format("the object does not answer {} (status {})", C3DE_IFACE_SIMULATOR_ID, code));
  const auto *table = static_cast<const c3de_simulator_v1 *>(answered);
  if (table->size < kFirstSize)
    return fail(ErrorCode::plugin, fmt::format("the table of {} has {} bytes; needed: {}", C3DE_IFACE_SIMULATOR_ID,
                                               table->size, kFirstSize));
  for (const Slot &slot : kRequired)
    if (isNull(table, slot))
      return fail(ErrorCode::plugin,
                  fmt::format("{}() in the table of {} is null; it may not be", slot.name, C3DE_IFACE_SIMULATOR_ID));
  // These four are one thing.
  const bool holds = table->hold != nullptr;
  if ((table->pull != nullptr) != holds || (table->let_go != nullptr) != holds ||
      (table->hold_force != nullptr) != holds)
    return fail(ErrorCode::plugin,
                fmt::format("of hold(), pull(), let_go() and hold_force() in the table of {} some are "
                            "null; accepted: all or none",
                            C3DE_IFACE_SIMULATOR_ID));
  return table;
}

}  // namespace c3de::scene
