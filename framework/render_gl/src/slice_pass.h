// SPDX-License-Identifier: Apache-2.0
// Planes of an image, flat in a separate view or in space.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "frame.h"
#include "volume_texture.h"

namespace c3de::render {

/// The objects that a look refers to, looked up for every frame.
struct ImageParts {
  const ImageSlot *image = nullptr, *labels = nullptr, *displacement = nullptr, *bodies = nullptr, *missing = nullptr,
                  *second = nullptr;

  [[nodiscard]] bool hasEmptiedRegion() const { return displacement && displacement->hasGaps && bodies; }
};

/// Maps a value to the grey ramp: grey = gain * texel + bias.
[[nodiscard]] std::array<float, 2> greyRamp(const ImageSlot &image, double window, double level);

class SlicePass {
 public:
  SlicePass();
  void setOverlayColours(std::span<const Colour> colours) { uploadColourRow(overlayColours_, colours); }
  /// Fills the bound viewport.
  void drawFlat(const ImageParts &parts, const ImageDisplay &look, const SlicePlane &plane, int width, int height,
                RenderStatistics &statistics);
  /// A convex polygon in world space, depth-tested.
  void drawInSpace(const ImageParts &parts, const ImageDisplay &look, std::span<const Vec3> corners,
                   const SliceInSpace &slice, const Frame &frame, RenderStatistics &statistics);

 private:
  /// The rows and columns of a checkerboard: orthogonal unit directions in the plane.
  struct InPlane {
    Vec3 along{}, across{};
  };
  /// Corners in local coordinates, as a fan.
  void draw(const ImageParts &parts, const ImageDisplay &look, std::span<const Vec3f> corners,
            const Mat4 &clipFromLocal, const Mat4 &worldFromLocal, const InPlane &squares,
            RenderStatistics &statistics);
  [[nodiscard]] const Program *programFor(unsigned variant, RenderStatistics &statistics);

  std::array<std::optional<Program>, 512> programs_;
  std::optional<Program> outline_;
  Texture overlayColours_ = Texture::create();
  VertexArray array_ = VertexArray::create();
  Buffer buffer_ = Buffer::create();
};

/// Binds the textures of a look; unbindImageTextures() reverts it.
void bindImageTextures(const ImageParts &parts, bool isSmooth);
void bindTexture(GLuint unit, GLenum target, GLuint name);
void unbindImageTextures();

}  // namespace c3de::render
