// SPDX-License-Identifier: Apache-2.0
#include "window/chrome.h"

namespace c3de::ui {

void drawQuestion(FrameContext &frame) {
  if (!frame.state.question) return;
  const Question &question = *frame.state.question;
  const std::string popup = question.title + "###question";
  const bool isNew = !ImGui::IsPopupOpen("###question");
  if (isNew) ImGui::OpenPopup("###question");
  ImGui::SetNextWindowPos(
      ImVec2(0.5f * static_cast<float>(frame.windowSize[0]), 0.5f * static_cast<float>(frame.windowSize[1])),
      ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  if (!ImGui::BeginPopupModal(popup.c_str(), nullptr,
                              ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize))
    return;
  ImGui::PushTextWrapPos(frame.theme.px(460.0f));
  ImGui::TextUnformatted(question.text.c_str());
  ImGui::PopTextWrapPos();
  frame.automation.value(question.id, "text", question.text);
  const auto isPressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false); };
  std::optional<std::size_t> answer;
  for (std::size_t i = 0; i < question.answers.size(); ++i) {
    const bool isFirst = i == 0, isLast = i + 1 == question.answers.size();
    if (!isFirst) ImGui::SameLine();
    if (isFirst) ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
    const std::string label = question.answers[i].label + (isFirst ? " (Enter)" : isLast ? " (Esc)" : "");
    if (ImGui::Button(label.c_str(), ImVec2(frame.theme.px(130.0f), 0))) answer = i;
    if (isFirst) ImGui::PopStyleColor();
    markItem(frame, question.id, question.answers[i].id);
  }
  // The key press that opened the question does not answer it. With the focus ring, Enter presses what it is around.
  if (!isNew && !ImGui::GetIO().NavVisible && (isPressed(ImGuiKey_Enter) || isPressed(ImGuiKey_KeyPadEnter)))
    answer = 0;
  if (isPressed(ImGuiKey_Escape)) answer = question.answers.size() - 1;
  if (answer) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  if (!answer) return;
  frame.state.answer = {question.id, question.answers[*answer].id};
  frame.state.question.reset();
}

}  // namespace c3de::ui
