// SPDX-License-Identifier: Apache-2.0
#include <imgui_internal.h>  // the focus ring

#include <algorithm>
#include <iterator>
#include <string_view>

#include "c3de/abi/log.h"
#include "c3de/abi/tools.h"
#include "c3de/core/text.h"
#include "c3de/registry/command_registry.h"
#include "c3de/registry/parameter_registry.h"
#include "c3de/registry/tool_registry.h"
#include "window/chrome.h"
#include "window/execute_command.h"

namespace c3de::ui {
namespace {

bool isChecked(const FrameContext &frame, Command command) {
  const ImageViews *images = frame.shownImages();
  const auto isCut = [&](Pane pane) {
    return images && images->options().cuts[static_cast<std::size_t>(pane)] != SliceCut::none;
  };
  switch (command) {
    case Command::fourViews: return images && !images->maximised();
    case Command::onlySpace: return images && images->maximised() == Pane::space;
    case Command::crossHair: return images && images->options().showsCrossHair;
    case Command::windowLevelMode: return images && images->options().isWindowLevelMode;
    case Command::showPlots: return frame.state.plots.isShown;
    case Command::cutAxial: return isCut(Pane::axial);
    case Command::cutSagittal: return isCut(Pane::sagittal);
    case Command::cutCoronal: return isCut(Pane::coronal);
    case Command::orbitTool: return !frame.services.tools || frame.services.tools->active().isNull();
    default: return false;
  }
}

void commandItem(FrameContext &frame, const CommandInfo &info) {
  const bool isEnabled = ui::isEnabled(frame, info);
  const std::string key = keyText(info.key, info.modifiers);
  const char *label = frame.camera.upAxis == render::UpAxis::z && info.patientLabel ? info.patientLabel : info.label;
  if (ImGui::MenuItem(label, key.empty() ? nullptr : key.c_str(), isChecked(frame, info.command), isEnabled))
    frame.request(info.command);
  markItem(frame, "menu", info.id, isEnabled);
  itemTooltip(frame, isEnabled ? info.doc : std::string(info.doc) + "\n" + whyDisabled(frame, info));
}

/// The commands of a menu.
void commandItems(FrameContext &frame, const std::string &menu) {
  for (const CommandInfo &info : commands()) {
    if (!std::string_view(info.id).starts_with(menu + ".")) continue;
    if ((info.flags & beginsGroup) != 0) ImGui::Separator();
    commandItem(frame, info);
    if (info.command == Command::openLabels) drawRecentMenu(frame);
    if (info.command == Command::screenshot) drawScreenshotMenu(frame);
  }
}

/// "Undo Young's modulus": states what it would change.
void editItem(FrameContext &frame, Command command) {
  const CommandInfo &info = commandInfo(command);
  const std::string what = command == Command::undo ? frame.modes.undoLabel() : frame.modes.redoLabel();
  const std::string label = std::string(info.label) + (what.empty() ? "" : " " + what) + "###" + info.id;
  const std::string key = keyText(info.key, info.modifiers);
  std::string whyNot = whyDisabled(frame, info);
  if (whyNot.empty() && what.empty()) whyNot = command == Command::undo ? "Nothing to undo." : "Nothing to redo.";
  if (ImGui::MenuItem(label.c_str(), key.c_str(), false, whyNot.empty())) frame.request(command);
  markItem(frame, "menu", info.id, whyNot.empty());
  itemTooltip(frame, whyNot.empty() ? info.doc : std::string(info.doc) + "\n" + whyNot);
}

/// An arrow has left the open menu to a side, and Dear ImGui has closed it: 1 to the right, -1 to the left, else 0.
int sideMove() {
  ImGuiContext &context = *ImGui::GetCurrentContext();
  if (context.OpenPopupStack.Size > 0 || !context.NavMoveForwardToNextFrame) return 0;
  context.NavMoveForwardToNextFrame = false;
  return context.NavMoveDir == ImGuiDir_Right ? 1 : context.NavMoveDir == ImGuiDir_Left ? -1 : 0;
}

bool beginMenu(FrameContext &frame, const char *label, const char *id) {
  if (frame.state.menuToOpen == id) {
    frame.state.menuToOpen.clear();
    ImGui::OpenPopup(label);
    // The focus ring is there from the start.
    ImGui::GetCurrentContext()->NavDisableHighlight = false;
    ImGui::GetCurrentContext()->NavDisableMouseHover = true;
  }
  const bool isOpen = ImGui::BeginMenu(label);
  markOpener(frame, "menu", id, isOpen);
  return isOpen;
}

void editMenu(FrameContext &frame) {
  editItem(frame, Command::undo);
  editItem(frame, Command::redo);
  ImGui::Separator();
  commandItem(frame, commandInfo(Command::searchPanel));
  ImGui::Separator();
  commandItem(frame, commandInfo(Command::preferences));
}

void simulationMenu(FrameContext &frame) {
  commandItems(frame, "simulation");
  if (!frame.actions.simulators || !frame.actions.chooseSimulator) return;
  const std::vector<SimulatorChoice> choices = frame.actions.simulators();
  if (choices.size() < 2) return;
  ImGui::Separator();
  ImGui::TextDisabled("Simulator for the next scene");
  for (const SimulatorChoice &choice : choices) {
    const std::string label = choice.label + "###" + choice.id;
    const bool isPicked = ImGui::MenuItem(label.c_str(), nullptr, choice.isChosen);
    markItem(frame, "menu", "simulator." + choice.id);
    itemTooltip(frame, choice.id + " of " + choice.plugin);
    if (isPicked) frame.actions.chooseSimulator(choice.id);
  }
}

void toolsMenu(FrameContext &frame) {
  commandItems(frame, "tools");
  registry::ToolRegistry *tools = frame.services.tools;
  if (!tools) return;
  for (const registry::ToolRegistry::Entry &entry : tools->tools()) {
    const std::string key = isFreeForTools(entry.tool->shortcut) ? keyText(entry.tool->shortcut, 0) : std::string();
    const std::string label = entry.tool->label + "###" + entry.tool->id, id = "tools." + entry.tool->id;
    const std::string hint = entry.tool->hint;
    const bool isFree = !frame.simulation.replay;
    const bool isPicked =
        ImGui::MenuItem(label.c_str(), key.empty() ? nullptr : key.c_str(), tools->active() == entry.handle, isFree);
    markItem(frame, "menu", id, isFree);
    itemTooltip(frame, isFree ? hint : kReplayLocks);
    if (isPicked) {
      tools->activate(entry.handle);
      return;  // the list may have changed
    }
  }
}

void pluginsMenu(FrameContext &frame) {
  for (const registry::CommandRegistry::Entry &entry : frame.services.commands->commands()) {
    const registry::PluginCommand &command = *entry.command;
    const std::string key = keyText(command.key, command.modifiers);
    const std::string label = command.title + "###" + command.id, id = "plugins." + command.id;
    const bool isEnabled = command.isEnabled && !frame.simulation.replay;
    const bool isPicked = ImGui::MenuItem(label.c_str(), key.empty() ? nullptr : key.c_str(), false, isEnabled);
    markItem(frame, "menu", id, isEnabled);
    itemTooltip(frame, command.doc.empty() ? "Of " + command.owner : command.doc + " (" + command.owner + ")");
    if (isPicked) return runPluginCommand(frame.services, entry.handle);  // the list may have changed
  }
  if (!frame.services.commands->commands().empty()) ImGui::Separator();
  commandItems(frame, "plugins");
}

void transportButton(FrameContext &frame, const char *id, Command command, Icon icon, const ImVec4 &tint,
                     bool isEnabled, const std::string &doc) {
  const CommandInfo &info = commandInfo(command);
  if (iconButton(id, icon, ImGui::GetFrameHeight() * 1.15f, tint, isEnabled)) frame.request(command);
  markItem(frame, "toolbar", id, isEnabled);
  const std::string key = keyText(info.key, info.modifiers);
  itemTooltip(frame, doc + (key.empty() ? "" : "  (" + key + ")") + (isEnabled ? "" : "\nNothing is loaded."));
  ImGui::SameLine(0.0f, frame.theme.px(4.0f));
}

void rateChoice(FrameContext &frame) {
  static constexpr double kRates[] = {0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 0.0};
  static constexpr const char *kLabels[] = {"1/8×", "1/4×", "1/2×", "1×", "2×", "4×", "8×", "max"};
  const double rate = frame.simulation.transport.target_rate;
  const auto *known = std::find(std::begin(kRates), std::end(kRates), rate);
  const std::string shown = known != std::end(kRates) ? kLabels[known - std::begin(kRates)] : formatNumber(rate) + "×";
  ImGui::BeginDisabled(!frame.simulation.exists);
  ImGui::SetNextItemWidth(frame.theme.px(78.0f));
  const bool isOpen = ImGui::BeginCombo("##rate", frame.simulation.exists ? shown.c_str() : "1×");
  markOpener(frame, "toolbar", "rate", isOpen, frame.simulation.exists);
  if (isOpen) {
    for (std::size_t i = 0; i < std::size(kRates); ++i) {
      if (ImGui::Selectable(kLabels[i], kRates[i] == rate) && frame.actions.setTargetRate)
        frame.actions.setTargetRate(kRates[i]);
      markItem(frame, "toolbar", std::string("rate.option.") + kLabels[i]);
    }
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  itemTooltip(frame, "Target rate: simulated seconds per second. 1× is real time, max is as fast as possible.");
}

void separator(const FrameContext &frame) {
  ImGui::SameLine(0.0f, frame.theme.px(12.0f));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = ImGui::GetFrameHeight() * 1.15f;
  ImGui::GetWindowDrawList()->AddLine(ImVec2(at.x, at.y + 3), ImVec2(at.x, at.y + height - 3),
                                      ImGui::GetColorU32(colour::kLine));
  ImGui::Dummy(ImVec2(1, height));
  ImGui::SameLine(0.0f, frame.theme.px(12.0f));
}

bool toolButton(FrameContext &frame, const std::string &id, const std::string &label, bool isActive,
                const std::string &tooltip, bool isEnabled = true) {
  const ImVec4 on = colour::kPrimary;
  if (isActive) {
    ImGui::PushStyleColor(ImGuiCol_Button, on);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, colour::kPrimaryHovered);
  }
  ImGui::BeginDisabled(!isEnabled);
  const bool isPressed = ImGui::Button((label + "###" + id).c_str(), ImVec2(0, ImGui::GetFrameHeight() * 1.15f));
  ImGui::EndDisabled();
  if (isActive) ImGui::PopStyleColor(2);
  markItem(frame, "toolbar", id, isEnabled);
  itemTooltip(frame, tooltip);
  ImGui::SameLine(0.0f, frame.theme.px(4.0f));
  return isPressed;
}

void toolButtons(FrameContext &frame) {
  registry::ToolRegistry *tools = frame.services.tools;
  const bool isOrbit = !tools || tools->active().isNull();
  if (toolButton(frame, "tool.orbit", "Orbit", isOrbit, "The left button turns the camera  (O)"))
    frame.request(Command::orbitTool);
  if (!tools) return;
  const bool isFree = !frame.simulation.replay;
  for (const registry::ToolRegistry::Entry &entry : tools->tools()) {
    const std::string key = isFreeForTools(entry.tool->shortcut) ? "  (" + keyText(entry.tool->shortcut, 0) + ")" : "";
    if (toolButton(frame, "tool." + entry.tool->id, entry.tool->label, tools->active() == entry.handle,
                   isFree ? entry.tool->hint + key : kReplayLocks, isFree)) {
      tools->activate(entry.handle);
      return;  // the list may have changed
    }
  }
}

}  // namespace

void beginFixed(const char *name, const PixelRect &area, const ImVec4 &background, ImVec2 padding, int extraFlags) {
  ImGui::SetNextWindowPos(ImVec2(area.x, area.y));
  ImGui::SetNextWindowSize(ImVec2(std::max(area.w, 1.0f), std::max(area.h, 1.0f)));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, background);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  // An area that appears automatically must not end a drag or typing in another one: it takes no focus.
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing | extraFlags);
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
}

