// SPDX-License-Identifier: Apache-2.0
// Landmarks, distances and angles, in the side panel.
#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cstdio>
#include <cstring>

#include "c3de/ui/measurement_list.h"
#include "c3de/ui/measurement_tools.h"
#include "frame/file_dialog.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kArea = "measurements";
constexpr std::size_t kMaxRows = 10;

void numberCell(const std::string &text) {
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(room, 0.0f));
  ImGui::TextUnformatted(text.c_str());
}

/// Of a landmark, or the first point of a distance or angle's vertex.
Vec3 placeOf(const MeasurementList &list, const std::string &name) {
  const MeasurementSet &set = list.set();
  const Measure *measure = set.measure(name);
  const MeasuredPoint *point = set.point(measure ? measure->points[measure->isAngle() ? 1 : 0] : name);
  return point ? list.positionOf(*point) : Vec3{};
}

void select(FrameContext &frame, MeasurementList &list, const std::string &name) {
  list.selected = name;
  if (ImageViews *images = frame.shownImages()) images->setCrossHair(placeOf(list, name));
}

void drawRow(FrameContext &frame, MeasurementList &list, const MeasurementRow &row) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, row.isHidden ? colour::kDim : colour::kText);
  const std::string label = elided(row.name, ImGui::GetContentRegionAvail().x) + "###row." + row.name;
  if (ImGui::Selectable(label.c_str(), list.selected == row.name, ImGuiSelectableFlags_SpanAllColumns))
    select(frame, list, row.name);
  markItem(frame, kArea, "row." + row.name);
  itemTooltip(frame, row.name + ": " + kindName(row.kind) + ", " + row.unit() +
                         "\nA press selects it, and moves the cross-hair to it");
  for (const std::string &text : {row.referenceText(), row.nowText(), row.changeText(), row.unit()}) {
    ImGui::TableNextColumn();
    numberCell(text);
  }
  ImGui::TableNextColumn();
  const int decimals = row.length.factor < 1.0 ? 2 : 1;
  numberCell(row.error_mm ? fmt::format("{:.{}f} → {:.{}f}", row.shown((*row.error_mm)[0]), decimals,
                                        row.shown((*row.error_mm)[1]), decimals)
                          : "–");
  ImGui::PopStyleColor();
  AutomationState &automation = frame.automation;
  automation.value(kArea, row.name + ".rest", row.reference ? fmt::format("{:.4f}", *row.reference) : "none");
  automation.value(kArea, row.name + ".now", row.now ? fmt::format("{:.4f}", *row.now) : "none");
  automation.value(kArea, row.name + ".label", row.label());
  if (const MeasuredPoint *point = list.set().point(row.name)) {
    const auto text = [](const Vec3 &p) { return fmt::format("{:.4f} {:.4f} {:.4f}", p[0], p[1], p[2]); };
    automation.value(kArea, row.name + ".reference", text(point->reference_mm));
    automation.value(kArea, row.name + ".at", text(list.positionOf(*point)));
    automation.value(kArea, row.name + ".target", point->target_mm ? text(*point->target_mm) : "none");
  }
  if (row.error_mm)
    automation.value(kArea, row.name + ".error", fmt::format("{:.4f} {:.4f}", (*row.error_mm)[0], (*row.error_mm)[1]));
}

