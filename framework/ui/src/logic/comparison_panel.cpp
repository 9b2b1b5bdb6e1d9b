// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/comparison_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "c3de/core/path_text.h"
#include "logic/panel_widgets.h"

namespace c3de::ui {
namespace {

constexpr double kLeastReach_mm = 400.0;

/// Middle of the first scan minus that of the second one, where it is at present.
Vec3 betweenMiddles(const Comparison &comparison, const scene::StoredImage &first) {
  const imaging::VolumeGeometry &grid = first.volume.geometry;
  Vec3 index{};
  for (std::size_t a = 0; a < 3; ++a) index[a] = 0.5 * (static_cast<double>(grid.size[a]) - 1.0);
  return grid.worldAt(index) - transformPoint(comparison.worldFromSecond(), comparison.centre_mm());
}

}  // namespace

ComparisonPanel::ComparisonPanel(registry::PanelRegistry &panels, Comparison &comparison, const ImageViews &views,
                                 Actions actions)
    : panels_(panels), comparison_(comparison), views_(views), actions_(std::move(actions)) {
  registry::Panel panel;
  panel.owner = "c3de";
  panel.id = "comparison";
  panel.title = "Comparison";
  panel.self = this;
  panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<ComparisonPanel *>(self)->draw(*ui); };
  panel_ = panels_.add(std::move(panel));
}

ComparisonPanel::~ComparisonPanel() { panels_.remove(panel_); }

void ComparisonPanel::draw(const c3de_ui_v1 &ui) {
  const scene::StoredImage *image = comparison_.image();
  if (!image || !views_.image()) return;
  const imaging::VolumeGeometry &grid = image->volume.geometry;
  const Vec3 s = grid.spacing();
  row(ui, "Second scan", image->name);
  row(ui, "Grid",
      fmt::format("{} × {} × {} voxels of {:.3g} × {:.3g} × {:.3g} mm", grid.size[0], grid.size[1], grid.size[2], s[0],
                  s[1], s[2]));
  drawLook(ui);
  drawPlace(ui);
  drawNumbers(ui);
  // The last one: the panel may be gone afterwards.
  const bool isRemoved = button(ui, "remove", "Remove comparison");
  tooltip(ui, "Closes the second scan; the open image stays");
  if (isRemoved) actions_.remove();
}

void ComparisonPanel::drawLook(const c3de_ui_v1 &ui) {
  ComparisonOptions options = comparison_.options();
  checkbox(ui, "shown", "Show it in the slices", options.isShown, "The open image alone, or both");
  std::uint32_t mode = options.isCheckerboard ? 1 : 0;
  choice(ui, "mode", "Both as", mode, {"blend", "checkerboard"});
  tooltip(ui, "Blend: a mean of both. Checkerboard: squares of the open image and of the second scan in turn");
  options.isCheckerboard = mode == 1;
  if (options.isCheckerboard) {
    slider(ui, "square", "Square", "mm", options.square_mm, Comparison::kSmallestSquare_mm,
           Comparison::kLargestSquare_mm, "Side of the squares");
  } else {
    double percent = 100.0 * options.blend;
    if (slider(ui, "blend", "Second scan", "%", percent, 0.0, 100.0,
               "0 %: only the open image; 100 %: only the second scan"))
      options.blend = 0.01 * percent;
  }
  const imaging::ValueRange &range = comparison_.image()->range;
  const std::string &unit = comparison_.image()->volume.unit;
  const double width = std::max(range.max - range.min, 1e-9);
  WindowLevel &wl = options.windowLevel;
  slider(ui, "window", "Window", unit, wl.window, 1e-3 * width, std::max(width, 2.0 * wl.window),
         "Values of the second scan from black to white");
  slider(ui, "level", "Level", unit, wl.level, std::min(range.min, wl.level), std::max(range.max, wl.level),
         "Value shown as middle grey");
  comparison_.setOptions(options);
}

