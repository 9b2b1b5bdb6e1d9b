// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "logic/os_event.h"

struct GLFWwindow;

namespace c3de::ui {

/// The OS window and its OpenGL context. Main thread, except wake().
class GlfwWindow {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<GlfwWindow>> create(const std::string &title, int width, int height);
  ~GlfwWindow();
  GlfwWindow(const GlfwWindow &) = delete;
  GlfwWindow &operator=(const GlfwWindow &) = delete;

  [[nodiscard]] GLFWwindow *handle() const { return window_; }
  /// Waits for an event or wake() for at most timeout_s (0: does not wait).
  void wait(double timeout_s);
  /// The pending events that this frame can show; the rest remains for the next.
  [[nodiscard]] std::vector<OsEvent> takeEvents(bool holdsTyping) { return takeFrameEvents(events_, holdsTyping); }
  [[nodiscard]] const std::vector<OsEvent> &events() const { return events_; }
  [[nodiscard]] bool hasEvents() const { return !events_.empty(); }
  void wake();
  /// True once after each wake().
  [[nodiscard]] bool takeWake() { return isWoken_.exchange(false); }

  [[nodiscard]] bool closeRequested() const;
  void requestClose();
  void swap();
  void setTitle(const std::string &title);
  [[nodiscard]] std::array<int, 2> windowSize() const;
  [[nodiscard]] std::array<int, 2> framebufferSize() const;
  [[nodiscard]] float contentScale() const;
  [[nodiscard]] bool isFocused() const;
  [[nodiscard]] static double now_s();

 private:
  GlfwWindow() = default;
  void installCallbacks();
  static GlfwWindow &of(GLFWwindow *window);
  OsEvent &add(OsEvent::Kind kind);

  GLFWwindow *window_ = nullptr;
  std::string title_;
  std::vector<OsEvent> events_;
  std::uint32_t modifiers_ = 0;
  std::atomic<bool> isWoken_{false};
};

}  // namespace c3de::ui
