// SPDX-License-Identifier: Apache-2.0
// Messages and running jobs below the panels, and the list of all messages.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/abi/log.h"
#include "c3de/core/background_jobs.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/plain_words.h"
#include "frame/dock.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr std::size_t kShown = 4;
constexpr double kInfoStays_s = 20.0, kWarningStays_s = 90.0;
/// Jobs that end sooner would only flicker.
constexpr double kQuietJob_s = 0.25;

ImVec4 severityTint(std::uint32_t severity) {
  if (severity >= C3DE_LOG_ERROR) return colour::kError;
  if (severity == C3DE_LOG_WARN) return colour::kWarn;
  return colour::kAccent;
}

void copyButton(const FrameContext &frame, const registry::Notification &n, const std::string &id) {
  ImGui::PushFont(frame.theme.small);
  if (ImGui::SmallButton("Copy")) ImGui::SetClipboardText((n.title + "\n" + n.text).c_str());
  ImGui::PopFont();
  markItem(frame, "notification", "copy." + id);
}

/// The choices of a message; returns the chosen one.
const registry::Choice *choice(const FrameContext &frame, const registry::Notification &n, const std::string &id) {
  const registry::Choice *chosen = nullptr;
  for (std::size_t i = 0; i < n.choices.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::SmallButton(n.choices[i].label.c_str())) chosen = &n.choices[i];
    ImGui::PopID();
    markItem(frame, "notification", "choose." + id + "." + std::to_string(i));
    ImGui::SameLine();
  }
  return chosen;
}

/// True if it was closed.
bool message(const FrameContext &frame, const registry::Notification &n, const std::string &index) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::BeginGroup();
  ImGui::Indent(frame.theme.px(10.0f));
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0, 0, 0, 0));
  const float buttonSize = ImGui::GetFrameHeight();
  ImGui::PushFont(frame.theme.bold);
  ImGui::AlignTextToFramePadding();
  ImGui::PushTextWrapPos(ImGui::GetWindowContentRegionMax().x - buttonSize - frame.theme.px(4.0f));
  ImGui::TextColored(severityTint(n.severity), "%s", n.title.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - buttonSize);
  const bool isClosed = iconButton("close", Icon::close, buttonSize, colour::kDim, true);
  markItem(frame, "notification", "close." + index);
  ImGui::PopStyleColor();
  ImGui::PushTextWrapPos(0.0f);
  ImGui::TextUnformatted(n.text.c_str());
  ImGui::PopTextWrapPos();
  const registry::Choice *chosen = choice(frame, n, index);
  copyButton(frame, n, index);
  ImGui::Unindent(frame.theme.px(10.0f));
  ImGui::EndGroup();
  ImGui::GetWindowDrawList()->AddRectFilled(at, ImVec2(at.x + frame.theme.px(4.0f), ImGui::GetItemRectMax().y),
                                            ImGui::GetColorU32(severityTint(n.severity)), frame.theme.px(2.0f));
  ImGui::Dummy(ImVec2(0, frame.theme.px(4.0f)));
  if (chosen) chosen->act();
  return isClosed || chosen;
}

