// SPDX-License-Identifier: Apache-2.0
// Transparent surfaces, separated by depth, so that ray-cast parts can be drawn between them: the nearest two of each
// pixel separately, everything behind them together.
#pragma once

#include <array>
#include <optional>

#include "blended_pass.h"

namespace c3de::render {

/// Number of surfaces of a pixel that are separated.
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
  /// For the surfaces prepared in the blended pass, for a viewport at (x, y); the bound framebuffer and its viewport
  /// are unchanged. False: insufficient memory, or a driver without a required feature.
  [[nodiscard]] bool find(LayerDepths &depths, const Frame &frame, int x, int y, RenderStatistics &statistics);
  /// Blends one layer into the bound framebuffer; kLayers: everything farther.
  void draw(const LayerDepths &depths, std::size_t layer, const Frame &frame, RenderStatistics &statistics);

 private:
  void bindLimits(GLuint nearer, GLuint farther) const;

  BlendedPass &blended_;
  std::optional<Programs> programs_;
  bool hasFailed_ = false;
  Texture beforeAll_ = Texture::create(), behindAll_ = Texture::create();
};

}  // namespace c3de::render
