// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/displacement_sampler.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "c3de/imaging/masks.h"
#include "c3de/session/body_displacement.h"

namespace c3de::session {
namespace {

// Minimum time between two displacements during playback.
constexpr double kMinMilliseconds = 50.0;
constexpr double kTimes = 4.0;  // times the duration of one, from its start to the start of the next

// The bodies with the regions that a rule fixes around them; null: there are none, or memory is insufficient.
std::shared_ptr<const imaging::Mask> withFixedRegions(const std::shared_ptr<const imaging::Mask> &bodies,
                                                      const FixedRegions &fixedRegions) try {
  if (!bodies || !fixedRegions.image || fixedRegions.rule.isEmpty()) return nullptr;
  auto mask = std::make_shared<imaging::Mask>(*bodies);
  if (!imaging::markFixedRegions(fixedRegions.rule, fixedRegions.image->volume,
                                 fixedRegions.labels ? &fixedRegions.labels->map : nullptr, *mask))
    return nullptr;
  return mask;
} catch (const std::bad_alloc &) {
  return nullptr;
}

}  // namespace

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
                               const FixedRegions &fixedRegions) {
  const std::lock_guard lock(mutex_);
  if (image.size != image_.size || image.indexToWorld != image_.indexToWorld) ++serial_;
  image_ = image;
  fixedRegions_ = fixedRegions;
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
  FixedRegions fixedRegions;
  RequestedFields fields;
  {
    const std::lock_guard lock(mutex_);
    image = image_;
    fixedRegions = fixedRegions_;
    fields = fields_;
  }
  const bool isNew = std::exchange(gridSerial_, serial) != serial;
  if (isNew) {
    grid_.forget();
    auto offered = pointFields(simulation.table(), simulation.object());
    const std::lock_guard lock(mutex_);
    if (serial == serial_) offered_ = std::move(offered);
  }
  if (isNew || fixedRegions.tissues != marked_.tissues)
    reference_ = referenceBodies(simulation.object(), image, fixedRegions.tissues.get());
  if (isNew || !(fixedRegions == marked_)) {
    marked_ = fixedRegions;
    const std::shared_ptr<const imaging::Mask> mask = withFixedRegions(reference_, fixedRegions);
    bodies_ = mask ? mask : reference_;
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
