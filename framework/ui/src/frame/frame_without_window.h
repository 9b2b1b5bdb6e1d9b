// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include "frame/theme.h"

namespace c3de::ui {

/// Dear ImGui without a window, for one frame that is drawn into pictures. That of a window is current again whenever
/// no Use exists. Needs a current OpenGL context, also when it is destroyed. Main thread.
class FrameWithoutWindow {
 public:
  /// @param width, height  logical pixels
  /// @param scale          pixels of the picture per logical pixel
  FrameWithoutWindow(int width, int height, float scale);
  ~FrameWithoutWindow();
  FrameWithoutWindow(const FrameWithoutWindow &) = delete;
  FrameWithoutWindow &operator=(const FrameWithoutWindow &) = delete;

  /// Makes it current.
  class Use {
   public:
    explicit Use(const FrameWithoutWindow &frame) : before_(ImGui::GetCurrentContext()) {
      ImGui::SetCurrentContext(frame.context_);
    }
    ~Use() { ImGui::SetCurrentContext(before_); }
    Use(const Use &) = delete;
    Use &operator=(const Use &) = delete;

   private:
    ImGuiContext *before_;
  };

  /// False: the texts cannot be drawn with this OpenGL.
  [[nodiscard]] bool isReady() const { return isReady_; }
  [[nodiscard]] const Theme &theme() const { return theme_; }
  /// Draws a part of the frame, after ImGui::Render(), into the bound framebuffer.
  /// @param at, size       of the part, logical pixels
  /// @param width, height  of the picture, pixels
  void draw(ImVec2 at, ImVec2 size, int width, int height) const;

 private:
  ImGuiContext *context_ = nullptr;
  Theme theme_;
  bool isReady_ = false;
};

}  // namespace c3de::ui
