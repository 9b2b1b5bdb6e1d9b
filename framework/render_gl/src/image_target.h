// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/render/renderer.h"
#include "gl_objects.h"

namespace c3de::render {

/// A multisampled framebuffer of a given size with depth, bound during its lifetime; then the previous binding is
/// restored.
class ImageTarget {
 public:
  [[nodiscard]] static Expected<ImageTarget> create(int width, int height);
  ImageTarget(ImageTarget &&other) noexcept;
  ImageTarget &operator=(ImageTarget &&) = delete;
  ~ImageTarget();

  /// Resolves the samples and reads the pixels.
  [[nodiscard]] Expected<Image> read();

 private:
  ImageTarget() = default;
  int width_ = 0, height_ = 0;
  GLint previousDraw_ = 0, previousRead_ = 0;
  bool bound_ = false;
  Framebuffer samples_, resolved_;
  Renderbuffer colour_, depth_, resolvedColour_;
};

}  // namespace c3de::render