void drawTable(FrameContext &frame, MeasurementList &list, const std::vector<MeasurementRow> &rows) {
  ImGui::PushFont(frame.theme.small);
  const auto count = static_cast<float>(std::clamp<std::size_t>(rows.size(), 1, kMaxRows) + 1);
  const float height = count * (ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y) + 2.0f;
  if (ImGui::BeginTable("measurements", 6,
                        ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerH,
                        ImVec2(0.0f, height))) {
    ImGui::TableSetupScrollFreeze(0, 1);
    const float wide = ImGui::CalcTextSize("1000.0").x;
    ImGui::TableSetupColumn("Name", ImGuiTableColumnFlags_WidthStretch);
    for (const char *title : {"at rest", "now", "change"})
      ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed, wide);
    ImGui::TableSetupColumn("unit", ImGuiTableColumnFlags_WidthFixed, ImGui::CalcTextSize("unit").x);
    ImGui::TableSetupColumn(("error " + list.length().name).c_str(), ImGuiTableColumnFlags_WidthFixed,
                            ImGui::CalcTextSize("10.0 → 10.0").x);
    ImGui::TableHeadersRow();
    for (const MeasurementRow &row : rows) drawRow(frame, list, row);
    ImGui::EndTable();
  }
  ImGui::PopFont();
}

void drawErrors(FrameContext &frame, const MeasurementList &list) {
  const auto errors = list.targetErrors();
  if (!errors) return;
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    const auto &[unit, factor] = list.length();
    const int decimals = factor < 1.0 ? 3 : 2;
    const auto shown = [&, f = factor](double x_mm) { return fmt::format("{:.{}f}", f * x_mm, decimals); };
    const std::string sd = errors->count > 1 ? ", sd " + shown(errors->sd_mm[k]) : std::string();
    const std::string text = std::string("Error ") + (k == 0 ? "at rest" : "now") + ": mean " +
                             shown(errors->mean_mm[k]) + sd + ", max " + shown(errors->max_mm[k]) + " " + unit;
    ImGui::TextUnformatted(text.c_str());
    frame.automation.value(kArea, k == 0 ? "error.rest" : "error.now", text);
  }
}

/// The selected row over time, with the ranges of both axes.
void drawCurve(FrameContext &frame, const MeasurementList &list, const MeasurementRow &row) {
  std::vector<CurvePoint2> curve = list.curve(row.name);
  for (CurvePoint2 &point : curve) point.value = row.shown(point.value);
  frame.automation.value(kArea, "curve.samples", std::to_string(curve.size()));
  if (curve.size() < 2) return;
  const auto [low, high] =
      std::minmax_element(curve.begin(), curve.end(), [](const auto &a, const auto &b) { return a.value < b.value; });
  const double least = low->value, most = std::max(high->value, low->value + 1e-3);
  const double begin_s = curve.front().time_s, length_s = std::max(curve.back().time_s - begin_s, 1e-9);
  ImGui::PushFont(frame.theme.small);
  const float line = ImGui::GetTextLineHeight(), height = frame.theme.px(70.0f);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, left = ImGui::CalcTextSize("-1000.00").x;
  ImDrawList *draw = ImGui::GetWindowDrawList();
  const ImVec2 from(at.x + left, at.y + line + 2.0f), to(at.x + width - 4.0f, at.y + line + 2.0f + height);
  draw->AddRectFilled(from, to, ImGui::GetColorU32(colour::kChrome));
  draw->AddRect(from, to, ImGui::GetColorU32(colour::kLine));
  std::vector<ImVec2> pixels;
  for (const CurvePoint2 &p : curve)
    pixels.emplace_back(from.x + (to.x - from.x) * static_cast<float>((p.time_s - begin_s) / length_s),
                        to.y - (to.y - from.y) * static_cast<float>((p.value - least) / (most - least)));
  draw->AddPolyline(pixels.data(), static_cast<int>(pixels.size()), ImGui::GetColorU32(colour::kAccent),
                    ImDrawFlags_None, frame.theme.px(1.5f));
  const ImU32 ink = ImGui::GetColorU32(colour::kText), dim = ImGui::GetColorU32(colour::kDim);
  const auto text = [&](float x, float y, ImU32 tint, const std::string &what) {
    draw->AddText(ImVec2(x, y), tint, what.c_str());
  };
  text(at.x, at.y, ink,
       fmt::format("{}{}: {:.2f} {} at {:.2f} s", row.name, row.kind == MeasureKind::landmark ? ", displacement" : "",
                   curve.back().value, row.unit(), curve.back().time_s));
  text(at.x, from.y - 2.0f, dim, fmt::format("{:.2f}", most));
  text(at.x, to.y - line, dim, fmt::format("{:.2f}", least));
  text(at.x, 0.5f * (from.y + to.y - line), dim, row.unit());
  text(from.x, to.y + 2.0f, dim, fmt::format("{:.2f} s", begin_s));
  const std::string end = fmt::format("{:.2f} s", curve.back().time_s);
  text(to.x - ImGui::CalcTextSize(end.c_str()).x, to.y + 2.0f, dim, end);
  ImGui::Dummy(ImVec2(width, height + 2.0f * line + 8.0f));
  ImGui::PopFont();
}

