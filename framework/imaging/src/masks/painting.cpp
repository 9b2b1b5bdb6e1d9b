// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/painting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/imaging/masks.h"
#include "masks/mask_tools.h"

namespace c3de::imaging {
namespace {

using Index = std::array<std::size_t, 3>;

bool isFinite(const Vec3 &p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

Vec3 columnOf(const Mat4 &m, std::size_t c) { return {m[4 * c], m[4 * c + 1], m[4 * c + 2]}; }

std::size_t offsetOf(const VolumeGeometry &grid, const Index &i) {
  return i[0] + grid.size[0] * (i[1] + grid.size[1] * i[2]);
}

/// Writes the voxels of a brush.
class Brush {
 public:
  Brush(Mask &mask, const BrushStroke &stroke, const Volume *image)
      : mask_(mask), stroke_(stroke), image_(image), toIndex_(affineInverse(mask.geometry.indexToWorld)),
        value_(stroke.isErasing ? 0 : 1) {
    if (image) toImage_ = multiply(affineInverse(image->geometry.indexToWorld), mask.geometry.indexToWorld);
    if (!stroke.normal) return;
    for (std::size_t a = 0; a < 3; ++a)
      halfThickness_ =
          std::max(halfThickness_, 0.5 * std::abs(dot(columnOf(mask.geometry.indexToWorld, a), *stroke.normal)));
  }

  void point(const Vec3 &p) {
    if (const auto voxel = voxelAt(mask_.geometry, transformPoint(toIndex_, p))) set(*voxel);
  }

  /// All voxels within the radius of the segment from p to q.
  void segment(const Vec3 &p, const Vec3 &q) {
    Index low{}, high{};
    const Vec3 i = transformPoint(toIndex_, p), j = transformPoint(toIndex_, q);
    for (std::size_t a = 0; a < 3; ++a) {
      const double reach = reach_mm() * norm({toIndex_[a], toIndex_[4 + a], toIndex_[8 + a]});
      const double last = static_cast<double>(mask_.geometry.size[a]) - 1.0;
      const double from = std::ceil(std::min(i[a], j[a]) - reach), to = std::floor(std::max(i[a], j[a]) + reach);
      if (!(to >= 0.0) || !(from <= last)) return;
      low[a] = static_cast<std::size_t>(std::max(from, 0.0));
      high[a] = static_cast<std::size_t>(std::min(to, last));
    }
    for (std::size_t c = low[2]; c <= high[2]; ++c)
      for (std::size_t b = low[1]; b <= high[1]; ++b)
        for (std::size_t a = low[0]; a <= high[0]; ++a)
          if (isWithin({static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)}, p, q)) set({a, b, c});
  }

 private:
  [[nodiscard]] double reach_mm() const { return std::hypot(stroke_.radius_mm, halfThickness_); }

  [[nodiscard]] bool isWithin(const Vec3 &index, const Vec3 &p, const Vec3 &q) const {
    const Vec3 x = mask_.geometry.worldAt(index), along = q - p;
    const double length = dot(along, along);
    const double t = length > 0.0 ? std::clamp(dot(x - p, along) / length, 0.0, 1.0) : 0.0;
    Vec3 away = x - (p + t * along);
    if (stroke_.normal) {
      const double height = dot(away, *stroke_.normal);
      if (std::abs(height) > halfThickness_ * (1.0 + 1e-9)) return false;
      away = away - height * *stroke_.normal;
    }
    return dot(away, away) <= stroke_.radius_mm * stroke_.radius_mm;
  }

  void set(const Index &voxel) {
    if (stroke_.values) {
      const Vec3 at = transformPoint(
          toImage_, {static_cast<double>(voxel[0]), static_cast<double>(voxel[1]), static_cast<double>(voxel[2])});
      const auto source = voxelAt(image_->geometry, at);
      if (!source) return;
      const double value = image_->value((*source)[0], (*source)[1], (*source)[2]);
      if (!(value >= stroke_.values->low) || !(value <= stroke_.values->high)) return;
    }
    mask_.voxels[offsetOf(mask_.geometry, voxel)] = value_;
  }

  Mask &mask_;
  const BrushStroke &stroke_;
  const Volume *image_;
  Mat4 toIndex_, toImage_ = kIdentity4;
  double halfThickness_ = 0.0;  // mm, of the painted slice
  std::uint8_t value_;
};

}  // namespace

Expected<void> paint(Mask &mask, const BrushStroke &stroke, const Volume *image) {
  if (auto checked = checkMask(mask); !checked) return checked;
  if (stroke.path.empty()) return fail(ErrorCode::usage, "a brush stroke without points");
  for (const Vec3 &p : stroke.path)
    if (!isFinite(p)) return fail(ErrorCode::usage, "a brush stroke with a point that is not finite");
  if (!(stroke.radius_mm > 0.0) || !std::isfinite(stroke.radius_mm))
    return fail(ErrorCode::usage,
                fmt::format("a brush of radius {} mm is not accepted: finite and > 0", stroke.radius_mm));
  if (stroke.values && !image) return fail(ErrorCode::usage, "a brush limited to image values needs an image");
  Brush brush(mask, stroke, stroke.values ? image : nullptr);
  for (std::size_t i = 0; i < stroke.path.size(); ++i) {
    brush.point(stroke.path[i]);
    brush.segment(stroke.path[i > 0 ? i - 1 : 0], stroke.path[i]);
  }
  return {};
}

Expected<Mask> regionAround(const Volume &volume, const Vec3 &world, double tolerance, double maxDistance_mm,
                            const ProgressFn &progress) {
  if (!(tolerance >= 0.0) || !std::isfinite(tolerance))
    return fail(ErrorCode::usage, fmt::format("a tolerance of {} is not accepted: finite and >= 0", tolerance));
  if (!(maxDistance_mm >= 0.0) || !std::isfinite(maxDistance_mm))
    return fail(ErrorCode::usage, fmt::format("a distance of {} mm is not accepted: finite and >= 0", maxDistance_mm));
  const VolumeGeometry &grid = volume.geometry;
  const auto seed = voxelAt(grid, transformPoint(affineInverse(grid.indexToWorld), world));
  if (!seed)
    return fail(ErrorCode::usage, fmt::format("the click at LPS {:.1f}, {:.1f}, {:.1f} mm is outside of the image",
                                              world[0], world[1], world[2]));
  const double value = volume.value((*seed)[0], (*seed)[1], (*seed)[2]);
  if (!std::isfinite(value)) return fail(ErrorCode::usage, "the image has no finite value at the click");
  auto mask = threshold(volume, value - tolerance, value + tolerance, stage(progress, 0.0, 0.4));
  if (!mask) return mask;
  if (maxDistance_mm > 0.0) {
    std::size_t v = 0;
    const double limit = maxDistance_mm * maxDistance_mm;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
      for (std::size_t j = 0; j < grid.size[1]; ++j)
        for (std::size_t i = 0; i < grid.size[0]; ++i, ++v) {
          if (mask->voxels[v] == 0) continue;
          const Vec3 away =
              grid.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) - world;
          if (dot(away, away) > limit) mask->voxels[v] = 0;
        }
    mask->voxels[offsetOf(grid, *seed)] = 1;
  }
  return connectedComponent(*mask, *seed, stage(progress, 0.4, 1.0));
}