void messages(FrameContext &frame) {
  registry::PanelRegistry *panels = frame.services.panels;
  if (!panels) return;
  Dock &dock = frame.state.dock;
  const std::vector<registry::Notification> all = panels->notifications();
  const double now_s = ImGui::GetTime();
  const bool isLookedAt =
      ImGui::IsWindowHovered(ImGuiHoveredFlags_ChildWindows | ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
  std::size_t shown = 0;
  // The newest is on top.
  for (auto it = all.rbegin(); it != all.rend(); ++it) {
    const registry::Notification &n = *it;
    // Messages disappear automatically, but not from under the mouse; the list keeps them.
    double &since_s = dock.since_s.try_emplace(n.serial, now_s).first->second;
    if (isLookedAt) since_s = now_s;
    const double left_s = since_s + (n.severity <= C3DE_LOG_INFO ? kInfoStays_s : kWarningStays_s) - now_s;
    bool isClosed = left_s <= 0.0;
    if (shown < kShown) {
      ImGui::PushID(static_cast<int>(n.serial));
      isClosed = message(frame, n, std::to_string(shown)) || isClosed;
      ImGui::PopID();
      ++shown;
    }
    if (isClosed)
      panels->dismiss(n.serial);
    else if (dock.ends_s <= 0.0 || left_s < dock.ends_s)
      dock.ends_s = left_s;
  }
  std::erase_if(dock.since_s, [&](const auto &seen) {
    return std::none_of(all.begin(), all.end(),
                        [&](const registry::Notification &n) { return n.serial == seen.first; });
  });
  if (all.size() > shown && ImGui::SmallButton(("and " + std::to_string(all.size() - shown) + " more").c_str()))
    frame.request(Command::showMessages);
}

void jobs(FrameContext &frame) {
  if (!frame.services.jobs) return;
  std::size_t index = 0;
  for (const BackgroundJobs::Status &job : frame.services.jobs->running()) {
    if (job.age_s < kQuietJob_s) continue;
    ImGui::PushID(static_cast<int>(index));
    const float buttonWidth = frame.theme.px(76.0f), width = ImGui::GetContentRegionAvail().x;
    ImGui::PushFont(frame.theme.bold);
    ImGui::TextUnformatted(elided(job.title, width).c_str());
    ImGui::PopFont();
    const std::string what = job.cancelling ? "stopping…" : job.what.empty() ? "…" : job.what;
    ImGui::TextColored(colour::kDim, "%s", elided(what, width).c_str());
    const bool isKnown = job.fraction >= 0.0;
    const auto fraction =
        static_cast<float>(isKnown ? std::min(job.fraction, 1.0) : 0.5 + 0.5 * std::sin(3.0 * ImGui::GetTime()));
    const std::string percent = isKnown ? std::to_string(std::lround(100.0 * job.fraction)) + " %" : std::string();
    ImGui::ProgressBar(fraction, ImVec2(width - buttonWidth - ImGui::GetStyle().ItemSpacing.x, ImGui::GetFrameHeight()),
                       percent.c_str());
    ImGui::SameLine();
    ImGui::BeginDisabled(job.cancelling);
    if (ImGui::Button("Cancel", ImVec2(buttonWidth, 0))) frame.services.jobs->cancel(job.handle);
    markItem(frame, "job", "cancel." + std::to_string(index), !job.cancelling);
    ImGui::EndDisabled();
    ImGui::PopID();
    ++index;
  }
}

/// Displays a step that takes long while it lasts.
void longStep(FrameContext &frame) {
  if (!frame.simulation.isLongStep()) return;
  const c3de_sim_transport &transport = frame.simulation.transport;
  const std::string title = transport.step_running_s > SimulationView::kLongStep_s
                                ? fmt::format("Step running for {:.1f} s", transport.step_running_s)
                                : fmt::format("Steps take {:.1f} s", 1e-3 * transport.step_ms);
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextColored(colour::kWarn, "%s", title.c_str());
  ImGui::PopFont();
  ImGui::PushTextWrapPos(0.0f);
  const std::string activity = frame.services.parameters
                                   ? registry::plainWords(frame.simulation.activity, *frame.services.parameters)
                                   : frame.simulation.activity;
  if (!activity.empty()) ImGui::TextUnformatted(activity.c_str());
  const CommandInfo &reset = commandInfo(Command::reset);
  ImGui::TextColored(colour::kDim, "Esc pauses, %s goes back to the initial state",
                     keyText(reset.key, reset.modifiers).c_str());
  ImGui::PopTextWrapPos();
  frame.automation.value("status", "long_step", title + ": " + activity);
}

}  // namespace

bool isDockNeeded(const FrameContext &frame) {
  if (frame.services.panels && !frame.services.panels->notifications().empty()) return true;
  if (frame.simulation.isLongStep()) return true;
  if (!frame.services.jobs) return false;
  const auto running = frame.services.jobs->running();
  return std::any_of(running.begin(), running.end(), [](const auto &job) { return job.age_s >= kQuietJob_s; });
}

void drawDock(FrameContext &frame, const PixelRect &area) {
  Dock &dock = frame.state.dock;
  dock.ends_s = 0.0;
  dock.height = 0.0f;
  if (!isDockNeeded(frame)) return;
  const ImVec2 padding(frame.theme.px(10.0f), frame.theme.px(8.0f));
  beginFixed("##dock", area, colour::kChrome, padding);
  ImGui::BeginChild("scroll", ImVec2(0, 0));
  const float begin = ImGui::GetCursorPosY();
  longStep(frame);
  jobs(frame);
  messages(frame);
  const float used = ImGui::GetCursorPosY() - begin;
  ImGui::EndChild();
  ImGui::End();
  dock.height = used > 0.0f ? used + 2.0f * padding.y : 0.0f;
}

void drawMessages(FrameContext &frame) {
  if (!frame.state.showMessages || !frame.services.panels) return;
  if (!beginDialog(frame, "Messages", "messages", frame.state.showMessages, ImVec2(720, 560))) return;
  ImGui::BeginChild("rows", ImVec2(0, -ImGui::GetFrameHeightWithSpacing() - frame.theme.px(4.0f)));
  const std::vector<registry::Notification> &log = frame.services.panels->log();
  if (log.empty()) ImGui::TextColored(colour::kDim, "No messages since the start");
  std::function<void()> act;  // executed afterwards: it may add a message
  for (auto n = log.rbegin(); n != log.rend(); ++n) {
    ImGui::PushID(static_cast<int>(n->serial));
    ImGui::TextColored(colour::kDim, "%s", n->time.c_str());
    ImGui::SameLine();
    ImGui::TextColored(severityTint(n->severity), "%s", n->title.c_str());
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(n->text.c_str());
    ImGui::PopTextWrapPos();
    if (const registry::Choice *chosen = choice(frame, *n, "log." + std::to_string(n->serial))) act = chosen->act;
    copyButton(frame, *n, "log." + std::to_string(n->serial));
    ImGui::Dummy(ImVec2(0, frame.theme.px(4.0f)));
    ImGui::PopID();
  }
  ImGui::EndChild();
  frame.automation.value("messages", "count", std::to_string(log.size()));
  if (act) act();
  endDialog(frame, frame.state.showMessages);
}

}  // namespace c3de::ui
