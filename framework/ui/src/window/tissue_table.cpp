// SPDX-License-Identifier: Apache-2.0
// The labels of a body of many tissues, in the side panel.
#include "c3de/ui/tissue_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cfloat>

#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kTissueArea = "tissues";
constexpr std::size_t kMaxRows = 14;

struct Column {
  const char *title, *id, *tooltip;
  std::string (TissueRow::*text)() const;
  TissueOrder order;
  bool isLength = false;
};
constexpr std::array kColumns{
    Column{"ml", "volume", "Volume now", &TissueRow::volumeText, TissueOrder::volume},
    Column{"%", "change", "Its change since the scan", &TissueRow::changeText, TissueOrder::change},
    Column{"|u|", "mean", "Displacement, mean", &TissueRow::meanText, TissueOrder::mean, true},
    Column{"most", "largest", "Largest displacement", &TissueRow::largestText, TissueOrder::largest, true},
    Column{"det F", "det_f", "Smallest det F: where it is compressed most, its volume over that of the scan",
           &TissueRow::ratioText, TissueOrder::leastRatio}};

void numberCell(const std::string &text) {
  const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(room, 0.0f));
  ImGui::TextUnformatted(text.c_str());
}

/// In the unit of the user, without its name.
std::string textOf(const FrameContext &frame, const Column &column, const TissueRow &row) {
  const std::string text = (row.*column.text)();
  if (!column.isLength) return text;
  const std::string shown = shownText(frame.state.preferences.units, text + " mm");
  return shown.substr(0, shown.rfind(' '));
}

std::string titleOf(const FrameContext &frame, const Column &column) {
  const bool hasUnit = column.order == TissueOrder::mean;
  return column.title + (hasUnit ? " " + displayUnit(frame.state.preferences.units, "mm").name : std::string());
}

void headings(FrameContext &frame) {
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("Label", ImGuiTableColumnFlags_WidthStretch);
  for (const Column &column : kColumns)
    ImGui::TableSetupColumn(
        column.title, ImGuiTableColumnFlags_WidthFixed,
        std::max(ImGui::CalcTextSize("-100.0").x, ImGui::CalcTextSize(titleOf(frame, column).c_str()).x));
  ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
  ImGui::TableNextColumn();
  TissueOrder &order = frame.state.tissueOrder;
  const auto heading = [&](const char *title, const char *id, TissueOrder its, const std::string &tooltip) {
    // Drawn in front of its number; the whole cell is clickable.
    const ImVec2 at = ImGui::GetCursorPos();
    if (ImGui::Selectable((std::string("###") + id).c_str(), false)) order = order == its ? TissueOrder::labels : its;
    markItem(frame, kTissueArea, std::string("order.") + id);
    itemTooltip(frame, tooltip);
    ImGui::SetCursorPos(at);
    ImGui::PushStyleColor(ImGuiCol_Text, order == its ? colour::kText : colour::kDim);
    if (its == TissueOrder::labels)
      ImGui::TextUnformatted(title);
    else
      numberCell(title);
    ImGui::PopStyleColor();
  };
  heading("Label", "label", TissueOrder::labels, "In the order of the body");
  for (const Column &column : kColumns) {
    ImGui::TableNextColumn();
    heading(
        titleOf(frame, column).c_str(), column.id, column.order,
        std::string(column.tooltip) + (column.order == order                     ? ".\nA press: as the body has them"
                                       : column.order == TissueOrder::leastRatio ? ".\nA press: the smallest first"
                                                                                 : ".\nA press: the largest first"));
  }
}

/// Shortened but with its last word, which often distinguishes two labels: "lung_lower…_left".
std::string shortened(const std::string &label, float width) {
  constexpr std::size_t kLongestEnd = 8;
  const std::size_t last = label.find_last_of("_ ");
  if (last == std::string::npos || label.size() - last > kLongestEnd || ImGui::CalcTextSize(label.c_str()).x <= width)
    return elided(label, width);
  const std::string end = label.substr(last);
  return elided(label.substr(0, last), width - ImGui::CalcTextSize(end.c_str()).x) + end;
}

void drawRow(FrameContext &frame, const TissueRow &row) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const float side = 0.75f * ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (row.colour) {
    const auto &c = *row.colour;
    const float top = at.y + 0.5f * (ImGui::GetTextLineHeight() - side);
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, top), ImVec2(at.x + side, top + side),
                                              ImGui::GetColorU32(ImVec4(c[0], c[1], c[2], 1.0f)), 2.0f);
  }
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 1.4f * side);
  ImGui::TextUnformatted(shortened(row.label, ImGui::GetContentRegionAvail().x).c_str());
  markItem(frame, kTissueArea, row.label);
  itemTooltip(frame, row.label + (row.isRigid ? ": rigid" : row.tissue.empty() ? "" : ": " + row.tissue));
  for (const Column &column : kColumns) {
    ImGui::TableNextColumn();
    numberCell(textOf(frame, column, row));
  }
}

}  // namespace

void drawTissueTable(FrameContext &frame, const TissueTable &table) {
  std::array<char, 128> &filter = frame.state.tissueFilter;
  frame.state.sideRows.row("tissues/filter");
  ImGui::SetNextItemWidth(-FLT_MIN);
  ImGui::InputTextWithHint("###tissue_filter", "Filter: kidney, lung left", filter.data(), filter.size());
  markItem(frame, kTissueArea, "filter");
  const std::vector<std::size_t> listed = listedRows(table, filter.data(), frame.state.tissueOrder);
  frame.automation.value(kTissueArea, "first", listed.empty() ? std::string() : table.rows[listed.front()].label);
  frame.automation.value(kTissueArea, "count", fmt::format("{} of {} labels", listed.size(), table.rows.size()));
  for (const std::size_t at : listed)
    for (const Column &column : kColumns)
      frame.automation.value(kTissueArea, table.rows[at].label + "." + column.id, (table.rows[at].*column.text)());
  ImGui::PushFont(frame.theme.small);
  const auto rows = static_cast<float>(std::clamp<std::size_t>(listed.size(), 1, kMaxRows) + 1);
  const float height = rows * (ImGui::GetTextLineHeight() + 2.0f * ImGui::GetStyle().CellPadding.y) + 2.0f;
  if (ImGui::BeginTable("tissues", 1 + static_cast<int>(kColumns.size()),
                        ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerH,
                        ImVec2(0.0f, height))) {
    headings(frame);
    for (const std::size_t at : listed) drawRow(frame, table.rows[at]);
    ImGui::EndTable();
  }
  ImGui::PopFont();
  if (listed.empty()) ImGui::TextColored(colour::kDim, "No label matches.");
  frame.state.sideRows.row("tissues/export");
  if (ImGui::Button("Export…###export")) frame.request(Command::exportTissues);
  markItem(frame, kTissueArea, "export");
  itemTooltip(frame, commandInfo(Command::exportTissues).doc);
}

}  // namespace c3de::ui
