// SPDX-License-Identifier: Apache-2.0
// Volume rendering into a separate picture: coarse while something changes, then finer in bands that take some
// milliseconds each, until there is a ray for every pixel. The picture is drawn over opaque content, at which its rays
// end. It has parts between which transparent surfaces are drawn.
#pragma once

#include <functional>
#include <optional>

#include "layer_pass.h"
#include "slice_pass.h"

namespace c3de::render {

/// Determines whether a picture is still valid.
struct RayKey {
  Camera camera;
  int width = 0, height = 0;
  std::uint64_t changes = 0;
  friend bool operator==(const RayKey &, const RayKey &) = default;
};

class RayPass {
 public:
  /// Draws opaque content into the bound depth buffer of another size.
  using DrawDepth = std::function<void(const Frame &)>;

  /// Draws over the bound framebuffer, whose viewport is that of the frame and begins at (x, y).
  /// @param isFinal  a ray for every pixel at once
  /// @return whether transparent primitives were drawn too
  bool draw(const ImageParts &parts, const ImageScene &scene, const RayKey &key, const Frame &frame, int x, int y,
            bool isFinal, const DrawDepth &drawDepth, LayerPass &layers, RenderStatistics &statistics);
  [[nodiscard]] bool isRefined() const { return !shown_ || isResolutionLimited_ || (shown_->divisor == 1 && !next_); }
  /// Discards the picture.
  void forget() {
    shown_.reset();
    next_.reset();
    key_.reset();
  }

 private:
  struct Picture {
    int width = 0, height = 0, divisor = 1;
    int rows = 0;  ///< completed, from below
    Texture colour = Texture::create(), depth = Texture::create();
    Framebuffer colourBuffer = Framebuffer::create(), depthBuffer = Framebuffer::create();
    /// Where surfaces are transparent: the part behind the nearest of them, and behind the next one.
    std::array<std::optional<Texture>, kLayers> behind;
    std::optional<LayerDepths> layers;
  };
  [[nodiscard]] std::optional<Picture> begin(const Frame &frame, int divisor, const DrawDepth &drawDepth,
                                             LayerPass &layers, RenderStatistics &statistics);
  void castRows(Picture &picture, const ImageParts &parts, const ImageScene &scene, const Frame &frame, int rows,
                RenderStatistics &statistics);
  /// Including transparent primitives between the parts; false: the caller has to draw these.
  bool composite(const Picture &picture, const Frame &frame, int x, int y, LayerPass &layers,
                 RenderStatistics &statistics);
  void layOver(const Texture &part, const Frame &frame, int x, int y, RenderStatistics &statistics);
  [[nodiscard]] const Program *programFor(unsigned variant, RenderStatistics &statistics);
  /// The mapping of values to colours, for the program in use.
  void setTransfer(const Program &program, const ImageParts &parts, const ImageScene &scene, double step_mm);
  void buildTable(const VolumeDisplay &look, double step_mm);

  std::array<std::optional<Program>, 64> programs_;
  std::optional<Program> composite_;
  Texture table_ = Texture::create();
  VertexArray array_ = VertexArray::create();
  std::optional<Picture> shown_, next_;
  LayerDepths layers_;  ///< at the window's resolution
  std::optional<RayKey> key_;
  bool isResolutionLimited_ = false;  ///< insufficient memory for a finer picture
  int bandRows_ = 16;
};

}  // namespace c3de::render
