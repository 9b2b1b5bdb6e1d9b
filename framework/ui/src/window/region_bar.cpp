// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr double kSmall_mm = 10.0;

/// A note on what is not as it appears; empty if nothing.
std::string noteOf(const FrameContext &frame) {
  std::string note;
  if (frame.modes.region()->isTurned())
    note = "The slices are along the axes of the patient, as the box is, until this ends.";
  if (const ImageViews *images = frame.shownImages(); images && images->isAtRest())
    note += std::string(note.empty() ? "" : " ") + "The scan is shown undeformed until you finish.";
  return note;
}

}  // namespace

float regionBarHeight(const FrameContext &frame) {
  if (!frame.modes.region()) return 0.0f;
  const float note = noteOf(frame).empty() ? 0.0f : frame.theme.small->FontSize + ImGui::GetStyle().ItemSpacing.y;
  return std::round(ImGui::GetFrameHeight() + note + frame.theme.px(12.0f));
}

void drawRegionBar(FrameContext &frame, const PixelRect &area) {
  frame.modes.followRegion();
  if (!frame.modes.region()) return;
  RegionDrawing &drawing = *frame.modes.region();
  beginFixed("##region", area, colour::kPanel, ImVec2(frame.theme.px(10.0f), frame.theme.px(6.0f)));
  const Vec3 size = drawing.region().size_mm();
  const int decimals = std::max({size[0], size[1], size[2]}) < kSmall_mm ? 3 : 1;
  const std::string sizeText = fmt::format("{:.{}f} × {:.{}f} × {:.{}f} mm", size[0], decimals, size[1], decimals,
                                           size[2], decimals),
                    volumeText = fmt::format("{:.4g} ml", drawing.region().volume_ml());
  ImGui::AlignTextToFramePadding();
  ImGui::PushFont(frame.theme.bold);
  ImGui::TextUnformatted("Region");
  ImGui::PopFont();
  ImGui::SameLine();
  ImGui::TextUnformatted(sizeText.c_str());
  itemTooltip(frame, "From right to left, from front to back, from the feet to the head");
  frame.automation.value("region", "size", sizeText);
  ImGui::SameLine();
  ImGui::TextColored(colour::kDim, "%s", volumeText.c_str());
  frame.automation.value("region", "volume", volumeText);
  const Box &box = drawing.region().box();
  frame.automation.value(
      "region", "box",
      fmt::format("{} {} {} {} {} {}", box[0][0], box[0][1], box[0][2], box[1][0], box[1][1], box[1][2]));

  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float done = frame.theme.px(110.0f), whole = frame.theme.px(100.0f), cancel = frame.theme.px(100.0f);
  const float right = ImGui::GetWindowContentRegionMax().x - done - whole - cancel - 2.0f * gap;
  ImGui::SameLine(right);
  // Enter in a field of the side panel, or of a dialog above, belongs to that field.
  const Modes::Above above = frame.above();
  const bool isFree = !above.isTyping && !above.isPopup;
  const auto isPressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false); };
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isDone = ImGui::Button("Done (Enter)", ImVec2(done, 0)) ||
                      (isFree && (isPressed(ImGuiKey_Enter) || isPressed(ImGuiKey_KeyPadEnter)));
  ImGui::PopStyleColor();
  markItem(frame, "region", "done");
  itemTooltip(frame, "Back to the dialog, with this region");
  ImGui::SameLine();
  if (ImGui::Button("Whole scan", ImVec2(whole, 0))) drawing.takeAll();
  markItem(frame, "region", "whole");
  itemTooltip(frame, "The box around all of it");
  ImGui::SameLine();
  const bool isCancelled = ImGui::Button("Cancel (Esc)", ImVec2(cancel, 0));
  markItem(frame, "region", "cancel");
  itemTooltip(frame, "Back to the dialog, with the region as it was before");
  const std::string note = noteOf(frame);
  if (!note.empty()) {
    ImGui::PushFont(frame.theme.small);
    ImGui::TextColored(colour::kWarn, "%s", elided(note, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopFont();
    itemTooltip(frame, note);
  }
  frame.automation.value("region", "note", note);
  ImGui::End();
  if (isDone || isCancelled) frame.modes.endRegion(isDone);
}

}  // namespace c3de::ui
