// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/core/vec.h"
#include "c3de/render/camera.h"

namespace c3de::render {

using Vec3f = std::array<float, 3>;
using Colour = std::array<float, 4>;  ///< sRGB and opacity, 0 … 1
/// As sRGB, from the linear colour of a label.
[[nodiscard]] Colour shownColour(const std::array<float, 3> &linear, float opacity = 1.0f);

struct Material {
  Colour colour{0.8f, 0.8f, 0.8f, 1.0f};  ///< opacity below 1 blends
  bool twoSided = false;                  ///< meshes: false hides triangles seen from behind (clockwise corners)
  /// Whoever draws slices of images draws it over them (forEachMark); opaque lines and spheres are drawn whole, in
  /// front of everything.
  bool inSlices = false;
  /// Meshes: it lies inside of a body. Whoever draws slices of images does not outline it; a tool takes hold of the
  /// tissue behind it.
  bool isInside = false;
  /// Meshes that do not blend: nothing that blends is seen in front of it within this, in its own space. Two surfaces
  /// of the same thing, each off by some of that, would alternate from pixel to pixel.
  float cover = 0.0f;
};

/// What colours mean. Drawn as a bar with numbers at the right edge of the picture, several below each other.
struct Legend {
  std::string title, unit;       ///< UTF-8
  std::string note;              ///< below the bar, lines parted by '\n'
  double low = 0.0, high = 1.0;  ///< values of the first and the last colour
  std::vector<Colour> colours;   ///< at even distances, the one of `low` first; 2 at least
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 bytes per pixel, top row first
};
/// @param path  UTF-8; its folder must exist
[[nodiscard]] Expected<void> writePng(const std::string &path, const Image &image);

/// Where a frame goes: pixels from the lower left corner of the framebuffer.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const Viewport &, const Viewport &) = default;
};

/// Work of the last frame, and what was made since the renderer was.
struct RenderStatistics {
  std::size_t drawCalls = 0;         ///< last frame
  std::size_t sortedPrimitives = 0;  ///< last frame: triangles, spheres and segments that blend
  double sort_ms = 0.0;              ///< last frame: their ordering
  std::size_t uploadedBytes = 0;     ///< last frame: array contents handed to the graphics memory
  double upload_ms = 0.0;            ///< last frame: that, and the normals that had to be found for it
  std::size_t vertexArraysMade = 0;  ///< in all; updating a proxy adds none
  std::size_t programsLinked = 0;    ///< in all; does not grow after the start
};

class ImageRenderer;

/// A mesh as it is drawn, for whoever wants to cut or measure it. Borrowed for the call.
struct MeshView {
  std::span<const Vec3f> positions;  ///< in the proxy's own space
  std::span<const Triangle> triangles;
  const Mat4 &worldFromProxy;
  const Material &material;
};

/// Spheres, lines or a label that are drawn over slices, too. Borrowed for the call.
struct MarkView {
  enum class Kind { spheres, lines, label };
  Kind kind;
  std::span<const Vec3f> positions;  ///< in the proxy's own space; lines: pairs, a label: one
  float radius;                      ///< of spheres, in the proxy's own space
  float width_px;                    ///< of lines
  const std::string &text;           ///< of a label
  const Mat4 &worldFromProxy;
  const Material &material;
};

/// Retained drawing. A proxy is created once and updated when its arrays change; updating never compiles or relinks.
/// Positions are in the proxy's own space; `transform` (world from proxy, mm) places it.
///
/// What blends (opacity below 1) is ordered by the depth of each triangle, sphere and segment over all proxies, so
/// opaque things inside show through and the order of creation does not matter; only primitives that cut through each
/// other, or that are much larger than what they overlap, may blend in the wrong order. Blending is done on the sRGB
/// values.
///
/// One thread, the one that owns the graphics context, which must still be current when the renderer is destroyed.
class Renderer {
 public:
  virtual ~Renderer() = default;

  /// A null handle: an index beyond the positions, an odd number of line ends, a radius or width that is not positive.
  virtual Handle createMesh(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                            const Material &) = 0;
  virtual Handle createSpheres(std::span<const Vec3f> centres, float radius, const Material &) = 0;
  virtual Handle createLines(std::span<const Vec3f> pairs, float width_px, const Material &) = 0;
  /// UTF-8, lines parted by '\n', of constant size on the screen, above the point and on top of everything.
  virtual Handle createLabel(const Vec3f &at, std::string_view text, const Material &) = 0;

  /// Of constant size, on top of everything; left out of pictures too small for it. A null handle: fewer than 2
  /// colours, or a range that is not finite or not increasing.
  virtual Handle createLegend(const Legend &) = 0;

  /// The count may change for spheres and lines, which then lose their colours and radii. Without setNormals, a mesh
  /// computes normals from its triangles. An empty span given to setNormals, setColours or setRadii returns to the
  /// default.
  /// False: stale handle, a kind of proxy that has no such array, or a count that does not fit.
  virtual bool setPositions(Handle, std::span<const Vec3f> positions) = 0;
  virtual bool setNormals(Handle, std::span<const Vec3f> normals) = 0;
  /// Per point; replaces the material's colour. The opacities multiply.
  virtual bool setColours(Handle, std::span<const Colour> colours) = 0;
  virtual bool setRadii(Handle, std::span<const float> radii) = 0;
  virtual bool setLabel(Handle, const Vec3f &at, std::string_view text) = 0;
  virtual bool setLegend(Handle, const Legend &) = 0;
  virtual bool setMaterial(Handle, const Material &) = 0;
  virtual bool setTransform(Handle, const Mat4 &worldFromProxy) = 0;
  virtual bool setVisible(Handle, bool visible) = 0;
  virtual bool destroy(Handle) = 0;

  struct Background {
    Colour top{0.16f, 0.18f, 0.22f, 1.0f}, bottom{0.05f, 0.06f, 0.08f, 1.0f};
  };
  virtual void setBackground(const Background &) = 0;

  /// Draws everything visible into the bound framebuffer, which needs a depth buffer; clears that region's depth.
  /// Leaves depth test, culling, blending and scissor off and nothing bound.
  virtual void draw(const Camera &camera, const Viewport &viewport) = 0;
  /// Grows with everything that changes what draw() shows for the same camera, images included: as long as it stays, so
  /// does the picture. Refinement (ImageRenderer::wantsRefinement) does not count.
  [[nodiscard]] virtual std::uint64_t changes() const = 0;
  /// Draws into an image of its own, independent of the window's size, with smoothed edges.
  [[nodiscard]] virtual Expected<Image> drawToImage(const Camera &camera, int width, int height) = 0;

  /// Every mesh that is visible, in the order of creation.
  virtual void forEachMesh(const std::function<void(const MeshView &)> &) const {}
  /// Everything visible but meshes whose material says `inSlices`, in the order of creation.
  virtual void forEachMark(const std::function<void(const MarkView &)> &) const {}
  /// Images beside the proxies; null: this back end draws none.
  [[nodiscard]] virtual ImageRenderer *images() { return nullptr; }

  [[nodiscard]] virtual std::string description() const = 0;  ///< back end, version, device
  [[nodiscard]] virtual RenderStatistics statistics() const { return {}; }
};

/// Keeps what it is told and draws a flat background: logic can be tested without graphics.
[[nodiscard]] std::unique_ptr<Renderer> createNullRenderer();

}  // namespace c3de::render