void button(FrameContext &frame, const char *label, const char *id, const std::string &tooltip, bool isEnabled,
            const std::function<void()> &pressed) {
  // The next row where the button does not fit.
  const float width = ImGui::CalcTextSize(label).x + 2.0f * ImGui::GetStyle().FramePadding.x;
  const float end = ImGui::GetWindowPos().x + ImGui::GetContentRegionMax().x;
  if (std::strcmp(id, "load") != 0 && std::strcmp(id, "hide") != 0 &&
      ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width < end)
    ImGui::SameLine();
  ImGui::BeginDisabled(!isEnabled);
  const bool isPressed = ImGui::Button((std::string(label) + "###" + id).c_str());
  ImGui::EndDisabled();
  markItem(frame, kArea, id, isEnabled);
  itemTooltip(frame, tooltip);
  if (isPressed) pressed();
}

void openDialog(FrameContext &frame, const char *title, const char *extensions, const char *proposed,
                const std::function<void(const std::filesystem::path &)> &action) {
  FileDialog::Request request;
  request.title = title;
  request.extensions = extensions;
  request.isSaving = proposed != nullptr;
  if (proposed) request.proposed = proposed;
  request.chosen = [action](const std::filesystem::path &file, const std::string &) {
    if (action) action(file);
  };
  frame.fileDialog.open(std::move(request));
}

void drawFileButtons(FrameContext &frame, MeasurementList &list, bool isFree) {
  const WindowActions &actions = frame.actions;
  constexpr const char *kFiles = "csv;fcsv;json";
  const bool hasPoints = !list.set().points.empty();
  frame.state.sideRows.row("measurements/files");
  button(frame, "Load landmarks…", "load", "CSV, or .fcsv and .mrk.json of 3D Slicer: positions at rest", isFree,
         [&] { openDialog(frame, "Load landmarks", kFiles, nullptr, actions.loadLandmarks); });
  button(frame, "Load target landmarks…", "load_targets",
         "Where landmarks of the same names should be; the table shows the errors", hasPoints && isFree,
         [&] { openDialog(frame, "Load target landmarks", kFiles, nullptr, actions.loadTargetLandmarks); });
  button(frame, "Save landmarks…", "save", "CSV with positions at rest and now; .fcsv and .mrk.json: now", hasPoints,
         [&] { openDialog(frame, "Save landmarks", kFiles, "landmarks.csv", actions.saveLandmarks); });
  button(frame, "Copy as CSV", "copy", "Copy the table to the clipboard", !list.set().isEmpty(),
         [&] { ImGui::SetClipboardText(list.tableCsv().c_str()); });
  button(frame, "Export curves as CSV…", "export_curves", "All measurements over time",
         list.sampleCount() > 1 && !list.set().isEmpty(),
         [&] { openDialog(frame, "Export curves", "csv", "measurements.csv", actions.exportCurves); });
}