void runPluginCommand(const WindowServices &services, Handle command) {
  const registry::PluginCommand *found = services.commands->find(command);
  if (!found) return;
  const std::string title = found->title;
  const registry::CommandResult result = services.commands->run(command);
  if (result.status < 0 && services.panels) services.panels->notify(C3DE_LOG_ERROR, title, result.text);
}

float drawMenuBar(FrameContext &frame) {
  struct Menu {
    const char *label, *id;
    void (*draw)(FrameContext &frame) = nullptr;  ///< null: only its commands
  };
  static constexpr Menu kMenus[] = {{"File", "file"},
                                    {"Edit", "edit", editMenu},
                                    {"View", "view"},
                                    {"Simulation", "simulation", simulationMenu},
                                    {"Tools", "tools", toolsMenu},
                                    {"Plugins", "plugins", pluginsMenu},
                                    {"Help", "help"}};
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.theme.px(8.0f), frame.theme.px(5.0f)));
  float height = 0.0f;
  if (ImGui::BeginMainMenuBar()) {
    height = ImGui::GetWindowSize().y;
    ImGui::PopStyleVar();
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.theme.px(8.0f), frame.theme.px(4.0f)));
    const Menu *open = nullptr;
    for (const Menu &menu : kMenus) {
      if (menu.draw == pluginsMenu && !frame.services.commands) continue;
      if (!beginMenu(frame, menu.label, menu.id)) continue;
      open = &menu;
      if (menu.draw)
        menu.draw(frame);
      else
        commandItems(frame, menu.id);
      ImGui::EndMenu();
    }
    ImGui::EndMainMenuBar();
    const int side = open ? sideMove() : 0;
    const auto count = static_cast<std::ptrdiff_t>(std::size(kMenus));
    if (side != 0) frame.state.menuToOpen = kMenus[(open - kMenus + side + count) % count].id;
  }
  ImGui::PopStyleVar();
  return height;
}

