// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/image_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "logic/label_list.h"
#include "logic/panel_widgets.h"

namespace c3de::ui {
namespace {

std::string sizeText(const imaging::VolumeGeometry &grid) {
  const Vec3 s = grid.spacing();
  return fmt::format("{} × {} × {} voxels of {:.3g} × {:.3g} × {:.3g} mm", grid.size[0], grid.size[1], grid.size[2],
                     s[0], s[1], s[2]);
}

struct CutNames {
  Pane pane;
  const char *id, *label, *withoutNear, *withoutFar;
};
constexpr std::array<CutNames, 3> kCutNames{{
    {Pane::axial, "cut_axial", "Axial cut (Shift+A)", "without what is above", "without what is below"},
    {Pane::sagittal, "cut_sagittal", "Sagittal cut (Shift+S)", "without the left", "without the right"},
    {Pane::coronal, "cut_coronal", "Coronal cut (Shift+C)", "without the front", "without the back"},
}};

}  // namespace

ImagePanel::ImagePanel(registry::PanelRegistry &panels, ImageViews &views, LabelMaps labelMaps)
    : panels_(panels), views_(views), labelMaps_(std::move(labelMaps)) {
  registry::Panel panel;
  panel.owner = "c3de";
  panel.id = "image";
  panel.title = "Image";
  panel.self = this;
  panel.onUi = [](void *self, const c3de_ui_v1 *ui) { static_cast<ImagePanel *>(self)->draw(*ui); };
  panel_ = panels_.add(std::move(panel));
}

ImagePanel::~ImagePanel() { panels_.remove(panel_); }

void ImagePanel::draw(const c3de_ui_v1 &ui) {
  const scene::StoredImage *image = views_.image();
  if (!image) return;
  row(ui, "Image", image->name);
  row(ui, "Grid", sizeText(image->volume.geometry));
  drawTime(ui, *image);
  ImageOptions options = views_.options();
  drawWindowLevel(ui, options);
  drawViews(ui, options);
  drawLabels(ui, options);
  drawVolume(ui, options);
  drawShift(ui, options);
  views_.setOptions(options);
}

void ImagePanel::drawTime(const c3de_ui_v1 &ui, const scene::StoredImage &image) {
  if (image.times < 2) return;
  const auto last = static_cast<double>(image.times - 1);
  auto time = static_cast<double>(image.time);
  const bool isMoved = slider(ui, "time", "Time point", fmt::format("of 0 … {}", image.times - 1), time, 0.0, last,
                              "T and Shift+T do the same while the mouse is over a slice");
  if (isMoved) views_.chooseTime(static_cast<std::size_t>(std::lround(std::clamp(time, 0.0, last))));
}

void ImagePanel::drawWindowLevel(const c3de_ui_v1 &ui, ImageOptions &options) {
  const imaging::ValueRange &range = views_.image()->range;
  const std::string &unit = views_.image()->volume.unit;
  heading(ui, "Window and level");
  const double width = std::max(range.max - range.min, 1e-9);
  WindowLevel &wl = options.windowLevel;
  slider(ui, "window", "Window", unit, wl.window, 1e-3 * width, std::max(width, 2.0 * wl.window),
         "Values from black to white");
  slider(ui, "level", "Level", unit, wl.level, std::min(range.min, wl.level), std::max(range.max, wl.level),
         "Value of middle grey");
  std::vector<std::string> names{"–"};
  std::uint32_t index = 0;
  for (const WindowLevelPreset &preset : windowLevelPresets()) {
    if (windowLevelOf(preset, range) == wl) index = static_cast<std::uint32_t>(names.size());
    names.push_back(fmt::format("{} ({})", preset.name, static_cast<char>(preset.key)));
  }
  if (choice(ui, "preset", "Preset", index, names) && index > 0)
    wl = windowLevelOf(windowLevelPresets()[index - 1], range);
  ui.tooltip(ui.ctx, toAbi(std::string_view("The digits do the same while the mouse is over a slice")));
  bool isOn = options.isWindowLevelMode;
  checkbox(ui, "window_level_mode", "Drag in slices changes them (W)", isOn,
           "Left drag: sideways the window, upwards brighter");
  options.isWindowLevelMode = isOn;
}

void ImagePanel::drawViews(const c3de_ui_v1 &ui, ImageOptions &options) {
  heading(ui, "Slices");
  std::uint32_t smooth = options.isSmooth ? 0 : 1;
  choice(ui, "interpolation", "Interpolation", smooth, {"linear", "nearest voxel"});
  options.isSmooth = smooth == 0;
  std::uint32_t convention = options.convention == Convention::radiological ? 0 : 1;
  choice(ui, "convention", "Convention", convention,
         {"radiological (right on the left)", "neurological (right on the right)"});
  options.convention = convention == 0 ? Convention::radiological : Convention::neurological;
  std::uint32_t alignment = options.isAlignedWithImage ? 0 : 1;
  choice(ui, "alignment", "Planes along", alignment, {"the image", "the patient"});
  options.isAlignedWithImage = alignment == 0;
  checkbox(ui, "cross_hair", "Cross-hair (C)", options.showsCrossHair, "");
  checkbox(ui, "outlines", "Outlines", options.showsOutlines,
           "Where the surfaces of the 3D view cut the slices: of bodies, implants, instruments and jaws, as they move");
  if (button(ui, "reset_views", "Reset views")) views_.resetViews();
}

void ImagePanel::drawLabels(const c3de_ui_v1 &ui, ImageOptions &options) {
  const scene::StoredLabels *labels = views_.labels();
  if (!labels) return;
  heading(ui, "Labels");
  const std::vector<std::string> maps = labelMaps_.names ? labelMaps_.names() : std::vector<std::string>();
  if (maps.size() > 1) {
    std::uint32_t index = static_cast<std::uint32_t>(labelMaps_.shown());
    if (choice(ui, "label_map", "Label map", index, maps)) return labelMaps_.show(index);
    tooltip(ui, "The label maps that have been opened over the image; one is shown");
  } else {
    row(ui, "Label map", labels->name);
  }
  slider(ui, "label_opacity", "Opacity", "", options.labelOpacity, 0.0, 1.0, "");
  const auto &all = labels->map.labels;
  const auto isShownInList = [&](const imaging::LabelMap::Label &label) {
    return all.size() <= kManyLabels || isListed(label.name, labelFilter_);
  };
  const auto listed = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), isShownInList));
  labelList(ui, all.size(), listed, labelFilter_, [&] {
    for (const imaging::LabelMap::Label &label : all) {
      if (!isShownInList(label)) continue;
      bool isShown = views_.labelOpacity(label.value) > 0.0f;
      const render::Colour colour = render::displayColour(label.colour);
      ui.swatch(ui.ctx, colour[0], colour[1], colour[2]);
      sameLine(ui);
      if (checkbox(ui, "label." + std::to_string(label.value), fmt::format("{}  {}", label.value, label.name), isShown,
                   ""))
        views_.setLabelOpacity(label.value, isShown ? 1.0f : 0.0f);
    }
  });
  if (all.size() < 2) return;
  const bool areShown = button(ui, "labels_show", "Show the listed", listed > 0);
  sameLine(ui);
  const bool areHidden = button(ui, "labels_hide", "Hide the listed", listed > 0);
  if (!areShown && !areHidden) return;
  for (const imaging::LabelMap::Label &label : all)
    if (isShownInList(label)) views_.setLabelOpacity(label.value, areShown ? 1.0f : 0.0f);
}

