// SPDX-License-Identifier: Apache-2.0
// Surfaces that blend, taken apart by depth, so that what rays see can be laid between them: the nearest two of each
// pixel by themselves, everything behind them together.
#pragma once

#include <array>
#include <optional>

#include "blended_pass.h"

namespace c3de::render {

/// How many surfaces of a pixel stand alone.
inline constexpr std::size_t kLayers = 2;

/// Depth of the nearest and the next surface at each pixel; 1 where there is none.
class LayerDepths {
 public:
  [[nodiscard]] GLuint texture(std::size_t layer) const { return depths_[layer].name(); }

 private:
  friend class LayerPass;
  int width_ = 0, height_ = 0;
  std::array<Texture, kLayers> depths_{Texture::create(), Texture::create()};
  std::array<Framebuffer, kLayers> buffers_{Framebuffer::create(), Framebuffer::create()};
};

class LayerPass {
 public:
  explicit LayerPass(BlendedPass &blended);
  [[nodiscard]] bool isEmpty() const { return blended_.isEmpty(); }
  /// Of the surfaces that are ready in the pass that blends them, for a viewport at (x, y); the bound framebuffer and
  /// its viewport stay. False: there is no memory, or a driver that lacks something.
  [[nodiscard]] bool find(LayerDepths &depths, const Frame &frame, int x, int y, RenderStatistics &statistics);
  /// Blends one layer into the bound framebuffer; kLayers: all that is farther.
  void draw(const LayerDepths &depths, std::size_t layer, const Frame &frame, RenderStatistics &statistics);

 private:
  void bindLimits(GLuint nearer, GLuint farther) const;

  BlendedPass &blended_;
  std::optional<Programs> programs_;
  bool hasFailed_ = false;
  Texture beforeAll_ = Texture::create(), behindAll_ = Texture::create();
};

}  // namespace c3de::render
