// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <string>

namespace c3de::ui {

/// Colours that are not part of the widget style.
namespace colour {
inline const ImVec4 kText{0.87f, 0.89f, 0.92f, 1.0f};
inline const ImVec4 kDim{0.56f, 0.61f, 0.68f, 1.0f};
inline const ImVec4 kAccent{0.29f, 0.66f, 0.74f, 1.0f};
inline const ImVec4 kGood{0.38f, 0.74f, 0.49f, 1.0f};
inline const ImVec4 kWarn{0.91f, 0.69f, 0.29f, 1.0f};
inline const ImVec4 kError{0.90f, 0.38f, 0.37f, 1.0f};
inline const ImVec4 kChrome{0.105f, 0.118f, 0.141f, 1.0f};
inline const ImVec4 kPanel{0.129f, 0.145f, 0.173f, 1.0f};
inline const ImVec4 kLine{0.20f, 0.225f, 0.265f, 1.0f};
}  // namespace colour

struct Theme {
  ImFont *regular = nullptr, *bold = nullptr, *small = nullptr;
  float scale = 1.0f;  ///< of the monitor
  std::string note;    ///< missing fonts or glyphs, for the log; empty if nothing is missing

  [[nodiscard]] float px(float logical) const { return logical * scale; }
  [[nodiscard]] bool hasGlyph(unsigned character) const;
};

/// Fonts of the system (DejaVu Sans or Segoe UI) and the program's dark colours, sized for the monitor.
/// Needs a current ImGui context whose font atlas is not built yet.
[[nodiscard]] Theme applyTheme(float contentScale);

/// Small icons for buttons, drawn so that no icon font is needed.
enum class Icon { play, pause, step, reset, stop, close, toStart, toEnd };
void drawIcon(ImDrawList *list, Icon icon, ImVec2 min, ImVec2 max, ImU32 tint);
/// True when pressed. A square button; `size` is usually the frame height.
bool iconButton(const char *id, Icon icon, float size, const ImVec4 &tint, bool enabled);

}  // namespace c3de::ui
