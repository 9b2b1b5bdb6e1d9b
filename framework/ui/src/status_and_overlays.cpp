// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "c3de/abi/draft/log.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/text.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/ui/panel_registry.h"
#include "c3de/ui/tool_registry.h"
#include "chrome.h"

namespace c3de::ui {
namespace {

constexpr std::size_t kNotificationsShown = 4;
constexpr double kInfoStays_s = 20.0;
/// What ends sooner would only flicker.
constexpr double kQuietJob_s = 0.25;

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

ImVec4 severityTint(std::uint32_t severity) {
  if (severity >= C3DE_LOG_ERROR) return colour::kError;
  if (severity == C3DE_LOG_WARN) return colour::kWarn;
  return colour::kAccent;
}

void rememberOverlay(FrameContext &frame) {
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  frame.state.overlays.push_back({at.x, at.y, size.x, size.y});
}

/// A box over the view; its height follows from what is in it.
void beginOverlay(FrameContext &frame, const std::string &name, ImVec2 at, ImVec2 pivot, float width) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, 4096));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, frame.theme.px(5.0f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.theme.px(14.0f), frame.theme.px(10.0f)));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImVec4(0.145f, 0.162f, 0.193f, 0.97f));
  ImGui::Begin(name.c_str(), nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoScrollbar);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar(3);
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
  if (simulation.exists) {
    cell(frame, "time", "t = " + fixedText(t.time_s, 3) + " s", colour::kText, 84, "Simulated time");
    cell(frame, "steps", "step " + std::to_string(t.steps), colour::kDim, 74, "Steps since the initial state");
    const std::string target = t.target_rate > 0.0 ? formatNumber(t.target_rate) + "×" : std::string("max");
    const bool isSlow = t.mode == C3DE_SIM_PLAYING && t.target_rate > 0.0 && t.real_time_factor < 0.9 * t.target_rate;
    const bool hasRate = t.mode == C3DE_SIM_PLAYING;
    cell(frame, "rate", hasRate ? fixedText(t.real_time_factor, 2) + "× real time (target " + target + ")" : "target " + target,
         isSlow ? colour::kWarn : colour::kText, 190,
         "Simulated seconds per second, achieved over the last second of playing, and aimed at");
    cell(frame, "step_ms", fixedText(t.step_ms, 2) + " ms/step", simulation.isLongStep() ? colour::kWarn : colour::kText, 88,
         "Wall time of a step, mean of the last second; of the present one when that is longer");
  }
  std::string hint = "Left drag: orbit    Middle or Shift+left: pan    Right, Ctrl+left or wheel: zoom    F: fit";
  if (frame.services.tools)
    if (const Tool *tool = frame.services.tools->find(frame.services.tools->active())) hint = tool->label + ": " + tool->hint;
  const std::string rate = frame.framesPerSecond > 0.0 ? fixedText(frame.framesPerSecond, 0) + " fps" : std::string("idle");
  const float right = ImGui::GetWindowContentRegionMax().x - frame.theme.px(56.0f);
  const std::string shownHint = elided(hint, right - ImGui::GetCursorPosX() - frame.theme.px(12.0f));
  ImGui::TextColored(colour::kDim, "%s", shownHint.c_str());
  itemTooltip(frame, hint);
  frame.automation.value("status", "hint", hint);
  ImGui::SameLine(right);
  ImGui::TextColored(colour::kDim, "%s", rate.c_str());
  itemTooltip(frame, "Frames drawn per second; nothing is drawn while nothing changes");
  ImGui::PopFont();
  ImGui::End();
}

