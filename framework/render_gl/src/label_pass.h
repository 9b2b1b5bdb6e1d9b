// SPDX-License-Identifier: Apache-2.0
// Text above points of the scene, of constant size, in front of everything else, and legends, which are text next to a
// bar. An atlas is drawn when a size of text is first used.
#pragma once

#include <deque>
#include <string_view>
#include <vector>

#include "c3de/render/renderer.h"
#include "font_atlas.h"
#include "frame.h"
#include "retained_renderer.h"

namespace c3de::render {

class LabelPass {
 public:
  LabelPass();

  /// Starts an empty frame.
  void begin();
  void add(const Proxy &proxy, const Frame &frame);
  void addLegend(const Legend &legend) { legends_.push_back(&legend); }
  void draw(const Frame &frame, const Programs &programs, RenderStatistics &statistics);

 private:
  struct Vertex {
    float x, y, u, v;
    Rgba8 colour;
  };
  struct Placed {
    const Proxy *proxy;
    float x, y, depth;
  };
  struct SizedAtlas {
    float scale = 1.0f;
    FontAtlas atlas;
    Texture texture;
  };
  /// Binds the characters for text of this many pixels per pixel.
  void useAtlas(float scale);
  void layOut(const Placed &label);
  void layOutLegends(const Frame &frame);
  [[nodiscard]] float lineHeight() const { return atlas_->lineHeight / scale_; }
  [[nodiscard]] float ascent() const { return atlas_->ascent / scale_; }
  [[nodiscard]] float widthOf(std::u32string_view line) const;
  /// From x on, on the base line.
  void addLine(std::u32string_view line, float x, float baseLine, Rgba8 colour);
  void addRectangle(float x0, float y0, float x1, float y1, Rgba8 bottom, Rgba8 top);

  std::deque<SizedAtlas> atlases_;  ///< references to its elements remain valid
  const FontAtlas *atlas_ = nullptr;
  float scale_ = 1.0f;  ///< pixels of the atlas per pixel of the layout
  VertexArray array_;
  Buffer buffer_;
  std::vector<Placed> labels_;
  std::vector<const Legend *> legends_;
  std::vector<Vertex> vertices_;
};

}  // namespace c3de::render
