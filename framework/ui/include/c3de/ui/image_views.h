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
#include "c3de/ui/image_presets.h"
#include "c3de/ui/overlay.h"
#include "c3de/ui/slice_view.h"
#include "c3de/ui/view_controller.h"

namespace c3de::ui {

enum class Pane { axial, sagittal, coronal, space };
inline constexpr std::array kSlicePanes{Pane::axial, Pane::sagittal, Pane::coronal};
[[nodiscard]] const char *paneName(Pane pane);  ///< "axial", …, "3D"

/// What the 3D view leaves out beside a slice.
enum class SliceCut {
  none,
  nearPart,  ///< above, left or in front of it: what the first view of an image has towards the viewer
  farPart
};

/// What a person chooses about images.
struct ImageOptions {
  WindowLevel windowLevel;
  bool isSmooth = true;
  double labelOpacity = 0.4;
  bool showsSlicesInSpace = true, showsVolume = false;
  VolumePreset volumePreset = VolumePreset::ctBone;
  double volumeShift = 0.0;         ///< -1 … 1
  std::array<SliceCut, 3> cuts{};   ///< of the 3D view, by slice pane
  bool cutsBodies = true;           ///< and of what is beside the image there
  Overlay overlay = Overlay::none;  ///< in colours over the slices
  std::string overlayField;         ///< name of the field that it shows
  bool hasFixedRange = false;       ///< of the overlay; else it follows what is seen
  OverlayRange fixedRange;
  scene::SceneStill still;  ///< what does not go with the bodies
  Convention convention = Convention::radiological;
  bool isAlignedWithImage = true;  ///< views along the image's axes; else along the patient's
  bool showsCrossHair = true;
  bool isWindowLevelMode = false;  ///< a left drag in a slice changes window and level, else the cross-hair
  bool showsOutlines = true;       ///< surfaces of the 3D view, cut by the slices
  bool showsPreview = true;        ///< what is being picked, instead of the labels
};

/// Handles of the renderer for what is shown; the owner of the renderer fills them.
struct ImageHandles {
  Handle image, labels, displacement;
  Handle preview{};  ///< labels that are shown instead of `labels`
  Handle bodies{};   ///< where bodies are in the reference, ImageLook::bodies
  Handle missing{};  ///< what of masks no body stands for, ImageLook::missing
};

/// What is known about a point of the world.
struct Readout {
  Vec3 world{};
  std::optional<std::array<std::size_t, 3>> index;  ///< voxel of the material that is there; none: outside the image
  double value = 0.0;
  std::string unit, label;      ///< label: name; empty where there is none
  std::optional<double> shift;  ///< |u|, mm, where there is a displacement
  /// Where tissue of a body is, and fields of it are known
  std::optional<double> volumeRatio, field;
  Quantity fieldQuantity;                        ///< of `field`
  bool isVacated = false;                        ///< a body has gone away from there: nothing is known
  [[nodiscard]] std::string placeText() const;   ///< where, voxel, value, label
  [[nodiscard]] std::string tissueText() const;  ///< what has become of the tissue; empty: nothing is known
  [[nodiscard]] std::string text() const;        ///< both
};

/// Image, three slice views and one cross-hair; mouse and keys in the slices. No drawing. Main thread.
///
/// Wheel: next slice (Shift: ten, Ctrl: zoom). Left: cross-hair, or window and level while that mode is on. Shift+move:
/// cross-hair. Middle or Shift+left: pan. Right or Ctrl+left: zoom. Keys: arrows, B and F: slices; T (Shift: back):
/// time points; digits: window/level presets.
class ImageViews {
 public:
  /// A null image: nothing is shown. Views, window and level start anew with another image.
  void setImage(std::shared_ptr<const scene::StoredImage> image);
  /// Another time point of the image that is shown, on the same grid: everything else stays as it is.
  void replaceImage(std::shared_ptr<const scene::StoredImage> image, Handle handle);
  /// Who reads another time point when a person asks for it.
  void setTimeChooser(std::function<void(std::size_t time)> choose) { chooseTime_ = std::move(choose); }
  /// Asks for a time point of the image; nothing happens for the one that is shown or beyond the last.
  void chooseTime(std::size_t time);
  void setLabels(std::shared_ptr<const scene::StoredLabels> labels);
  void setDisplacement(std::shared_ptr<const imaging::DisplacementGrid> displacement);
  /// Fields that may be chosen as an overlay, with their units.
  void setOfferedFields(std::vector<std::pair<std::string, std::string>> fields) { offered_ = std::move(fields); }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>> &offeredFields() const { return offered_; }
  /// The mouse is over a slice: its read-out asks for the fields there.
  void setPointedAt(bool isPointedAt) { isPointedAt_ = isPointedAt; }
  [[nodiscard]] bool wantsFields() const;
  /// The field that the overlay shows; null: none, or it has not come yet.
  [[nodiscard]] const imaging::TissueField *shownField() const;
  [[nodiscard]] Quantity overlayQuantity() const;
  /// In the unit of its quantity: the fixed one, or that of what is seen.
  [[nodiscard]] OverlayRange overlayRange() const;
  void setHandles(const ImageHandles &handles) { handles_ = handles; }
  [[nodiscard]] const ImageHandles &handles() const { return handles_; }
  /// What is marked as missing, for the legend of the slices; empty: nothing is.
  void setMissingText(std::string text) { missingText_ = std::move(text); }
  [[nodiscard]] const std::string &missingText() const { return missingText_; }
  [[nodiscard]] const scene::StoredImage *image() const { return image_.get(); }
  [[nodiscard]] const std::shared_ptr<const scene::StoredImage> &sharedImage() const { return image_; }
  [[nodiscard]] const scene::StoredLabels *labels() const { return labels_.get(); }
  [[nodiscard]] const std::shared_ptr<const scene::StoredLabels> &sharedLabels() const { return labels_; }
  [[nodiscard]] const imaging::DisplacementGrid *displacement() const { return displacement_.get(); }
  [[nodiscard]] bool hasDisplacement() const { return displacement_ != nullptr; }
  /// Shows the image as it was read, in all views and read-outs, although bodies have moved it; the displacement stays.
  void showAtRest(bool isAtRest);
  [[nodiscard]] bool showsDisplacement() const { return warp() != nullptr; }
  /// There is a displacement that is not shown.
  [[nodiscard]] bool isAtRest() const { return hasDisplacement() && !showsDisplacement(); }

