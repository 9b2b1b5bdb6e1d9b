// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "c3de/abi/log.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/text.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/scene/scene_graph.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

std::string fixedText(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

struct ModeText {
  const char *text;
  ImVec4 tint;
};

ModeText modeText(const SimulationView &simulation) {
  if (!simulation.exists) return {"No simulation", colour::kDim};
  switch (simulation.transport.mode) {
    case C3DE_SIM_PLAYING: return {"Playing", colour::kGood};
    case C3DE_SIM_PAUSED: return {"Paused", colour::kWarn};
    case C3DE_SIM_FAILED: return {"Failed", colour::kError};
    default: return {"Stopped", colour::kDim};
  }
}

void cell(FrameContext &frame, const char *name, const std::string &text, const ImVec4 &tint, float minWidth,
          const char *tooltip) {
  const float begin = ImGui::GetCursorPosX();
  ImGui::TextColored(tint, "%s", text.c_str());
  itemTooltip(frame, tooltip);
  frame.automation.value("status", name, text);
  const float width = std::max(ImGui::CalcTextSize(text.c_str()).x, frame.theme.px(minWidth));
  ImGui::SameLine(begin + width + frame.theme.px(18.0f));
}

/// The active tool; null if none.
const registry::Tool *toolOf(const FrameContext &frame) {
  return frame.services.tools ? frame.services.tools->find(frame.services.tools->active()) : nullptr;
}

/// The effect of the left button with a tool, preceded by a note that nothing moves while the simulation does not play.
std::string hintOf(const FrameContext &frame, const registry::Tool &tool) {
  const std::uint32_t mode = frame.simulation.transport.mode;
  const bool isStill = frame.simulation.exists && (mode == C3DE_SIM_STOPPED || mode == C3DE_SIM_PAUSED);
  const CommandInfo &play = commandInfo(Command::playPause);
  return (isStill ? keyText(play.key, play.modifiers) + " plays the simulation    " : std::string()) + tool.label +
         ": " + tool.hint;
}

/// The effect of the mouse at its position.
std::string hintOf(const FrameContext &frame) {
  const auto isOver = [&](Pane pane) {
    return frame.panes[static_cast<std::size_t>(pane)].contains(frame.mouseX, frame.mouseY);
  };
  if (const ImageViews *images = frame.shownImages();
      images && std::any_of(kSlicePanes.begin(), kSlicePanes.end(), isOver)) {
    if (frame.modes.region() && !images->isPicking() && !images->options().isWindowLevelMode)
      return "Drag: handles move a side, inside moves the box, outside draws another    Click: cross-hair    Wheel: "
             "slices    Middle or Shift+left: pan    Right or Ctrl+wheel: zoom    Ctrl+Z: undo";
    if (const registry::Tool *tool = toolOf(frame); tool && tool->inSlices && !images->isPicking())
      return hintOf(frame, *tool);
    const char *left = images->isPicking()                   ? "Click: pick what is there"
                       : images->options().isWindowLevelMode ? "Left drag: window (sideways), level (upwards)"
                                                             : "Left: cross-hair";
    return std::string(left) +
           "    Wheel: slices (Shift: ten)    Middle or Shift+left: pan    Right or Ctrl+wheel: zoom    Double click: "
           "only this view    R: reset";
  }
  if (frame.state.startPage.isShown && isOver(Pane::space))
    return "Click: open    Arrows, Enter: mark and open a recent file    Right click: menu    H: keys and mouse";
  if (!isOver(Pane::space)) return "H: keys and mouse";
  if (const registry::Tool *tool = toolOf(frame)) return hintOf(frame, *tool);
  return "Left drag: orbit    Middle or Shift+left: pan    Right, Ctrl+left or wheel: zoom    F: fit    R: reset";
}

}  // namespace

