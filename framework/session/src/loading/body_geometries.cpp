// SPDX-License-Identifier: Apache-2.0
#include "loading/body_geometries.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/scene/simulation.h"
#include "loading/fitted_skins.h"

namespace c3de::session {
namespace {

constexpr double kFitReach = 1.5;  // voxels: skins are within about half a voxel of the border, corners within an edge

/// The point count of the scene, or the count for its spacing.
double pointsOf(const std::vector<ParameterValue> &values, const imaging::Mask &mask) {
  double points = 1000.0;
  for (const ParameterValue &value : values) {
    if (value.id == C3DE_PARAM_ID_COUNT && value.num > 0.0) points = value.num;
    if (value.id == C3DE_PARAM_ID_SPACING && value.num > 0.0)
      points = imaging::volumeOf(mask) / std::pow(value.num * scene::kMillimetresPerMetre, 3);
  }
  return points;
}

/// Progress of items built before the first body.
ProgressFn namedAfter(const scene::SceneBody &body, const ProgressFn &progress) {
  return [&](double, const std::string &what) { return !progress || progress(0.0, body.name + ": " + what); };
}

}  // namespace

Expected<void> BodyGeometries::prepare(const ProgressFn &progress) {
  const std::vector<scene::SceneBody> &bodies = scene_.scene.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].mesh.empty()) continue;
    auto read = ofMesh(bodies[i], namedAfter(bodies[i], progress));
    if (!read) return failInScene(read.error(), scene_.scene, bodies[i].line);
    ready_[i] = std::move(*read);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].volume.cut && bodies[i].volume.piece == 0)
      if (auto pieces = preparePieces(i, progress); !pieces) return pieces;
  return {};
}

Expected<BodyGeometry> BodyGeometries::build(std::size_t body, const ProgressFn &progress) {
  if (ready_[body]) return std::move(*ready_[body]);
  auto made = ofVolume(body, progress);
  if (!made) return failInScene(made.error(), scene_.scene, scene_.scene.bodies[body].line);
  return made;
}

Expected<BodyGeometry> BodyGeometries::ofMesh(const scene::SceneBody &body, const ProgressFn &progress) const {
  BodyGeometry loaded;
  {
    const ScopedTimer reading(loaded.took.reading_s);
    const auto unit = formats_.unitOf(body.mesh, body.meshUnit);
    if (!unit) return tl::unexpected(unit.error());
    auto mesh = formats_.load(body.mesh, *unit, progress);
    if (!mesh) return tl::unexpected(mesh.error());
    loaded.skin = std::move(*mesh);
  }
  if (const auto fillable = geometry::checkFillable(loaded.skin.mesh, loaded.skin.report); !fillable)
    return tl::unexpected(fillable.error());
  return loaded;
}

Expected<BodyGeometry> BodyGeometries::ofVolume(std::size_t index, const ProgressFn &progress) {
  const scene::SceneBody &body = scene_.scene.bodies[index];
  Preparation took;
  const auto picked = sources_.pick(body.volume, progress, took);
  if (!picked) return tl::unexpected(picked.error());
  const double points = pointsOf(scene_.bodies[index].values, picked->mask);
  auto made = bodyGeometryOf(picked->mask, body.volume.edgeLength_mm, points, picked->tissues != nullptr, progress);
  if (!made) return made;
  if (picked->tissues) {
    if (const auto added = addTissues(body.volume, *picked->tissues, points, *made); !added)
      return tl::unexpected(added.error());
    auto tissues = sources_.placesOf(body, *picked);
    if (!tissues) return tl::unexpected(tissues.error());
    made->tissueVoxels = std::make_shared<TissueVoxels>(std::move(*tissues));
    made->thickness_mm = thicknessOf(*picked->tissues, body.volume.tissues.size());
  }
  made->took += took;
  made->colour = picked->colour;
  return made;
}

Expected<void> BodyGeometries::preparePieces(std::size_t first, const ProgressFn &progress) {
  const std::vector<scene::SceneBody> &bodies = scene_.scene.bodies;
  const auto &cut = bodies[first].volume.cut;
  std::vector<geometry::TriangleMesh *> skins;
  for (std::size_t p = first; p < bodies.size() && bodies[p].volume.cut == cut; ++p) {
    auto piece = ofVolume(p, namedAfter(bodies[p], progress));
    if (!piece) return failInScene(piece.error(), scene_.scene, bodies[p].line);
    ready_[p] = std::move(*piece);
    skins.push_back(&ready_[p]->skin.mesh);
  }
  const Vec3 edges = cut->tissues.geometry.spacing();
  if (auto good = fitSkins(skins, kFitReach * std::max({edges[0], edges[1], edges[2]})); !good)
    return failInScene(good.error(), scene_.scene, bodies[first].line);
  return {};
}

}  // namespace c3de::session
