// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <string>

#include "c3de/ui/preferences.h"

namespace c3de::ui {

/// All colours of a theme.
struct Palette {
  ImVec4 text, dim, disabled, accent, accentMid, good, warn, error;
  ImVec4 chrome, panel, popup, line, border;
  ImVec4 field, fieldHovered, fieldActive, button, buttonHovered, header;
  ImVec4 primary, primaryHovered;  ///< buttons that do what a dialog is for, and what is switched on
  ImVec4 filled, filledHovered;    ///< part of a slider up to its value
  ImVec4 scroll, scrollHovered, selectedText, dimmed;
};
[[nodiscard]] const Palette &paletteOf(ThemeKind kind);

/// Colours of the theme of the current ImGui context. Views stay dark in every theme: they use those of ThemeKind::dark.
namespace colour {
struct Role {
  ImVec4 Palette::*of;
  operator ImVec4() const;
};
inline constexpr Role kText{&Palette::text}, kDim{&Palette::dim}, kAccent{&Palette::accent}, kGood{&Palette::good},
    kWarn{&Palette::warn}, kError{&Palette::error}, kChrome{&Palette::chrome}, kPanel{&Palette::panel},
    kLine{&Palette::line}, kPrimary{&Palette::primary}, kPrimaryHovered{&Palette::primaryHovered},
    kAccentMid{&Palette::accentMid}, kFilled{&Palette::filled}, kFilledHovered{&Palette::filledHovered};
}  // namespace colour

struct Theme {
  ImFont *regular = nullptr, *bold = nullptr, *small = nullptr;
  float scale = 1.0f;  ///< of the monitor, times that of the font size
  ThemeKind kind = ThemeKind::dark;
  std::string note;  ///< missing fonts or glyphs, for the log; empty if nothing is missing

  [[nodiscard]] float px(float logical) const { return logical * scale; }
  [[nodiscard]] bool hasGlyph(unsigned character) const;
};

/// Fonts of the system (DejaVu Sans or Segoe UI) and the colours of a theme, sized for the monitor and the font size.
/// Needs a current ImGui context whose font atlas is not built yet.
[[nodiscard]] Theme applyTheme(float contentScale, ThemeKind kind = ThemeKind::dark,
                               double fontSize_px = Preferences::kUsualFont);

/// Small icons for buttons, drawn so that no icon font is needed.
enum class Icon { play, pause, step, reset, stop, close, toStart, toEnd };
void drawIcon(ImDrawList *list, Icon icon, ImVec2 min, ImVec2 max, ImU32 tint);
/// True when pressed. A square button; `size` is usually the frame height.
bool iconButton(const char *id, Icon icon, float size, const ImVec4 &tint, bool enabled);

}  // namespace c3de::ui
