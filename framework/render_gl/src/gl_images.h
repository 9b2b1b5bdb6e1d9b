// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ray_pass.h"

namespace c3de::render {

/// Images of the OpenGL back end; called by the renderer between its passes.
class GlImages final : public RetainedImages {
 public:
  explicit GlImages(RenderStatistics &statistics) : statistics_(statistics) { overlayColoursChanged(); }

  void drawSlice(const ImageDisplay &look, const SlicePlane &plane, const Viewport &viewport) override;
  Expected<Image> drawSliceToImage(const ImageDisplay &look, const SlicePlane &plane, int width, int height) override;
  [[nodiscard]] bool wantsRefinement() const override { return scene_.showsVolume && wantsRefinement_; }

  /// The slices in space, opaque.
  void drawOpaque(const Frame &frame);
  /// Draws the ray-cast volume. True: transparent primitives were drawn between its parts.
  bool drawVolume(const Camera &camera, const Frame &frame, const Viewport &viewport, std::uint64_t changesOfProxies,
                  bool isFinal, const RayPass::DrawDepth &drawDepth, LayerPass &layers);
  /// Sets the cuts of the scene, for everything that the frame draws.
  void setCuts(Frame &frame) const;

 private:
  Expected<void> uploadImage(ImageSlot &slot, const ImageVoxels &image, std::string *notice) override {
    return uploadGreyValues(slot, image, notice);
  }
  Expected<void> uploadLabels(ImageSlot &slot, std::span<const std::uint16_t> voxels) override {
    return uploadLabelValues(slot, voxels);
  }
  Expected<void> uploadDisplacement(ImageSlot &slot, std::span<const float> xyz_mm,
                                    std::span<const float> gap_mm) override {
    return uploadDisplacementValues(slot, xyz_mm, gap_mm);
  }
  bool uploadField(ImageSlot &slot, std::span<const float> pairs) override { return uploadFieldValues(slot, pairs); }
  void labelColoursChanged(ImageSlot &slot) override { uploadLabelTable(slot); }
  void overlayColoursChanged() override { slices_.setOverlayColours(overlayColours_); }
  [[nodiscard]] ImageParts partsOf(const ImageDisplay &look);

  RenderStatistics &statistics_;
  SlicePass slices_;
  RayPass rays_;
  bool wantsRefinement_ = false;
};

}  // namespace c3de::render