void ImagePanel::drawVolume(const c3de_ui_v1 &ui, ImageOptions &options) {
  heading(ui, "In the 3D view");
  checkbox(ui, "slices_in_space", "Slices as planes", options.showsSlicesInSpace, "");
  checkbox(ui, "volume", "Volume rendering", options.showsVolume, "Coarse while something moves, fine at rest");
  std::vector<std::string> names;
  std::uint32_t index = 0;
  for (const VolumePresetInfo &info : volumePresets()) {
    if (info.preset == options.volumePreset) index = static_cast<std::uint32_t>(names.size());
    names.emplace_back(info.name);
  }
  if (choice(ui, "volume_preset", "Technique", index, names)) {
    options.volumePreset = volumePresets()[index].preset;
    options.volumeShift = 0.0;
  }
  slider(ui, "volume_shift", "Shift", "", options.volumeShift, -1.0, 1.0,
         "Moves the colours over the values of the image");
  for (const CutNames &cut : kCutNames) {
    SliceCut &chosen = options.cuts[static_cast<std::size_t>(cut.pane)];
    auto part = static_cast<std::uint32_t>(chosen);
    if (choice(ui, cut.id, cut.label, part, {"whole", cut.withoutNear, cut.withoutFar}))
      chosen = static_cast<SliceCut>(part);
    ui.tooltip(ui.ctx, toAbi(std::string_view("Cuts at the slice, which goes through the cross-hair")));
  }
  checkbox(ui, "cuts_bodies", "Cut bodies too", options.cutsBodies, "Their surfaces, not how they move");
}

