// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/imaging/displacement.h"
#include "c3de/scene/image_store.h"
#include "c3de/scene/scene_file.h"
#include "c3de/ui/comparison.h"
#include "c3de/ui/display_units.h"
#include "c3de/ui/image_presets.h"
#include "c3de/ui/overlay.h"
#include "c3de/ui/slice_view.h"
#include "c3de/ui/view_controller.h"

namespace c3de::ui {

enum class Pane { axial, sagittal, coronal, space };
inline constexpr std::array kSlicePanes{Pane::axial, Pane::sagittal, Pane::coronal};
[[nodiscard]] const char *paneName(Pane pane);  ///< "axial", …, "3D"

/// The part that the 3D view cuts away at a slice.
enum class SliceCut {
  none,
  nearPart,  ///< above, left or in front of it: the side that faces the viewer in an image's first view
  farPart
};

/// Display options of images that the user sets.
struct ImageOptions {
  WindowLevel windowLevel;
  bool isSmooth = true;
  double labelOpacity = 0.4;
  bool showsSlicesInSpace = true, showsVolume = false;
  VolumePreset volumePreset = VolumePreset::ctBone;
  double volumeShift = 0.0;         ///< -1 … 1
  std::array<SliceCut, 3> cuts{};   ///< in the 3D view, by slice pane
  bool cutsBodies = true;           ///< also cuts what is next to the image there
  Overlay overlay = Overlay::none;  ///< colours over the slices
  std::string overlayField;         ///< name of the field it shows
  bool hasFixedRange = false;       ///< of the overlay; otherwise the range follows the visible values
  OverlayRange fixedRange;
  scene::SceneFixedRegions still;  ///< what does not move with the bodies
  Convention convention = Convention::radiological;
  bool isAlignedWithImage = true;  ///< views along the image's axes; otherwise along the patient's
  bool showsCrossHair = true;
  bool isWindowLevelMode = false;   ///< a left drag in a slice changes window and level; otherwise it moves the
                                    ///< cross-hair
  bool showsOutlines = true;        ///< surfaces of the 3D view, intersected with the slices
  bool showsPreview = true;         ///< the present selection, instead of the labels
  bool showsPreviewSurface = true;  ///< its surface in the 3D view
};

/// Renderer handles of what is shown; set by the owner of the renderer.
struct ImageHandles {
  Handle image, labels, displacement;
  Handle preview{};  ///< labels that are shown instead of `labels`
  Handle bodies{};   ///< body regions in the reference, ImageDisplay::bodies
  Handle missing{};  ///< mask parts not represented by any body, ImageDisplay::missing
};

/// The data available at a point of the world.
struct Readout {
  Vec3 world{};
  std::optional<std::array<std::size_t, 3>> index;  ///< voxel of the material at the point; none: outside the image
  double value = 0.0;
  std::string unit, label;      ///< label: name; empty where there is none
  std::optional<double> shift;  ///< |u|, mm, where there is a displacement
  /// Set where there is tissue of a body and fields of it are available
  std::optional<double> volumeRatio, field;
  Quantity fieldQuantity;        ///< of `field`
  bool isEmptied = false;        ///< a body has moved away from here: nothing is known
  std::optional<double> second;  ///< value of the second scan, where it is shown
  std::string secondUnit;
  DisplayUnit length{"mm", 1.0};                 ///< in which texts have lengths
  [[nodiscard]] std::string placeText() const;   ///< position, voxel, value, label, value of the second scan
  [[nodiscard]] std::string tissueText() const;  ///< deformation of the tissue; empty if unknown
  [[nodiscard]] std::string text() const;        ///< both
};

/// Image, three slice views and one cross-hair; mouse and keys in the slices. No drawing. Main thread.
///
/// Wheel: next slice (Shift: ten, Ctrl: zoom). Left: cross-hair, or window and level while that mode is on. Shift+move:
/// cross-hair. Middle or Shift+left: pan. Right or Ctrl+left: zoom. Keys: arrows, B and F: slices; T (Shift: back):
/// time points; digits: window/level presets.
class ImageViews {
 public:
  /// A null image: nothing is shown. A different image resets views, window and level.
  void setImage(std::shared_ptr<const scene::StoredImage> image);
  /// Another time point of the displayed image, on the same grid; everything else remains.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image, Handle handle);
  /// Function that reads another time point at the user's request.
  void setTimeChooser(std::function<void(std::size_t time)> choose) { chooseTime_ = std::move(choose); }
  /// Requests a time point of the image; no effect for the displayed one or beyond the last.
  void chooseTime(std::size_t time);
  void setLabels(std::shared_ptr<const scene::StoredLabels> labels);
  void setDisplacement(std::shared_ptr<const imaging::DisplacementGrid> displacement);
  /// Fields that can be chosen as an overlay, with their units.
  void setOfferedFields(std::vector<std::pair<std::string, std::string>> fields) { offered_ = std::move(fields); }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>> &offeredFields() const { return offered_; }
  /// Whether the mouse is over a slice, whose read-out then needs the fields there.
  void setPointedAt(bool isPointedAt) { isPointedAt_ = isPointedAt; }
  [[nodiscard]] bool wantsFields() const;
  /// The field that the overlay shows; null if none, or if it is not available yet.
  [[nodiscard]] const imaging::TissueField *shownField() const;
  [[nodiscard]] Quantity overlayQuantity() const;
  /// In the unit of its quantity: the fixed range, or that of the visible values.
  [[nodiscard]] OverlayRange overlayRange() const;
  void setHandles(const ImageHandles &handles) { handles_ = handles; }
  [[nodiscard]] const ImageHandles &handles() const { return handles_; }
  /// Description of what is marked as missing, for the legend of the slices; empty if nothing is.
  void setMissingText(std::string text) { missingText_ = std::move(text); }
  [[nodiscard]] const std::string &missingText() const { return missingText_; }
  /// A second scan that is shown over the image; null: none. It must outlive this and copies of it.
  void setComparison(const Comparison *comparison) { comparison_ = comparison; }
  [[nodiscard]] const Comparison *comparison() const { return comparison_; }
  [[nodiscard]] bool isCompared() const { return image_ && comparison_ && comparison_->isShown(); }
  [[nodiscard]] const scene::StoredImage *image() const { return image_.get(); }
  [[nodiscard]] const std::shared_ptr<const scene::StoredImage> &sharedImage() const { return image_; }
  [[nodiscard]] const scene::StoredLabels *labels() const { return labels_.get(); }
  [[nodiscard]] const std::shared_ptr<const scene::StoredLabels> &sharedLabels() const { return labels_; }
  [[nodiscard]] const imaging::DisplacementGrid *displacement() const { return displacement_.get(); }
  [[nodiscard]] bool hasDisplacement() const { return displacement_ != nullptr; }
  /// Shows the image as it was read, in all views and read-outs, although bodies have moved it. The displacement is
  /// kept.
  void showAtRest(bool isAtRest);
  [[nodiscard]] bool showsDisplacement() const { return warp() != nullptr; }
  /// There is a displacement, but it is not shown.
  [[nodiscard]] bool isAtRest() const { return hasDisplacement() && !showsDisplacement(); }

