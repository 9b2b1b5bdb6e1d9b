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

void setColours(ImGuiStyle &style) {
  ImVec4 *c = style.Colors;
  const ImVec4 field{0.172f, 0.194f, 0.231f, 1.0f}, hovered{0.215f, 0.243f, 0.289f, 1.0f};
  const ImVec4 accentDim{0.20f, 0.42f, 0.48f, 1.0f}, accentMid{0.24f, 0.52f, 0.59f, 1.0f};
  c[ImGuiCol_Text] = colour::kText;
  c[ImGuiCol_TextDisabled] = ImVec4(0.43f, 0.47f, 0.53f, 1.0f);
  c[ImGuiCol_WindowBg] = colour::kPanel;
  c[ImGuiCol_ChildBg] = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_PopupBg] = ImVec4(0.150f, 0.168f, 0.200f, 0.99f);
  c[ImGuiCol_Border] = ImVec4(0.26f, 0.29f, 0.34f, 1.0f);
  c[ImGuiCol_FrameBg] = field;
  c[ImGuiCol_FrameBgHovered] = hovered;
  c[ImGuiCol_FrameBgActive] = ImVec4(0.235f, 0.268f, 0.318f, 1.0f);
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = c[ImGuiCol_TitleBgCollapsed] = colour::kChrome;
  c[ImGuiCol_MenuBarBg] = colour::kChrome;
  c[ImGuiCol_ScrollbarBg] = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_ScrollbarGrab] = ImVec4(0.28f, 0.31f, 0.37f, 1.0f);
  c[ImGuiCol_ScrollbarGrabHovered] = ImVec4(0.36f, 0.40f, 0.47f, 1.0f);
  c[ImGuiCol_ScrollbarGrabActive] = accentMid;
  c[ImGuiCol_CheckMark] = colour::kAccent;
  c[ImGuiCol_SliderGrab] = accentMid;
  c[ImGuiCol_SliderGrabActive] = colour::kAccent;
  c[ImGuiCol_Button] = ImVec4(0.205f, 0.232f, 0.276f, 1.0f);
  c[ImGuiCol_ButtonHovered] = ImVec4(0.262f, 0.297f, 0.353f, 1.0f);
  c[ImGuiCol_ButtonActive] = accentDim;
  c[ImGuiCol_Header] = ImVec4(0.175f, 0.200f, 0.240f, 1.0f);
  c[ImGuiCol_HeaderHovered] = hovered;
  c[ImGuiCol_HeaderActive] = accentDim;
  c[ImGuiCol_Separator] = colour::kLine;
  c[ImGuiCol_SeparatorHovered] = accentMid;
  c[ImGuiCol_SeparatorActive] = colour::kAccent;
  c[ImGuiCol_ResizeGrip] = ImVec4(0.28f, 0.31f, 0.37f, 0.6f);
  c[ImGuiCol_ResizeGripHovered] = accentMid;
  c[ImGuiCol_ResizeGripActive] = colour::kAccent;
  c[ImGuiCol_PlotHistogram] = accentMid;
  c[ImGuiCol_TextSelectedBg] = ImVec4(0.20f, 0.42f, 0.48f, 0.8f);
  c[ImGuiCol_ModalWindowDimBg] = ImVec4(0.02f, 0.025f, 0.03f, 0.6f);
  c[ImGuiCol_NavHighlight] = colour::kAccent;
}

}  // namespace

bool Theme::hasGlyph(unsigned character) const {
  return regular && regular->FindGlyphNoFallback(static_cast<ImWchar>(character)) != nullptr;
}

Theme applyTheme(float contentScale) {
  Theme theme;
  theme.scale = std::isfinite(contentScale) ? std::clamp(contentScale, 0.75f, 4.0f) : 1.0f;

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
  ImGui::StyleColorsDark(&style);
  setColours(style);
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
