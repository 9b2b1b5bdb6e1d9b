// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/core/vec.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

/// The grid of values in space: an integer index is a point of the grid, i fastest; world is mm.
struct GridGeometry {
  std::array<std::size_t, 3> size{};
  Mat4 worldFromIndex = kIdentity4;  ///< affine, invertible
};

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Grey values, borrowed for the call. value = slope * voxel + intercept.
struct ImageVoxels {
  GridGeometry place;
  VoxelType type = VoxelType::int16;
  const void *voxels = nullptr;
  double slope = 1.0, intercept = 0.0;
  /// Red, green, blue and opacity (ignored) of each voxel, or null. Slices then show them through window and level
  /// instead of the grey values, which are their brightness from 0 to 255; volumes are rendered from the grey values.
  const std::array<std::uint8_t, 4> *colours = nullptr;
};

/// Colour overlay of the displacement on slices.
enum class Overlay {
  none,
  shift,  ///< |u|
  field   ///< of setField()
};

/// A second image over the first one in slices. It is not warped by the displacement.
struct ComparisonDisplay {
  Handle image{};                     ///< null: none
  Mat4 worldFromSecond = kIdentity4;  ///< rigid: from the world of the second image to that of the first
  double window = 1.0, level = 0.5;   ///< values of the second image
  float weight = 0.5f;                ///< of the second image where both are blended, 0 … 1
  bool isCheckerboard = false;        ///< squares of the first and of the second image in turn, instead of blending
  double square_mm = 20.0;            ///< side of the squares, above 0; one has a corner in the middle of the first
                                      ///< image
  friend bool operator==(const ComparisonDisplay &, const ComparisonDisplay &) = default;
};

/// Display settings of an image. Null handles: without that part.
struct ImageDisplay {
  Handle image, labels, displacement;
  ComparisonDisplay comparison{};
  /// An image on the grid of `image`, white where bodies are in the reference. With a displacement that has gaps,
  /// vacated regions are hatched in slices and empty in volumes. Null: bodies are unknown.
  Handle bodies{};
  /// A quarter of white in `bodies` is fixed: only bodies move over it, and material that moves away from it leaves a
  /// gap. Three eighths: fixed, and only the displacement's own gaps count next to it.
  bool hasFixedRegions = false;
  /// An image on the grid of `image`, above half its white where tissue of the reference was meant to be in a body but
  /// is in none: marked in slices. Null: nothing is missing.
  Handle missing{};
  double leastGap = 0.0;             ///< mm; a larger gap counts
  double window = 1.0, level = 0.5;  ///< values: black at level - window/2, white at level + window/2
  bool isSmooth = true;              ///< linear interpolation of grey values; otherwise the nearest voxel
  float labelOpacity = 0.4f;
  Overlay overlay = Overlay::none;
  double overlayLow = 0.0, overlayHigh = 10.0;  ///< |u|: mm; a field: in its own unit
  float overlayOpacity = 0.6f;  ///< for |u|: above overlayLow, after a short ramp, otherwise hidden; for a field:
                                ///< wherever a body is
  friend bool operator==(const ImageDisplay &, const ImageDisplay &) = default;
};

/// The plane of a view: world point of pixel (x, y) = origin + x right + y down, pixels from the upper left corner of
/// the viewport; the centre of the first pixel is at 0.5.
struct SlicePlane {
  Vec3 origin{}, right{1, 0, 0}, down{0, 1, 0};  ///< mm, mm per pixel
  friend bool operator==(const SlicePlane &, const SlicePlane &) = default;
};

/// A slice as a plane in space; clipped to the image's box.
struct SliceInSpace {
  Vec3 point{}, normal{0, 0, 1};
  Colour frame{0.6f, 0.6f, 0.6f, 1.0f};  ///< of its border
  Vec3 along{};                          ///< direction of the rows of a checkerboard; zero: any
  friend bool operator==(const SliceInSpace &, const SliceInSpace &) = default;
};

/// The appearance of an image value in volume rendering.
struct TransferPoint {
  double value = 0.0;
  Colour colour{};  ///< opacity of 1 mm of it
  friend bool operator==(const TransferPoint &, const TransferPoint &) = default;
};
struct VolumeDisplay {
  bool isMaximum = false;  ///< brightest value along the ray, through window and level; no transfer function
  bool isShaded = true;
  std::vector<TransferPoint> points;  ///< by increasing value, at least 2
  double shift = 0.0;                 ///< added to the values of the points
  friend bool operator==(const VolumeDisplay &, const VolumeDisplay &) = default;
};