void drawViewDecorations(FrameContext &frame) {
  if (frame.view.isEmpty()) return;
  ImDrawList *list = ImGui::GetBackgroundDrawList();
  const PixelRect &view = frame.view;
  list->PushClipRect(ImVec2(view.x, view.y), ImVec2(view.x + view.w, view.y + view.h));

  // World axes as the camera sees them; nearer ends are drawn last.
  struct Axis {
    Vec3 direction;
    const char *name;
    ImU32 tint;
  };
  std::array<Axis, 3> axes{{{{1, 0, 0}, "x", IM_COL32(224, 92, 92, 255)},
                            {{0, 1, 0}, "y", IM_COL32(116, 190, 104, 255)},
                            {{0, 0, 1}, "z", IM_COL32(98, 148, 232, 255)}}};
  const Vec3 right = frame.camera.right(), up = frame.camera.up(), forward = frame.camera.forward();
  std::sort(axes.begin(), axes.end(),
            [&](const Axis &a, const Axis &b) { return dot(a.direction, forward) > dot(b.direction, forward); });
  const float length = frame.theme.px(30.0f);
  const ImVec2 origin(view.x + frame.theme.px(48.0f), view.y + view.h - frame.theme.px(48.0f));
  for (const Axis &axis : axes) {
    const auto dx = static_cast<float>(dot(axis.direction, right)), dy = static_cast<float>(-dot(axis.direction, up));
    const ImVec2 tip(origin.x + dx * length, origin.y + dy * length);
    list->AddLine(origin, tip, axis.tint, frame.theme.px(2.0f));
    const ImVec2 size = ImGui::CalcTextSize(axis.name);
    list->AddText(ImVec2(origin.x + dx * 1.35f * length - 0.5f * size.x, origin.y + dy * 1.35f * length - 0.5f * size.y),
                  axis.tint, axis.name);
  }

  const bool isEmpty = !frame.simulation.exists && (!frame.services.scene || frame.services.scene->rows().empty());
  const bool isBusy = frame.services.jobs && !frame.services.jobs->running().empty();
  if (isEmpty && !isBusy) {
    const char *const lines[] = {"Open an image (Ctrl+I), a mesh (Ctrl+M) or a scene (Ctrl+O),", "or drop a file here"};
    float y = view.y + 0.45f * view.h;
    for (const char *line : lines) {
      const ImVec2 size = ImGui::CalcTextSize(line);
      list->AddText(ImVec2(view.x + 0.5f * (view.w - size.x), y), ImGui::GetColorU32(colour::kDim), line);
      y += 1.4f * size.y;
    }
  }
  if (frame.simulation.exists && !frame.simulation.title.empty())
    list->AddText(frame.theme.bold, frame.theme.bold->FontSize, ImVec2(view.x + frame.theme.px(14.0f), view.y + frame.theme.px(10.0f)),
                  ImGui::GetColorU32(colour::kText), frame.simulation.title.c_str());
  list->PopClipRect();
}

void drawNotifications(FrameContext &frame) {
  PanelRegistry *panels = frame.services.panels;
  if (!panels) return;
  const std::vector<Notification> notifications = panels->notifications();
  const float width = std::min(frame.theme.px(400.0f), 0.8f * frame.area.w);
  float y = frame.area.y + frame.theme.px(12.0f);
  std::size_t shown = 0;
  // The newest stands on top.
  for (auto it = notifications.rbegin(); it != notifications.rend() && shown < kNotificationsShown; ++it, ++shown) {
    const Notification &n = *it;
    beginOverlay(frame, "##notification" + std::to_string(n.serial),
                 ImVec2(frame.area.x + frame.area.w - frame.theme.px(12.0f), y), ImVec2(1, 0), width);
    const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    ImDrawList *list = ImGui::GetWindowDrawList();
    list->PushClipRect(at, ImVec2(at.x + frame.theme.px(4.0f), at.y + size.y));
    list->AddRectFilled(at, ImVec2(at.x + frame.theme.px(10.0f), at.y + size.y),
                        ImGui::GetColorU32(severityTint(n.severity)), frame.theme.px(5.0f));
    list->PopClipRect();
    const std::string index = std::to_string(shown);
    ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
    const float buttonSize = ImGui::GetFrameHeight(), contentWidth = ImGui::GetContentRegionAvail().x;
    ImGui::PushFont(frame.theme.bold);
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(severityTint(n.severity), "%s", elided(n.title, contentWidth - buttonSize).c_str());
    ImGui::PopFont();
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - buttonSize);
    const bool isClosed = iconButton("close", Icon::close, buttonSize, colour::kDim, true);
    markItem(frame, "notification", "close." + index);
    ImGui::PopStyleColor();
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(n.text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PushFont(frame.theme.small);
    if (ImGui::SmallButton("Copy")) ImGui::SetClipboardText((n.title + "\n" + n.text).c_str());
    markItem(frame, "notification", "copy." + index);
    ImGui::PopFont();
    rememberOverlay(frame);
    y += ImGui::GetWindowSize().y + frame.theme.px(8.0f);
    // What only informs goes by itself, but not from under the mouse.
    double &since_s = frame.state.notificationsSince_s.try_emplace(n.serial, ImGui::GetTime()).first->second;
    if (ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows)) since_s = ImGui::GetTime();
    const bool isOver = n.severity <= C3DE_LOG_INFO && ImGui::GetTime() - since_s > kInfoStays_s;
    ImGui::End();
    if (isClosed || isOver) panels->dismiss(n.serial);
  }
  std::erase_if(frame.state.notificationsSince_s, [&](const auto &seen) {
    return std::none_of(notifications.begin(), notifications.end(), [&](const Notification &n) { return n.serial == seen.first; });
  });
  if (notifications.size() > kNotificationsShown) {
    const std::string more = "and " + std::to_string(notifications.size() - kNotificationsShown) + " more";
    const float textWidth = ImGui::CalcTextSize(more.c_str()).x;
    ImGui::GetBackgroundDrawList()->AddText(
        ImVec2(frame.area.x + frame.area.w - textWidth - frame.theme.px(16.0f), y), ImGui::GetColorU32(colour::kDim), more.c_str());
  }
}