  [[nodiscard]] const ImageOptions &options() const { return options_; }
  /// Reorients the views if convention or alignment changes.
  void setOptions(const ImageOptions &options);
  /// Opacity of one label, 0 … 1, in addition to the common one.
  [[nodiscard]] float labelOpacity(std::uint16_t value) const;
  void setLabelOpacity(std::uint16_t value, float opacity);
  /// While not empty, all other labels are faint.
  void setPickedLabels(std::vector<std::uint16_t> values) { pickedLabels_ = std::move(values); }
  [[nodiscard]] std::vector<std::pair<std::uint16_t, render::Colour>> labelColours() const;

  [[nodiscard]] const Vec3 &crossHair() const { return crossHair_; }
  /// Set to the nearest point of the image; slices that do not contain it move to it.
  void setCrossHair(const Vec3 &world);
  /// Restores cross-hair and slices to their state before the last press, which began a double click.
  void undoClick();
  /// Called when another press begins: the last one can no longer be taken back.
  void forgetClick() { beforeClick_.reset(); }
  [[nodiscard]] SliceView &view(Pane slice) { return views_[static_cast<std::size_t>(slice)]; }
  [[nodiscard]] const SliceView &view(Pane slice) const { return views_[static_cast<std::size_t>(slice)]; }
  void resetViews();

