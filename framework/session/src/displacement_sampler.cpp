// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/displacement_sampler.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <new>
#include <utility>

#include "c3de/imaging/masks.h"
#include "c3de/session/body_sources.h"
#include "c3de/session/body_states.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

// Minimum time between two displacements during playback.
constexpr double kMinMilliseconds = 50.0;
constexpr double kTimes = 4.0;  // times the duration of one, from its start to the start of the next

// The bodies with the regions that a rule fixes around them; null: there are none, or memory is insufficient.
std::shared_ptr<const imaging::Mask> withFixedRegions(const std::shared_ptr<const imaging::Mask> &bodies,
                                                      const FixedRegions &still) try {
  if (!bodies || !still.image || still.rule.isEmpty()) return nullptr;
  auto places = std::make_shared<imaging::Mask>(*bodies);
  if (!imaging::markFixedRegions(still.rule, still.image->volume, still.labels ? &still.labels->map : nullptr, *places))
    return nullptr;
  return places;
} catch (const std::bad_alloc &) {
  return nullptr;
}

}  // namespace

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

void DisplacementSampler::begin() {
  ++serial_;
  const std::lock_guard lock(mutex_);
  newest_.reset();
  offered_.clear();
}

void DisplacementSampler::requestFields(const RequestedFields &fields) {
  const std::lock_guard lock(mutex_);
  fields_ = fields;
}

std::vector<PointField> DisplacementSampler::offered() const {
  const std::lock_guard lock(mutex_);
  return offered_;
}

void DisplacementSampler::want(bool wanted, double rim_mm, const imaging::VolumeGeometry &image,
                               const FixedRegions &still) {
  const std::lock_guard lock(mutex_);
  if (image.size != image_.size || image.indexToWorld != image_.indexToWorld) ++serial_;
  image_ = image;
  still_ = still;
  falloff_mm_ = rim_mm;
  wanted_ = wanted;
}

std::shared_ptr<const imaging::DisplacementGrid> DisplacementSampler::onPublished(const scene::Simulation &simulation) {
  if (!wanted_) return nullptr;
  const std::lock_guard asking(askingMutex_);
  const auto from = std::chrono::steady_clock::now();
  const std::chrono::duration<double, std::milli> since = from - last_;
  behind_ =
      simulation.state().mode == C3DE_SIM_PLAYING && since.count() < std::max(kMinMilliseconds, kTimes * milliseconds_);
  if (behind_) return nullptr;
  const double falloff = falloff_mm_;
  const std::uint64_t serial = serial_;
  imaging::VolumeGeometry image;
  FixedRegions still;
  RequestedFields fields;
  {
    const std::lock_guard lock(mutex_);
    image = image_;
    still = still_;
    fields = fields_;
  }
  const bool isNew = std::exchange(gridSerial_, serial) != serial;
  if (isNew) {
    grid_.forget();
    auto offered = pointFields(simulation.table(), simulation.object());
    const std::lock_guard lock(mutex_);
    if (serial == serial_) offered_ = std::move(offered);
  }
  if (isNew || still.tissues != marked_.tissues)
    reference_ = referenceBodies(simulation.object(), image, still.tissues.get());
  if (isNew || !(still == marked_)) {
    marked_ = still;
    const std::shared_ptr<const imaging::Mask> places = withFixedRegions(reference_, still);
    bodies_ = places ? places : reference_;
    hasStill_ = bodies_ && imaging::hasFixedVoxels(*bodies_);
  }
  const PresentBodies bodies = presentBodies(simulation.table(), simulation.object());
  grid_.follow(bodies.box, bodies.spacing_mm, falloff);
  auto grid = std::make_shared<imaging::DisplacementGrid>();
  grid->geometry = grid_.geometry();
  grid->bodies = bodies_;
  grid->hasFixedRegions = hasStill_;
  if (!readDisplacement(simulation.table(), simulation.object(), falloff, *grid)) return nullptr;
  addFields(simulation.table(), simulation.object(), fields, *grid);
  last_ = from;  // intervals count from the start of a query: at most a quarter of the time is used for them
  milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - from).count();
  const std::lock_guard lock(mutex_);
  if (serial == serial_) newest_ = grid;
  return grid;
}

std::shared_ptr<const imaging::DisplacementGrid> DisplacementSampler::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(newest_, nullptr);
}

}  // namespace c3de::session
