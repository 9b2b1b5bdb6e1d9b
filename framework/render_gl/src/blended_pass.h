// SPDX-License-Identifier: Apache-2.0
// All transparent primitives, in one order across all proxies: triangles, spheres and line segments are sorted by the
// depth of their centres on the CPU each frame and drawn from the farthest to the nearest, without writing depth.
//
// Limit: two primitives that intersect each other, or a large one next to a small one whose centre is closer although
// it is behind, cannot be ordered as wholes and blend in one of the two orders.
#pragma once

#include <array>
#include <vector>

#include "c3de/render/renderer.h"
#include "depth_order.h"
#include "frame.h"
#include "retained_renderer.h"

namespace c3de::render {

class BlendedPass {
 public:
  BlendedPass();

  /// Starts an empty frame.
  void begin();
  /// Adds the part in front of the near plane, in view space.
  void add(Proxy &proxy, const Frame &frame);
  /// Call after the last add(): sorts and uploads once for all draws of the frame.
  void prepare(RenderStatistics &statistics);
  [[nodiscard]] bool isEmpty() const { return items_.empty(); }
  void draw(const Frame &frame, const Programs &programs, RenderStatistics &statistics);
  /// Draws depth only, that of the nearest.
  void drawDepth(const Frame &frame, const Programs &programs, RenderStatistics &statistics);

 private:
  struct MeshVertex {
    Vec3f position, normal;
    Rgba8 colour;
  };
  struct Sphere {
    Vec3f centre;
    float radius;
    Rgba8 colour;
  };
  struct Segment {
    Vec3f start, end;
    Rgba8 startColour, endColour;
    float width_px;
  };
  /// Consecutive primitives of one kind in the order: one draw call.
  struct Run {
    ProxyKind kind;
    std::uint32_t first, count;
  };

  void addMesh(Proxy &proxy, const Frame &frame);
  void addSpheres(const Proxy &proxy, const Frame &frame);
  void addLines(const Proxy &proxy, const Frame &frame);
  void push(ProxyKind kind, std::size_t index, float depth);
  void drawRuns(const Frame &frame, const Programs &programs, RenderStatistics &statistics);
  void order();
  void upload();

  std::vector<MeshVertex> vertices_;
  std::vector<Triangle> triangles_, orderedTriangles_;
  std::vector<Sphere> spheres_, orderedSpheres_;
  std::vector<Segment> segments_, orderedSegments_;
  std::vector<DepthItem> items_, scratch_;
  std::vector<Run> runs_;
  VertexArray meshArray_, sphereArray_, lineArray_;
  Buffer vertexBuffer_, indexBuffer_, sphereBuffer_, segmentBuffer_;
};

}  // namespace c3de::render
