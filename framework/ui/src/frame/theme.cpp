// SPDX-License-Identifier: Apache-2.0
#include "frame/theme.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <system_error>

#include "c3de/core/platform.h"
#include "c3de/ui/file_browser.h"

namespace c3de::ui {
namespace {

namespace fs = std::filesystem;

/// The first of the files found in one of the system's font folders, at most three levels deep.
std::string findFont(std::initializer_list<const char *> names) {
  for (const char *name : names)
    for (const fs::path &folder : fontDirectories()) {
      std::error_code error;
      if (fs::exists(folder / name, error)) return pathText(folder / name);
      fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
      if (error) continue;
      for (const fs::recursive_directory_iterator end; it != end; it.increment(error)) {
        if (error) break;
        if (it.depth() > 2) it.disable_recursion_pending();
        if (it->path().filename() == name) return pathText(it->path());
      }
    }
  return {};
}

// Latin, Greek, Cyrillic; dashes, quotes, super- and subscripts, arrows, mathematical and geometric signs.
constexpr ImWchar kGlyphs[] = {0x0020, 0x017F, 0x0370, 0x03FF, 0x0400, 0x045F, 0x2010, 0x2044, 0x2070, 0x209C,
                               0x20AC, 0x20AC, 0x2190, 0x21FF, 0x2200, 0x22FF, 0x25A0, 0x25FF, 0};

ImFont *loadFont(const std::string &file, float pixels) {
  if (file.empty()) return nullptr;
  ImFontConfig config;
  config.OversampleH = 2;
  config.OversampleV = 1;
  config.PixelSnapH = true;
  return ImGui::GetIO().Fonts->AddFontFromFileTTF(file.c_str(), pixels, &config, kGlyphs);
}

ImVec4 grey(float r, float g, float b, float a = 1.0f) { return {r, g, b, a}; }

const Palette kDark{// clang-format off
    .text = grey(0.87f, 0.89f, 0.92f), .dim = grey(0.56f, 0.61f, 0.68f), .disabled = grey(0.43f, 0.47f, 0.53f),
    .accent = grey(0.29f, 0.66f, 0.74f), .accentMid = grey(0.24f, 0.52f, 0.59f), .good = grey(0.38f, 0.74f, 0.49f),
    .warn = grey(0.91f, 0.69f, 0.29f), .error = grey(0.90f, 0.38f, 0.37f), .chrome = grey(0.105f, 0.118f, 0.141f),
    .panel = grey(0.129f, 0.145f, 0.173f), .popup = grey(0.150f, 0.168f, 0.200f, 0.99f),
    .line = grey(0.20f, 0.225f, 0.265f), .border = grey(0.26f, 0.29f, 0.34f), .field = grey(0.172f, 0.194f, 0.231f),
    .fieldHovered = grey(0.215f, 0.243f, 0.289f), .fieldActive = grey(0.235f, 0.268f, 0.318f),
    .button = grey(0.205f, 0.232f, 0.276f), .buttonHovered = grey(0.262f, 0.297f, 0.353f),
    .header = grey(0.175f, 0.200f, 0.240f), .primary = grey(0.20f, 0.42f, 0.48f),
    .primaryHovered = grey(0.24f, 0.49f, 0.55f), .filled = grey(0.18f, 0.37f, 0.42f),
    .filledHovered = grey(0.20f, 0.43f, 0.49f), .scroll = grey(0.28f, 0.31f, 0.37f),
    .scrollHovered = grey(0.36f, 0.40f, 0.47f), .selectedText = grey(0.20f, 0.42f, 0.48f, 0.8f),
    .dimmed = grey(0.02f, 0.025f, 0.03f, 0.6f)};
const Palette kLight{
    .text = grey(0.10f, 0.12f, 0.15f), .dim = grey(0.34f, 0.38f, 0.44f), .disabled = grey(0.52f, 0.55f, 0.60f),
    .accent = grey(0.03f, 0.42f, 0.50f), .accentMid = grey(0.22f, 0.56f, 0.63f), .good = grey(0.10f, 0.48f, 0.22f),
    .warn = grey(0.62f, 0.38f, 0.00f), .error = grey(0.75f, 0.13f, 0.13f), .chrome = grey(0.875f, 0.885f, 0.905f),
    .panel = grey(0.945f, 0.950f, 0.960f), .popup = grey(0.985f, 0.987f, 0.990f, 0.99f),
    .line = grey(0.76f, 0.78f, 0.81f), .border = grey(0.70f, 0.72f, 0.76f), .field = grey(1.0f, 1.0f, 1.0f),
    .fieldHovered = grey(0.89f, 0.92f, 0.95f), .fieldActive = grey(0.84f, 0.89f, 0.93f),
    .button = grey(0.835f, 0.850f, 0.875f), .buttonHovered = grey(0.77f, 0.79f, 0.83f),
    .header = grey(0.86f, 0.875f, 0.90f), .primary = grey(0.60f, 0.82f, 0.86f),
    .primaryHovered = grey(0.52f, 0.77f, 0.82f), .filled = grey(0.66f, 0.85f, 0.89f),
    .filledHovered = grey(0.58f, 0.80f, 0.85f), .scroll = grey(0.70f, 0.72f, 0.76f),
    .scrollHovered = grey(0.58f, 0.61f, 0.66f), .selectedText = grey(0.55f, 0.79f, 0.85f, 0.8f),
    .dimmed = grey(0.20f, 0.22f, 0.25f, 0.45f)};
// clang-format on

void setColours(ImGuiStyle &style, const Palette &palette) {
  ImVec4 *c = style.Colors;
  const ImVec4 kNone{0, 0, 0, 0};
  c[ImGuiCol_Text] = palette.text;
  c[ImGuiCol_TextDisabled] = palette.disabled;
  c[ImGuiCol_WindowBg] = palette.panel;
  c[ImGuiCol_ChildBg] = c[ImGuiCol_ScrollbarBg] = kNone;
  c[ImGuiCol_PopupBg] = palette.popup;
  c[ImGuiCol_Border] = palette.border;
  c[ImGuiCol_FrameBg] = palette.field;
  c[ImGuiCol_FrameBgHovered] = c[ImGuiCol_HeaderHovered] = palette.fieldHovered;
  c[ImGuiCol_FrameBgActive] = palette.fieldActive;
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = c[ImGuiCol_TitleBgCollapsed] = palette.chrome;
  c[ImGuiCol_MenuBarBg] = palette.chrome;
  c[ImGuiCol_ScrollbarGrab] = palette.scroll;
  c[ImGuiCol_ScrollbarGrabHovered] = palette.scrollHovered;
  c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrabActive] = c[ImGuiCol_SeparatorActive] = palette.accent;
  c[ImGuiCol_ScrollbarGrabActive] = c[ImGuiCol_SliderGrab] = c[ImGuiCol_SeparatorHovered] = palette.accentMid;
  c[ImGuiCol_Button] = palette.button;
  c[ImGuiCol_ButtonHovered] = palette.buttonHovered;
  c[ImGuiCol_ButtonActive] = c[ImGuiCol_HeaderActive] = palette.primary;
  c[ImGuiCol_Header] = palette.header;
  c[ImGuiCol_Separator] = palette.line;
  c[ImGuiCol_ResizeGrip] = palette.scroll;
  c[ImGuiCol_ResizeGrip].w = 0.6f;
  c[ImGuiCol_ResizeGripHovered] = c[ImGuiCol_PlotHistogram] = palette.accentMid;
  c[ImGuiCol_ResizeGripActive] = c[ImGuiCol_NavHighlight] = palette.accent;
  c[ImGuiCol_TextSelectedBg] = palette.selectedText;
  c[ImGuiCol_ModalWindowDimBg] = palette.dimmed;
}

}  // namespace

