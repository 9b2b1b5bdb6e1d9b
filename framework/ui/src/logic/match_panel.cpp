// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/match_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/core/path_text.h"
#include "c3de/registry/number_text.h"
#include "logic/panel_widgets.h"

namespace c3de::ui {
namespace {

constexpr double kLeastNoise_mm = 0.01, kMostNoise_mm = 50.0, kMostWeight = 1000.0, kLongestArrows = 50.0;
constexpr const char *kPointExtensions = "csv;fcsv;json";
constexpr std::size_t kListedLandmarks = 8;

}  // namespace

scene::SceneMatch MatchForm::match() const {
  scene::SceneMatch out = wanted;
  if (source != MatchSource::points) out.points.clear();
  if (source != MatchSource::surface) out.surface.clear();
  if (source != MatchSource::labels) out.labels = {};
  if (source == MatchSource::labels || source == MatchSource::stream) out.unit.reset();
  return out;
}

std::string MatchForm::whyNot() const {
  if (source == MatchSource::points && wanted.points.empty()) return "Choose the file of measured points.";
  if (source == MatchSource::surface && wanted.surface.empty()) return "Choose the file of the measured surface.";
  if (source == MatchSource::labels && wanted.labels.file.empty()) return "Choose a label map.";
  if (source == MatchSource::labels && label.empty()) return "State the label, by its number or its name.";
  if (source == MatchSource::stream && server.empty()) return "State the address of the tracking system.";
  if (!wanted.isRigidFirst && !wanted.deforms)
    return "Without rigid motion and deformation nothing is found. Choose one of them, or both.";
  if (wanted.body.empty()) return "Choose the body that was measured.";
  return {};
}

MatchForm matchFormOf(const scene::SceneMatch &match) {
  MatchForm form;
  form.wanted = match;
  form.label = match.labels.labelName;
  if (match.labels.label) form.label = std::to_string(*match.labels.label);
  if (!match.surface.empty()) form.source = MatchSource::surface;
  if (!match.labels.file.empty()) form.source = MatchSource::labels;
  return form;
}

MatchPanel::MatchPanel(registry::PanelRegistry &panels, MatchForm &form, Actions actions)
    : panels_(panels), form_(form), actions_(std::move(actions)) {
  const auto fill = [](PathText &text, const std::filesystem::path &file) {
    registry::copyText(text.data(), text.size(), pathText(file));
  };
  fill(points_, form.wanted.points);
  fill(surface_, form.wanted.surface);
  fill(labels_, form.wanted.labels.file);
  fill(landmarks_, form.wanted.landmarks);
  registry::Panel panel;
  panel.owner = "c3de";
  panel.id = "match";
  panel.title = "Match";
  panel.self = this;
  panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<MatchPanel *>(self)->draw(*ui); };
  panel_ = panels_.add(std::move(panel));
}

MatchPanel::~MatchPanel() { panels_.remove(panel_); }

void MatchPanel::draw(const c3de_ui_v1 &ui) {
  const MatchView view = actions_.view();
  drawMeasured(ui, view);
  drawLandmarks(ui);
  drawMotion(ui);
  drawButtons(ui, view);
  if (view.result != nullptr) drawResult(ui, *view.result, !view.progress && view.stream.empty());
}

void MatchPanel::fileRow(const c3de_ui_v1 &ui, const char *id, const char *label, const std::string &extensions,
                         const char *doc, PathText &path, std::filesystem::path &file) {
  const std::uint32_t chosen = ui.file_button(ui.ctx, toAbi(std::string_view(id)), toAbi(std::string_view(label)),
                                              toAbi(extensions), path.data(), path.size());
  tooltip(ui, doc);
  if ((chosen & C3DE_UI_CHANGED) != 0) file = pathFromText(path.data());
}

