// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "c3de/registry/panel_registry.h"
#include "c3de/scene/scene_graph.h"
#include "c3de/ui/measurement_list.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr float kNarrowest = 220.0f, kWidest = 900.0f;

bool section(FrameContext &frame, const std::string &area, const std::string &title, bool isOpenAtFirst) {
  frame.state.sideRows.row(area + "/header");
  ImGui::SetNextItemOpen(isOpenAtFirst, frame.state.layout.resetSections ? ImGuiCond_Always : ImGuiCond_Once);
  ImGui::PushFont(frame.theme.bold);
  const bool isOpen = ImGui::CollapsingHeader((title + "###" + area).c_str());
  ImGui::PopFont();
  markItem(frame, area, "header");
  return isOpen;
}

/// In its next drawing.
void openSection(const std::string &area, const std::string &title) {
  ImGui::GetStateStorage()->SetInt(ImGui::GetID((title + "###" + area).c_str()), 1);
}

void sceneTree(FrameContext &frame) {
  scene::SceneGraph *scene = frame.services.scene;
  if (!scene) return;
  const auto rows = scene->rows();
  if (rows.empty()) ImGui::TextColored(colour::kDim, "Nothing is loaded");
  int foldedAt = std::numeric_limits<int>::max();  // depth of the folded node that contains the next rows
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const scene::SceneGraph::Row &row = rows[i];
    scene::Node *node = scene->find(row.node);
    if (!node || row.depth > foldedAt) continue;
    foldedAt = node->isFolded ? row.depth : std::numeric_limits<int>::max();
    const bool isParent = i + 1 < rows.size() && rows[i + 1].depth > row.depth;
    frame.state.sideRows.row("scene/" + std::to_string(row.node.index));
    ImGui::PushID(static_cast<int>(row.node.index));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + static_cast<float>(row.depth) * frame.theme.px(16.0f));
    bool isVisible = node->visible;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(frame.theme.px(2.0f), frame.theme.px(1.0f)));
    if (ImGui::Checkbox("##visible", &isVisible)) {
      node->visible = isVisible;
      scene->touch();
    }
    ImGui::PopStyleVar();
    markItem(frame, "scene", node->name);
    itemTooltip(frame, isVisible ? "Shown; click to hide it and what is below it" : "Hidden; click to show it");
    ImGui::SameLine();
    const bool isShown = scene->isVisible(row.node);
    ImGui::PushStyleColor(ImGuiCol_Text, isShown ? colour::kText : colour::kDim);
    ImGui::TextUnformatted(elided(node->name, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::PopStyleColor();
    if (isParent) {
      ImGui::SameLine();
      ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0.0f, 0.0f));
      if (ImGui::ArrowButton("##fold", node->isFolded ? ImGuiDir_Right : ImGuiDir_Down))
        node->isFolded = !node->isFolded;
      ImGui::PopStyleVar();
      markItem(frame, "scene", node->name + "/fold");
      itemTooltip(frame, node->isFolded ? "Expand" : "Collapse");
    }
    ImGui::PopID();
  }
}

}  // namespace

