// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/image_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/abi/tools.h"
#include "c3de/ui/commands.h"

namespace c3de::ui {
namespace {

constexpr double kPixelsPerZoomStep = 20.0, kDoubleClick_s = 0.4, kDoubleClick_px = 5.0;
constexpr float kFaint = 0.25f;
constexpr float kLabelsBelowField = 0.3f;  // otherwise the colours of the field would differ from the legend
constexpr int kFastScroll = 10;
constexpr int kMovingDivisor = 4;
constexpr double kAir_HU = -900.0;
// Colour ranges smaller than these show only round-off.
constexpr double kMinShift_mm = 0.1, kMinChange_percent = 0.1, kMinField = 1e-3;
constexpr std::array<render::Colour, 3> kPaneColours{
    {{0.86f, 0.36f, 0.36f, 1}, {0.88f, 0.76f, 0.30f, 1}, {0.40f, 0.74f, 0.42f, 1}}};

SliceAxis axisOf(Pane pane) {
  return pane == Pane::axial ? SliceAxis::axial : pane == Pane::sagittal ? SliceAxis::sagittal : SliceAxis::coronal;
}

/// The side of a slice that faces the viewer.
Vec3 nearSide(Pane pane) {
  return pane == Pane::axial ? Vec3{0, 0, 1} : pane == Pane::sagittal ? Vec3{1, 0, 0} : Vec3{0, -1, 0};
}

}  // namespace

const char *paneName(Pane pane) {
  static constexpr const char *kNames[] = {"axial", "sagittal", "coronal", "3D"};
  return kNames[static_cast<std::size_t>(pane)];
}

std::string Readout::placeText() const {
  const auto number = [&](double v) {
    const double shown = std::abs(v) < 0.05 ? 0.0 : v * length.factor;
    return fmt::format("{:.{}f}", shown, length.factor < 1.0 ? 2 : 1);
  };
  std::string text = "LPS " + number(world[0]) + ", " + number(world[1]) + ", " + number(world[2]) + " " + length.name;
  if (isEmptied) {
    text += "   vacated by a body";
  } else if (index) {
    text += fmt::format("   [{}, {}, {}]   ", (*index)[0], (*index)[1], (*index)[2]) + fmt::format("{:.6g}", value);
    if (!unit.empty()) text += " " + unit;
    if (!label.empty()) text += "   " + label;
  }
  if (second) text += fmt::format("   second {:.6g}{}{}", *second, secondUnit.empty() ? "" : " ", secondUnit);
  return text;
}

std::string Readout::tissueText() const {
  if (isEmptied || !index || !shift) return {};
  std::string text = fmt::format("|u| {:.{}f} {}", *shift * length.factor, length.factor < 1.0 ? 3 : 2, length.name);
  if (volumeRatio) text += fmt::format("   det F {:.3f}", *volumeRatio);
  if (field)
    text += fmt::format("   {} {:.3g}{}{}", fieldQuantity.title, fieldQuantity.shown(*field),
                        fieldQuantity.unit.empty() ? "" : " ", fieldQuantity.unit);
  return text;
}

std::string Readout::text() const {
  const std::string tissue = tissueText();
  return placeText() + (tissue.empty() ? "" : "   ") + tissue;
}

void viewOfImages(render::Camera &camera) {
  camera.upAxis = render::UpAxis::z;
  resetCamera(camera);
}

void ImageViews::setImage(std::shared_ptr<const scene::StoredImage> image) {
  image_ = std::move(image);
  labels_.reset();
  displacement_.reset();
  handles_ = {};
  missingText_.clear();
  labelOpacities_.clear();
  drag_ = Drag::none;
  maximised_.reset();
  beforeClick_.reset();
  picked_ = nullptr;
  if (!image_) return;
  options_.windowLevel = automaticWindowLevel(image_->range);
  // Files without a unit are recognised by the value of air.
  const bool isTomography = image_->volume.unit == "HU" || image_->range.min <= kAir_HU;
  options_.volumePreset = isTomography ? VolumePreset::ctBone : VolumePreset::magneticResonance;
  options_.volumeShift = 0.0;
  options_.cuts = {};
  options_.overlay = Overlay::none;
  options_.hasFixedRange = false;
  steadyRange_.forget();
  for (const Pane pane : kSlicePanes) view(pane).setGrid(image_->volume.geometry);
  applyFrames();
  resetViews();
}

void ImageViews::setUnits(const DisplayUnits &units) {
  const Quantity before = overlayQuantity();
  units_ = units;
  const Quantity after = overlayQuantity();
  for (double *bound : {&options_.fixedRange.low, &options_.fixedRange.high})
    *bound = after.shown(before.value(*bound));
  steadyRange_.forget();
  followRange();
}

void ImageViews::replaceImage(std::shared_ptr<const scene::StoredImage> image, Handle handle) {
  image_ = std::move(image);
  handles_.image = handle;
}

void ImageViews::chooseTime(std::size_t time) {
  if (image_ && chooseTime_ && time < image_->times && time != image_->time) chooseTime_(time);
}

void ImageViews::setLabels(std::shared_ptr<const scene::StoredLabels> labels) {
  labels_ = std::move(labels);
  labelOpacities_.clear();
  pickedLabels_.clear();
}

void ImageViews::applyFrames() {
  if (!image_) return;
  const imaging::VolumeGeometry *grid = options_.isAlignedWithImage ? &image_->volume.geometry : nullptr;
  for (const Pane pane : kSlicePanes) view(pane).setFrame(sliceFrame(axisOf(pane), options_.convention, grid));
}

void ImageViews::setDisplacement(std::shared_ptr<const imaging::DisplacementGrid> displacement) {
  displacement_ = std::move(displacement);
  followRange();
}

void ImageViews::showAtRest(bool isAtRest) {
  isAtRest_ = isAtRest;
  followRange();
}

bool ImageViews::wantsFields() const {
  return showsDisplacement() &&
         (isPointedAt_ || options_.overlay == Overlay::volumeChange || options_.overlay == Overlay::field);
}

const imaging::TissueField *ImageViews::shownField() const {
  if (!warp()) return nullptr;
  if (options_.overlay == Overlay::volumeChange) return warp()->field(imaging::kVolumeRatio);
  return options_.overlay == Overlay::field ? warp()->field(options_.overlayField) : nullptr;
}

Quantity ImageViews::overlayQuantity() const {
  std::string unit;
  for (const auto &[name, ofIt] : offered_)
    if (name == options_.overlayField) unit = ofIt;
  return quantityOf(options_.overlay, options_.overlayField, unit, units_);
}

OverlayRange ImageViews::overlayRange() const {
  return options_.hasFixedRange ? options_.fixedRange : steadyRange_.range();
}

void ImageViews::followRange() {
  const Quantity quantity = overlayQuantity();
  if (options_.overlay == Overlay::shift && displacement_) {
    double squared = 0.0;
    for (std::size_t i = 0; i + 2 < displacement_->xyz_mm.size(); i += 3) {
      const float *u = &displacement_->xyz_mm[i];
      squared = std::max(squared, static_cast<double>(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
    }
    steadyRange_.follow(0.0, quantity.shown(std::sqrt(squared)), false, quantity.shown(kMinShift_mm));
  } else if (const imaging::TissueField *field = shownField()) {
    const bool isChange = options_.overlay == Overlay::volumeChange;
    steadyRange_.follow(quantity.shown(field->low), quantity.shown(field->high), isChange,
                        isChange ? kMinChange_percent : kMinField);
  }
}

void ImageViews::setOptions(const ImageOptions &options) {
  const bool isOther = options.overlay != options_.overlay || options.overlayField != options_.overlayField;
  const bool isTurned =
      options.convention != options_.convention || options.isAlignedWithImage != options_.isAlignedWithImage;
  options_ = options;
  if (isOther) {
    steadyRange_.forget();
    followRange();
  }
  if (isTurned) applyFrames();
}

float ImageViews::labelOpacity(std::uint16_t value) const {
  for (const auto &[label, opacity] : labelOpacities_)
    if (label == value) return opacity;
  return 1.0f;
}

void ImageViews::setLabelOpacity(std::uint16_t value, float opacity) {
  std::erase_if(labelOpacities_, [&](const auto &entry) { return entry.first == value; });
  labelOpacities_.emplace_back(value, opacity);
}

std::vector<std::pair<std::uint16_t, render::Colour>> ImageViews::labelColours() const {
  std::vector<std::pair<std::uint16_t, render::Colour>> colours;
  if (!labels_) return colours;
  for (const imaging::LabelMap::Label &label : labels_->map.labels) {
    const bool isFaint = !pickedLabels_.empty() &&
                         std::find(pickedLabels_.begin(), pickedLabels_.end(), label.value) == pickedLabels_.end();
    colours.push_back(
        {label.value, render::displayColour(label.colour, (isFaint ? kFaint : 1.0f) * labelOpacity(label.value))});
  }
  return colours;
}

void ImageViews::setCrossHair(const Vec3 &world) {
  crossHair_ = nearestInImage(world);
  for (const Pane pane : kSlicePanes)
    if (!view(pane).isOnSlice(crossHair_)) view(pane).showPoint(crossHair_);
}

Vec3 ImageViews::nearestInImage(const Vec3 &world) const {
  if (!image_) return world;
  // Of the voxels, whose centres are at integer indices.
  constexpr double kInside = 1e-6;
  const imaging::VolumeGeometry &grid = image_->volume.geometry;
  const Vec3 index = transformPoint(imaging::affineInverse(grid.indexToWorld), world);
  Vec3 inside{};
  for (std::size_t a = 0; a < 3; ++a)
    inside[a] = std::clamp(index[a], -0.5 + kInside, static_cast<double>(grid.size[a]) - 0.5 - kInside);
  return inside == index ? world : grid.worldAt(inside);
}

void ImageViews::undoClick() {
  if (!beforeClick_) return;
  crossHair_ = beforeClick_->crossHair;
  views_ = beforeClick_->views;
  beforeClick_.reset();
}

void ImageViews::resetViews() {
  for (SliceView &view : views_) view.reset();
  // Intersection of the middle slices.
  const SliceView &axial = view(Pane::axial), &sagittal = view(Pane::sagittal), &coronal = view(Pane::coronal);
  const Vec3 middle = axial.worldAt(0.5 * axial.width(), 0.5 * axial.height());
  crossHair_ = middle;
  for (const SliceView *other : {&sagittal, &coronal}) {
    const Vec3 at = other->worldAt(0.5 * other->width(), 0.5 * other->height());
    crossHair_ = crossHair_ + dot(at - crossHair_, other->frame().forward) * other->frame().forward;
  }
}

bool ImageViews::isSliceKey(std::uint32_t key, std::uint32_t modifiers) {
  if ((modifiers & ~C3DE_MOD_SHIFT) != 0) return false;
  switch (key) {
    case keyUp:
    case keyDown:
    case keyLeft:
    case keyRight:
    case 'B':
    case 'F':
    case 'T': return true;
    default: {
      const auto presets = windowLevelPresets();
      return modifiers == 0 &&
             std::any_of(presets.begin(), presets.end(), [&](const WindowLevelPreset &p) { return p.key == key; });
    }
  }
}

bool ImageViews::handle(Pane slice, const ViewInput &input) {
  if (!image_ || slice == Pane::space) return false;
  bool isChanged = false;
  switch (input.kind) {
    case ViewInput::Kind::press: isChanged = press(slice, input); break;
    case ViewInput::Kind::release:
      buttons_ &= ~input.button;
      if (input.button == dragButton_) drag_ = Drag::none;
      break;
    case ViewInput::Kind::move: isChanged = move(slice, input); break;
    case ViewInput::Kind::wheel: {
      if (input.wheel == 0.0) break;
      if (input.modifiers & C3DE_MOD_CTRL)
        view(slice).zoom(input.wheel, input.x, input.y);
      else
        view(slice).scroll((input.wheel > 0.0 ? 1 : -1) * std::max(1, static_cast<int>(std::abs(input.wheel) + 0.5)) *
                           (input.modifiers & C3DE_MOD_SHIFT ? kFastScroll : 1));
      isChanged = true;
      break;
    }
    case ViewInput::Kind::key: isChanged = pressKey(slice, input); break;
  }
  lastX_ = input.x;
  lastY_ = input.y;
  return isChanged;
}

Vec3 ImageViews::referenceAt(const Vec3 &world) const { return warp() ? world - warp()->at(world) : world; }

bool ImageViews::press(Pane slice, const ViewInput &input) {
  const bool isFirst = buttons_ == 0;
  buttons_ |= input.button;
  if (!isFirst) return false;
  if (picked_ && input.button == C3DE_BUTTON_LEFT && input.modifiers == 0) {
    std::exchange(picked_, nullptr)(referenceAt(view(slice).worldAt(input.x, input.y)));
    return true;
  }
  dragButton_ = input.button;
  startX_ = input.x;
  startY_ = input.y;
  if (input.button == C3DE_BUTTON_MIDDLE)
    drag_ = Drag::pan;
  else if (input.button == C3DE_BUTTON_RIGHT)
    drag_ = Drag::zoom;
  else if (input.modifiers & C3DE_MOD_SHIFT)
    drag_ = Drag::pan;
  else if (input.modifiers & C3DE_MOD_CTRL)
    drag_ = Drag::zoom;
  else if (options_.isWindowLevelMode)
    drag_ = Drag::windowLevel;
  else {
    drag_ = Drag::crossHair;
    beforeClick_ = Click{crossHair_, views_};
    setCrossHair(view(slice).worldAt(input.x, input.y));
  }
  return true;
}

bool ImageViews::move(Pane slice, const ViewInput &input) {
  const double dx = input.x - lastX_, dy = input.y - lastY_;
  switch (drag_) {
    case Drag::crossHair: setCrossHair(view(slice).worldAt(input.x, input.y)); return true;
    case Drag::windowLevel: options_.windowLevel = dragged(options_.windowLevel, dx, dy, image_->range); return true;
    case Drag::pan: view(slice).pan(dx, dy); return true;
    case Drag::zoom: view(slice).zoom(-dy / kPixelsPerZoomStep, startX_, startY_); return true;
    case Drag::none:
      if (buttons_ != 0 || !(input.modifiers & C3DE_MOD_SHIFT)) return false;
      setCrossHair(view(slice).worldAt(input.x, input.y));
      return true;
  }
  return false;
}

bool ImageViews::pressKey(Pane slice, const ViewInput &input) {
  if (!isSliceKey(input.key, input.modifiers)) return false;
  const int slices = input.modifiers & C3DE_MOD_SHIFT ? kFastScroll : 1;
  switch (input.key) {
    case keyUp:
    case keyRight:
    case 'F': view(slice).scroll(slices); return true;
    case keyDown:
    case keyLeft:
    case 'B': view(slice).scroll(-slices); return true;
    case 'T':
      if ((input.modifiers & C3DE_MOD_SHIFT) == 0)
        chooseTime(image_->time + 1);
      else if (image_->time > 0)
        chooseTime(image_->time - 1);
      return true;
    default: break;
  }
  for (const WindowLevelPreset &preset : windowLevelPresets())
    if (preset.key == input.key) options_.windowLevel = windowLevelOf(preset, image_->range);
  return true;
}

Readout ImageViews::readout(const Vec3 &world) const {
  Readout readout = readoutOfImage(world);
  if (isCompared()) {
    readout.second = comparison_->valueAt(world);
    readout.secondUnit = comparison_->image()->volume.unit;
  }
  return readout;
}

Readout ImageViews::readoutOfImage(const Vec3 &world) const {
  Readout readout;
  readout.world = world;
  readout.length = displayUnit(units_, "mm");
  if (!image_) return readout;
  Vec3 material = world;
  if (const imaging::DisplacementGrid *warp = this->warp()) {
    const Vec3 u = warp->at(world);
    material = world - u;
    readout.shift = norm(u);
    readout.isEmptied = warp->isEmptied(world);
    if (readout.isEmptied) return readout;
    for (const imaging::TissueField &field : warp->fields) {
      const std::optional<double> value = warp->valueOf(field, world);
      if (field.name == imaging::kVolumeRatio) {
        readout.volumeRatio = value;
      } else {
        readout.field = value;
        readout.fieldQuantity = quantityOf(Overlay::field, field.name, field.unit, units_);
      }
    }
  }
  const imaging::VolumeGeometry &grid = image_->volume.geometry;
  const Vec3 at = transformPoint(imaging::affineInverse(grid.indexToWorld), material);
  readout.index = imaging::voxelAt(grid, at);
  if (!readout.index) return readout;
  const std::array<std::size_t, 3> &index = *readout.index;
  readout.value = image_->volume.value(index[0], index[1], index[2]);
  readout.unit = image_->volume.unit;
  if (labels_)
    if (const std::uint16_t label = labels_->at(material); label != 0) {
      readout.label = labels_->nameOf(label);
      if (readout.label.empty()) readout.label = "label " + std::to_string(label);
    }
  return readout;
}

render::ImageDisplay ImageViews::look() const {
  render::ImageDisplay look;
  look.image = handles_.image;
  look.labels = handles_.preview.isNull() || !options_.showsPreview ? handles_.labels : handles_.preview;
  look.displacement = isAtRest_ ? Handle{} : handles_.displacement;
  look.bodies = handles_.bodies;
  look.hasFixedRegions = warp() && warp()->hasFixedRegions;
  look.missing = handles_.missing;
  if (isCompared()) look.comparison = comparison_->look();
  look.leastGap = warp() ? warp()->leastGap() : 0.0;
  look.window = options_.windowLevel.window;
  look.level = options_.windowLevel.level;
  look.isSmooth = options_.isSmooth;
  look.labelOpacity = static_cast<float>(options_.labelOpacity);
  const Quantity quantity = overlayQuantity();
  const OverlayRange range = overlayRange();
  if (options_.overlay == Overlay::shift) look.overlay = render::Overlay::shift;
  if (shownField()) {
    look.overlay = render::Overlay::field;
    look.labelOpacity *= kLabelsBelowField;
  }
  look.overlayLow = quantity.value(range.low);
  look.overlayHigh = quantity.value(range.high);
  return look;
}

render::ImageScene ImageViews::scene() const {
  render::ImageScene scene;
  if (!image_ || !isVisibleInSpace_) return scene;
  scene.look = look();
  if (options_.showsSlicesInSpace)
    for (const Pane pane : kSlicePanes) {
      const SliceView &v = view(pane);
      scene.slices.push_back({v.worldAt(0.5 * v.width(), 0.5 * v.height()), v.frame().forward,
                              kPaneColours[static_cast<std::size_t>(pane)], v.frame().right});
    }
  for (const Pane pane : kSlicePanes) {
    const SliceCut cut = options_.cuts[static_cast<std::size_t>(pane)];
    if (cut == SliceCut::none) continue;
    const SliceView &v = view(pane);
    const bool isNear = dot(v.frame().forward, nearSide(pane)) > 0.0;
    const double sign = isNear == (cut == SliceCut::nearPart) ? 1.0 : -1.0;
    scene.cuts.push_back({v.worldAt(0.5 * v.width(), 0.5 * v.height()), sign * v.frame().forward});
  }
  scene.cutsProxies = options_.cutsBodies;
  scene.showsVolume = options_.showsVolume;
  if (options_.showsVolume) scene.volume = volumeLook(options_.volumePreset, image_->range, options_.volumeShift);
  scene.movingDivisor = kMovingDivisor;
  return scene;
}

void ImageViews::cycleCut(Pane slice) {
  SliceCut &cut = options_.cuts[static_cast<std::size_t>(slice)];
  cut = cut == SliceCut::none ? SliceCut::nearPart : cut == SliceCut::nearPart ? SliceCut::farPart : SliceCut::none;
}

bool DoubleClick::press(Pane pane, const ViewInput &input) {
  const bool isPlain = input.button == C3DE_BUTTON_LEFT && input.modifiers == 0;
  const bool isSecond = isPlain && pane_ == pane && input.time_s - time_s_ <= kDoubleClick_s &&
                        std::hypot(input.x - x_, input.y - y_) <= kDoubleClick_px;
  pane_ = isPlain && !isSecond ? std::optional(pane) : std::nullopt;
  x_ = input.x;
  y_ = input.y;
  time_s_ = input.time_s;
  return isSecond;
}

}  // namespace c3de::ui
