// SPDX-License-Identifier: Apache-2.0
#include "loading/body_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "c3de/imaging/mask_coverage.h"
#include "c3de/imaging/surface.h"

namespace c3de::session {
namespace {

constexpr double kVoxelsPerSpacing = 16.0;

// Edge of the blocks of voxels that suffice for this number of points, mm.
double coarsestOf(double volume_mm3, double points) {
  return std::cbrt(volume_mm3 / std::max(points, 1.0)) / kVoxelsPerSpacing;
}

}  // namespace

Expected<BodyGeometry> bodyGeometryOf(const imaging::Mask &asked, double edge_mm, double points, bool isOfTissues,
                                      const ProgressFn &progress) {
  BodyGeometry built;
  auto cleaned = [&] {
    const ScopedTimer masking(built.took.masks_s);
    return imaging::removeSpecks(asked, progress);
  }();
  if (!cleaned) return tl::unexpected(cleaned.error());
  const imaging::Mask &mask = cleaned->mask;
  built.volume_mm3 = imaging::volumeOf(mask);
  imaging::SurfaceSettings settings;
  settings.edgeLength = edge_mm;
  {
    const ScopedTimer surfacing(built.took.surfaces_s);
    auto surface = imaging::surfaceOf(mask, settings, progress);
    if (!surface) return tl::unexpected(surface.error());
    auto skin = geometry::buildMesh(std::move(*surface), geometry::LengthUnit::millimetre);
    if (!skin) return tl::unexpected(skin.error());
    built.skin = std::move(*skin);
    // Tissues occupy their voxels, whatever the skin leaves out.
    built.coverage =
        isOfTissues ? coverageOf(asked, mask, cleaned->specks) : coverageOf(asked, built.skin.mesh, cleaned->specks);
  }
  {
    const ScopedTimer filling(built.took.fills_s);
    auto fill = imaging::fillOf(mask, coarsestOf(built.volume_mm3, points));
    if (!fill) return tl::unexpected(fill.error());
    built.fill = std::move(*fill);
  }
  return built;
}

Expected<void> addTissues(const scene::SceneVolume &volume, const imaging::LabelMap &tissues, double points,
                          BodyGeometry &geometry) {
  const ScopedTimer filling(geometry.took.fills_s);
  const double coarsest = coarsestOf(geometry.volume_mm3, points);
  std::vector<std::uint16_t> rigid;
  for (std::size_t i = 0; i < volume.tissues.size(); ++i) {
    const auto number = static_cast<std::uint16_t>(i + 1);
    if (volume.tissues[i].isEmpty) continue;
    if (volume.tissues[i].isRigid) {
      rigid.push_back(number);
      continue;
    }
    auto fill = imaging::fillOf(imaging::maskOf(tissues, number), coarsest);
    if (!fill && !volume.usesKnownTissues && !volume.cut && !volume.region)
      return fail(fill.error().code, "tissue '" + volume.tissues[i].label +
                                         "' has no voxel of its own: labels of other tissues lie over all of it, or "
                                         "'mend' has taken it away (largest: it lies apart from the largest piece)");
    geometry.tissues.push_back(fill ? std::make_shared<const imaging::Fill>(std::move(*fill)) : nullptr);
  }
  const imaging::Mask mask = imaging::maskOf(tissues, rigid);
  if (imaging::voxelCount(mask) == 0) return {};
  auto fill = imaging::fillOf(mask, coarsest);
  if (!fill) return tl::unexpected(fill.error());
  geometry.rigid = std::make_shared<const imaging::Fill>(std::move(*fill));
  return {};
}

}  // namespace c3de::session
