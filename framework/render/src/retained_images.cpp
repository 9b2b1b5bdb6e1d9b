// SPDX-License-Identifier: Apache-2.0
#include "retained_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace c3de::render {
namespace {

Vec3 column(const Mat4 &m, std::size_t c) { return {m[4 * c], m[4 * c + 1], m[4 * c + 2]}; }

std::string sizeText(const GridGeometry &place) {
  return fmt::format("{} x {} x {}", place.size[0], place.size[1], place.size[2]);
}

/// Number of grid points, or why the grid is invalid.
Expected<std::size_t> checkGeometry(const GridGeometry &place, const char *what) {
  std::size_t count = 1;
  for (const std::size_t n : place.size) {
    if (n == 0 || count > std::numeric_limits<std::size_t>::max() / 64 / n)
      return fail(ErrorCode::usage,
                  fmt::format("{}: {} points; accepted: at least 1 in each direction", what, sizeText(place)));
    count *= n;
  }
  const double volume = linearDeterminant(place.worldFromIndex);
  const bool isFinite =
      std::all_of(place.worldFromIndex.begin(), place.worldFromIndex.end(), [](double v) { return std::isfinite(v); });
  if (!isFinite || volume == 0.0)
    return fail(ErrorCode::usage,
                fmt::format("{}: its world transform has the determinant {}; accepted: finite, not 0", what, volume));
  return count;
}

Expected<void> checkCount(std::size_t given, std::size_t needed, const GridGeometry &place, const char *what) {
  if (given == needed) return {};
  return fail(ErrorCode::usage,
              fmt::format("{}: {} numbers for {} points, needed: {}", what, given, sizeText(place), needed));
}

}  // namespace

Mat4 affineInverse(const Mat4 &affine) {
  const Vec3 x = column(affine, 0), y = column(affine, 1), z = column(affine, 2), origin = column(affine, 3);
  const double inverse = 1.0 / dot(x, cross(y, z));
  const Vec3 rows[3] = {inverse * cross(y, z), inverse * cross(z, x), inverse * cross(x, y)};
  Mat4 m = kIdentity4;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) m[4 * c + r] = rows[r][c];
    m[12 + r] = -dot(rows[r], origin);
  }
  return m;
}

Mat3f linearPart(const Mat4 &m) {
  const auto f = [&](std::size_t i) { return static_cast<float>(m[i]); };
  return {f(0), f(1), f(2), f(4), f(5), f(6), f(8), f(9), f(10)};
}

ImageSlot *RetainedImages::find(Handle handle, ImageSlot::Kind kind) {
  ImageSlot *slot = slots_.find(handle);
  return slot && slot->kind == kind ? slot : nullptr;
}

Expected<Handle> RetainedImages::addImage(const ImageVoxels &image, std::string *notice) {
  if (auto count = checkGeometry(image.place, "an image"); !count) return tl::unexpected(count.error());
  if (!image.voxels) return fail(ErrorCode::usage, "an image without voxels");
  if (!std::isfinite(image.slope) || !std::isfinite(image.intercept) || image.slope == 0.0)
    return fail(ErrorCode::usage, fmt::format("an image of slope {} and intercept {}; accepted: finite, slope not 0",
                                              image.slope, image.intercept));
  ImageSlot slot;
  slot.place = image.place;
  slot.hasColours = image.colours != nullptr;
  if (auto done = uploadImage(slot, image, notice); !done) return tl::unexpected(done.error());
  slot.indexFromWorld = affineInverse(slot.place.worldFromIndex);
  ++changes_;
  return slots_.add(std::move(slot));
}

Expected<Handle> RetainedImages::addLabels(const GridGeometry &place, std::span<const std::uint16_t> voxels) {
  const auto count = checkGeometry(place, "a label map");
  if (!count) return tl::unexpected(count.error());
  if (auto fits = checkCount(voxels.size(), *count, place, "a label map"); !fits) return tl::unexpected(fits.error());
  ImageSlot slot;
  slot.kind = ImageSlot::Kind::labels;
  slot.place = place;
  if (auto done = uploadLabels(slot, voxels); !done) return tl::unexpected(done.error());
  slot.indexFromWorld = affineInverse(slot.place.worldFromIndex);
  ++changes_;
  return slots_.add(std::move(slot));
}

bool RetainedImages::setLabelColours(Handle labels, std::span<const std::pair<std::uint16_t, Colour>> colours) {
  ImageSlot *slot = find(labels, ImageSlot::Kind::labels);
  if (!slot) return false;
  if (std::equal(colours.begin(), colours.end(), slot->colours.begin(), slot->colours.end())) return true;
  slot->colours.assign(colours.begin(), colours.end());
  labelColoursChanged(*slot);
  ++changes_;
  return true;
}