void drawSidePanel(FrameContext &frame, ImGuiPanels &panels, const PixelRect &area) {
  beginFixed("##side", area, colour::kPanel, ImVec2(frame.theme.px(10.0f), frame.theme.px(8.0f)));
  // The scroll bar is in the padding.
  ImGui::BeginChild("scroll", ImVec2(ImGui::GetContentRegionAvail().x + frame.theme.px(7.0f), 0.0f));
  const Handle opened = frame.services.openedPanel ? frame.services.openedPanel() : Handle();
  const bool isRevealed = opened != std::exchange(frame.state.openedPanel, opened) && !opened.isNull();
  // It is to be seen, whatever is under the mouse.
  if (isRevealed) frame.state.sideRows = {};
  frame.state.sideRows.begin();
  if (section(frame, "scene", "Scene", true)) sceneTree(frame);
  if (TissueTable *tissues = frame.services.tissues) {
    tissues->isShown = !tissues->rows.empty();
    if (tissues->isShown) {
      ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
      tissues->isShown = section(frame, "tissues", "Tissues", false);
      if (tissues->isShown) drawTissueTable(frame, *tissues);
    }
  }
  if (MeasurementList *measurements = frame.services.measurements;
      measurements && (frame.simulation.exists || frame.shownImages() || !measurements->set().isEmpty())) {
    ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
    if (section(frame, "measurements", "Measurements", false)) drawMeasurements(frame, *measurements);
  }
  // Where all panels are folded, the first one is opened, and searched in the next frame.
  bool opensPanel = frame.state.isSearchWanted && !panels.beginSearch(frame);
  frame.state.isSearchWanted = false;
  float top = 0.0f;  // of the opened panel, in the contents
  if (frame.services.panels) {
    // By handle and by value: a panel may remove itself or others while it is drawn.
    std::vector<Handle> handles = frame.services.panels->handles();
    std::stable_partition(handles.begin(), handles.end(), [&](Handle one) { return one == opened; });
    for (const Handle handle : handles) {
      const registry::Panel *found = frame.services.panels->find(handle);
      if (!found || found->isInView) continue;
      const registry::Panel panel = *found;
      ImGui::Dummy(ImVec2(0, frame.theme.px(2.0f)));
      if (std::exchange(opensPanel, false)) {
        openSection(panel.id, panel.title);
        frame.state.isSearchWanted = true;
      }
      if (isRevealed && handle == opened) {
        openSection(panel.id, panel.title);
        top = ImGui::GetCursorPosY();
      }
      const bool isOpen = section(frame, panel.id, panel.title, panel.open);
      if (isOpen) panels.draw(frame, panel);
    }
  }
  frame.state.layout.resetSections = false;
  frame.state.sideRows.end();
  if (isRevealed) ImGui::SetScrollY(top);
  ImGui::EndChild();
  ImGui::End();
}

void drawViewPanels(FrameContext &frame, ImGuiPanels &panels) {
  if (!frame.services.panels) return;
  const PixelRect &area = frame.area;
  for (const Handle handle : std::vector<Handle>(frame.services.panels->handles())) {
    const registry::Panel *found = frame.services.panels->find(handle);
    if (!found || !found->isInView) continue;
    const registry::Panel panel = *found;
    const float width = std::min(frame.theme.px(560.0f), 0.9f * area.w);
    ImGui::SetNextWindowPos(ImVec2(area.x + 0.5f * area.w, area.y + 0.5f * area.h), ImGuiCond_Always,
                            ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, 0.9f * area.h));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(frame.theme.px(18.0f), frame.theme.px(14.0f)));
    ImGui::Begin(("##view-" + panel.id).c_str(), nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PopStyleVar();
    ImGui::PushFont(frame.theme.bold);
    ImGui::TextUnformatted(panel.title.c_str());
    ImGui::PopFont();
    panels.draw(frame, panel);
    const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
    frame.state.overlays.push_back({at.x, at.y, size.x, size.y});
    ImGui::End();
  }
}

void drawSplitter(FrameContext &frame, const PixelRect &area) {
  beginFixed("##splitter", area, colour::kChrome, ImVec2(0, 0));
  ImGui::InvisibleButton("grip", ImVec2(area.w, area.h));
  markItem(frame, "window", "splitter");
  const bool isHot = ImGui::IsItemHovered() || ImGui::IsItemActive();
  if (isHot) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  const ImVec4 tint = ImGui::IsItemActive() ? colour::kAccent : isHot ? colour::kAccentMid : colour::kLine;
  ImGui::GetWindowDrawList()->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), ImGui::GetColorU32(tint));
  if (ImGui::IsItemActive()) {
    const float wanted = (ImGui::GetIO().MousePos.x - 0.5f * area.w) / frame.theme.scale;
    const float room = static_cast<float>(frame.windowSize[0]) / frame.theme.scale - 240.0f;
    frame.state.layout.sideWidth = std::clamp(wanted, kNarrowest, std::max(kNarrowest, std::min(kWidest, room)));
  }
  ImGui::End();
}

}  // namespace c3de::ui