  /// Null if all four views are shown.
  [[nodiscard]] std::optional<Pane> maximised() const { return maximised_; }
  void setMaximised(std::optional<Pane> pane) { maximised_ = pane; }

  /// Input in a slice; positions relative to its upper left corner. True if something changed.
  bool handle(Pane slice, const ViewInput &input);
  void cancel() { drag_ = Drag::none; }
  /// The next left press in a slice calls `picked` instead of moving the cross-hair. The argument is the point of the
  /// reference image displayed there.
  void pickNext(std::function<void(const Vec3 &reference)> picked) { picked_ = std::move(picked); }
  [[nodiscard]] bool isPicking() const { return static_cast<bool>(picked_); }
  void cancelPick() { picked_ = nullptr; }
  /// Whether a key has a function in a slice: it is then sent to the slice under the mouse.
  [[nodiscard]] static bool isSliceKey(std::uint32_t key, std::uint32_t modifiers);

  /// The point of the image as it was read that is displayed at a point of the world.
  [[nodiscard]] Vec3 referenceAt(const Vec3 &world) const;
  [[nodiscard]] Readout readout(const Vec3 &world) const;
  [[nodiscard]] render::ImageDisplay look() const;
  /// Empty if the image is hidden in space.
  [[nodiscard]] render::ImageScene scene() const;
  /// Cycles from uncut to without the near part, to without the far part, and back.
  void cycleCut(Pane slice);
  /// In which read-outs and ranges of the overlay have lengths and pressures. A fixed range is converted.
  void setUnits(const DisplayUnits &units);
  void setVisibleInSpace(bool isVisible) { isVisibleInSpace_ = isVisible; }

 private:
  enum class Drag { none, crossHair, windowLevel, pan, zoom };
  void applyFrames();
  /// The displacement shown by the views; null: the image is shown as it was read.
  [[nodiscard]] const imaging::DisplacementGrid *warp() const { return isAtRest_ ? nullptr : displacement_.get(); }
  [[nodiscard]] Vec3 nearestInImage(const Vec3 &world) const;
  bool press(Pane slice, const ViewInput &input);
  bool move(Pane slice, const ViewInput &input);
  bool pressKey(Pane slice, const ViewInput &input);
  void followRange();
  [[nodiscard]] Readout readoutOfImage(const Vec3 &world) const;

  DisplayUnits units_;
  std::shared_ptr<const scene::StoredImage> image_;
  std::shared_ptr<const scene::StoredLabels> labels_;
  std::shared_ptr<const imaging::DisplacementGrid> displacement_;
  std::vector<std::pair<std::string, std::string>> offered_;
  StableRange steadyRange_;
  bool isPointedAt_ = false, isAtRest_ = false;
  ImageOptions options_;
  std::vector<std::pair<std::uint16_t, float>> labelOpacities_;
  std::vector<std::uint16_t> pickedLabels_;
  std::array<SliceView, 3> views_;
  std::optional<Pane> maximised_;
  Vec3 crossHair_{};
  struct Click {
    Vec3 crossHair;
    std::array<SliceView, 3> views;
  };
  std::optional<Click> beforeClick_;  ///< state before the click that set the cross-hair
  bool isVisibleInSpace_ = true;
  std::function<void(const Vec3 &)> picked_;
  std::function<void(std::size_t)> chooseTime_;
  Drag drag_ = Drag::none;
  std::uint32_t buttons_ = 0, dragButton_ = 0;
  double lastX_ = 0.0, lastY_ = 0.0, startX_ = 0.0, startY_ = 0.0;
  ImageHandles handles_;
  std::string missingText_;
  const Comparison *comparison_ = nullptr;
};

/// Initial camera for images in space: the patient upright, from the front, slightly from the left and above.
void viewOfImages(render::Camera &camera);

/// Recognises the second press of a double click in the same pane.
class DoubleClick {
 public:
  /// True for a left press that follows another one at the same position within 0.4 s.
  bool press(Pane pane, const ViewInput &input);

 private:
  std::optional<Pane> pane_;
  double x_ = 0.0, y_ = 0.0, time_s_ = -1e9;
};

}  // namespace c3de::ui
