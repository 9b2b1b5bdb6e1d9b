// SPDX-License-Identifier: Apache-2.0
// Size and contents of a figure, and the size of screenshots.
#include <array>
#include <cmath>
#include <utility>

#include "c3de/registry/number_text.h"
#include "c3de/ui/views_picture.h"
#include "frame/file_dialog.h"
#include "panels/fields.h"
#include "window/chrome.h"

namespace c3de::ui {
namespace {

constexpr const char *kFigureArea = "figure";
struct FigureOption {
  const char *id, *label;
};
constexpr std::array<FigureOption, 6> kFigureViews{{{"shown", "As in the window"},
                                                    {"four", "All four"},
                                                    {"3d", "3D"},
                                                    {"axial", "Axial"},
                                                    {"sagittal", "Sagittal"},
                                                    {"coronal", "Coronal"}}};
constexpr std::array<FigureOption, 4> kFigureShapes{
    {{"shown", "As in the window"}, {"4_3", "4 : 3"}, {"1_1", "1 : 1"}, {"16_9", "16 : 9"}}};
constexpr std::array<FigureOption, 2> kFigureBackgrounds{{{"light", "Light"}, {"dark", "Dark"}}};

void figureLabel(const FrameContext &frame, const char *label) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  ImGui::SameLine(frame.theme.px(110.0f));
}

void figureNumber(FrameContext &frame, const char *id, const char *label, const char *unit, double &value,
                  const char *tooltip) {
  figureLabel(frame, label);
  ImGui::SetNextItemWidth(frame.theme.px(110.0f));
  double typed = value;
  if (ImGui::InputDouble((std::string("###") + id).c_str(), &typed, 0.0, 0.0, "%.6g") && std::isfinite(typed))
    value = typed;
  markItem(frame, kFigureArea, id);
  itemTooltip(frame, tooltip);
  frame.automation.value(kFigureArea, id, shortNumber(value));
  ImGui::SameLine();
  ImGui::TextUnformatted(unit);
}

template <typename Choice, std::size_t count>
void figureChoice(FrameContext &frame, const char *id, const char *label,
                  const std::array<FigureOption, count> &options, Choice &chosen, const std::string &whyNot = {}) {
  figureLabel(frame, label);
  ImGui::BeginDisabled(!whyNot.empty());
  ImGui::SetNextItemWidth(frame.theme.px(190.0f));
  const FigureOption &shown = options[static_cast<std::size_t>(chosen)];
  const bool isOpen = ImGui::BeginCombo((std::string("###") + id).c_str(), shown.label);
  markOpener(frame, kFigureArea, id, isOpen, whyNot.empty());
  if (isOpen) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto option = static_cast<Choice>(i);
      if (ImGui::Selectable(options[i].label, option == chosen)) chosen = option;
      markItem(frame, kFigureArea, std::string(id) + ".option." + options[i].id);
    }
    ImGui::EndCombo();
  }
  ImGui::EndDisabled();
  if (!isOpen) itemTooltip(frame, whyNot);
  frame.automation.value(kFigureArea, id, options[static_cast<std::size_t>(chosen)].id);
}

void figureBox(FrameContext &frame, const char *id, const char *label, bool &value, const char *tooltip) {
  ImGui::Checkbox((std::string(label) + "###" + id).c_str(), &value);
  markItem(frame, kFigureArea, id);
  itemTooltip(frame, tooltip);
  frame.automation.value(kFigureArea, id, value ? "true" : "false");
}

void drawFigureSettings(FrameContext &frame, FigureSettings &wanted) {
  figureNumber(frame, "width", "Width", "mm on paper", wanted.width_mm,
               "Often 80 to 90 mm for one column of a journal, 170 to 180 mm for two");
  figureNumber(
      frame, "dpi", "Resolution", "dpi", wanted.dpi,
      "Pixels per inch. The resolution is stored in the file, so other programs show the figure at its physical size");
  figureNumber(frame, "text", "Text", "pt", wanted.text_pt, "Size of the text on paper; lines are scaled with it");
  figureChoice(frame, "views", "Views", kFigureViews, wanted.views,
               frame.shownImages() ? "" : "Without an image there is only the 3D view.");
  figureChoice(frame, "shape", "Shape", kFigureShapes, wanted.shape);
  auto background = static_cast<std::size_t>(wanted.isLight ? 0 : 1);
  figureChoice(frame, "background", "Background", kFigureBackgrounds, background);
  wanted.isLight = background == 0;
  figureBox(frame, "notes", "Names, cross-hair, read-outs and axes", wanted.hasAnnotations,
            "Legends, scale bars, orientation letters and measurements are always drawn");
  figureBox(frame, "caption", "Time and forces of the simulation", wanted.hasCaption,
            "The simulated time, and the force on each probe tool");
}