void MatchPanel::drawMeasured(const c3de_ui_v1 &ui, const MatchView &view) {
  scene::SceneMatch &wanted = form_.wanted;
  if (view.bodies.size() > 1) {
    const auto found = std::find(view.bodies.begin(), view.bodies.end(), wanted.body);
    auto index = static_cast<std::uint32_t>(found - view.bodies.begin());
    std::vector<std::string> names = view.bodies;
    if (found == view.bodies.end()) names.push_back("choose one");
    choice(ui, "body", "Body", index, names);
    tooltip(ui, "The body that was measured");
    wanted.body = index < view.bodies.size() ? view.bodies[index] : std::string();
  } else {
    wanted.body = view.bodies.empty() ? std::string() : view.bodies.front();
    row(ui, "Body", wanted.body.empty() ? "none" : wanted.body);
  }
  auto source = static_cast<std::uint32_t>(form_.source);
  choice(ui, "source", "Measured", source, {"points", "surface", "label", "points of a tracking system"});
  tooltip(ui,
          "Points on the surface, a surface or a part of it, the surface of a label of a label map, or points that "
          "a tracking system sends");
  form_.source = static_cast<MatchSource>(source);
  if (form_.source == MatchSource::points)
    fileRow(ui, "points", "Points…", kPointExtensions,
            "Points on the surface, LPS: CSV with the columns x, y, z, or .fcsv or .mrk.json of 3D Slicer", points_,
            wanted.points);
  if (form_.source == MatchSource::surface)
    fileRow(ui, "surface", "Surface…", view.meshExtensions, "The whole surface of the body, or a part of it", surface_,
            wanted.surface);
  if (form_.source == MatchSource::labels) drawLabels(ui, view);
  if (form_.source == MatchSource::stream) {
    inputText(ui, "server", "Server", form_.server);
    tooltip(ui,
            "HOST or HOST:PORT of an OpenIGTLink server. Each POINT message is matched; points with the name of a "
            "landmark of Measurements are that landmark");
    inputText(ui, "tool", "Tool", form_.tool);
    tooltip(ui,
            "Name of a tracked tool, such as a stylus: the surface is measured by moving its tip along it. Empty: the "
            "points of a frame are sent together, in a POINT message");
    if (!form_.tool.empty()) {
      double points = form_.toolPoints;
      slider(ui, "tool_points", "Points per frame", "", points, MatchForm::kFewestToolPoints,
             MatchForm::kMostToolPoints,
             "Points after which the body is matched. Positions of the tip within 2 mm count as one");
      form_.toolPoints = static_cast<std::uint32_t>(std::lround(points));
    }
  } else if (form_.source != MatchSource::labels) {
    static constexpr std::array<geometry::LengthUnit, 3> kUnits{
        geometry::LengthUnit::millimetre, geometry::LengthUnit::centimetre, geometry::LengthUnit::metre};
    const auto found =
        wanted.unit ? std::find(kUnits.begin(), kUnits.end(), *wanted.unit) - kUnits.begin() + 1 : std::ptrdiff_t{0};
    auto index = static_cast<std::uint32_t>(found);
    choice(ui, "unit", "Unit", index, {"as in the file, or mm", "mm", "cm", "m"});
    wanted.unit = index == 0 ? std::nullopt : std::optional(kUnits[index - 1]);
  }
  slider(ui, "noise", "Noise", "mm", wanted.noise_mm, kLeastNoise_mm, kMostNoise_mm,
         "Standard deviation of the measurement noise. It decides which points are outliers, and whether it explains "
         "the residual");
}

void MatchPanel::drawLabels(const c3de_ui_v1 &ui, const MatchView &view) {
  std::filesystem::path &file = form_.wanted.labels.file;
  if (!view.openLabels.empty() && file != view.openLabels) {
    if (button(ui, "open_labels", "Use the open label map")) {
      file = view.openLabels;
      registry::copyText(labels_.data(), labels_.size(), pathText(file));
    }
    tooltip(ui, "Its labels can then be chosen by name");
  }
  fileRow(ui, "labels", "Label map…", {},
          "A label map of the body in the position in which it was measured: NIfTI, NRRD, MetaImage, DICOM", labels_,
          file);
  if (!file.empty() && file == view.openLabels && !view.labelNames.empty()) {
    const auto found = std::find(view.labelNames.begin(), view.labelNames.end(), form_.label);
    auto index = static_cast<std::uint32_t>(found - view.labelNames.begin());
    std::vector<std::string> names = view.labelNames;
    if (found == view.labelNames.end()) names.push_back(form_.label.empty() ? "choose one" : form_.label);
    choice(ui, "label", "Label", index, names);
    if (index < view.labelNames.size()) form_.label = view.labelNames[index];
  } else {
    inputText(ui, "label", "Label", form_.label);
    tooltip(ui, "Number or name of the label");
  }
}

void MatchPanel::drawLandmarks(const c3de_ui_v1 &ui) {
  scene::SceneMatch &wanted = form_.wanted;
  if (form_.source != MatchSource::stream) drawTargetFile(ui);
  std::uint32_t use = wanted.fitsLandmarks ? 1 : 0;
  choice(ui, "use", "Landmarks", use, {"judge the result", "are fitted"});
  tooltip(ui, "Landmarks that judge the result are not fitted, so that they measure its error");
  wanted.fitsLandmarks = use == 1;
  if (wanted.fitsLandmarks)
    slider(ui, "weight", "Weight", "points", wanted.landmarkWeight, 1.0, kMostWeight,
           "Measured points that one landmark counts as in the search for the rigid motion");
}

