// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <cfloat>
#include <cstdint>

#include "frame/theme.h"
#include "window/glfw_window.h"

namespace c3de::ui {

/// Dear ImGui with its two back ends, for as long as the window exists.
class ImGuiSession {
 public:
  explicit ImGuiSession(const GlfwWindow &window);
  ~ImGuiSession();
  ImGuiSession(const ImGuiSession &) = delete;
  ImGuiSession &operator=(const ImGuiSession &) = delete;

  /// Passes on an event of the frame that begins next.
  void take(const GlfwWindow &window, const OsEvent &event);
  /// Between frames. No effect if they are the present ones.
  void setLook(const GlfwWindow &window, ThemeKind kind, double fontSize_px);
  void beginFrame();
  void endFrame();
  /// Into the bound framebuffer.
  void draw();
  [[nodiscard]] const Theme &theme() const { return theme_; }

 private:
  Theme theme_;
  double fontSize_px_ = Preferences::kUsualFont;
  ImVec2 mouse_{-FLT_MAX, -FLT_MAX};
  std::uint32_t buttons_ = 0;
  ClickPairs clicks_;
  bool isSecondPress_ = false;  ///< in this frame
};

}  // namespace c3de::ui
