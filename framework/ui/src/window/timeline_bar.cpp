// SPDX-License-Identifier: Apache-2.0
// The timeline of a replay, below the views.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "c3de/core/text.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr std::size_t kMarksInTooltip = 8;

std::string textOf(const ReplayView &replay, std::uint64_t position) {
  return fmt::format("t = {:.3f} s, step {}", replay.timeAt_s ? replay.timeAt_s(position) : 0.0, position);
}

/// Where positions are on the slider.
struct Track {
  const ReplayView &replay;
  float x0, x1;

  [[nodiscard]] float xOf(std::uint64_t position) const {
    const double length = static_cast<double>(std::max<std::uint64_t>(replay.length, 1));
    return x0 + static_cast<float>(static_cast<double>(position) / length) * (x1 - x0);
  }
  [[nodiscard]] std::uint64_t positionAt(float x) const {
    const double share = std::clamp(static_cast<double>((x - x0) / std::max(x1 - x0, 1.0f)), 0.0, 1.0);
    return static_cast<std::uint64_t>(std::llround(share * static_cast<double>(replay.length)));
  }
};

/// The changes under the mouse, otherwise the position there. Above the slider, where it covers no button.
void sliderTooltip(FrameContext &frame, const Track &track, float mouseX, float bottom) {
  const float near_px = frame.theme.px(4.0f);
  std::string text;
  std::size_t count = 0;
  for (const ReplayView::Mark &mark : *track.replay.marks) {
    if (std::abs(track.xOf(mark.position) - mouseX) > near_px) continue;
    if (++count <= kMarksInTooltip)
      text += (text.empty() ? "" : "\n") + mark.text + "  (" + textOf(track.replay, mark.position) + ")";
  }
  if (count > kMarksInTooltip) text += fmt::format("\nand {} more", count - kMarksInTooltip);
  if (text.empty()) text = textOf(track.replay, track.positionAt(mouseX));
  const float x = std::clamp(mouseX, track.x0, track.x1), share = (x - track.x0) / std::max(track.x1 - track.x0, 1.0f);
  ImGui::SetNextWindowPos(ImVec2(x, bottom), ImGuiCond_Always, ImVec2(share, 1.0f));
  ImGui::SetTooltip("%s", text.c_str());
  frame.automation.value("timeline", "hover", text);
}

/// The bounds of the stretch: brackets around its part of the track.
void drawStretch(const FrameContext &frame, const Track &track, float top, float bottom) {
  ImDrawList *list = ImGui::GetWindowDrawList();
  const float thick = std::max(1.0f, std::round(frame.theme.px(2.0f))), foot = frame.theme.px(5.0f);
  const ImU32 colour = ImGui::GetColorU32(colour::kText);
  const auto bracket = [&](std::uint64_t position, float inwards) {
    const float x = std::round(track.xOf(position)) - 0.5f * inwards * thick;
    list->AddLine(ImVec2(x, top), ImVec2(x, bottom), colour, thick);
    for (const float y : {top, bottom}) list->AddLine(ImVec2(x, y), ImVec2(x + inwards * foot, y), colour, thick);
  };
  bracket(track.replay.stretch.begin, 1.0f);
  bracket(track.replay.stretch.end, -1.0f);
}

void drawTrack(const FrameContext &frame, const Track &track, ImVec2 min, ImVec2 max, std::uint64_t thumb) {
  ImDrawList *list = ImGui::GetWindowDrawList();
  const float middle = std::round(0.5f * (min.y + max.y)), half = frame.theme.px(2.5f);
  const float at = track.xOf(track.replay.position), thumbAt = track.xOf(thumb);
  list->AddRectFilled(ImVec2(track.x0, middle - half), ImVec2(track.x1, middle + half),
                      ImGui::GetColorU32(colour::kLine), half);
  list->AddRectFilled(ImVec2(track.x0, middle - half), ImVec2(at, middle + half), ImGui::GetColorU32(colour::kAccent),
                      half);
  drawStretch(frame, track, min.y, max.y);
  for (const ReplayView::Mark &mark : *track.replay.marks) {
    const float x = std::round(track.xOf(mark.position));
    list->AddLine(ImVec2(x, min.y + frame.theme.px(1.0f)), ImVec2(x, max.y - frame.theme.px(1.0f)),
                  ImGui::GetColorU32(colour::kWarn), std::max(1.0f, frame.theme.px(1.0f)));
  }
  list->AddCircleFilled(ImVec2(thumbAt, middle), frame.theme.px(7.0f), ImGui::GetColorU32(colour::kText));
}