void MatchPanel::drawTargetFile(const c3de_ui_v1 &ui) {
  scene::SceneMatch &wanted = form_.wanted;
  fileRow(ui, "landmarks", "Target landmarks…", kPointExtensions,
          "Where landmarks of Measurements with the same names were measured. Without a file: the targets of the "
          "landmarks, if they have any",
          landmarks_, wanted.landmarks);
  if (!wanted.landmarks.empty() && button(ui, "no_landmarks", "Without target landmarks")) {
    wanted.landmarks.clear();
    landmarks_ = {};
  }
}

void MatchPanel::drawMotion(const c3de_ui_v1 &ui) {
  checkbox(ui, "rigid", "Rigid motion first", form_.wanted.isRigidFirst,
           "Searches rotation and translation; no position is needed. Off: the points were measured in the space of "
           "the scene, and the body only deforms");
  checkbox(ui, "deform", "Deform the body", form_.wanted.deforms,
           "Finds the forces that deform the body until its surface meets the points. Off: the rigid motion only");
}

void MatchPanel::drawButtons(const c3de_ui_v1 &ui, const MatchView &view) {
  if (!view.stream.empty()) {
    row(ui, "Stream", view.stream);
    if (button(ui, "cancel", "Stop")) actions_.cancel();
    tooltip(ui, "Disconnects; the body keeps the shape of the last frame that was matched");
    return;
  }
  if (view.progress) {
    ui.progress(ui.ctx, view.progress->first, toAbi(view.progress->second));
    if (button(ui, "cancel", "Cancel", !view.isCancelling)) actions_.cancel();
    tooltip(ui, "The body stays as it is");
    return;
  }
  const std::string whyNot = view.whyNot.empty() ? form_.whyNot() : view.whyNot;
  if (button(ui, "match", "Match", whyNot.empty())) actions_.begin();
  tooltip(ui, whyNot.empty() ? "Pauses the simulation, and matches the body in the background" : whyNot.c_str());
  sameLine(ui);
  if (button(ui, "close", "Close")) actions_.close();
  tooltip(ui, "Closes this panel and hides the measured points; the body stays as it is");
  if (!whyNot.empty()) text(ui, whyNot);
}

void MatchPanel::drawResult(const c3de_ui_v1 &ui, const MatchTexts &result, bool canMatch) {
  for (std::size_t i = 0; i < result.sections.size(); ++i) {
    const MatchTexts::Section &section = result.sections[i];
    heading(ui, section.title.c_str());
    for (const MatchTexts::Row &one : section.rows) row(ui, one.name.c_str(), one.value);
    // What must not be trusted is stated below the verdict.
    if (i > 0) continue;
    for (const std::string &warning : result.warnings) text(ui, "Warning: " + warning + ".");
    drawCandidates(ui, result, canMatch);
  }
  if (!result.landmarks.empty()) {
    heading(ui, "Errors of the landmarks");
    const bool isLong = result.landmarks.size() > kListedLandmarks;
    if (isLong) ui.list_begin(ui.ctx, toAbi(std::string_view("landmark_errors")), kListedLandmarks);
    for (const MatchTexts::Row &one : result.landmarks) row(ui, one.name.c_str(), one.value);
    if (isLong) ui.list_end(ui.ctx);
  }
  slider(ui, "arrows", "Arrows", "×", arrowScale_, 1.0, kLongestArrows,
         "Factor by which the arrows are longer than the residuals. They point from the surface to the measured point");
  text(ui,
       "The measured points are drawn in the space of the body: moved by the inverse of the motion. The panel "
       "Scene shows and hides them.");
}

void MatchPanel::drawCandidates(const c3de_ui_v1 &ui, const MatchTexts &result, bool canMatch) {
  for (std::size_t i = 0; i < result.candidates.size(); ++i) {
    const std::string id = "candidate." + std::to_string(i);
    text(ui, result.candidates[i]);
    if (button(ui, id + ".show", i == result.shownCandidate ? "Shown" : "Show", i != result.shownCandidate))
      actions_.show(i);
    tooltip(ui, "Draws the measured points as this motion places them");
    sameLine(ui);
    if (button(ui, id + ".deform", "Deform from it", form_.wanted.deforms && canMatch)) actions_.deform(i);
    tooltip(ui, "Deforms the body from this motion. You decide that it is the right one");
  }
}

}  // namespace c3de::ui
