// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/still.h"

#include <algorithm>
#include <cmath>

#include "c3de/imaging/displacement.h"

namespace c3de::imaging {
namespace {

void markValues(const StillRule &rule, const Volume &image, Mask &places) {
  std::visit(
      [&](const auto &voxels) {
        for (std::size_t v = 0; v < voxels.size(); ++v) {
          const double value = image.slope * static_cast<double>(voxels[v]) + image.intercept;
          const bool stays = (rule.above && value > *rule.above) || (rule.below && value < *rule.below);
          if (stays && places.voxels[v] == 0) places.voxels[v] = kStillVoxel;
        }
      },
      image.voxels);
}

/// Voxels whose centres lie in one of the labels. @param mark  given what a voxel is already
template <class Mark>
void markLabels(const LabelMap &labels, const Mat4 &worldFromLabel, std::span<const std::uint16_t> wanted, Mask &places,
                const Mark &mark) {
  std::vector<std::uint8_t> isWanted(65536, 0);
  for (const std::uint16_t label : wanted) isWanted[label] = 1;
  isWanted[0] = 0;
  const Mat4 labelFromVoxel = multiply(affineInverse(worldFromLabel), places.geometry.indexToWorld);
  const auto &n = places.geometry.size, &size = labels.geometry.size;
  std::size_t v = 0;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i, ++v) {
        const Vec3 index =
            transformPoint(labelFromVoxel, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        std::size_t at = 0, stride = 1;
        bool isInside = true;
        for (std::size_t a = 0; a < 3; ++a) {
          const double nearest = std::floor(index[a] + 0.5);
          isInside = isInside && nearest >= 0.0 && nearest < static_cast<double>(size[a]);
          if (!isInside) break;
          at += stride * static_cast<std::size_t>(nearest);
          stride *= size[a];
        }
        if (isInside && isWanted[labels.voxels[at]] != 0) mark(places.voxels[v]);
      }
}

}  // namespace

Expected<void> markStill(const StillRule &rule, const Volume &image, const LabelMap *labels, Mask &places) {
  if (places.geometry.size != image.geometry.size || places.voxels.size() != image.geometry.voxelCount())
    return fail(ErrorCode::usage, "what stays is told on another grid than that of the image");
  if (rule.outside) {
    std::replace(places.voxels.begin(), places.voxels.end(), std::uint8_t{0}, kStillVoxel);
    return {};
  }
  if (rule.above || rule.below) markValues(rule, image, places);
  if (labels != nullptr && !rule.labels.empty())
    markLabels(*labels, labels->geometry.indexToWorld, rule.labels, places,
               [](std::uint8_t &place) { place = place == 0 ? kStillVoxel : place; });
  return {};
}

bool markRigid(const LabelMap &tissues, const Mat4 &placement, std::span<const std::uint16_t> rigid, Mask &places) {
  bool isAny = false;
  markLabels(tissues, multiply(placement, tissues.geometry.indexToWorld), rigid, places, [&](std::uint8_t &place) {
    place = kRigidVoxel;
    isAny = true;
  });
  return isAny;
}

}  // namespace c3de::imaging
