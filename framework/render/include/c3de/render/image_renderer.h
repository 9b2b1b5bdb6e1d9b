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

/// Where the values of a grid lie: a whole index is a point of the grid, i fastest; world is mm.
struct GridPlace {
  std::array<std::size_t, 3> size{};
  Mat4 worldFromIndex = kIdentity4;  ///< affine, invertible
};

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Grey values, borrowed for the call. value = slope * voxel + intercept.
struct ImageVoxels {
  GridPlace place;
  VoxelType type = VoxelType::int16;
  const void *voxels = nullptr;
  double slope = 1.0, intercept = 0.0;
  /// Red, green, blue and opacity (left out) of each voxel, or null. Slices then show them through window and level
  /// instead of the grey values, which are their brightness from 0 to 255; volumes are drawn from the grey values.
  const std::array<std::uint8_t, 4> *colours = nullptr;
};

/// What slices show of the displacement in colours.
enum class Overlay {
  none,
  shift,  ///< |u|
  field   ///< of setField()
};

/// How an image is looked at. Null handles: without that part.
struct ImageLook {
  Handle image, labels, displacement;
  /// An image on the grid of `image`, white where bodies are in the reference; with a displacement that has gaps,
  /// places that they have left are hatched in slices and empty in volumes. Null: nothing is known of bodies.
  Handle bodies{};
  /// A quarter of white in `bodies` is what stays: only bodies come over it, and what moves away from it leaves a gap;
  /// three eighths: it stays, and a gap beside it is one that the displacement has.
  bool hasStill = false;
  /// An image on the grid of `image`, above half its white where tissue of the reference was meant to be a body and is
  /// in none: marked in slices. Null: nothing is.
  Handle missing{};
  double leastGap = 0.0;             ///< mm; a gap above it counts
  double window = 1.0, level = 0.5;  ///< values: black at level - window/2, white at level + window/2
  bool isSmooth = true;              ///< linear interpolation of grey values; else the nearest voxel
  float labelOpacity = 0.4f;
  Overlay overlay = Overlay::none;
  double overlayLow = 0.0, overlayHigh = 10.0;  ///< |u|: mm; a field: as its numbers are
  float overlayOpacity = 0.6f;  ///< of |u| above overlayLow, after a short rise, elsewhere nothing is shown; of a field
                                ///< wherever a body is
  friend bool operator==(const ImageLook &, const ImageLook &) = default;
};

/// The plane of a view: world point of pixel (x, y) = origin + x right + y down, pixels from the upper left corner of
/// the viewport; the centre of the first pixel is at 0.5.
struct SlicePlane {
  Vec3 origin{}, right{1, 0, 0}, down{0, 1, 0};  ///< mm, mm per pixel
  friend bool operator==(const SlicePlane &, const SlicePlane &) = default;
};

/// A slice as a plane in space; cut to the image's box.
struct SliceInSpace {
  Vec3 point{}, normal{0, 0, 1};
  Colour frame{0.6f, 0.6f, 0.6f, 1.0f};  ///< of its border
  friend bool operator==(const SliceInSpace &, const SliceInSpace &) = default;
};

/// What a value of the image looks like in a volume rendering.
struct TransferPoint {
  double value = 0.0;
  Colour colour{};  ///< opacity of 1 mm of it
  friend bool operator==(const TransferPoint &, const TransferPoint &) = default;
};
struct VolumeLook {
  bool isMaximum = false;  ///< brightest value along the ray, through window and level; no transfer function
  bool isShaded = true;
  std::vector<TransferPoint> points;  ///< by rising value, 2 at least
  double shift = 0.0;                 ///< added to the values of the points
  friend bool operator==(const VolumeLook &, const VolumeLook &) = default;
};

/// Half of space that is left out: what lies beyond the plane, where its normal points.
struct CutPlane {
  Vec3 point{}, normal{0, 0, 1};  ///< mm; any length
  friend bool operator==(const CutPlane &, const CutPlane &) = default;
};