/// Where the selected landmark was measured.
void drawTarget(FrameContext &frame, MeasurementList &list, const MeasuredPoint &point, bool isFree) {
  MeasurementTools *tools = frame.services.measurementTools;
  if (tools == nullptr) return;
  const bool isPlacing = tools->targetOf() == point.name;
  button(frame, "Set target", "set_target",
         "The next click is where this landmark was measured; with a second scan over the image, a click on that scan",
         isFree && !isPlacing, [&] { tools->placeTargetOf(point.name); });
  button(frame, "Remove target", "remove_target", "The landmark stays; a match does not use it",
         isFree && point.target_mm.has_value(), [&] {
           MeasurementSet set = list.set();
           set.setTarget(point.name, std::nullopt);
           list.edit("remove target of " + point.name, std::move(set));
         });
  if (!isPlacing) return;
  const std::string hint = "Click where " + point.name + " was measured. Esc: cancel";
  ImGui::TextWrapped("%s", hint.c_str());
}

/// Name, visibility and removal of the selected row, and its target.
void drawSelected(FrameContext &frame, MeasurementList &list, bool isFree) {
  if (list.selected.empty()) return;
  const auto row = list.row(list.selected);
  if (!row) return;
  static constexpr const char *kField = "###name";
  auto &[shownFor, text, problem] = frame.state.measurementName;
  if (shownFor != row->name) {
    shownFor = row->name;
    problem.clear();
    std::snprintf(text.data(), text.size(), "%s", row->name.c_str());
  }
  frame.state.sideRows.row("measurements/name");
  ImGui::SetNextItemWidth(-FLT_MIN);
  ImGui::BeginDisabled(!isFree);
  const bool isEntered = ImGui::InputText(kField, text.data(), text.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  const bool isDone = isEntered || ImGui::IsItemDeactivatedAfterEdit();
  ImGui::EndDisabled();
  markItem(frame, kArea, "name", isFree);
  itemTooltip(frame, "Name of the selected measurement; Return renames it");
  if (isDone) {
    MeasurementSet set = list.set();
    if (const auto renamed = set.rename(row->name, text.data()); !renamed) {
      problem = renamed.error().message;
    } else if (row->name != text.data()) {
      problem.clear();
      list.edit("rename " + row->name, std::move(set));
      list.selected = text.data();
      return;
    }
  }
  if (!problem.empty()) ImGui::TextWrapped("%s", problem.c_str());
  button(frame, row->isHidden ? "Show" : "Hide", "hide", "Show or hide it in the views", isFree, [&] {
    MeasurementSet set = list.set();
    set.setHidden(row->name, !row->isHidden);
    list.edit((row->isHidden ? "show " : "hide ") + row->name, std::move(set));
  });
  button(frame, "Delete", "delete", "Remove it; a landmark with the distances and angles that use it  (Delete)", isFree,
         [&] {
           MeasurementSet set = list.set();
           set.remove(row->name);
           list.edit("delete " + row->name, std::move(set));
         });
  if (const MeasuredPoint *point = list.set().point(row->name)) drawTarget(frame, list, *point, isFree);
}

}  // namespace

void drawMeasurements(FrameContext &frame, MeasurementList &list) {
  const std::vector<MeasurementRow> rows = list.rows();
  const bool isFree = !frame.simulation.replay;
  frame.automation.value(kArea, "count", std::to_string(rows.size()));
  frame.automation.value(kArea, "selected", list.selected);
  if (const MeasurementTools *tools = frame.services.measurementTools)
    frame.automation.value(kArea, "target_of", tools->targetOf().empty() ? "none" : tools->targetOf());
  if (rows.empty())
    ImGui::TextColored(colour::kDim, "Place points with Landmark, Distance and Angle.");
  else
    drawTable(frame, list, rows);
  drawErrors(frame, list);
  drawSelected(frame, list, isFree);
  if (!rows.empty()) {
    const auto shown = list.row(list.selected);
    drawCurve(frame, list, shown ? *shown : rows.back());
  }
  drawFileButtons(frame, list, isFree);
}

}  // namespace c3de::ui
