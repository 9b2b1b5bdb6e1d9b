// SPDX-License-Identifier: Apache-2.0
#include "logic/region_drawing.h"

#include <cmath>
#include <utility>

#include "c3de/abi/tools.h"

namespace c3de::ui {
namespace {

constexpr double kDrag_px = 3.0, kSameDirection = 1e-6;

/// All of the scan, with a voxel as the least width.
RegionBox regionOf(const segmentation::ScanBody &scan) {
  Vec3 voxel_mm{1, 1, 1};
  for (std::size_t a = 0; a < 3 && !scan.sources().layers.empty(); ++a) {
    Vec3 along{};
    along[a] = 1.0;
    voxel_mm[a] = voxelStep(scan.sources().layers.front()->map.geometry, along);
  }
  return {scan.extent_mm(), voxel_mm, scan.settings().region};
}

}  // namespace

RegionDrawing::RegionDrawing(ImageViews &images, segmentation::ScanBody &scan, double handle_px)
    : images_(images), scan_(scan), region_(regionOf(scan)), handle_px_(handle_px) {
  scan.hideTemporarily();
  images.showAtRest(true);
  const Vec3 right = images.view(Pane::axial).frame().right, down = images.view(Pane::coronal).frame().down;
  ImageOptions options = images.options();
  wasWindowLevel_ = std::exchange(options.isWindowLevelMode, false);
  images.setOptions(options);
  (void)follow();
  isTurned_ = dot(images.view(Pane::axial).frame().right, right) < 1.0 - kSameDirection ||
              dot(images.view(Pane::coronal).frame().down, down) < 1.0 - kSameDirection;
  if (images.maximised() == Pane::space) images.setMaximised({});
}

std::optional<BoxGrip> RegionDrawing::grip(Pane slice, double x, double y) const {
  if (press_) return press_->slice == slice ? std::optional(*region_.grip()) : std::nullopt;
  if (images_.isPicking() || images_.options().isWindowLevelMode) return {};
  return gripAt(images_.view(slice), region_, handle_px_, x, y);
}

bool RegionDrawing::follow() {
  ImageOptions options = images_.options();
  if (std::exchange(options.isAlignedWithImage, false)) {
    wasAligned_ = true;
    images_.setOptions(options);
  }
  if (!scan_.isShown() || scan_.extent_mm() != region_.limits()) return false;
  if (!scan_.isHiddenTemporarily()) keep();
  return scan_.isHiddenTemporarily();
}

bool RegionDrawing::handle(Pane slice, const ViewInput &input) {
  if (slice == Pane::space) return false;
  const SliceView &view = images_.view(slice);
  switch (input.kind) {
    case ViewInput::Kind::press: {
      const bool isFirst = buttons_ == 0;
      buttons_ |= input.button;
      if (press_) return true;
      const bool isPlain =
          input.button == C3DE_BUTTON_LEFT && (input.modifiers & (C3DE_MOD_SHIFT | C3DE_MOD_CTRL)) == 0;
      const std::optional<BoxGrip> grip = this->grip(slice, input.x, input.y);
      if (!isFirst || !isPlain || !grip) return false;
      press_ = Press{slice, input};
      region_.begin(*grip, view.worldAt(input.x, input.y));
      return true;
    }
    case ViewInput::Kind::move:
      // Hides hover markers of tools here.
      if (!press_) return buttons_ == 0 && (input.modifiers & C3DE_MOD_SHIFT) == 0;
      press_->isDrag = press_->isDrag || std::hypot(input.x - press_->input.x, input.y - press_->input.y) >= kDrag_px;
      if (press_->isDrag) region_.dragTo(view.worldAt(input.x, input.y));
      return true;
    case ViewInput::Kind::release:
      buttons_ &= ~input.button;
      if (!press_) return false;
      if (input.button == C3DE_BUTTON_LEFT) release(input);
      return true;
    default: return false;
  }
}

void RegionDrawing::release(const ViewInput &input) {
  const Press press = *std::exchange(press_, {});
  if (press.isDrag) return region_.finish();
  region_.takeBack();
  (void)images_.handle(press.slice, press.input);
  (void)images_.handle(press.slice, input);
}

bool RegionDrawing::cancelDrag() {
  buttons_ = 0;  // buttons that are still down are ignored until released
  region_.takeBack();
  return std::exchange(press_, {}).has_value();
}

void RegionDrawing::undo() {
  if (!cancelDrag()) region_.undo();
}

void RegionDrawing::redo() {
  if (!press_) region_.redo();
}

void RegionDrawing::takeAll() {
  (void)cancelDrag();
  region_.takeAll();
}

void RegionDrawing::end() {
  ImageOptions options = images_.options();
  options.isAlignedWithImage = wasAligned_;
  options.isWindowLevelMode = options.isWindowLevelMode || wasWindowLevel_;
  images_.setOptions(options);
  images_.showAtRest(false);
  scan_.show(scan_.isShown());
}

}  // namespace c3de::ui
