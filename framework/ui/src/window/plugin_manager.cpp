// SPDX-License-Identifier: Apache-2.0
#include "window/chrome.h"

namespace c3de::ui {
namespace {

ImVec4 colourOf(PluginEntry::State state) {
  switch (state) {
    case PluginEntry::State::loaded: return colour::kGood;
    case PluginEntry::State::refused: return colour::kError;
    case PluginEntry::State::shadowed: return colour::kWarn;
    case PluginEntry::State::off: break;
  }
  return colour::kDim;
}

const char *nameOf(PluginEntry::State state) {
  switch (state) {
    case PluginEntry::State::loaded: return "loaded";
    case PluginEntry::State::refused: return "refused";
    case PluginEntry::State::shadowed: return "shadowed";
    case PluginEntry::State::off: break;
  }
  return "off";
}

void drawEntry(FrameContext &frame, const PluginEntry &plugin) {
  ImGui::PushID(plugin.file.c_str());
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  if (!plugin.id.empty()) {
    bool isOn = plugin.isOn;
    if (ImGui::Checkbox("##on", &isOn) && frame.actions.switchPlugin) frame.actions.switchPlugin(plugin.id, isOn);
    markItem(frame, "plugin", plugin.id);
    itemTooltip(frame, isOn ? "Loaded at each start" : "Stays off");
  }
  ImGui::TableNextColumn();
  ImGui::TextUnformatted((plugin.name + (plugin.version.empty() ? "" : " " + plugin.version)).c_str());
  ImGui::SameLine();
  ImGui::TextColored(colourOf(plugin.state), "%s", nameOf(plugin.state));
  ImGui::PushTextWrapPos(0.0f);
  std::string detail = plugin.id;
  for (const std::string &part : {plugin.vendor, plugin.license})
    if (!part.empty()) detail += (detail.empty() ? "" : ", ") + part;
  if (!detail.empty()) ImGui::TextColored(colour::kDim, "%s", detail.c_str());
  ImGui::TextColored(colour::kDim, "%s", plugin.file.c_str());
  if (!plugin.reason.empty())
    ImGui::TextColored(plugin.state == PluginEntry::State::refused ? colour::kError : colour::kDim, "%s",
                       plugin.reason.c_str());
  if (plugin.crashes > 0)
    ImGui::TextColored(colour::kWarn, "%s %s",
                       plugin.crashes == 1 ? "One run" : (std::to_string(plugin.crashes) + " runs; the last").c_str(),
                       plugin.lastCrash.c_str());
  ImGui::PopTextWrapPos();
  const bool isLoaded = plugin.state == PluginEntry::State::loaded;
  frame.automation.value("plugins", plugin.name,
                         std::string(nameOf(plugin.state)) + (isLoaded ? " " + plugin.version : ": " + plugin.reason));
  ImGui::PopID();
}

}  // namespace

void drawPluginManager(FrameContext &frame) {
  if (!frame.state.showPlugins || !frame.actions.plugins) return;
  if (!beginDialog(frame, "Plugins", "manage_plugins", frame.state.showPlugins, ImVec2(760, 560))) return;
  const std::vector<PluginEntry> plugins = frame.actions.plugins();
  const float below = 2.0f * ImGui::GetFrameHeightWithSpacing() + frame.theme.px(4.0f);
  ImGui::BeginChild("list", ImVec2(0, -below));
  if (plugins.empty()) ImGui::TextColored(colour::kDim, "none found");
  if (!plugins.empty() && ImGui::BeginTable("plugins", 2, ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("on", ImGuiTableColumnFlags_WidthFixed, ImGui::GetFrameHeight());
    ImGui::TableSetupColumn("plugin");
    for (const PluginEntry &plugin : plugins) drawEntry(frame, plugin);
    ImGui::EndTable();
  }
  ImGui::EndChild();
  bool isPending = false;
  for (const PluginEntry &plugin : plugins) isPending = isPending || plugin.hasChanged;
  const char *note = isPending ? "Takes effect at the next start of the program." : "";
  ImGui::TextColored(colour::kWarn, "%s", note);
  frame.automation.value("plugins", "note", note);
  endDialog(frame, frame.state.showPlugins);
}

}  // namespace c3de::ui