bool Theme::hasGlyph(unsigned character) const {
  return regular && regular->FindGlyphNoFallback(static_cast<ImWchar>(character)) != nullptr;
}

const Palette &paletteOf(ThemeKind kind) { return kind == ThemeKind::light ? kLight : kDark; }

colour::Role::operator ImVec4() const {
  const auto *palette = static_cast<const Palette *>(ImGui::GetIO().UserData);
  return (palette ? *palette : kDark).*of;
}

Theme applyTheme(float contentScale, ThemeKind kind, double fontSize_px) {
  Theme theme;
  theme.kind = kind;
  theme.scale = std::isfinite(contentScale) ? std::clamp(contentScale, 0.75f, 4.0f) : 1.0f;
  theme.scale *= static_cast<float>(fontSize_px / Preferences::kUsualFont);
  ImGui::GetIO().UserData = const_cast<Palette *>(&paletteOf(kind));  // only read

  const float pixels = std::round(theme.px(14.0f));
  const std::string regular = findFont({"DejaVuSans.ttf", "segoeui.ttf"});
  const std::string bold = findFont({"DejaVuSans-Bold.ttf", "segoeuib.ttf"});
  theme.regular = loadFont(regular, pixels);
  if (!theme.regular) {
    theme.note = "DejaVu Sans and Segoe UI are not installed: using a built-in font without special characters";
    ImFontConfig config;
    config.SizePixels = std::round(theme.px(13.0f));
    theme.regular = ImGui::GetIO().Fonts->AddFontDefault(&config);
  }
  theme.bold = loadFont(bold, pixels);
  theme.small = loadFont(regular, std::round(theme.px(12.0f)));
  if (!theme.bold) theme.bold = theme.regular;
  if (!theme.small) theme.small = theme.regular;

  ImGuiStyle style;
  kind == ThemeKind::light ? ImGui::StyleColorsLight(&style) : ImGui::StyleColorsDark(&style);
  setColours(style, paletteOf(kind));
  style.WindowPadding = ImVec2(10, 8);
  style.FramePadding = ImVec2(8, 4);
  style.ItemSpacing = ImVec2(8, 6);
  style.ItemInnerSpacing = ImVec2(6, 4);
  style.IndentSpacing = 16;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 10;
  style.WindowRounding = 0;
  style.ChildRounding = 4;
  style.PopupRounding = 5;
  style.FrameRounding = 4;
  style.GrabRounding = 3;
  style.ScrollbarRounding = 6;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.ScaleAllSizes(theme.scale);
  ImGui::GetStyle() = style;
  return theme;
}

