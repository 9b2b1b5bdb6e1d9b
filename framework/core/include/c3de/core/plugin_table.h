// SPDX-License-Identifier: Apache-2.0
// Function tables of plugins, checked entry by entry before the first call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "c3de/abi/c3de.h"
#include "c3de/abi/entry.h"
#include "c3de/abi/object.h"
#include "c3de/core/expected.h"

namespace c3de {

/// A function that is required from a revision of its table on.
struct TableSlot {
  const char *name;
  std::size_t offset;
  std::uint32_t rev;
};

/// The name of a table for messages, and its required entries. Each table passed by a plugin has a specialisation.
template <class T>
struct TableSlots;

#define C3DE_SLOT(member, rev) \
  TableSlot { #member, offsetof(Table, member), rev }
#define C3DE_TABLE_SLOTS(T, tableName, ...)            \
  template <>                                          \
  struct TableSlots<T> {                               \
    using Table = T;                                   \
    static constexpr const char *name = tableName;     \
    static constexpr std::array slots = {__VA_ARGS__}; \
  }

C3DE_TABLE_SLOTS(c3de_plugin, "descriptor", C3DE_SLOT(create, 1), C3DE_SLOT(start, 1), C3DE_SLOT(stop, 1),
                 C3DE_SLOT(destroy, 1));
C3DE_TABLE_SLOTS(c3de_class, "class", C3DE_SLOT(create, 1));
C3DE_TABLE_SLOTS(c3de_object_vt, "object", C3DE_SLOT(retain, 1), C3DE_SLOT(release, 1), C3DE_SLOT(query, 1));
C3DE_TABLE_SLOTS(c3de_panel, "panel", C3DE_SLOT(on_ui, 1));
C3DE_TABLE_SLOTS(c3de_tool, "tool", C3DE_SLOT(activate, 1), C3DE_SLOT(cancel, 1), C3DE_SLOT(on_event, 1));
C3DE_TABLE_SLOTS(c3de_edit, "edit", C3DE_SLOT(undo, 1), C3DE_SLOT(redo, 1));
C3DE_TABLE_SLOTS(c3de_param_listener, "listener", C3DE_SLOT(changed, 1));
C3DE_TABLE_SLOTS(c3de_job, "job", C3DE_SLOT(run, 1), C3DE_SLOT(done, 1));
C3DE_TABLE_SLOTS(c3de_force_field, "field", C3DE_SLOT(apply, 1));
C3DE_TABLE_SLOTS(c3de_simulator_v1, C3DE_IFACE_SIMULATOR_ID, C3DE_SLOT(attach, 1), C3DE_SLOT(declarations, 1),
                 C3DE_SLOT(set_world, 1), C3DE_SLOT(add_body, 1), C3DE_SLOT(add_obstacle, 1), C3DE_SLOT(add_probe, 1),
                 C3DE_SLOT(set_body_param, 1), C3DE_SLOT(get_body_param, 1), C3DE_SLOT(remove, 1), C3DE_SLOT(clear, 1),
                 C3DE_SLOT(step, 1), C3DE_SLOT(reset, 1), C3DE_SLOT(publish, 1), C3DE_SLOT(status, 1),
                 C3DE_SLOT(state_hash, 1), C3DE_SLOT(report, 1), C3DE_SLOT(body_at, 1), C3DE_SLOT(body_info, 1),
                 C3DE_SLOT(enum_fields, 1), C3DE_SLOT(read_field, 1), C3DE_SLOT(triangles, 1),
                 C3DE_SLOT(enum_probes, 1));
C3DE_TABLE_SLOTS(c3de_contact_v1, C3DE_IFACE_CONTACT_ID, C3DE_SLOT(set_pair, 1));
C3DE_TABLE_SLOTS(c3de_attachment_v1, C3DE_IFACE_ATTACHMENT_ID, C3DE_SLOT(add, 1), C3DE_SLOT(enumerate, 1));
C3DE_TABLE_SLOTS(c3de_grasp_v1, C3DE_IFACE_GRASP_ID, C3DE_SLOT(add, 1));
C3DE_TABLE_SLOTS(c3de_changes_v1, C3DE_IFACE_CHANGES_ID, C3DE_SLOT(observe, 1), C3DE_SLOT(apply, 1));

#undef C3DE_TABLE_SLOTS
#undef C3DE_SLOT

/// Why the entries cannot be called, with the name of the first invalid one: null, or beyond the table's size for its
/// revision. Empty: valid.
[[nodiscard]] std::string slotProblem(const void *table, std::uint32_t size, std::uint32_t rev,
                                      std::span<const TableSlot> slots);

/// Same, as "TABLE: SLOT is null …"; a struct without a revision counts as the first.
template <class T>
[[nodiscard]] std::string tableProblem(const T *table) {
  std::string problem;
  if (!table)
    problem = "is null";
  else if constexpr (requires { table->rev; })
    problem = slotProblem(table, table->size, table->rev, TableSlots<T>::slots);
  else
    problem = slotProblem(table, table->size, 1, TableSlots<T>::slots);
  return problem.empty() ? problem : std::string(TableSlots<T>::name) + ": " + problem;
}

/// Why an object of a plugin cannot be used; empty: it can.
[[nodiscard]] std::string objectProblem(const c3de_object *object);

/// Queries an object for an interface; an exception from the call is an error, too. The table is not checked.
[[nodiscard]] Expected<const void *> queryObject(c3de_object *object, std::string_view interfaceId,
                                                 std::uint32_t minRev);

/// Same, checked: every entry of its revision can be called.
template <class T>
[[nodiscard]] Expected<const T *> queryTable(c3de_object *object, std::string_view interfaceId,
                                             std::uint32_t minRev = 1) {
  const auto found = queryObject(object, interfaceId, minRev);
  if (!found) return tl::unexpected(found.error());
  const auto *table = static_cast<const T *>(*found);
  if (std::string problem = tableProblem(table); !problem.empty())
    return fail(ErrorCode::plugin, "the object's table of " + std::move(problem));
  return table;
}

/// Releases a reference. An exception from the call is logged.
void releaseObject(c3de_object *object) noexcept;

}  // namespace c3de