void drawToolbar(FrameContext &frame, const PixelRect &area) {
  beginFixed("##toolbar", area, colour::kChrome, ImVec2(frame.theme.px(10.0f), frame.theme.px(5.0f)),
             ImGuiWindowFlags_NoScrollWithMouse);
  const bool exists = frame.simulation.exists;
  const std::uint32_t mode = frame.simulation.transport.mode;
  const bool isPlaying = exists && mode == C3DE_SIM_PLAYING, hasFailed = exists && mode == C3DE_SIM_FAILED;
  transportButton(frame, "play", Command::playPause, isPlaying ? Icon::pause : Icon::play,
                  isPlaying ? colour::kWarn : colour::kGood, exists && !hasFailed,
                  isPlaying                 ? "Pause"
                  : mode == C3DE_SIM_PAUSED ? "Continue"
                                            : "Play");
  transportButton(frame, "step", Command::step, Icon::step, colour::kText, exists && !hasFailed,
                  commandInfo(Command::step).doc);
  transportButton(frame, "reset", Command::reset, Icon::reset, colour::kText, exists, commandInfo(Command::reset).doc);
  transportButton(frame, "stop", Command::stop, Icon::stop, colour::kText, exists, commandInfo(Command::stop).doc);
  ImGui::SameLine(0.0f, frame.theme.px(10.0f));
  // As tall as the buttons next to it.
  ImGui::PushStyleVar(
      ImGuiStyleVar_FramePadding,
      ImVec2(ImGui::GetStyle().FramePadding.x, 0.5f * (1.15f * ImGui::GetFrameHeight() - ImGui::GetFontSize())));
  rateChoice(frame);
  ImGui::PopStyleVar();
  separator(frame);
  toolButtons(frame);
  if (const ImageViews *images = frame.shownImages()) {
    separator(frame);
    const bool isOn = images->options().isWindowLevelMode;
    if (toolButton(frame, "slices.cross_hair", "Cross-hair", !isOn,
                   "The left button sets the cross-hair in slices  (W)") &&
        isOn)
      frame.request(Command::windowLevelMode);
    if (toolButton(frame, "slices.window_level", "W/L", isOn,
                   std::string(commandInfo(Command::windowLevelMode).doc) + "  (W)") &&
        !isOn)
      frame.request(Command::windowLevelMode);
  }
  ImGui::End();
}

}  // namespace c3de::ui