void drawIcon(ImDrawList *list, Icon icon, ImVec2 min, ImVec2 max, ImU32 tint) {
  const float size = std::min(max.x - min.x, max.y - min.y);
  const float cx = 0.5f * (min.x + max.x), cy = 0.5f * (min.y + max.y), r = 0.26f * size;
  switch (icon) {
    case Icon::play:
      list->AddTriangleFilled(ImVec2(cx - 0.75f * r, cy - r), ImVec2(cx - 0.75f * r, cy + r), ImVec2(cx + r, cy), tint);
      break;
    case Icon::pause:
      list->AddRectFilled(ImVec2(cx - 0.8f * r, cy - r), ImVec2(cx - 0.2f * r, cy + r), tint);
      list->AddRectFilled(ImVec2(cx + 0.2f * r, cy - r), ImVec2(cx + 0.8f * r, cy + r), tint);
      break;
    case Icon::step:
      list->AddTriangleFilled(ImVec2(cx - r, cy - r), ImVec2(cx - r, cy + r), ImVec2(cx + 0.5f * r, cy), tint);
      list->AddRectFilled(ImVec2(cx + 0.6f * r, cy - r), ImVec2(cx + r, cy + r), tint);
      break;
    case Icon::reset: {
      constexpr float kPi = 3.14159265f;
      const float radius = 0.95f * r;
      list->PathArcTo(ImVec2(cx, cy), radius, -0.35f * kPi, 1.25f * kPi, 24);
      list->PathStroke(tint, 0, std::max(1.5f, 0.07f * size));
      // The arrow head at the counter-clockwise end.
      const float a = -0.35f * kPi, hx = cx + radius * std::cos(a), hy = cy + radius * std::sin(a), h = 0.55f * r;
      list->AddTriangleFilled(ImVec2(hx - 1.3f * h, hy - 0.35f * h), ImVec2(hx + 0.35f * h, hy - 1.05f * h),
                              ImVec2(hx + 0.35f * h, hy + 0.75f * h), tint);
      break;
    }
    case Icon::stop:
      list->AddRectFilled(ImVec2(cx - 0.85f * r, cy - 0.85f * r), ImVec2(cx + 0.85f * r, cy + 0.85f * r), tint);
      break;
    case Icon::close: {
      const float d = 0.6f * r, width = std::max(1.0f, 0.06f * size);
      list->AddLine(ImVec2(cx - d, cy - d), ImVec2(cx + d, cy + d), tint, width);
      list->AddLine(ImVec2(cx - d, cy + d), ImVec2(cx + d, cy - d), tint, width);
      break;
    }
    case Icon::toStart:
    case Icon::toEnd: {
      const float d = icon == Icon::toStart ? -r : r;
      list->AddTriangleFilled(ImVec2(cx - d, cy - r), ImVec2(cx - d, cy + r), ImVec2(cx + 0.5f * d, cy), tint);
      list->AddRectFilled(ImVec2(cx + std::min(0.7f * d, d), cy - r), ImVec2(cx + std::max(0.7f * d, d), cy + r), tint);
      break;
    }
  }
}

bool iconButton(const char *id, Icon icon, float size, const ImVec4 &tint, bool enabled) {
  ImGui::BeginDisabled(!enabled);
  ImGui::PushID(id);
  const bool isPressed = ImGui::Button("##icon", ImVec2(size, size));
  ImGui::PopID();
  drawIcon(ImGui::GetWindowDrawList(), icon, ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
           ImGui::GetColorU32(enabled ? tint : ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled)));
  ImGui::EndDisabled();
  return isPressed;
}

}  // namespace c3de::ui
