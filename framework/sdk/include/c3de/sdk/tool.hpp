// SPDX-License-Identifier: Apache-2.0
// Tools: what the left mouse button does in the 3D view and in slices of an image.
#pragma once

#include "c3de/sdk/services.hpp"

namespace c3de::sdk {

struct ToolInfo {
  std::string_view id{}, label{};
  std::string_view hint{};  ///< one line, shown while active
  char shortcut = 0;        ///< ASCII upper case; 0: none
  bool inSlices = false;    ///< events of the slices of an image come, too; see isInSlice()
};

/// Whether an event happened in a slice: its ray begins in the plane that is shown. False for all with older hosts.
[[nodiscard]] inline bool isInSlice(const c3de_event &event) noexcept {
  return C3DE_HAS(c3de_event, &event, where) && event.where != C3DE_IN_SPACE;
}

/// Of a press in the 3D view: how far along its ray, mm, the inside of a body is seen, on a slice that is shown there as
/// a plane or as the surface of a tissue.
[[nodiscard]] inline std::optional<double> seenInside(const c3de_event &event) noexcept {
  if (!C3DE_HAS(c3de_event, &event, inside_mm) || event.inside_mm < 0.0) return std::nullopt;
  return event.inside_mm;
}

/// The point that a person has marked, mm, world: the cross-hair of the image that is open, else the point that the
/// camera turns about. Nothing in a run without a window, and with older hosts. Main thread.
[[nodiscard]] inline std::optional<Vec3> markedPoint(Host host) {
  const auto *table = host.service<c3de_tools_v1>(2);
  Vec3 point{};
  if (!table || table->marked_point(table->ctx, point.data()) < 0) return std::nullopt;
  return point;
}

/// Base of a tool. Registered by add(), taken back by the destructor; at most one tool is active. Main thread.
class Tool {
 public:
  Tool() = default;
  Tool(const Tool &) = delete;
  Tool &operator=(const Tool &) = delete;
  virtual ~Tool() = default;

  /// May throw or fail: then the tool does not become active.
  virtual Result<void> activate() { return {}; }
  /// Lets go of everything: Escape, loss of focus, another tool.
  virtual void cancel() {}
  /// True keeps the event from the camera and from the gestures of slices.
  virtual bool onEvent(const c3de_event &event) = 0;

  /// C3DE_E_UNSUPPORTED in a run without a window.
  Result<void> add(Host host, const ToolInfo &info) {
    auto table = host.require<c3de_tools_v1>();
    if (!table) return table.failure();
    const c3de_tool tool{sizeof(c3de_tool),
                         1,
                         str(info.id),
                         str(info.label),
                         str(info.hint),
                         static_cast<std::uint32_t>(static_cast<unsigned char>(info.shortcut)),
                         0,
                         this,
                         &activateThunk,
                         &cancelThunk,
                         &eventThunk,
                         info.inSlices ? C3DE_TOOL_IN_SLICES : 0u,
                         0};
    c3de_handle handle{0};
    if (const c3de_status status = (*table)->add((*table)->ctx, &tool, &handle); status < 0)
      return host.failure(status);
    registration_ = {*table, handle};
    return {};
  }
  /// Makes it the active tool.
  Result<void> select() const {
    const auto *table = registration_.table();
    if (!table) return Failure{C3DE_E_STATE, "the tool is not registered"};
    return currentHost().check(table->activate(table->ctx, registration_.handle()));
  }
  [[nodiscard]] bool isActive() const noexcept {
    std::uint32_t active = 0;
    const auto *table = registration_.table();
    return table && table->is_active(table->ctx, registration_.handle(), &active) >= 0 && active != 0;
  }
  void remove() noexcept { registration_.reset(); }
  [[nodiscard]] bool isRegistered() const noexcept { return static_cast<bool>(registration_); }

 private:
  static c3de_status C3DE_CALL activateThunk(void *self) noexcept {
    return guard([&] { return static_cast<Tool *>(self)->activate(); });
  }
  static void C3DE_CALL cancelThunk(void *self) noexcept {
    guardQuietly("tool", [&] { static_cast<Tool *>(self)->cancel(); });
  }
  static c3de_status C3DE_CALL eventThunk(void *self, const c3de_event *event, std::uint32_t *consumed) noexcept {
    return guard([&] { *consumed = static_cast<Tool *>(self)->onEvent(*event) ? 1u : 0u; });
  }
  Owned<c3de_tools_v1, &c3de_tools_v1::remove> registration_;
};

}  // namespace c3de::sdk