  [[nodiscard]] const ImageOptions &options() const { return options_; }
  /// Turns the views where convention or alignment change.
  void setOptions(const ImageOptions &options);
  /// Opacity of one label, 0 … 1, beside that of all.
  [[nodiscard]] float labelOpacity(std::uint16_t value) const;
  void setLabelOpacity(std::uint16_t value, float opacity);
  /// The others are faint while it is not empty.
  void setPickedLabels(std::vector<std::uint16_t> values) { pickedLabels_ = std::move(values); }
  [[nodiscard]] std::vector<std::pair<std::uint16_t, render::Colour>> labelColours() const;

  [[nodiscard]] const Vec3 &crossHair() const { return crossHair_; }
  /// The nearest point of the image; slices that do not show it move to it.
  void setCrossHair(const Vec3 &world);
  /// Cross-hair and slices are again where they were before the last press: it began a double click.
  void takeBackClick();
  /// Another press than that one began: it is not to be taken back any more.
  void forgetClick() { beforeClick_.reset(); }
  [[nodiscard]] SliceView &view(Pane slice) { return views_[static_cast<std::size_t>(slice)]; }
  [[nodiscard]] const SliceView &view(Pane slice) const { return views_[static_cast<std::size_t>(slice)]; }
  void resetViews();

  /// Null: four views.
  [[nodiscard]] std::optional<Pane> maximised() const { return maximised_; }
  void setMaximised(std::optional<Pane> pane) { maximised_ = pane; }

  /// Input in a slice; positions from its upper left corner. True: something changed.
  bool handle(Pane slice, const ViewInput &input);
  void cancel() { drag_ = Drag::none; }
  /// The next left press in a slice is told to `picked` instead of moving the cross-hair: the point of the reference
  /// image that is shown there.
  void pickNext(std::function<void(const Vec3 &reference)> picked) { picked_ = std::move(picked); }
  [[nodiscard]] bool isPicking() const { return static_cast<bool>(picked_); }
  void cancelPick() { picked_ = nullptr; }
  /// Whether a key means something in a slice: it then belongs to the slice under the mouse.
  [[nodiscard]] static bool isSliceKey(std::uint32_t key, std::uint32_t modifiers);

  [[nodiscard]] Readout readout(const Vec3 &world) const;
  [[nodiscard]] render::ImageLook look() const;
  /// Empty while the image is hidden in space.
  [[nodiscard]] render::ImageScene scene() const;
  /// From whole to without the near part, without the far part, and back.
  void turnCut(Pane slice);
  void setVisibleInSpace(bool isVisible) { isVisibleInSpace_ = isVisible; }

 private:
  enum class Drag { none, crossHair, windowLevel, pan, zoom };
  void applyFrames();
  /// That the views show; null: the image is as it was read.
  [[nodiscard]] const imaging::DisplacementGrid *warp() const { return isAtRest_ ? nullptr : displacement_.get(); }
  [[nodiscard]] Vec3 referenceAt(const Vec3 &world) const;
  [[nodiscard]] Vec3 nearestInImage(const Vec3 &world) const;
  bool press(Pane slice, const ViewInput &input);
  bool move(Pane slice, const ViewInput &input);
  bool pressKey(Pane slice, const ViewInput &input);
  void followRange();

  std::shared_ptr<const scene::StoredImage> image_;
  std::shared_ptr<const scene::StoredLabels> labels_;
  std::shared_ptr<const imaging::DisplacementGrid> displacement_;
  std::vector<std::pair<std::string, std::string>> offered_;
  SteadyRange steadyRange_;
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
  std::optional<Click> beforeClick_;  ///< that has set the cross-hair
  bool isVisibleInSpace_ = true;
  std::function<void(const Vec3 &)> picked_;
  std::function<void(std::size_t)> chooseTime_;
  Drag drag_ = Drag::none;
  std::uint32_t buttons_ = 0, dragButton_ = 0;
  double lastX_ = 0.0, lastY_ = 0.0, startX_ = 0.0, startY_ = 0.0;
  ImageHandles handles_;
  std::string missingText_;
};

/// How a first image is looked at in space: the patient upright, from the front, a little from the left and above.
void viewOfImages(render::Camera &camera);

/// Recognises the second press of a double click in the same pane.
class DoubleClick {
 public:
  /// True for a left press that follows another one at the same place within 0.4 s.
  bool press(Pane pane, const ViewInput &input);

 private:
  std::optional<Pane> pane_;
  double x_ = 0.0, y_ = 0.0, time_s_ = -1e9;
};

}  // namespace c3de::ui
