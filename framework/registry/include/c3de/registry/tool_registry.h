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
  bool inSlices = false;  ///< wants events of slices, too
  void *self = nullptr;
  c3de_status(C3DE_CALL *activate)(void *self) = nullptr;
  void(C3DE_CALL *cancel)(void *self) = nullptr;
  c3de_status(C3DE_CALL *onEvent)(void *self, const c3de_event *event, std::uint32_t *consumed) = nullptr;
};

/// The tools that plugins have registered; at most one is active. Main thread only.
class ToolRegistry {
 public:
  Handle add(Tool tool);
  bool remove(Handle tool);
  void removeOwnedBy(const std::string &plugin);
  /// Cancels the tool before. Null handle: none. False: stale handle, or the tool refused.
  bool activate(Handle tool);
  [[nodiscard]] Handle active() const { return active_; }
  /// Cancels what the active tool is doing; it stays active.
  void cancelActive();
  [[nodiscard]] const Tool *find(Handle tool) const { return tools_.find(tool); }
  /// The active tool gets events of slices.
  [[nodiscard]] bool worksInSlices() const;
  /// True: the tool took the event. One of a slice reaches only a tool that asks for it.
  bool dispatch(const c3de_event &event);

  /// Who knows the point that a person has marked, mm; none: there are no views.
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
