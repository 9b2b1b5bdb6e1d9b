// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "c3de/registry/command_registry.h"
#include "c3de/registry/tool_registry.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

void shortcutRow(const std::string &keys, const std::string &label) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextColored(colour::kAccent, "%s", keys.c_str());
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(label.c_str());
}

void heading(const FrameContext &frame, const char *text) {
  ImGui::Dummy(ImVec2(0, frame.theme.px(4.0f)));
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted(text);
  ImGui::PopFont();
}

bool beginRows(const FrameContext &frame, const char *id) {
  if (!ImGui::BeginTable(id, 2)) return false;
  ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, frame.theme.px(170.0f));
  ImGui::TableSetupColumn("what");
  return true;
}

}  // namespace

bool beginDialog(FrameContext &frame, const char *title, const char *id, bool &isShown, ImVec2 size, int flags) {
  if (frame.state.question) return false;  // above all others; the dialog reappears after it
  if (isShown) ImGui::OpenPopup((std::string(title) + "###" + id).c_str());
  ImGui::SetNextWindowSize(ImVec2(std::min(frame.theme.px(size.x), 0.9f * static_cast<float>(frame.windowSize[0])),
                                  std::min(frame.theme.px(size.y), 0.9f * static_cast<float>(frame.windowSize[1]))),
                           ImGuiCond_Appearing);
  ImGui::SetNextWindowPos(
      ImVec2(0.5f * static_cast<float>(frame.windowSize[0]), 0.5f * static_cast<float>(frame.windowSize[1])),
      ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  return ImGui::BeginPopupModal((std::string(title) + "###" + id).c_str(), &isShown,
                                ImGuiWindowFlags_NoSavedSettings | flags);
}

void endDialog(FrameContext &frame, bool &isShown) {
  const bool isClosed = ImGui::Button("Close", ImVec2(frame.theme.px(96.0f), 0));
  markItem(frame, "dialog", "close");
  // In a text field, Escape reverts the typed text.
  const bool isEscaped = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape)) && !frame.modes.isEscapeTaken() &&
                         !ImGui::GetIO().WantTextInput;
  if (isClosed || isEscaped) {
    isShown = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void drawShortcuts(FrameContext &frame) {
  if (!frame.state.showShortcuts) return;
  if (!beginDialog(frame, "Shortcuts", "shortcuts", frame.state.showShortcuts, ImVec2(640, 620))) return;
  ImGui::BeginChild("rows", ImVec2(0, -ImGui::GetFrameHeightWithSpacing() - frame.theme.px(4.0f)));
  heading(frame, "Mouse in the 3D view");
  if (beginRows(frame, "mouse")) {
    shortcutRow("Left drag", "active tool, else orbit");
    shortcutRow("Middle, Shift+left drag", "pan");
    shortcutRow("Right, Ctrl+left drag", "zoom");
    shortcutRow("Wheel", "zoom");
    shortcutRow("Esc", "release what the tool holds");
    ImGui::EndTable();
  }
  heading(frame, "In the slices of an image");
  if (beginRows(frame, "slices")) {
    shortcutRow("Left drag, Shift+move", "cross-hair; W: window and level instead");
    shortcutRow("Double click", "one view, and back (3D view too); the cross-hair stays");
    shortcutRow("Wheel, arrows, F and B", "next and previous slice; with Shift ten");
    shortcutRow("Middle, Shift+left drag", "pan");
    shortcutRow("Right, Ctrl+left drag, Ctrl+wheel", "zoom");
    shortcutRow("T, Shift+T", "next, previous time point");
    for (const WindowLevelPreset &preset : windowLevelPresets())
      shortcutRow(keyText(preset.key, 0), std::string("window/level: ") + preset.name);
    ImGui::EndTable();
  }
  heading(frame, "Keys");
  if (beginRows(frame, "keys")) {
    for (const CommandInfo &info : commands()) {
      if (info.key == 0) continue;
      std::string keys = keyText(info.key, info.modifiers);
      if (info.alternativeKey != 0) keys += " or " + keyText(info.alternativeKey, info.alternativeModifiers);
      shortcutRow(keys, info.doc);
    }
    if (frame.services.tools)
      for (const registry::ToolRegistry::Entry &entry : frame.services.tools->tools())
        if (isFreeForTools(entry.tool->shortcut))
          shortcutRow(keyText(entry.tool->shortcut, 0), entry.tool->label + " tool");
    if (frame.services.commands)
      for (const registry::CommandRegistry::Entry &entry : frame.services.commands->commands())
        if (entry.command->key != 0)
          shortcutRow(keyText(entry.command->key, entry.command->modifiers), entry.command->title);
    ImGui::EndTable();
  }
  heading(frame, "Menus, lists and dialogs");
  if (beginRows(frame, "panels")) {
    shortcutRow("Alt, or Alt and a letter", "open the File menu, or the menu that begins with the letter");
    shortcutRow("Arrows", "move the frame in a menu or dialog");
    shortcutRow("Enter, Space, Esc", "press the marked item; close");
    shortcutRow("Tab", "next text field of a dialog");
    shortcutRow("?", "this list");
    shortcutRow("Ctrl+click on a number", "type an exact value");
    ImGui::EndTable();
  }
  ImGui::EndChild();
  endDialog(frame, frame.state.showShortcuts);
}

void drawAbout(FrameContext &frame) {
  if (!frame.state.showAbout) return;
  if (!beginDialog(frame, "About", "about", frame.state.showAbout, ImVec2(520, 200))) return;
  const AboutText &about = frame.state.about;
  ImGui::BeginChild("text", ImVec2(0, -ImGui::GetFrameHeightWithSpacing() - frame.theme.px(4.0f)));
  ImGui::PushTextWrapPos(0.0f);
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted(about.version.c_str());
  ImGui::PopFont();
  ImGui::TextColored(colour::kDim, "%s", about.graphics.c_str());
  frame.automation.value("about", "version", about.version);
  frame.automation.value("about", "graphics", about.graphics);
  ImGui::PopTextWrapPos();
  ImGui::EndChild();
  endDialog(frame, frame.state.showAbout);
}

}  // namespace c3de::ui