/// A half-space that is cut away: beyond the plane, in the direction of its normal.
struct CutPlane {
  Vec3 point{}, normal{0, 0, 1};  ///< mm; any length
  friend bool operator==(const CutPlane &, const CutPlane &) = default;
};

/// The images shown in space, in addition to the proxies of the renderer.
struct ImageScene {
  ImageDisplay look;
  std::vector<SliceInSpace> slices;
  bool showsVolume = false;
  VolumeDisplay volume;
  /// At most 3 are used; for volume and slices, but not for a slice in one of these planes
  std::vector<CutPlane> cuts;
  bool cutsProxies = false;  ///< also for the proxies: meshes and lines at the plane, spheres as wholes
  int movingDivisor = 4;     ///< pixels per ray in each direction while something changes; at least 1
  friend bool operator==(const ImageScene &, const ImageScene &) = default;
};

/// Images, label maps and displacement fields: uploaded once, drawn as slices and by ray casting. A displacement field
/// u warps an image spatially: the value of material point x - u(x) is shown at x; outside its grid u is 0. Zero
/// displacement gives the same pixels as none. Thread and context as for Renderer.
class ImageRenderer {
 public:
  virtual ~ImageRenderer() = default;

  /// ErrorCode::usage for inconsistent sizes, ErrorCode::graphics if memory is insufficient. A side longer than the
  /// maximum texture size is stored at every second (third, …) voxel; `notice` then states this.
  [[nodiscard]] virtual Expected<Handle> addImage(const ImageVoxels &image, std::string *notice = nullptr) = 0;
  /// 0 is background; shown at the nearest voxel.
  [[nodiscard]] virtual Expected<Handle> addLabels(const GridGeometry &place,
                                                   std::span<const std::uint16_t> voxels) = 0;
  /// Colours by label value; their opacity multiplies that of the look, 0 hides a label. Values without one:
  /// transparent.
  virtual bool setLabelColours(Handle labels, std::span<const std::pair<std::uint16_t, Colour>> colours) = 0;
  /// 3 numbers per point of the grid, mm.
  /// @param gap_mm  for each point the present distance to the material of x - u; empty: unknown
  [[nodiscard]] virtual Expected<Handle> addDisplacement(const GridGeometry &place, std::span<const float> xyz_mm,
                                                         std::span<const float> gap_mm = {}) = 0;
  /// New values on the same grid. False: stale handle, or a different count, also of gaps.
  virtual bool setDisplacement(Handle displacement, std::span<const float> xyz_mm,
                               std::span<const float> gap_mm = {}) = 0;
  /// A number for each point of a displacement's grid, replaces the previous ones; NaN: none. Empty: removes the field.
  /// False: stale handle, wrong count, or insufficient memory.
  virtual bool setField(Handle displacement, std::span<const float> values) = 0;
  /// Colours of the overlay, beginning with that of overlayLow; at least 2.
  virtual bool setOverlayColours(std::span<const Colour> colours) = 0;
  virtual bool remove(Handle handle) = 0;

  /// Draws a slice into the bound framebuffer; black where there is no image.
  virtual void drawSlice(const ImageDisplay &look, const SlicePlane &plane, const Viewport &viewport) = 0;
  /// Incremented by every change that affects drawSlice() for the same look and plane.
  [[nodiscard]] virtual std::uint64_t changes() const = 0;
  /// Same, into an image.
  [[nodiscard]] virtual Expected<Image> drawSliceToImage(const ImageDisplay &look, const SlicePlane &plane, int width,
                                                         int height) = 0;

  /// Sets the images that Renderer::draw() and drawToImage() show from now on.
  virtual void setScene(ImageScene scene) = 0;
  /// The last draw() used fewer rays than there are pixels, or not all of them yet: drawing again refines the image.
  [[nodiscard]] virtual bool wantsRefinement() const = 0;
};

/// The corners of the polygon in which a plane cuts the box of an image (half a voxel around the outermost centres), in
/// order; fewer than 3: no intersection.
[[nodiscard]] std::vector<Vec3> sliceOutline(const GridGeometry &place, const Vec3 &point, const Vec3 &normal);
/// Clips a convex polygon by the planes; points in a plane are kept.
[[nodiscard]] std::vector<Vec3> cutPolygon(std::vector<Vec3> corners, std::span<const CutPlane> cuts);

}  // namespace c3de::render
