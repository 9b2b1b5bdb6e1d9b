// SPDX-License-Identifier: Apache-2.0
// Curves over simulated time, below the views.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "c3de/ui/plots.h"
#include "frame/file_dialog.h"
#include "views/plot_drawing.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kPlotArea = "plots";
constexpr float kMinStrip_px = 90.0f, kPlotGrip_px = 5.0f, kPlotList_px = 230.0f;

void savePlots(FrameContext &frame, bool isPicture) {
  FileDialog::Request request;
  request.isSaving = true;
  request.title = isPicture ? "Save plots as picture" : "Save plots as table";
  request.extensions = isPicture ? "png" : "csv";
  request.proposed = std::string("plots.") + request.extensions;
  request.chosen = [save = isPicture ? frame.actions.plots.savePicture : frame.actions.plots.saveTable](
                       const std::filesystem::path &file, const std::string &) {
    if (save) save(file);
  };
  frame.fileDialog.open(std::move(request));
}

void plotButton(FrameContext &frame, const char *id, const char *label, const char *tooltip, bool isEnabled,
                const std::function<void()> &pressed) {
  ImGui::BeginDisabled(!isEnabled);
  const bool isPressed = ImGui::SmallButton((std::string(label) + "###" + id).c_str());
  ImGui::EndDisabled();
  markItem(frame, kPlotArea, id, isEnabled);
  itemTooltip(frame, tooltip);
  ImGui::SameLine();
  if (isPressed) pressed();
}

void drawPlotChoices(FrameContext &frame, PlotList &plots) {
  // Colours count the shown curves in the order of the list of curves, rows have what matters most first.
  struct Row {
    const PlotList::Series *series;
    std::size_t number;
  };
  std::vector<Row> rows;
  std::size_t number = 0;
  for (const PlotList::Series &series : plots.series()) {
    if (series.points.empty()) continue;
    rows.push_back({&series, number});
    number += series.isShown ? 1 : 0;
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row &a, const Row &b) {
    return a.series->last.isShownAtFirst && !b.series->last.isShownAtFirst;
  });
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.theme.px(4.0f), frame.theme.px(1.0f)));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, ImVec2(frame.theme.px(6.0f), frame.theme.px(3.0f)));
  for (const Row &row : rows) {
    const PlotList::Series &series = *row.series;
    const std::string &id = series.last.id;
    const std::string unit = series.last.unit.empty() ? std::string() : " [" + series.last.unit + "]";
    const std::string name = series.last.label + unit;
    bool isShown = series.isShown;
    ImGui::PushStyleColor(ImGuiCol_Text, isShown ? ImGui::ColorConvertU32ToFloat4(
                                                       plotColour(row.number, frame.theme.kind == ThemeKind::light))
                                                 : colour::kDim);
    const std::string label = elided(name, ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - 6.0f);
    if (ImGui::Checkbox((label + "###" + id).c_str(), &isShown)) plots.show(id, isShown);
    ImGui::PopStyleColor();
    markItem(frame, kPlotArea, "show." + id);
    itemTooltip(frame, name + "\nNow: " + plotNumber(series.last.value));
    frame.automation.value(kPlotArea, id,
                           plotNumber(series.points.back().value) + " " + series.last.unit + "; " +
                               std::to_string(series.points.size()) + " points; " + (isShown ? "shown" : "hidden"));
  }
  ImGui::PopStyleVar(2);
}

/// Drag to make the strip higher or lower.
void drawPlotGrip(FrameContext &frame, const PixelRect &area) {
  ImGui::SetCursorScreenPos(ImVec2(area.x, area.y));
  ImGui::InvisibleButton("grip", ImVec2(area.w, frame.theme.px(kPlotGrip_px)));
  markItem(frame, kPlotArea, "grip");
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeNS);
  if (ImGui::IsItemActive())
    frame.state.plots.height =
        std::max(frame.state.plots.height - ImGui::GetIO().MouseDelta.y / frame.theme.scale, kMinStrip_px);
}

void drawCurves(FrameContext &frame, const PlotList &plots) {
  const ImVec2 at = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const PixelRect rect{at.x, at.y, std::max(room.x, 1.0f), std::max(room.y, 1.0f)};
  if (plots.shownCount() == 0) {
    ImGui::TextColored(colour::kDim, "%s",
                       plots.series().empty() ? "No quantities yet: they appear as the simulation runs."
                                              : "Select quantities on the left.");
    return;
  }
  PlotLook look;
  look.isLight = frame.theme.kind == ThemeKind::light;
  if (frame.simulation.exists) look.now_s = frame.simulation.transport.time_s;
  const bool isOver = rect.contains(frame.mouseX, frame.mouseY) && ImGui::IsWindowHovered();
  if (isOver) look.hoverX = static_cast<float>(frame.mouseX);
  const auto readout = drawPlots(ImGui::GetWindowDrawList(), rect, plots, look);
  if (!readout) return;
  std::string text = "t = " + plotNumber(readout->time_s) + " s";
  for (const std::string &line : readout->lines) text += "\n" + line;
  ImGui::SetTooltip("%s", text.c_str());
  frame.automation.value(kPlotArea, "hover", text);
}

}  // namespace

float plotStripHeight(const FrameContext &frame) {
  if (!frame.state.plots.isShown || !frame.services.plots) return 0.0f;
  return std::round(frame.theme.px(frame.state.plots.height));
}

void drawPlotStrip(FrameContext &frame, const PixelRect &area) {
  frame.automation.value(kPlotArea, "shown", area.h > 1.0f ? "true" : "false");
  if (!frame.state.plots.isShown || !frame.services.plots || area.h <= 1.0f) return;
  PlotList &plots = *frame.services.plots;
  beginFixed("##plots", area, colour::kPanel, ImVec2(frame.theme.px(8.0f), frame.theme.px(6.0f)),
             ImGuiWindowFlags_NoScrollWithMouse);
  drawPlotGrip(frame, area);
  ImGui::PushFont(frame.theme.small);
  const float list = frame.theme.px(kPlotList_px);
  ImGui::BeginChild("choices", ImVec2(list, 0));
  const bool hasCurves = plots.shownCount() > 0;
  plotButton(frame, "csv", "CSV…", "Save the shown curves as a table, with units", hasCurves,
             [&] { savePlots(frame, false); });
  plotButton(frame, "png", "PNG…", "Save the shown curves as a picture, with the settings of the last figure",
             hasCurves, [&] { savePlots(frame, true); });
  plotButton(frame, "close", "Close", "Values are recorded again when the strip is shown  (Ctrl+T)", true,
             [&] { frame.request(Command::showPlots); });
  ImGui::NewLine();
  ImGui::BeginChild("names");
  drawPlotChoices(frame, plots);
  ImGui::EndChild();
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("curves");
  drawCurves(frame, plots);
  ImGui::EndChild();
  ImGui::PopFont();
  ImGui::End();
}

}  // namespace c3de::ui
