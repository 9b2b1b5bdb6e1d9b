// SPDX-License-Identifier: Apache-2.0
#include "window/chrome.h"

namespace c3de::ui {

void drawQuitQuestion(FrameContext &frame) {
  std::string &toLose = frame.state.toLose;
  if (toLose.empty()) return;
  constexpr const char *kTitle = "Quit C3DE?###quit";
  const bool isNew = !ImGui::IsPopupOpen("###quit");
  if (isNew) ImGui::OpenPopup("###quit");
  ImGui::SetNextWindowPos(
      ImVec2(0.5f * static_cast<float>(frame.windowSize[0]), 0.5f * static_cast<float>(frame.windowSize[1])),
      ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  if (!ImGui::BeginPopupModal(kTitle, nullptr, ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize))
    return;
  ImGui::PushTextWrapPos(frame.theme.px(460.0f));
  ImGui::TextUnformatted(toLose.c_str());
  ImGui::PopTextWrapPos();
  frame.automation.value("quit", "text", toLose);
  const auto isPressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false); };
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.20f, 0.42f, 0.48f, 1.0f));
  const bool quits = ImGui::Button("Quit (Enter)", ImVec2(frame.theme.px(130.0f), 0)) ||
                     (!isNew && (isPressed(ImGuiKey_Enter) || isPressed(ImGuiKey_KeyPadEnter)));
  ImGui::PopStyleColor();
  markItem(frame, "quit", "quit");
  ImGui::SameLine();
  const bool stays = ImGui::Button("Stay (Esc)", ImVec2(frame.theme.px(130.0f), 0)) || isPressed(ImGuiKey_Escape);
  markItem(frame, "quit", "stay");
  if (quits || stays) {
    toLose.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  frame.state.quits = quits;
}

}  // namespace c3de::ui
