// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/tissue_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "base/placement_matrix.h"
#include "c3de/imaging/mask_coverage.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/surface.h"
#include "c3de/render/renderer.h"
#include "tissues/material_follower.h"

namespace c3de::session {
namespace {

constexpr double kBlocks = 40.0, kBlocksOfBody = 64.0;  // along a cube of the volume of a tissue, of its body
constexpr double kEdges = 1.5;                          // blocks
constexpr std::array<float, 3> kIvory{0.89f, 0.84f, 0.74f};

/// The surface of the voxels of a tissue. Errors: cancelled; no voxel remains.
/// @param least_mm  voxels are merged to blocks of at least this edge length
Expected<geometry::TriangleMesh> surfaceOf(const imaging::Mask &mask, double least_mm, const ProgressFn &progress) {
  const double block = std::max(least_mm, std::cbrt(imaging::volumeOf(mask)) / kBlocks);
  const auto fill = imaging::fillOf(mask, block);
  if (!fill) return tl::unexpected(fill.error());
  imaging::Mask coarse{fill->geometry, std::vector<std::uint8_t>(fill->values.size())};
  std::transform(fill->values.begin(), fill->values.end(), coarse.voxels.begin(),
                 [](float part) { return static_cast<std::uint8_t>(part >= 0.5f ? 1 : 0); });
  auto cleaned = imaging::removeSpecks(coarse, progress);
  if (!cleaned) return tl::unexpected(cleaned.error());
  const auto whole = imaging::fillHoles(cleaned->mask, progress);
  if (!whole) return tl::unexpected(whole.error());
  imaging::SurfaceSettings settings;
  const Vec3 steps = coarse.geometry.spacing();
  settings.edgeLength = kEdges * std::max({steps[0], steps[1], steps[2]});
  return imaging::surfaceOf(*whole, settings, progress);
}

std::array<float, 3> colourOf(const TissueVoxels &body, std::size_t tissue) {
  if (const std::optional<Vec3> &colour = body.tissues[tissue].colour)
    return {static_cast<float>((*colour)[0]), static_cast<float>((*colour)[1]), static_cast<float>((*colour)[2])};
  if (body.tissues[tissue].isRigid) return kIvory;
  const LabelVoxels *largest = nullptr;
  for (const LabelVoxels &label : body.labels)
    if (label.tissue == tissue && (largest == nullptr || label.voxels > largest->voxels)) largest = &label;
  const render::Colour shown = render::displayColour(largest != nullptr ? largest->colour : std::array<float, 3>{});
  return {shown[0], shown[1], shown[2]};
}

}  // namespace

Expected<std::vector<TissueSurface>> tissueSurfaces(const std::vector<TissueVoxels> &bodies,
                                                    const ProgressFn &progress) {
  std::vector<TissueSurface> out;
  double all = 0.0, done = 0.0;
  for (const TissueVoxels &body : bodies) all += static_cast<double>(body.tissues.size());
  for (const TissueVoxels &body : bodies) {
    if (!body.map) continue;
    const Mat4 placed = matrixOf(body.placement);
    double voxels = 0.0;
    for (const LabelVoxels &label : body.labels) voxels += static_cast<double>(label.voxels);
    const double least = std::cbrt(voxels * body.voxel_mm3) / kBlocksOfBody;
    for (std::size_t i = 0; i < body.tissues.size(); ++i, ++done) {
      const scene::SceneTissue &tissue = body.tissues[i];
      const ProgressFn part = [&](double, const std::string &) {
        return !progress || progress(done / all, "surface of " + tissue.label);
      };
      if (!part(0.0, {})) return fail(ErrorCode::cancelled, "cancelled");
      if (tissue.isEmpty || !tissue.isShown) continue;
      const imaging::Mask mask = imaging::maskOf(*body.map, static_cast<std::uint16_t>(i + 1));
      if (imaging::voxelCount(mask) == 0) continue;
      auto surface = surfaceOf(mask, least, part);
      if (!surface && surface.error().code == ErrorCode::cancelled) return tl::unexpected(surface.error());
      if (!surface || surface->triangles.empty()) continue;
      for (Vec3 &vertex : surface->vertices) vertex = transformPoint(placed, vertex);
      out.push_back({body.body, tissue.label, colourOf(body, i), tissue.isRigid, std::move(*surface)});
    }
  }
  return out;
}

Expected<SurfacePositions> followSurfaces(const TissueSnapshot &snapshot,
                                          std::shared_ptr<const std::vector<TissueSurface>> surfaces,
                                          const SurfacePositions *before, const std::function<bool()> &goesOn) {
  const imaging::DisplacementGrid &u = *snapshot.u;
  std::map<std::string, imaging::WorldBox> boxes;
  for (const TissueSurface &surface : *surfaces)
    for (const Vec3 &X : surface.reference.vertices) boxes[surface.body].add(X);
  std::map<std::string, MaterialFollower> followers;
  for (const auto &[body, box] : boxes)
    followers.try_emplace(
        body, u, box,
        snapshot.skins.size() > 1 ? ownPoints(snapshot.skins, body, u.geometry) : std::vector<std::uint8_t>{});
  SurfacePositions out{surfaces, {}};
  for (std::size_t s = 0; s < surfaces->size(); ++s) {
    if (goesOn && !goesOn()) return fail(ErrorCode::cancelled, "following the surfaces was ended");
    const TissueSurface &surface = (*surfaces)[s];
    std::vector<std::array<float, 3>> &now = out.vertices.emplace_back();
    if (surface.isRigid) continue;
    const MaterialFollower &follower = followers.at(surface.body);
    now.reserve(surface.reference.vertices.size());
    for (std::size_t v = 0; v < surface.reference.vertices.size(); ++v) {
      const Vec3 &X = surface.reference.vertices[v];
      Vec3 estimate{};
      if (before != nullptr)
        for (std::size_t a = 0; a < 3; ++a) estimate[a] = static_cast<double>(before->vertices[s][v][a]) - X[a];
      const Vec3 x = X + follower.findNear(X, estimate).value_or(estimate);
      now.push_back({static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])});
    }
  }
  return out;
}

}  // namespace c3de::session