void chooseFigureFile(FrameContext &frame, const FigureSettings &wanted) {
  FileDialog::Request request;
  request.isSaving = true;
  request.title = "Save figure";
  request.extensions = "png";
  const std::string name = frame.actions.proposeName ? frame.actions.proposeName(Command::saveFigure) : std::string();
  request.proposed = (name.empty() ? std::string("figure") : name) + ".png";
  request.note = sizeText(wanted, static_cast<double>(frame.area.w / frame.area.h));
  request.chosen = [save = frame.actions.figures.save, wanted](const std::filesystem::path &file, const std::string &) {
    save(wanted, file);
  };
  frame.fileDialog.open(std::move(request));
}

/// Whether the figure is divided into four views.
bool hasFourViews(const FrameContext &frame, FigureViews wanted) {
  const ImageViews *images = frame.shownImages();
  if (!images) return false;
  return wanted == FigureViews::four || (wanted == FigureViews::shown && !images->maximised());
}

}  // namespace

void drawFigureDialog(FrameContext &frame) {
  FigureDialog &dialog = frame.state.figure;
  const FigureActions &actions = frame.actions.figures;
  if (!actions.settings || !actions.save) dialog.isShown = false;
  if (!dialog.isShown || frame.fileDialog.isOpen()) return;
  if (!std::exchange(dialog.isFilled, true)) dialog.wanted = actions.settings();
  bool isShown = true;
  if (!beginDialog(frame, "Save figure", "save_figure", isShown, ImVec2(440, 344))) {
    dialog.isShown = isShown;
    return;
  }
  drawFigureSettings(frame, dialog.wanted);
  const double aspect = frame.area.isEmpty() ? 1.0 : static_cast<double>(frame.area.w / frame.area.h);
  const std::string problem =
      problemOf(dialog.wanted, aspect, largestFigureSide(hasFourViews(frame, dialog.wanted.views)));
  const std::string text = problem.empty() ? sizeText(dialog.wanted, aspect) : problem;
  ImGui::BeginChild("size", ImVec2(0, 2.0f * ImGui::GetTextLineHeightWithSpacing()));
  ImGui::PushStyleColor(ImGuiCol_Text, problem.empty() ? colour::kDim : colour::kError);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  ImGui::EndChild();
  frame.automation.value(kFigureArea, "size", text);
  ImGui::BeginDisabled(!problem.empty());
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kPrimary);
  const bool isSaved = ImGui::Button("Save…", ImVec2(frame.theme.px(120.0f), 0));
  ImGui::PopStyleColor();
  ImGui::EndDisabled();
  markItem(frame, kFigureArea, "save", problem.empty());
  itemTooltip(frame, problem.empty() ? "Choose a file, then write the figure as PNG" : problem);
  ImGui::SameLine();
  if (isSaved) {
    isShown = false;
    ImGui::CloseCurrentPopup();
  }
  endDialog(frame, isShown);
  dialog.isShown = isShown;
  if (isSaved) chooseFigureFile(frame, dialog.wanted);
}

void drawScreenshotMenu(FrameContext &frame) {
  const FigureActions &actions = frame.actions.figures;
  if (!actions.screenshotSize || !actions.setScreenshotSize) return;
  const bool isOpen = ImGui::BeginMenu("Screenshot size");
  markOpener(frame, "menu", "file.screenshot_size", isOpen);
  if (!isOpen) return;
  const ScreenshotSize chosen = actions.screenshotSize();
  for (const ScreenshotSize size :
       {ScreenshotSize::view, ScreenshotSize::fullHd, ScreenshotSize::ultraHd, ScreenshotSize::figure}) {
    if (ImGui::MenuItem(nameOf(size), nullptr, size == chosen)) actions.setScreenshotSize(size);
    markItem(frame, "menu", std::string("file.screenshot_size.") + idOf(size));
    itemTooltip(frame, size == ScreenshotSize::figure ? "F12 writes a figure with the settings of File > Save figure…"
                                                      : "F12 writes the 3D view, without overlays");
  }
  ImGui::EndMenu();
}

}  // namespace c3de::ui
