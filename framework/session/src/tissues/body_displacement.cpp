// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/body_displacement.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <new>

#include "c3de/scene/simulation.h"
#include "c3de/session/body_states.h"
#include "c3de/session/scene_to_abi.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {

PresentBodies presentBodies(const c3de_simulator_v1 *table, c3de_object *simulator) {
  PresentBodies bodies;
  bodies.spacing_mm = std::numeric_limits<double>::infinity();
  c3de_handle body{};
  for (std::uint64_t i = 0; table->body_at(simulator, i, &body) >= 0 && body.v != 0; ++i) {
    c3de_sim_body_info info{};
    info.size = sizeof info;
    if (table->body_info(simulator, body, &info) < 0) continue;
    bodies.spacing_mm = std::min(bodies.spacing_mm, info.spacing_m * scene::kMillimetresPerMetre);
    for (const Vec3 &x : surfacePositions(simulator, body)) bodies.box.add(scene::kMillimetresPerMetre * x);
  }
  return bodies;
}

bool readDisplacement(const c3de_simulator_v1 *table, c3de_object *simulator, double rim_mm,
                      imaging::DisplacementGrid &grid) {
  if (!supportsFills(table) || grid.geometry.voxelCount() == 0) return false;
  grid.xyz_mm.resize(3 * grid.geometry.voxelCount());
  grid.gap_mm.resize(grid.geometry.voxelCount());
  const c3de_sim_grid asked = toAbi(grid.geometry);
  if (table->displacement(simulator, &asked, rim_mm / scene::kMillimetresPerMetre, grid.xyz_mm.data(),
                          grid.gap_mm.data()) < 0)
    return false;
  for (float &u : grid.xyz_mm) u *= static_cast<float>(scene::kMillimetresPerMetre);
  for (float &gap : grid.gap_mm) gap *= static_cast<float>(scene::kMillimetresPerMetre);
  return true;
}

std::shared_ptr<imaging::Mask> referenceBodies(c3de_object *simulator, const imaging::VolumeGeometry &image,
                                               const std::vector<TissueVoxels> *tissues) try {
  const auto bodies = readBodyStates(simulator, BodyParts::skin, {});
  if (!bodies || image.voxelCount() == 0) return nullptr;
  const auto hasMap = [&](const std::string &name) {
    return tissues != nullptr && std::any_of(tissues->begin(), tissues->end(), [&](const TissueVoxels &places) {
             return places.map && places.body == name;
           });
  };
  auto all = std::make_shared<imaging::Mask>();
  for (const BodyState &body : *bodies) {
    if (body.skin.triangles.empty()) continue;
    if (hasMap(body.name)) {
      if (all->voxels.empty()) *all = {image, std::vector<std::uint8_t>(image.voxelCount(), 0)};
      continue;
    }
    geometry::TriangleMesh reference = body.skin;
    const std::vector<double> &moved = body.skinArrays.front().values;
    for (std::size_t v = 0; v < reference.vertices.size(); ++v)
      for (std::size_t a = 0; a < 3; ++a) reference.vertices[v][a] -= moved[3 * v + a];
    imaging::Mask one = imaging::maskOf(reference, image);
    if (all->voxels.empty())
      *all = std::move(one);
    else
      std::transform(one.voxels.begin(), one.voxels.end(), all->voxels.begin(), all->voxels.begin(), std::bit_or<>());
  }
  if (all->voxels.empty()) return nullptr;
  if (tissues != nullptr) markTissues(*tissues, *all);
  return all;
} catch (const std::bad_alloc &) {
  return nullptr;
}

}  // namespace c3de::session