void ImagePanel::drawFixedRegions(const c3de_ui_v1 &ui, scene::SceneFixedRegions &still) {
  enum : std::uint32_t { kNothing, kBoneAndAir, kOutside, kValues };
  const bool byValues = still.above || still.below || !still.labels.empty();
  std::uint32_t index = still.outside ? kOutside : still.isAutomatic ? kBoneAndAir : byValues ? kValues : kNothing;
  const bool isChanged =
      choice(ui, "still", "Stays", index, {"nothing", "bone and air", "all outside of the bodies", "by values"});
  tooltip(ui,
          "Regions that do not move with the bodies; a gap opens where bodies move away. Bone and air: CT above 200 "
          "and below -400 HU, and labels of bone");
  const imaging::ValueRange &range = views_.image()->range;
  if (isChanged) {
    std::vector<std::string> labels = std::move(still.labels);
    still = {};
    still.isAutomatic = index == kBoneAndAir;
    still.outside = index == kOutside;
    if (index == kValues) {
      still.above = range.high;
      still.below = range.low;
      still.labels = std::move(labels);
    }
  }
  std::string names;
  for (const std::string &name : still.labels) names += (names.empty() ? "" : ", ") + name;
  if (!names.empty()) row(ui, "Fixed labels", names);
  const std::string &unit = views_.image()->volume.unit;
  if (still.below) slider(ui, "still_below", "Below", unit, *still.below, range.min, range.max, "Fixed values");
  if (still.above) slider(ui, "still_above", "Above", unit, *still.above, range.min, range.max, "Fixed values");
  if (still.above && still.below) still.above = std::max(*still.above, *still.below);
}

void ImagePanel::drawShift(const c3de_ui_v1 &ui, ImageOptions &options) {
  if (!views_.hasDisplacement()) return;
  heading(ui, "Displacement");
  drawFixedRegions(ui, options.still);
  drawOverlay(ui, options);
}

void ImagePanel::drawOverlay(const c3de_ui_v1 &ui, ImageOptions &options) {
  std::vector<std::string> names{"none", quantityOf(Overlay::shift).title, quantityOf(Overlay::volumeChange).title};
  constexpr auto kFirstField = static_cast<std::uint32_t>(Overlay::field);
  auto index = static_cast<std::uint32_t>(options.overlay);
  for (const auto &[name, unit] : views_.offeredFields()) {
    if (options.overlay == Overlay::field && name == options.overlayField)
      index = static_cast<std::uint32_t>(names.size());
    names.push_back(quantityOf(Overlay::field, name, unit).title);
  }
  if (choice(ui, "overlay", "Colours", index, names)) {
    options.overlay = static_cast<Overlay>(std::min(index, kFirstField));
    options.overlayField = index >= kFirstField ? views_.offeredFields()[index - kFirstField].first : std::string();
    options.hasFixedRange = false;
    return;
  }
  tooltip(ui,
          "Over the slices, where bodies are: how far the tissue has moved, how its volume has changed, and what the "
          "simulator has at its points");
  if (options.overlay == Overlay::none) return;
  const std::string unit = views_.overlayQuantity().unit;
  const OverlayRange automatic = views_.overlayRange();
  if (checkbox(ui, "overlay_fixed", "Fixed range", options.hasFixedRange,
               "Otherwise it grows when a value exceeds it and shrinks when no value exceeds two fifths of it"))
    options.fixedRange = automatic;
  if (!options.hasFixedRange) return row(ui, "Range", rangeText(automatic, unit));
  OverlayRange &range = options.fixedRange;
  const double most = 10.0 * roundedUp(std::max({std::abs(range.low), std::abs(range.high), 1e-6}));
  slider(ui, "overlay_high", "Up to", unit, range.high, -most, most, "");
  slider(ui, "overlay_low", "From", unit, range.low, -most, most,
         options.overlay == Overlay::shift ? "No overlay below this value" : "");
  if (!(range.low < range.high)) range.low = range.high - 1e-3 * std::max(std::abs(range.high), 1e-6);
}

}  // namespace c3de::ui