void ComparisonPanel::drawPlace(const c3de_ui_v1 &ui) {
  heading(ui, "Alignment");
  const std::uint32_t chosen =
      ui.file_button(ui.ctx, toAbi(std::string_view("align")), toAbi(std::string_view("Align by landmarks…")),
                     toAbi(std::string_view("csv;fcsv;json")), landmarks_.data(), landmarks_.size());
  tooltip(ui,
          "A file of landmarks of the second scan: CSV, .fcsv or .mrk.json. Those with the names of landmarks in "
          "Measurements become pairs; at least three that are in no straight line");
  if ((chosen & C3DE_UI_CHANGED) != 0) actions_.align(pathFromText(landmarks_.data()));
  if (const auto alignment = comparison_.alignment()) {
    row(ui, "Pairs", std::to_string(alignment->pairs));
    row(ui, "Residual", fmt::format("mean {:.3f} mm, max {:.3f} mm", alignment->mean_mm, alignment->max_mm));
  }
  geometry::RigidPose pose = comparison_.pose();
  // Edits of finite numbers do not fail.
  if (button(ui, "centre", "Centre")) {
    pose.translation_mm = pose.translation_mm + betweenMiddles(comparison_, *views_.image());
    (void)comparison_.edit("centre comparison", pose);
  }
  tooltip(ui, "Moves the middle of the second scan to that of the open image");
  sameLine(ui);
  const geometry::RigidPose atFirst{{}, {}, comparison_.centre_mm()};
  if (button(ui, "reset", "Reset", comparison_.pose() != atFirst)) (void)comparison_.edit("reset comparison", atFirst);
  tooltip(ui, "Back to the position that its file states");
}

void ComparisonPanel::drawNumbers(const c3de_ui_v1 &ui) {
  struct Number {
    const char *id, *label, *doc;
    Vec3 geometry::RigidPose::*part;
    std::size_t axis;
  };
  static constexpr std::array<Number, 6> kNumbers{{
      {"x", "To the left", "Along x: to the patient's left", &geometry::RigidPose::translation_mm, 0},
      {"y", "To the back", "Along y: to the patient's back", &geometry::RigidPose::translation_mm, 1},
      {"z", "Upwards", "Along z: to the patient's head", &geometry::RigidPose::translation_mm, 2},
      {"rx", "About x", "About the axis to the left, first of the three", &geometry::RigidPose::rotation_deg, 0},
      {"ry", "About y", "About the axis to the back, second of the three", &geometry::RigidPose::rotation_deg, 1},
      {"rz", "About z", "About the axis upwards, last of the three", &geometry::RigidPose::rotation_deg, 2},
  }};
  const Vec3 between = betweenMiddles(comparison_, *views_.image());
  double reach_mm = kLeastReach_mm;
  for (const double one : {between[0], between[1], between[2], comparison_.pose().translation_mm[0],
                           comparison_.pose().translation_mm[1], comparison_.pose().translation_mm[2]})
    while (reach_mm < std::abs(one) + 100.0 && reach_mm < 1e9) reach_mm *= 2.0;
  for (const Number &number : kNumbers) {
    const bool isRotation = number.part == &geometry::RigidPose::rotation_deg;
    geometry::RigidPose pose = comparison_.pose();
    double &value = (pose.*number.part)[number.axis];
    const double most = isRotation ? 180.0 : reach_mm;
    const std::uint32_t result =
        ui.slider(ui.ctx, toAbi(std::string_view(number.id)), toAbi(std::string_view(number.label)),
                  toAbi(std::string_view(isRotation ? "°" : "mm")), &value, -most, most);
    tooltip(ui, number.doc);
    if ((result & C3DE_UI_CHANGED) != 0) comparison_.preview(pose);
    if ((result & C3DE_UI_COMMITTED) != 0)
      comparison_.finishPreview(isRotation ? "rotate comparison" : "move comparison");
  }
  text(ui, "Rotations are about the middle of the second scan. Move scan (V) and Turn scan (J) do the same by a drag.");
}

}  // namespace c3de::ui
