// SPDX-License-Identifier: Apache-2.0
// Common part of all image back ends: stores grids and settings, and validates calls.
#pragma once

#include <cmath>

#include "c3de/render/image_renderer.h"
#include "retained_renderer.h"
#include "view_math.h"

namespace c3de::render {

/// Inverse of an affine matrix that checkGeometry() has accepted.
[[nodiscard]] Mat4 affineInverse(const Mat4 &affine);
/// Its upper left part, which applies to directions and displacements.
[[nodiscard]] Mat3f linearPart(const Mat4 &affine);

struct ImageSlot {
  enum class Kind { image, labels, displacement };
  Kind kind = Kind::image;
  GridGeometry place;  ///< of the data in graphics memory
  Mat4 indexFromWorld = kIdentity4;
  double scale = 1.0, offset = 0.0;  ///< value = scale * texel + offset
  std::vector<std::pair<std::uint16_t, Colour>> colours;
  bool hasGaps = false;     ///< of displacements
  bool hasColours = false;  ///< of images
  bool hasField = false;    ///< of displacements
  std::unique_ptr<BackEndData> backEnd;
};

class RetainedImages : public ImageRenderer {
 public:
  Expected<Handle> addImage(const ImageVoxels &image, std::string *notice) override;
  Expected<Handle> addLabels(const GridGeometry &place, std::span<const std::uint16_t> voxels) override;
  bool setLabelColours(Handle labels, std::span<const std::pair<std::uint16_t, Colour>> colours) override;
  Expected<Handle> addDisplacement(const GridGeometry &place, std::span<const float> xyz_mm,
                                   std::span<const float> gap_mm) override;
  bool setDisplacement(Handle displacement, std::span<const float> xyz_mm, std::span<const float> gap_mm) override;
  bool setField(Handle displacement, std::span<const float> values) override;
  bool setOverlayColours(std::span<const Colour> colours) override;
  bool remove(Handle handle) override;
  void setScene(ImageScene scene) override;
  [[nodiscard]] std::uint64_t changes() const override { return changes_; }
  /// For the content in space: includes changes of the images and of the scene.
  [[nodiscard]] std::uint64_t changesInSpace() const { return changes_ + sceneChanges_; }

 protected:
  /// Fills `slot.backEnd`; `slot.place` and its scale may be changed to the stored resolution.
  virtual Expected<void> uploadImage(ImageSlot &slot, const ImageVoxels &image, std::string *notice) = 0;
  virtual Expected<void> uploadLabels(ImageSlot &slot, std::span<const std::uint16_t> voxels) = 0;
  virtual Expected<void> uploadDisplacement(ImageSlot &slot, std::span<const float> xyz_mm,
                                            std::span<const float> gap_mm) = 0;
  /// Values of `slot` without NaN as pairs of value and 1, or 0 and 0; empty: removes the field.
  virtual bool uploadField(ImageSlot &slot, std::span<const float> pairs) = 0;
  virtual void labelColoursChanged(ImageSlot &slot) = 0;
  virtual void overlayColoursChanged() = 0;

  [[nodiscard]] ImageSlot *find(Handle handle, ImageSlot::Kind kind);

  HandleTable<ImageSlot> slots_;
  std::vector<Colour> overlayColours_{{0.05f, 0.05f, 0.4f, 1.0f}, {0.95f, 0.9f, 0.2f, 1.0f}};
  ImageScene scene_;
  std::uint64_t changes_ = 0, sceneChanges_ = 0;
};

}  // namespace c3de::render
