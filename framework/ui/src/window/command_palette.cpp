// SPDX-License-Identifier: Apache-2.0
// Commands of the program, commands of plugins and tools in one list, found by words.
#include <algorithm>
#include <functional>
#include <utility>

#include "c3de/registry/command_registry.h"
#include "c3de/registry/tool_registry.h"
#include "logic/row_search.h"
#include "window/chrome.h"
#include "window/execute_command.h"

namespace c3de::ui {
namespace {

constexpr const char *kArea = "palette";

/// A line of the list.
struct Found {
  std::string id, label, keys, doc;
  std::string whyNot;  ///< why it is disabled; empty: it is enabled
  std::function<void()> run;
  [[nodiscard]] bool isEnabled() const { return whyNot.empty(); }
};

/// "File" of "file.save_session".
std::string menuOf(const char *id) {
  std::string menu(id, std::string_view(id).find('.'));
  menu.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(menu.front())));
  return menu;
}

std::vector<Found> allCommands(FrameContext &frame) {
  std::vector<Found> all;
  for (const CommandInfo &info : commands()) {
    if (info.command == Command::findCommand) continue;
    all.push_back({info.id, menuOf(info.id) + ": " + info.label, keyText(info.key, info.modifiers), info.doc,
                   whyDisabled(frame, info), [&frame, command = info.command] { frame.request(command); }});
  }
  const std::string locked = frame.simulation.replay ? kReplayLocks : "";
  if (registry::ToolRegistry *tools = frame.services.tools)
    for (const registry::ToolRegistry::Entry &entry : tools->tools())
      all.push_back({"tools." + entry.tool->id, "Tools: " + entry.tool->label,
                     isFreeForTools(entry.tool->shortcut) ? keyText(entry.tool->shortcut, 0) : std::string(),
                     entry.tool->hint, locked, [tools, handle = entry.handle] { tools->activate(handle); }});
  if (frame.services.commands)
    for (const registry::CommandRegistry::Entry &entry : frame.services.commands->commands()) {
      const registry::PluginCommand &command = *entry.command;
      all.push_back({"plugins." + command.id, "Plugins: " + command.title, keyText(command.key, command.modifiers),
                     command.doc.empty() ? "Of " + command.owner : command.doc,
                     !locked.empty() || command.isEnabled ? locked : "The plugin has disabled this command.",
                     [&frame, handle = entry.handle] { runPluginCommand(frame.services, handle); }});
    }
  return all;
}

/// Those that contain all words: what can be executed first, then those with the words in their names.
std::vector<Found> matches(FrameContext &frame) {
  std::vector<Found> all = allCommands(frame);
  std::erase_if(all, [&](const Found &one) {
    return !containsWords(one.label + " " + one.doc + " " + one.id, frame.state.palette.words.data());
  });
  const auto rankOf = [&](const Found &one) {
    return (one.isEnabled() ? 0 : 2) + (containsWords(one.label, frame.state.palette.words.data()) ? 0 : 1);
  };
  std::stable_sort(all.begin(), all.end(), [&](const Found &a, const Found &b) { return rankOf(a) < rankOf(b); });
  return all;
}

/// Without the selection of the whole text that a field gets with the keyboard.
int placeCursorAtEnd(ImGuiInputTextCallbackData *data) {
  bool &isWanted = *static_cast<bool *>(data->UserData);
  if (std::exchange(isWanted, false)) data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
  return 0;
}

/// @return whether it was clicked
bool drawRow(FrameContext &frame, const Found &one, bool isChosen, bool scrolls) {
  const bool isClicked =
      ImGui::Selectable((one.label + "###" + one.id).c_str(), isChosen,
                        ImGuiSelectableFlags_DontClosePopups | (one.isEnabled() ? 0 : ImGuiSelectableFlags_Disabled));
  markItem(frame, kArea, one.id, one.isEnabled());
  if (isChosen && scrolls) ImGui::SetScrollHereY();
  itemTooltip(frame, one.isEnabled() ? one.doc : one.doc + "\n" + one.whyNot);
  ImGui::SameLine(ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(one.keys.c_str()).x);
  ImGui::TextColored(colour::kDim, "%s", one.keys.c_str());
  return isClicked;
}

}  // namespace

void drawCommandPalette(FrameContext &frame) {
  CommandPalette &palette = frame.state.palette;
  if (!palette.isShown) return;
  if (!beginDialog(frame, "Find a command", "find_command", palette.isShown, ImVec2(560, 420),
                   ImGuiWindowFlags_NoNavInputs))
    return;
  const auto isPressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); };
  if (ImGui::IsWindowAppearing() || std::exchange(palette.isFieldLeft, false)) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0f);
  if (ImGui::InputTextWithHint("###words", "Name or description", palette.words.data(), palette.words.size(),
                               ImGuiInputTextFlags_CallbackAlways, &placeCursorAtEnd, &palette.placesCursor))
    palette.chosen = 0;
  markItem(frame, kArea, "words");
  frame.automation.value(kArea, "typing", ImGui::IsItemActive() ? "true" : "false");
  std::vector<Found> found = matches(frame);
  const bool isMoved = isPressed(ImGuiKey_DownArrow) || isPressed(ImGuiKey_UpArrow);
  if (isPressed(ImGuiKey_DownArrow)) ++palette.chosen;
  if (isPressed(ImGuiKey_UpArrow) && palette.chosen > 0) --palette.chosen;
  palette.chosen = std::min(palette.chosen, found.empty() ? 0 : found.size() - 1);
  const Found *run = nullptr;
  ImGui::BeginChild("found", ImVec2(0, -ImGui::GetFrameHeightWithSpacing() - ImGui::GetTextLineHeightWithSpacing() -
                                           frame.theme.px(4.0f)));
  for (std::size_t i = 0; i < found.size(); ++i)
    if (drawRow(frame, found[i], i == palette.chosen, isMoved)) run = &found[i];
  if (found.empty()) ImGui::TextColored(colour::kDim, "No command matches.");
  ImGui::EndChild();
  const bool isEntered = isPressed(ImGuiKey_Enter) || isPressed(ImGuiKey_KeyPadEnter);
  if (isEntered && !found.empty() && found[palette.chosen].isEnabled()) run = &found[palette.chosen];
  if (isEntered && !run) palette.isFieldLeft = palette.placesCursor = true;  // Enter ends the typing in a field
  const std::string whyNot = found.empty() ? std::string() : found[palette.chosen].whyNot;
  ImGui::TextColored(colour::kWarn, "%s", elided(whyNot, ImGui::GetContentRegionAvail().x).c_str());
  frame.automation.value(kArea, "why_not", whyNot);
  frame.automation.value(kArea, "found", std::to_string(found.size()));
  frame.automation.value(kArea, "chosen", found.empty() ? std::string() : found[palette.chosen].id);
  const bool isEscaped = isPressed(ImGuiKey_Escape) && !frame.modes.isEscapeTaken();
  const bool isClosed = ImGui::Button("Close", ImVec2(frame.theme.px(96.0f), 0));
  markItem(frame, "dialog", "close");
  if (run || isEscaped || isClosed) {
    palette.isShown = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
  if (run) run->run();
}

}  // namespace c3de::ui
