// SPDX-License-Identifier: Apache-2.0
// Text above points of the scene, of constant size, over everything else. The atlas is drawn at the first label.
#pragma once

#include <optional>
#include <vector>

#include "c3de/render/renderer.h"
#include "gl/font_atlas.h"
#include "gl/frame.h"
#include "retained_renderer.h"

namespace c3de::render {

class LabelPass {
 public:
  LabelPass();

  /// Starts an empty frame.
  void begin();
  void add(const Proxy &proxy, const Frame &frame);
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
  void buildAtlas();
  void layOut(const Placed &label);

  std::optional<FontAtlas> atlas_;
  Texture texture_;
  VertexArray array_;
  Buffer buffer_;
  std::vector<Placed> labels_;
  std::vector<Vertex> vertices_;
};

}  // namespace c3de::render