void drawStatusBar(FrameContext &frame, const PixelRect &area) {
  beginFixed("##status", area, colour::kChrome, ImVec2(frame.theme.px(12.0f), frame.theme.px(5.0f)),
             ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PushFont(frame.theme.small);
  const SimulationView &simulation = frame.simulation;
  const c3de_sim_transport &t = simulation.transport;
  const ModeText mode = modeText(simulation);

  const ImVec2 dot = ImGui::GetCursorScreenPos();
  const float lineHeight = ImGui::GetTextLineHeight();
  ImGui::GetWindowDrawList()->AddCircleFilled(ImVec2(dot.x + 0.35f * lineHeight, dot.y + 0.55f * lineHeight),
                                              0.28f * lineHeight, ImGui::GetColorU32(mode.tint));
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 1.1f * lineHeight);
  cell(frame, "mode", mode.text, mode.tint, 56, "State of the simulation");
  if (!simulation.recording.empty())
    cell(frame, "recording", "Recording", colour::kError, 60, ("In " + simulation.recording).c_str());
  if (simulation.exists) {
    cell(frame, "time", "t = " + fixedText(t.time_s, 3) + " s", colour::kText, 84, "Simulated time");
    cell(frame, "steps", "step " + std::to_string(t.steps), colour::kDim, 74, "Steps since the initial state");
    const std::string target = t.target_rate > 0.0 ? formatNumber(t.target_rate) + "×" : std::string("max");
    const bool isSlow = t.mode == C3DE_SIM_PLAYING && t.target_rate > 0.0 && t.real_time_factor < 0.9 * t.target_rate;
    const bool hasRate = t.mode == C3DE_SIM_PLAYING;
    cell(frame, "rate",
         !hasRate  ? "target " + target
         : !isSlow ? fixedText(t.real_time_factor, 2) + "× real time (target " + target + ")"
                   : std::string(t.target_rate == 1.0 ? "slower than real time: " : "slower than the target: ") +
                         fixedText(t.real_time_factor, 2) + "×",
         isSlow ? colour::kWarn : colour::kText, 190,
         ("Simulated seconds per second, achieved over the last second of playing; the target is " + target).c_str());
    cell(frame, "step_ms", fixedText(t.step_ms, 2) + " ms/step",
         simulation.isLongStep() ? colour::kWarn : colour::kText, 88,
         "Wall time of a step, mean of the last second; of the present one when that is longer");
  }
  const std::string hint = hintOf(frame);
  const std::string rate =
      frame.framesPerSecond > 0.0 ? fixedText(frame.framesPerSecond, 0) + " fps" : std::string("idle");
  const std::size_t messages = frame.services.panels ? frame.services.panels->log().size() : 0;
  const std::string messagesText = "Messages (" + std::to_string(messages) + ")";
  const float rateAt = ImGui::GetWindowContentRegionMax().x - frame.theme.px(56.0f);
  const float right = rateAt - ImGui::CalcTextSize(messagesText.c_str()).x - frame.theme.px(26.0f);
  const std::string shownHint = elided(hint, right - ImGui::GetCursorPosX() - frame.theme.px(12.0f));
  ImGui::TextColored(colour::kDim, "%s", shownHint.c_str());
  itemTooltip(frame, hint);
  frame.automation.value("status", "hint", hint);
  ImGui::SameLine(right);
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
  ImGui::PushStyleColor(ImGuiCol_Text, colour::kDim);
  if (ImGui::SmallButton(messagesText.c_str())) frame.request(Command::showMessages);
  ImGui::PopStyleColor(2);
  markItem(frame, "status", "messages");
  itemTooltip(frame, commandInfo(Command::showMessages).doc);
  ImGui::SameLine(rateAt);
  ImGui::TextColored(colour::kDim, "%s", rate.c_str());
  itemTooltip(frame, "Frames per second; no frames are drawn while nothing changes");
  ImGui::PopFont();
  ImGui::End();
}

}  // namespace c3de::ui