/// What is shown of images in space, beside the proxies of the renderer.
struct ImageScene {
  ImageLook look;
  std::vector<SliceInSpace> slices;
  bool showsVolume = false;
  VolumeLook volume;
  /// 3 at most count; of volume and slices, but not of a slice that lies in a plane of them
  std::vector<CutPlane> cuts;
  bool cutsProxies = false;  ///< and of the proxies: meshes and lines to the plane, spheres as wholes
  int movingDivisor = 4;     ///< a ray for so many pixels in each direction while something changes; at least 1
  friend bool operator==(const ImageScene &, const ImageScene &) = default;
};

/// Images, label maps and displacement fields: uploaded once, drawn as slices and by ray casting. A displacement field
/// u warps an image spatially: at x the value of material point x - u(x) is shown; outside its grid u is 0. Zero
/// displacement gives the same pixels as none. Thread and context as for Renderer.
class ImageRenderer {
 public:
  virtual ~ImageRenderer() = default;

  /// ErrorCode::usage for sizes that do not fit, ErrorCode::graphics when the memory does not suffice. A side longer
  /// than textures can be is kept at every second (third, …) voxel; `notice` then says so.
  [[nodiscard]] virtual Expected<Handle> addImage(const ImageVoxels &image, std::string *notice = nullptr) = 0;
  /// 0 is background; shown at the nearest voxel.
  [[nodiscard]] virtual Expected<Handle> addLabels(const GridPlace &place, std::span<const std::uint16_t> voxels) = 0;
  /// Colours by label value; their opacity multiplies that of the look, 0 hides a label. Values without: transparent.
  virtual bool setLabelColours(Handle labels, std::span<const std::pair<std::uint16_t, Colour>> colours) = 0;
  /// 3 numbers per point of the grid, mm.
  /// @param gap_mm  for each point how far the material of x - u is from it now; empty: nobody knows
  [[nodiscard]] virtual Expected<Handle> addDisplacement(const GridPlace &place, std::span<const float> xyz_mm,
                                                         std::span<const float> gap_mm = {}) = 0;
  /// New values on the same grid. False: stale handle, or another count; also of gaps.
  virtual bool setDisplacement(Handle displacement, std::span<const float> xyz_mm,
                               std::span<const float> gap_mm = {}) = 0;
  /// A number for each point of a displacement's grid, in the place of those before; NaN: there is none. Empty: no
  /// field is there any more. False: stale handle, another count, or too little memory.
  virtual bool setField(Handle displacement, std::span<const float> values) = 0;
  /// Colours of what is laid over, the one of overlayLow first; 2 at least.
  virtual bool setOverlayColours(std::span<const Colour> colours) = 0;
  virtual bool remove(Handle handle) = 0;

  /// Draws a slice into the bound framebuffer; black where there is no image.
  virtual void drawSlice(const ImageLook &look, const SlicePlane &plane, const Viewport &viewport) = 0;
  /// Grows with everything that changes what drawSlice() shows for the same look and plane.
  [[nodiscard]] virtual std::uint64_t changes() const = 0;
  /// The same as a picture.
  [[nodiscard]] virtual Expected<Image> drawSliceToImage(const ImageLook &look, const SlicePlane &plane, int width,
                                                         int height) = 0;

  /// What Renderer::draw() and drawToImage() show of images from now on.
  virtual void setScene(ImageScene scene) = 0;
  /// The last draw() used fewer rays than there are pixels, or not all of them yet: drawing again refines.
  [[nodiscard]] virtual bool wantsRefinement() const = 0;
};

/// The corners of the polygon in which a plane cuts the box of an image (half a voxel around the outermost centres), in
/// order; fewer than 3: it does not.
[[nodiscard]] std::vector<Vec3> sliceOutline(const GridPlace &place, const Vec3 &point, const Vec3 &normal);
/// What the planes leave of a convex polygon; what lies in a plane stays.
[[nodiscard]] std::vector<Vec3> cutPolygon(std::vector<Vec3> corners, std::span<const CutPlane> cuts);

}  // namespace c3de::render
