// SPDX-License-Identifier: Apache-2.0
#include "frame/frame_context.h"

#include "c3de/registry/tool_registry.h"
#include "frame/file_dialog.h"

namespace c3de::ui {

std::string FrameContext::activeToolId() const {
  if (services.tools)
    if (const registry::Tool *tool = services.tools->find(services.tools->active())) return tool->id;
  return "orbit";
}

Modes::Above FrameContext::above() const {
  const ImGuiIO &io = ImGui::GetIO();
  Modes::Above above;
  above.isPopup = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
  above.isFile = fileDialog.isOpen();
  above.isQuestion = state.question.has_value();
  above.isTyping = io.WantTextInput;
  above.takesKeys = io.WantCaptureKeyboard;
  return above;
}

void markItem(const FrameContext &frame, const std::string &area, const std::string &id, bool enabled) {
  markOpener(frame, area, id, false, enabled);
}

void markOpener(const FrameContext &frame, const std::string &area, const std::string &id, bool isOpen, bool enabled) {
  // In its first frame the size of a window is not determined yet, and its contents will move.
  if (!frame.automation.isOn() || ImGui::IsWindowAppearing()) return;
  auto &[rect, clip] = frame.state.openers[area + "/" + id];
  if (!isOpen) {
    const ImVec2 min = ImGui::GetItemRectMin(), max = ImGui::GetItemRectMax();
    const ImVec2 clipMin = ImGui::GetWindowDrawList()->GetClipRectMin();
    const ImVec2 clipMax = ImGui::GetWindowDrawList()->GetClipRectMax();
    rect = {min.x, min.y, max.x, max.y};
    clip = {clipMin.x, clipMin.y, clipMax.x, clipMax.y};
  }
  frame.automation.widget(area, id, rect, clip, enabled);
}

void itemTooltip(const FrameContext &frame, const std::string &text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  TooltipTimer &timer = frame.state.tooltip;
  const ImVec2 min = ImGui::GetItemRectMin();
  const std::array<float, 2> item{min.x, min.y};
  const double now_s = ImGui::GetTime();
  if (item != timer.item || ImGui::IsAnyMouseDown()) timer.since_s = now_s;
  timer.item = item;
  timer.isSeen = true;
  timer.isWaiting = now_s - timer.since_s < kTooltipDelay_s;
  if (timer.isWaiting) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(frame.theme.px(360.0f));
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

std::string elided(const std::string &text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  const std::string dots = "…";
  std::size_t length = text.size();
  while (length > 0) {
    do --length;
    while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u);
    std::string cut = text.substr(0, length) + dots;
    if (ImGui::CalcTextSize(cut.c_str()).x <= width) return cut;
  }
  return dots;
}

}  // namespace c3de::ui