void slider(FrameContext &frame, const ReplayView &replay) {
  const float height = frame.theme.px(22.0f), inset = frame.theme.px(8.0f);
  const ImVec2 min = ImGui::GetCursorScreenPos();
  const float width = std::max(ImGui::GetContentRegionAvail().x, 2.0f * inset + 1.0f);
  ImGui::InvisibleButton("slider", ImVec2(width, height));
  markItem(frame, "timeline", "slider");
  const Track track{replay, min.x + inset, min.x + width - inset};
  std::optional<std::uint64_t> &scrubbed = frame.state.scrubbed;
  const float mouseX = ImGui::GetIO().MousePos.x;
  if (ImGui::IsItemActive() && replay.exporting.empty()) {
    const std::uint64_t wanted = track.positionAt(mouseX);
    if (wanted != scrubbed && frame.actions.replay.seek) frame.actions.replay.seek(wanted);
    scrubbed = wanted;
  } else {
    scrubbed.reset();
  }
  if (ImGui::IsItemHovered() || scrubbed) sliderTooltip(frame, track, mouseX, min.y - frame.theme.px(6.0f));
  drawTrack(frame, track, min, ImVec2(min.x + width, min.y + height),
            scrubbed.value_or(replay.isSeeking ? replay.target : replay.position));
}

bool button(FrameContext &frame, const char *id, Icon icon, bool isEnabled, const char *doc) {
  const bool isPressed = iconButton(id, icon, ImGui::GetFrameHeight(), colour::kText, isEnabled);
  markItem(frame, "timeline", id, isEnabled);
  itemTooltip(frame, doc);
  ImGui::SameLine(0.0f, frame.theme.px(4.0f));
  return isPressed && isEnabled;
}

void rateChoice(FrameContext &frame, const ReplayView &replay) {
  static constexpr double kRates[] = {0.25, 1.0, 0.0};
  static constexpr const char *kLabels[] = {"0.25×", "1×", "max"};
  const auto *known = std::find(std::begin(kRates), std::end(kRates), replay.rate);
  const std::string shown = known != std::end(kRates) ? kLabels[known - kRates] : formatNumber(replay.rate) + "×";
  ImGui::SetNextItemWidth(frame.theme.px(78.0f));
  const bool isOpen = ImGui::BeginCombo("##rate", shown.c_str());
  markOpener(frame, "timeline", "rate", isOpen);
  if (isOpen) {
    for (std::size_t i = 0; i < std::size(kRates); ++i) {
      if (ImGui::Selectable(kLabels[i], kRates[i] == replay.rate)) frame.actions.replay.setRate(kRates[i]);
      markItem(frame, "timeline", std::string("rate.option.") + kLabels[i]);
    }
    ImGui::EndCombo();
  }
  itemTooltip(frame, "Simulated seconds per second. 1× is real time, max is as fast as possible.");
  ImGui::SameLine(0.0f, frame.theme.px(10.0f));
}

void transportButtons(FrameContext &frame, const ReplayView &replay) {
  const ReplayActions &actions = frame.actions.replay;
  const bool isAtEnd = replay.position >= replay.length, isFree = replay.exporting.empty();
  if (button(frame, "start", Icon::toStart, isFree, "To the start of the recording")) actions.seek(0);
  if (button(frame, "play", replay.isPlaying ? Icon::pause : Icon::play, isFree && (replay.isPlaying || !isAtEnd),
             replay.isPlaying ? "Pause  (Space)"
             : isAtEnd        ? "The recording ends here"
                              : "Replay the recording  (Space)"))
    actions.play(!replay.isPlaying);
  if (button(frame, "step", Icon::step, isFree && !isAtEnd && !replay.isSeeking, "One step forward  (Right)"))
    actions.step();
  if (button(frame, "end", Icon::toEnd, isFree && !isAtEnd, "To the end of the recording")) actions.seek(replay.length);
  rateChoice(frame, replay);
}

/// How far a jump is, with a button that ends it; otherwise a warning.
void progressOrWarning(FrameContext &frame, const ReplayView &replay, float right) {
  const auto room = [&] { return right - ImGui::GetCursorPosX() - frame.theme.px(10.0f); };
  if (const bool isExport = !replay.exporting.empty(); isExport || (replay.isSeeking && !frame.state.scrubbed)) {
    if (ImGui::Button("Cancel", ImVec2(frame.theme.px(76.0f), 0))) frame.actions.replay.cancel();
    markItem(frame, "timeline", "cancel");
    itemTooltip(frame,
                isExport ? "End the export; what has been written is kept" : "Stay at the step that has been reached");
    ImGui::SameLine();
    const std::string text = isExport ? "Exporting" : fmt::format("Jumping to step {}", replay.target);
    ImGui::TextColored(colour::kDim, "%s", elided(text, room()).c_str());
  } else if (!replay.warning.empty()) {
    const std::string text = elided(replay.warning, room());
    ImGui::TextColored(colour::kWarn, "%s", text.c_str());
    itemTooltip(frame, replay.warning);
  } else {
    ImGui::TextColored(colour::kDim, "%s", elided(replay.file, room()).c_str());
    itemTooltip(frame, replay.file);
  }
}

