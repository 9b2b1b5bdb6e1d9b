// SPDX-License-Identifier: Apache-2.0
// The field above the rows of a panel that filters them.
#include <string>
#include <utility>

#include "panels/imgui_panel.h"

namespace c3de::ui {
namespace {

constexpr const char *kSearchId = "rows.search", *kClearId = "rows.clear";

}  // namespace

bool ImGuiPanels::beginSearch(const FrameContext &frame) {
  SearchedPanel *chosen = nullptr;
  bool isUnderMouse = false;
  for (auto &[id, panel] : searched_) {
    // Only panels that are drawn now: those of the frame before.
    if (panel.frame + 1 < frame.frame) continue;
    const bool isHere = frame.mouseX < frame.area.x && frame.mouseY >= panel.top && frame.mouseY < panel.bottom;
    if (chosen && !isHere && (isUnderMouse || panel.rows.rowCount() <= chosen->rows.rowCount())) continue;
    chosen = &panel;
    isUnderMouse = isHere;
    if (isHere) break;
  }
  if (chosen) chosen->isWanted = true;
  return chosen != nullptr;
}

void ImGuiPanels::drawSearchField(SearchedPanel &panel) {
  const bool isUsed = panel.isWanted || panel.wasFocused || panel.typed.front() != '\0';
  panel.isShown = isUsed || panel.rows.rowCount() >= kManyRows;
  if (!panel.isShown) return;
  takeSameLine(kSearchId);
  const float side = ImGui::GetFrameHeight();
  const bool hasText = panel.typed.front() != '\0';
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - (hasText ? side + ImGui::GetStyle().ItemSpacing.x : 0.0f));
  if (panel.isWanted) ImGui::SetKeyboardFocusHere();
  const bool wasWanted = std::exchange(panel.isWanted, false);
  ImGui::InputTextWithHint("###rows.search", "Search settings (Ctrl+F)", panel.typed.data(), panel.typed.size());
  if (wasWanted) ImGui::SetScrollHereY(0.2f);
  panel.wasFocused = wasWanted || ImGui::IsItemActive();
  const bool isEscaped = ImGui::IsItemDeactivated() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  markItem(*frame_, area_, kSearchId);
  itemTooltip(*frame_, "Shows the rows with all of these words in their name, id or tooltip. Esc clears the field");
  if (hasText) {
    ImGui::SameLine();
    if (iconButton(kClearId, Icon::close, side, colour::kText, true)) panel.typed.fill('\0');
    markItem(*frame_, area_, kClearId);
    itemTooltip(*frame_, "Show all rows");
  }
  if (isEscaped) panel.typed.fill('\0');
  panel.rows.setWords(panel.typed.data());
  frame_->automation.value(area_, kSearchId, panel.typed.data());
}

void ImGuiPanels::drawSearchResult(const RowSearch &rows) {
  if (!rows.isActive()) return;
  const std::string result = rows.matchCount() == 0   ? "No row matches '" + rows.words() + "'."
                             : rows.matchCount() == 1 ? std::string("1 row matches.")
                                                      : std::to_string(rows.matchCount()) + " rows match.";
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextColored(colour::kDim, "%s", result.c_str());
  ImGui::PopTextWrapPos();
  frame_->automation.value(area_, "rows.found", result);
}

}  // namespace c3de::ui
