// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/abi/tools.h"
#include "c3de/core/handle.h"
#include "c3de/core/vec.h"

namespace c3de::registry {

struct Tool {
  std::string owner;  ///< plugin id
  std::string id, label, hint;
  std::uint32_t shortcut = 0;
  bool inSlices = false;  ///< also receives events of slices
  void *self = nullptr;
  c3de_status(C3DE_CALL *activate)(void *self) = nullptr;
  void(C3DE_CALL *cancel)(void *self) = nullptr;
  c3de_status(C3DE_CALL *onEvent)(void *self, const c3de_event *event, std::uint32_t *consumed) = nullptr;
};

/// The tools registered by plugins; at most one is active. Main thread only.
class ToolRegistry {
 public:
  Handle add(Tool tool);
  bool remove(Handle tool);
  void removeOwnedBy(const std::string &plugin);
  /// Cancels the previous tool. Null handle: none. False: stale handle, or the tool refused.
  bool activate(Handle tool);
  [[nodiscard]] Handle active() const { return active_; }
  /// Cancels the present action of the active tool; it stays active.
  void cancelActive();
  [[nodiscard]] const Tool *find(Handle tool) const { return tools_.find(tool); }
  /// Whether the active tool receives events of slices.
  [[nodiscard]] bool worksInSlices() const;
  /// True if the tool used the event. An event of a slice is sent only to a tool with inSlices.
  bool dispatch(const c3de_event &event);

  /// Sets the function that returns the point marked by the user, mm; none if there are no views.
  void setMarkedPoint(std::function<Vec3()> point) { markedPoint_ = std::move(point); }
  [[nodiscard]] std::optional<Vec3> markedPoint() const {
    return markedPoint_ ? std::optional(markedPoint_()) : std::nullopt;
  }

  struct Entry {
    Handle handle;
    const Tool *tool;
  };
  [[nodiscard]] std::vector<Entry> tools() const;

 private:
  HandleTable<Tool, HandleKind::tool> tools_;
  std::vector<Handle> order_;
  Handle active_;
  std::function<Vec3()> markedPoint_;
};

}  // namespace c3de::registry