/// The second row: the bounds of the stretch, and its export.
void stretchRow(FrameContext &frame, const ReplayView &replay) {
  const ReplayActions &actions = frame.actions.replay;
  const bool isFree = replay.exporting.empty();
  const auto textButton = [&](const char *id, const char *label, float width, bool isEnabled, const char *doc) {
    ImGui::BeginDisabled(!isEnabled);
    const bool isPressed = ImGui::Button(label, ImVec2(frame.theme.px(width), 0));
    ImGui::EndDisabled();
    markItem(frame, "timeline", id, isEnabled);
    itemTooltip(frame, doc);
    ImGui::SameLine(0.0f, frame.theme.px(6.0f));
    return isPressed && isEnabled;
  };
  if (textButton("begin", "Set begin", 90.0f, isFree && replay.position < replay.length,
                 "The stretch to be exported begins here"))
    actions.setBegin();
  if (textButton("until", "Set end", 90.0f, isFree && replay.position > 0, "The stretch to be exported ends here"))
    actions.setEnd();
  const bool isReady = isFree && !replay.isSeeking && !replay.isPlaying && replay.length > 0;
  if (textButton("export", "Export stretch…", 130.0f, isReady,
                 "Write the stretch as a series for ParaView, a table, pictures or a film"))
    frame.state.stretch.isShown = true;
  ImGui::AlignTextToFramePadding();
  const auto timeAt_s = [&](std::uint64_t position) { return replay.timeAt_s ? replay.timeAt_s(position) : 0.0; };
  std::string text = fmt::format("Stretch: t = {:.3f} to {:.3f} s, step {} to {}", timeAt_s(replay.stretch.begin),
                                 timeAt_s(replay.stretch.end), replay.stretch.begin, replay.stretch.end);
  if (!isFree) text = replay.exporting;
  ImGui::TextColored(colour::kDim, "%s", elided(text, ImGui::GetContentRegionAvail().x).c_str());
  itemTooltip(frame, text);
  frame.automation.value("timeline", "stretch", fmt::format("{} {}", replay.stretch.begin, replay.stretch.end));
  frame.automation.value("timeline", "exporting", replay.exporting);
}

}  // namespace

float timelineBarHeight(const FrameContext &frame) {
  if (!frame.simulation.replay) return 0.0f;
  return std::round(frame.theme.px(22.0f + 16.0f) + 2.0f * (ImGui::GetStyle().ItemSpacing.y + ImGui::GetFrameHeight()));
}

void drawTimelineBar(FrameContext &frame, const PixelRect &area) {
  if (!frame.simulation.replay) {
    frame.state.scrubbed.reset();
    return;
  }
  const ReplayView &replay = *frame.simulation.replay;
  beginFixed("##timeline", area, colour::kPanel, ImVec2(frame.theme.px(10.0f), frame.theme.px(8.0f)),
             ImGuiWindowFlags_NoScrollWithMouse);
  slider(frame, replay);
  transportButtons(frame, replay);
  ImGui::AlignTextToFramePadding();
  const auto timeAt_s = [&](std::uint64_t position) { return replay.timeAt_s ? replay.timeAt_s(position) : 0.0; };
  const std::string place = fmt::format("t = {:.3f} of {:.3f} s, step {} of {}", timeAt_s(replay.position),
                                        timeAt_s(replay.length), replay.position, replay.length);
  const float leave = frame.theme.px(150.0f), back = replay.hasNow ? frame.theme.px(120.0f) : 0.0f,
              gap = replay.hasNow ? frame.theme.px(6.0f) : 0.0f,
              right = ImGui::GetWindowContentRegionMax().x - leave - back - gap;
  ImGui::TextUnformatted(elided(place, right - ImGui::GetCursorPosX()).c_str());
  itemTooltip(frame, "Simulated time and steps since the recording began");
  ImGui::SameLine(0.0f, frame.theme.px(14.0f));
  progressOrWarning(frame, replay, right);
  frame.automation.value("timeline", "position", std::to_string(replay.position));
  frame.automation.value("timeline", "length", std::to_string(replay.length));
  frame.automation.value("timeline", "place", place);
  std::string marks;
  for (const ReplayView::Mark &mark : *replay.marks) marks += fmt::format("{} {}\n", mark.position, mark.text);
  frame.automation.value("timeline", "marks", marks);
  frame.automation.value("timeline", "warning", replay.warning);
  frame.automation.value("timeline", "state", replay.isSeeking ? "seeking" : replay.isPlaying ? "playing" : "paused");
  ImGui::SameLine(right);
  bool isReturned = false;
  if (replay.hasNow) {
    isReturned = ImGui::Button("Return to now", ImVec2(back, 0));
    markItem(frame, "timeline", "now");
    itemTooltip(frame, "Back to the simulation as it was when its timeline was shown");
    ImGui::SameLine(0.0f, gap);
  }
  const bool isLocked = replay.isSeeking || !replay.exporting.empty();
  ImGui::BeginDisabled(isLocked);
  const bool isLeft = ImGui::Button("Continue from here", ImVec2(leave, 0));
  ImGui::EndDisabled();
  markItem(frame, "timeline", "continue", !isLocked);
  itemTooltip(frame, "Ends the replay. The simulation continues from this moment, and can be changed.");
  stretchRow(frame, replay);
  ImGui::End();
  if (isReturned)
    frame.actions.replay.returnToNow();
  else if (isLeft)
    frame.actions.replay.leave();
}

}  // namespace c3de::ui