void drawLongStep(FrameContext &frame) {
  if (!frame.simulation.isLongStep()) return;
  const std::string title = "Step running for " + fixedText(frame.simulation.transport.step_running_s, 1) + " s";
  const std::string hint = "Esc pauses, R goes back to the initial state";
  beginOverlay(frame, "##longstep",
               ImVec2(frame.area.x + frame.theme.px(12.0f), frame.area.y + frame.area.h - frame.theme.px(12.0f)), ImVec2(0, 1),
               std::min(frame.theme.px(400.0f), 0.8f * frame.area.w));
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextColored(colour::kWarn, "%s", title.c_str());
  ImGui::PopFont();
  ImGui::PushTextWrapPos(0.0f);
  if (!frame.simulation.activity.empty()) ImGui::TextUnformatted(frame.simulation.activity.c_str());
  ImGui::TextColored(colour::kDim, "%s", hint.c_str());
  ImGui::PopTextWrapPos();
  rememberOverlay(frame);
  frame.automation.value("status", "long_step", title + ": " + frame.simulation.activity);
  ImGui::End();
}

void drawJobs(FrameContext &frame) {
  if (!frame.services.jobs) return;
  float y = frame.area.y + frame.area.h - frame.theme.px(12.0f);
  std::size_t index = 0;
  for (const BackgroundJobs::Status &job : frame.services.jobs->running()) {
    if (job.age_s < kQuietJob_s) continue;
    beginOverlay(frame, "##job" + std::to_string(job.handle.bits()),
                 ImVec2(frame.area.x + frame.area.w - frame.theme.px(12.0f), y), ImVec2(1, 1),
                 std::min(frame.theme.px(340.0f), 0.8f * frame.area.w));
    const float buttonWidth = frame.theme.px(76.0f), contentWidth = ImGui::GetContentRegionAvail().x;
    ImGui::PushFont(frame.theme.bold);
    ImGui::TextUnformatted(elided(job.title, contentWidth).c_str());
    ImGui::PopFont();
    ImGui::TextColored(colour::kDim, "%s", elided(job.cancelling ? "stopping…" : job.what.empty() ? "…" : job.what, contentWidth).c_str());
    const bool isKnown = job.fraction >= 0.0;
    const auto fraction = static_cast<float>(isKnown ? std::min(job.fraction, 1.0) : 0.5 + 0.5 * std::sin(3.0 * ImGui::GetTime()));
    ImGui::ProgressBar(fraction, ImVec2(contentWidth - buttonWidth - ImGui::GetStyle().ItemSpacing.x, ImGui::GetFrameHeight()),
                       isKnown ? (fixedText(100.0 * job.fraction, 0) + " %").c_str() : "");
    ImGui::SameLine();
    ImGui::BeginDisabled(job.cancelling);
    if (ImGui::Button("Cancel", ImVec2(buttonWidth, 0))) frame.services.jobs->cancel(job.handle);
    markItem(frame, "job", "cancel." + std::to_string(index), !job.cancelling);
    ImGui::EndDisabled();
    rememberOverlay(frame);
    y -= ImGui::GetWindowSize().y + frame.theme.px(8.0f);
    ImGui::End();
    ++index;
  }
}

}  // namespace c3de::ui
