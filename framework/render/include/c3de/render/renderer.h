// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
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
/// Converts the linear colour of a label to sRGB.
[[nodiscard]] Colour displayColour(const std::array<float, 3> &linear, float opacity = 1.0f);

struct Material {
  Colour colour{0.8f, 0.8f, 0.8f, 1.0f};  ///< opacity below 1 blends
  bool twoSided = false;                  ///< meshes: false hides triangles seen from behind (clockwise corners)
  /// Slice views draw it over the slices (forEachMark); opaque lines and spheres are drawn completely, in front of
  /// everything.
  bool inSlices = false;
  /// Meshes: it is inside a body. Slice views do not outline it; tools grab the tissue behind it.
  bool isInside = false;
  /// Opaque meshes: transparent primitives within this distance in front of it, in its own space, are hidden. Two
  /// surfaces of the same object, each with an error of this size, would otherwise alternate from pixel to pixel.
  float cover = 0.0f;
};

/// The meaning of colours. Drawn as a bar with numbers at the right edge of the picture, several below each other.
struct Legend {
  std::string title, unit;       ///< UTF-8
  std::string note;              ///< below the bar, lines separated by '\n'
  double low = 0.0, high = 1.0;  ///< values of the first and the last colour
  std::vector<Colour> colours;   ///< equidistant, beginning with that of `low`; at least 2
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< 3 bytes per pixel, top row first
};
/// @param path  UTF-8; its folder must exist
[[nodiscard]] Expected<void> writePng(const std::string &path, const Image &image);

/// The target of a frame: pixels from the lower left corner of the framebuffer.
struct Viewport {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const Viewport &, const Viewport &) = default;
};

/// Work of the last frame, and objects created since the renderer was.
struct RenderStatistics {
  std::size_t drawCalls = 0;         ///< last frame
  std::size_t sortedPrimitives = 0;  ///< last frame: transparent triangles, spheres and segments
  double sort_ms = 0.0;              ///< last frame: their sorting
  std::size_t uploadedBytes = 0;     ///< last frame: array contents uploaded to graphics memory
  double upload_ms = 0.0;            ///< last frame: the upload, including the computation of normals
  std::size_t vertexArraysMade = 0;  ///< total; updating a proxy adds none
  std::size_t programsLinked = 0;    ///< total; does not grow after the start
};

class ImageRenderer;

/// A mesh as drawn, for code that cuts or measures it. Borrowed for the call.
struct MeshView {
  std::span<const Vec3f> positions;  ///< in the proxy's own space
  std::span<const Triangle> triangles;
  const Mat4 &worldFromProxy;
  const Material &material;
};

/// Spheres, lines or a label that are also drawn over slices. Borrowed for the call.
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
/// Transparent primitives (opacity below 1) are sorted by the depth of each triangle, sphere and segment over all
/// proxies, so opaque objects inside show through and the order of creation does not matter. Only primitives that
/// intersect each other, or that are much larger than what they overlap, may blend in the wrong order. Blending is done
/// on the sRGB values.
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
  /// UTF-8, lines separated by '\n', of constant size on the screen, above the point and in front of everything.
  virtual Handle createLabel(const Vec3f &at, std::string_view text, const Material &) = 0;

  /// Of constant size, in front of everything; omitted in pictures too small for it. A null handle: fewer than 2
  /// colours, or a range that is not finite or not increasing.
  virtual Handle createLegend(const Legend &) = 0;

  /// The count may change for spheres and lines, which then lose their colours and radii. Without setNormals, a mesh
  /// computes normals from its triangles. An empty span passed to setNormals, setColours or setRadii restores the
  /// default.
  /// False: stale handle, a kind of proxy that has no such array, or a wrong count.
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

  static constexpr double kLegendText_px = 18.0;  ///< height of the text of labels and legends

  /// How a picture differs from what a window shows.
  struct PictureStyle {
    float scale = 1.0f;                    ///< pixels per pixel of text, lines and legends: 2 doubles their size; > 0
    bool isLight = false;                  ///< legends have dark text on a light background
    bool isFinal = false;                  ///< draw() renders at full quality, without a time limit
    std::optional<Background> background;  ///< instead of that of setBackground()
  };
  /// For draw() and drawToImage() from now on; {} restores that of windows. Not counted by changes(): no cached picture
  /// is affected.
  virtual void setPictureStyle(const PictureStyle &) {}

  /// Draws everything visible into the bound framebuffer, which needs a depth buffer; clears that region's depth.
  /// Leaves depth test, culling, blending and scissor off and nothing bound.
  virtual void draw(const Camera &camera, const Viewport &viewport) = 0;
  /// Incremented by every change that affects draw() for the same camera, including images: while it is unchanged, so
  /// is the picture. Refinement (ImageRenderer::wantsRefinement) does not count.
  [[nodiscard]] virtual std::uint64_t changes() const = 0;
  /// Draws into a separate image, independent of the window's size, with antialiasing.
  [[nodiscard]] virtual Expected<Image> drawToImage(const Camera &camera, int width, int height) = 0;

  /// All visible meshes, in the order of creation.
  virtual void forEachMesh(const std::function<void(const MeshView &)> &) const {}
  /// All visible proxies except meshes whose material has `inSlices`, in the order of creation.
  virtual void forEachMark(const std::function<void(const MarkView &)> &) const {}
  /// Images in addition to the proxies; null: this back end does not support them.
  [[nodiscard]] virtual ImageRenderer *images() { return nullptr; }

  [[nodiscard]] virtual std::string description() const = 0;  ///< back end, version, device
  [[nodiscard]] virtual RenderStatistics statistics() const { return {}; }
};

/// Stores its input and draws a flat background, so that logic can be tested without graphics.
[[nodiscard]] std::unique_ptr<Renderer> createNullRenderer();

}  // namespace c3de::render
