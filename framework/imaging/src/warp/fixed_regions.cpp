// SPDX-License-Identifier: Apache-2.0
#include "c3de/imaging/fixed_regions.h"

#include <algorithm>
#include <cmath>

#include "c3de/imaging/displacement.h"

namespace c3de::imaging {
namespace {

void markValues(const FixedRegionRule &rule, const Volume &image, Mask &places) {
  std::visit(
      [&](const auto &voxels) {
        for (std::size_t v = 0; v < voxels.size(); ++v) {
          const double value = image.slope * static_cast<double>(voxels[v]) + image.intercept;
          const bool stays = (rule.above && value > *rule.above) || (rule.below && value < *rule.below);
          if (stays && places.voxels[v] == 0) places.voxels[v] = kFixedVoxel;
        }
      },
      image.voxels);
}

/// Marks every voxel whose centre is in a label. @param mark  called with the label and the present value of the voxel
template <class Mark>
void markLabels(const LabelMap &labels, const Mat4 &worldFromLabel, Mask &places, const Mark &mark) {
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
        if (isInside && labels.voxels[at] != 0) mark(labels.voxels[at], places.voxels[v]);
      }
}

std::vector<std::uint8_t> among(std::span<const std::uint16_t> labels) {
  std::vector<std::uint8_t> all(65536, 0);
  for (const std::uint16_t label : labels) all[label] = 1;
  return all;
}

}  // namespace

Expected<void> markFixedRegions(const FixedRegionRule &rule, const Volume &image, const LabelMap *labels,
                                Mask &places) {
  if (places.geometry.size != image.geometry.size || places.voxels.size() != image.geometry.voxelCount())
    return fail(ErrorCode::usage, "the mask of fixed regions is on a different grid from the image");
  if (rule.outside) {
    std::replace(places.voxels.begin(), places.voxels.end(), std::uint8_t{0}, kFixedVoxel);
    return {};
  }
  if (rule.above || rule.below) markValues(rule, image, places);
  if (labels == nullptr || rule.labels.empty()) return {};
  const std::vector<std::uint8_t> stays = among(rule.labels);
  markLabels(*labels, labels->geometry.indexToWorld, places, [&](std::uint16_t label, std::uint8_t &place) {
    if (place == 0 && stays[label] != 0) place = kFixedVoxel;
  });
  return {};
}

void markTissues(const LabelMap &tissues, const Mat4 &placement, std::span<const std::uint16_t> rigid, Mask &places) {
  const std::vector<std::uint8_t> isRigid = among(rigid);
  markLabels(
      tissues, multiply(placement, tissues.geometry.indexToWorld), places,
      [&](std::uint16_t tissue, std::uint8_t &place) { place = isRigid[tissue] != 0 ? kRigidVoxel : kBodyVoxel; });
}

bool hasFixedVoxels(const Mask &places) {
  return std::any_of(places.voxels.begin(), places.voxels.end(),
                     [](std::uint8_t place) { return place == kFixedVoxel || place == kRigidVoxel; });
}

}  // namespace c3de::imaging
