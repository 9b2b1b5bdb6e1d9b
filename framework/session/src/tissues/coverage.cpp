// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "c3de/imaging/mask_coverage.h"

namespace c3de::session {
namespace {

constexpr double kReportedFraction = 1e-3;  // of the requested volume

Coverage missingOf(const imaging::Mask &asked, imaging::Mask missing, std::size_t specks) {
  Coverage out;
  out.requested_mm3 = imaging::volumeOf(asked);
  out.missing_mm3 = imaging::volumeOf(missing);
  out.specks = specks;
  if (out.missing_mm3 > 0.0) out.missing = std::make_shared<const imaging::Mask>(std::move(missing));
  return out;
}

}  // namespace

Coverage coverageOf(const imaging::Mask &asked, const geometry::TriangleMesh &skin, std::size_t specks) {
  return missingOf(asked, imaging::notEnclosed(asked, skin), specks);
}

Coverage coverageOf(const imaging::Mask &asked, const imaging::Mask &filled, std::size_t specks) {
  imaging::Mask missing = asked;
  for (std::size_t v = 0; v < missing.voxels.size(); ++v)
    if (filled.voxels[v] != 0) missing.voxels[v] = 0;
  return missingOf(asked, std::move(missing), specks);
}

std::string sentenceOf(const Coverage &coverage) {
  if (!(coverage.missing_mm3 > kReportedFraction * coverage.requested_mm3)) return {};
  std::string text = fmt::format("{:.3g} ml ({:.2g} %) of the volume requested as '{}' belongs to no body",
                                 1e-3 * coverage.missing_mm3, 100.0 * (1.0 - coverage.part()), coverage.body);
  if (coverage.specks > 0)
    text += coverage.specks == 1 ? "; 1 loose island of a few voxels is omitted"
                                 : fmt::format("; {} loose islands of a few voxels are omitted", coverage.specks);
  return text + "; shorter edges of the skin (edge_length) keep thin parts";
}

imaging::Mask missingOn(const imaging::VolumeGeometry &grid, const std::vector<Coverage> &bodies) {
  imaging::Mask all;
  for (const Coverage &body : bodies) {
    if (!body.missing) continue;
    imaging::LabelMap one{body.missing->geometry,
                          std::vector<std::uint16_t>(body.missing->voxels.begin(), body.missing->voxels.end()),
                          {}};
    if (one.geometry.size != grid.size || one.geometry.indexToWorld != grid.indexToWorld) {
      auto placed = imaging::resampled(one, grid);
      if (!placed) continue;
      one = std::move(*placed);
    }
    if (all.voxels.empty()) all = {grid, std::vector<std::uint8_t>(grid.voxelCount(), 0)};
    for (std::size_t v = 0; v < one.voxels.size(); ++v) all.voxels[v] |= static_cast<std::uint8_t>(one.voxels[v] != 0);
  }
  if (std::none_of(all.voxels.begin(), all.voxels.end(), [](std::uint8_t v) { return v != 0; })) all = {};
  return all;
}

}  // namespace c3de::session