std::size_t axisAlong(const VolumeGeometry &grid, const Vec3 &direction) {
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 step = columnOf(grid.indexToWorld, a);
    const double cosine = std::abs(dot(step, direction)) / norm(step);
    if (cosine > most) best = a, most = cosine;
  }
  return best;
}

Mask onGrid(const Mask &mask, const VolumeGeometry &grid) {
  if (sameGrid(mask.geometry, grid)) return {grid, mask.voxels};
  Mask out{grid, std::vector<std::uint8_t>(grid.voxelCount())};
  const Mat4 toSource = multiply(affineInverse(mask.geometry.indexToWorld), grid.indexToWorld);
  std::size_t v = 0;
  for (std::size_t k = 0; k < grid.size[2]; ++k)
    for (std::size_t j = 0; j < grid.size[1]; ++j)
      for (std::size_t i = 0; i < grid.size[0]; ++i, ++v) {
        const auto source =
            voxelAt(mask.geometry,
                    transformPoint(toSource, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        if (source) out.voxels[v] = mask.voxels[offsetOf(mask.geometry, *source)];
      }
  return out;
}

Expected<LabelMap> withLabel(const LabelMap *before, const Mask &mask, LabelMap::Label label) {
  if (auto checked = checkMask(mask); !checked) return tl::unexpected(checked.error());
  if (before && !sameGrid(before->geometry, mask.geometry))
    return fail(ErrorCode::usage, "the mask and the label map have different grids");
  LabelMap map = before ? *before : LabelMap{mask.geometry, std::vector<std::uint16_t>(mask.voxels.size()), {}};
  if (label.value == 0) {
    std::vector<std::uint8_t> isUsed(65536, 0);
    for (const LabelMap::Label &other : map.labels) isUsed[other.value] = 1;
    for (std::size_t value = 1; value < isUsed.size() && label.value == 0; ++value)
      if (isUsed[value] == 0) label.value = static_cast<std::uint16_t>(value);
    if (label.value == 0) return fail(ErrorCode::usage, "the label map uses all 65535 values");
  }
  std::vector<std::uint8_t> occurs(65536, 0);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    std::uint16_t &voxel = map.voxels[v];
    if (mask.voxels[v] != 0)
      voxel = label.value;
    else if (voxel == label.value)
      voxel = 0;
    occurs[voxel] = 1;
  }
  std::erase_if(map.labels,
                [&](const LabelMap::Label &other) { return other.value == label.value || occurs[other.value] == 0; });
  if (occurs[label.value] != 0) map.labels.push_back(std::move(label));
  std::sort(map.labels.begin(), map.labels.end(),
            [](const LabelMap::Label &a, const LabelMap::Label &b) { return a.value < b.value; });
  return map;
}

}  // namespace c3de::imaging
