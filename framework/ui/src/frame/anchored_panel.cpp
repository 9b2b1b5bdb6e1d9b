// SPDX-License-Identifier: Apache-2.0
#include "frame/anchored_panel.h"

#include <imgui.h>
#include <imgui_internal.h>  // the scroll of a window without a frame of delay

#include <algorithm>

namespace c3de::ui {

void AnchoredPanel::begin() {
  window_ = ImGui::GetCurrentWindow();
  const ImGuiIO &io = ImGui::GetIO();
  const bool isPressed = ImGui::IsMouseClicked(ImGuiMouseButton_Left) || ImGui::IsMouseClicked(ImGuiMouseButton_Right);
  // While an item is dragged or a list of a row is open, the anchor remains unchanged.
  const bool isTaken = (ImGui::IsAnyMouseDown() && !isPressed) ||
                       ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
  if (!isTaken) mouse_ = window_->InnerRect.Contains(io.MousePos) ? std::optional<double>(io.MousePos.y) : std::nullopt;
  window_->DC.CursorPos.y +=
      static_cast<float>(anchor_.begin(window_->DC.CursorStartPos.y, window_->InnerRect.GetHeight(), mouse_));
  const auto edge = anchor_.edge();
  isClipped_ = edge.has_value();
  if (!isClipped_) return;
  const ImRect clip = window_->ClipRect;
  ImGui::PushClipRect(clip.Min, ImVec2(clip.Max.x, static_cast<float>(*edge)), true);
}

void AnchoredPanel::row(const std::string &key) {
  if (!window_ || ImGui::GetCurrentWindow() != window_) return;
  window_->DC.CursorPos.y += static_cast<float>(anchor_.row(key, window_->DC.CursorPos.y));
  if (isClipped_ && !anchor_.edge()) {
    ImGui::PopClipRect();
    isClipped_ = false;
  }
}

void AnchoredPanel::end() {
  if (isClipped_) ImGui::PopClipRect();
  const auto scroll = static_cast<float>(anchor_.end(window_->Scroll.y));
  window_->Scroll.y = scroll;
  if (mouse_) {
    float &bottom = window_->DC.CursorMaxPos.y;
    bottom = std::max(bottom, window_->DC.CursorStartPos.y + scroll + window_->InnerRect.GetHeight());
  }
  window_ = nullptr;
}

}  // namespace c3de::ui