Expected<Handle> RetainedImages::addDisplacement(const GridGeometry &place, std::span<const float> xyz_mm,
                                                 std::span<const float> gap_mm) {
  const auto count = checkGeometry(place, "a displacement grid");
  if (!count) return tl::unexpected(count.error());
  if (auto fits = checkCount(xyz_mm.size(), 3 * *count, place, "a displacement grid"); !fits)
    return tl::unexpected(fits.error());
  if (!gap_mm.empty())
    if (auto fits = checkCount(gap_mm.size(), *count, place, "gaps of a displacement grid"); !fits)
      return tl::unexpected(fits.error());
  ImageSlot slot;
  slot.kind = ImageSlot::Kind::displacement;
  slot.hasGaps = !gap_mm.empty();
  slot.place = place;
  slot.indexFromWorld = affineInverse(place.worldFromIndex);
  if (auto done = uploadDisplacement(slot, xyz_mm, gap_mm); !done) return tl::unexpected(done.error());
  ++changes_;
  return slots_.add(std::move(slot));
}

bool RetainedImages::setDisplacement(Handle displacement, std::span<const float> xyz_mm,
                                     std::span<const float> gap_mm) {
  ImageSlot *slot = find(displacement, ImageSlot::Kind::displacement);
  if (!slot) return false;
  const std::size_t points = slot->place.size[0] * slot->place.size[1] * slot->place.size[2];
  if (xyz_mm.size() != 3 * points || gap_mm.size() != (slot->hasGaps ? points : 0)) return false;
  if (!uploadDisplacement(*slot, xyz_mm, gap_mm)) return false;
  ++changes_;
  return true;
}

bool RetainedImages::setField(Handle displacement, std::span<const float> values) {
  ImageSlot *slot = find(displacement, ImageSlot::Kind::displacement);
  if (!slot) return false;
  if (values.empty() && !slot->hasField) return true;
  const std::size_t points = slot->place.size[0] * slot->place.size[1] * slot->place.size[2];
  if (!values.empty() && values.size() != points) return false;
  // Between points with and without a value, the interpolated weight normalises the sum.
  std::vector<float> pairs(2 * values.size(), 0.0f);
  for (std::size_t p = 0; p < values.size(); ++p)
    if (std::isfinite(values[p])) pairs[2 * p] = values[p], pairs[2 * p + 1] = 1.0f;
  const bool isThere = uploadField(*slot, pairs);
  slot->hasField = isThere && !values.empty();
  ++changes_;
  return isThere;
}

bool RetainedImages::setOverlayColours(std::span<const Colour> colours) {
  if (colours.size() < 2) return false;
  overlayColours_.assign(colours.begin(), colours.end());
  overlayColoursChanged();
  ++changes_;
  return true;
}

bool RetainedImages::remove(Handle handle) {
  ++changes_;
  return slots_.remove(handle);
}

void RetainedImages::setScene(ImageScene scene) {
  scene.movingDivisor = std::max(scene.movingDivisor, 1);
  if (scene == scene_) return;
  scene_ = std::move(scene);
  ++sceneChanges_;
}

std::vector<Vec3> sliceOutline(const GridGeometry &place, const Vec3 &point, const Vec3 &normal) {
  std::array<Vec3, 8> corners;
  std::array<double, 8> distance{};
  for (std::size_t c = 0; c < 8; ++c) {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = (c >> a & 1u) != 0 ? static_cast<double>(place.size[a]) - 0.5 : -0.5;
    corners[c] = c3de::transformPoint(place.worldFromIndex, index);
    distance[c] = dot(corners[c] - point, normal);
  }
  std::vector<Vec3> points;
  for (std::size_t a = 0; a < 8; ++a)
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const std::size_t b = a | bit;
      if (b == a || (distance[a] >= 0.0) == (distance[b] >= 0.0)) continue;
      points.push_back(corners[a] + (distance[a] / (distance[a] - distance[b])) * (corners[b] - corners[a]));
    }
  if (points.size() < 3) return {};
  // Around their centre, so that they form a convex polygon.
  Vec3 middle{};
  for (const Vec3 &p : points) middle = middle + (1.0 / static_cast<double>(points.size())) * p;
  const Vec3 u = points[0] - middle, v = cross(normal, u);
  std::sort(points.begin(), points.end(), [&](const Vec3 &p, const Vec3 &q) {
    return std::atan2(dot(p - middle, v), dot(p - middle, u) * norm(normal)) <
           std::atan2(dot(q - middle, v), dot(q - middle, u) * norm(normal));
  });
  return points;
}

std::vector<Vec3> cutPolygon(std::vector<Vec3> corners, std::span<const CutPlane> cuts) {
  constexpr double kInPlane_mm = 1e-3;
  for (const CutPlane &cut : cuts) {
    const double length = std::max(norm(cut.normal), 1e-12);
    const auto beyond = [&](const Vec3 &p) { return dot(p - cut.point, cut.normal) / length - kInPlane_mm; };
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
      const double da = beyond(a), db = beyond(b);
      if (da <= 0.0) kept.push_back(a);
      if ((da <= 0.0) != (db <= 0.0)) kept.push_back(a + (da / (da - db)) * (b - a));
    }
    corners = std::move(kept);
  }
  return corners;
}

}  // namespace c3de::render
