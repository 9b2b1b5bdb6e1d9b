// SPDX-License-Identifier: Apache-2.0
#include "simulator/external_forces.h"

#include <algorithm>
#include <utility>

#include "c3de/sdk/structs.hpp"

namespace pointbased {

using sdk::Error;

namespace {

/// Of the sum of the forces' magnitudes. A repetition reduces the difference by the strain of the loaded surface, so
/// the forces of the last solution are more accurate than this.
constexpr double kFollowerTolerance = 1e-4;
/// Pressures that stretch the surface without a bound never agree; a warning reports it.
constexpr int kMostRepetitions = 20;

}  // namespace

void ExternalForces::points(c3de_handle handle, c3de_sim_points *out) {
  const StateLock lock(world_);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  const Body &body = *simulator_.body(handle.v);
  c3de_sim_points points{};
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  if (n > 0 && !body.isStatic() && !body.stopped) {
    SharedPoints &lent = sharedPoints_[handle.v];
    lent.name = record.name;
    lent.positions.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      lent.positions[i] = rest.origin + rest.positions[i] + body.state().displacements[i];
    // Copied as well: the caller may keep the pointer, or write to it.
    lent.velocities = body.state().velocities;
    lent.forces.assign(n, Vec3::Zero());
    lent.isRequested = true;
    if (lent.masses.size() != n || lent.rest != body.sharedRest()) {
      lent.rest = body.sharedRest();
      lent.masses.resize(n);
      for (std::size_t i = 0; i < n; ++i) lent.masses[i] = body.inverseMasses()[i] > 0.0 ? body.restMasses()[i] : 0.0;
    }
    points.name = sdk::str(lent.name);
    points.count = n;
    points.positions_m = lent.positions.front().data();
    points.velocities_m_s = lent.velocities.front().data();
    points.masses_kg = lent.masses.data();
    points.forces_N = lent.forces.front().data();
  }
  sdk::writeStruct(out, points, "out");
}

void ExternalForces::bind(RuntimeLoad &live) const {
  const Body &body = *simulator_.body(live.body);
  const BodyRecord &record = *table_.body(live.body);
  const PlacedMesh &mesh = *record.surface;
  auto part = loadOn(live.load, body.rest(), {mesh.positions, mesh.triangles});
  if (!part) throw Error(C3DE_E_ARG, "a load on body '" + record.name + "': " + part.error());
  live.part = std::move(*part);
  live.rest = body.sharedRest();
}

std::uint64_t ExternalForces::addLoad(ChangeAccess, std::uint64_t body, const Load &load, std::uint64_t &number) {
  const BodyRecord &record = table_.bodyOrThrow(body);
  if (simulator_.body(body)->isStatic())
    throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid and fixed, so a load cannot move it");
  RuntimeLoad live{body, load, {}, nullptr, simulator_.time(), number == 0 ? lastNumber_ + 1 : number};
  bind(live);
  number = live.number;
  lastNumber_ = std::max(lastNumber_, number);
  const std::uint64_t id = world_.allocateIds(1);
  loads_.emplace(id, std::move(live));
  return id;
}

std::uint64_t ExternalForces::numberOf(std::uint64_t id) const {
  const auto found = loads_.find(id);
  return found == loads_.end() ? 0 : found->second.number;
}

std::uint64_t ExternalForces::loadNumbered(std::uint64_t number) const {
  for (const auto &[id, load] : loads_)
    if (load.number == number) return id;
  return 0;
}

void ExternalForces::apply(const SurfaceConditions &conditions) {
  for (const auto &[id, record] : table_.bodies()) {
    const auto found = sharedPoints_.find(id);
    const Body &body = *simulator_.body(id);
    const std::size_t n = body.rest().phyxelCount();
    const bool isRequested = found != sharedPoints_.end() && std::exchange(found->second.isRequested, false);
    std::vector<Vec3> forces;
    if (isRequested && found->second.forces.size() == n) forces.swap(found->second.forces);
    for (auto &[number, live] : loads_)
      if (live.body == id && !body.isStatic() && live.rest != body.sharedRest()) bind(live);
    addLoads(id, conditions, forces);
    if (!forces.empty())
      simulator_.stepper().swapExternalForces(id, forces);
    else if (!body.externalForces().empty())
      simulator_.stepper().setExternalForces(id, {});
    if (isRequested) found->second.forces.swap(forces);
  }
  std::erase_if(sharedPoints_, [this](const auto &entry) { return !table_.hasBody(entry.first); });
}

void ExternalForces::addLoads(std::uint64_t id, const SurfaceConditions &conditions, std::vector<Vec3> &forces) const {
  const Body &body = *simulator_.body(id);
  if (body.isStatic()) return;
  const std::size_t n = body.rest().phyxelCount();
  const bool isReset = matchedResets_ != world_.resets;
  // A renewed reference has the same phyxels; a body that was filled again has others.
  if (const auto matched = matched_.find(id); !isReset && matched != matched_.end() && matched->second.size() == n) {
    forces.resize(n, Vec3::Zero());
    for (std::size_t i = 0; i < n; ++i) forces[i] += matched->second[i];
  }
  for (const auto &[number, live] : loads_) {
    if (live.body != id) continue;
    forces.resize(n, Vec3::Zero());
    const double since_s = simulator_.time() - live.startTime_s;
    const double s = live.load.ramp > 0.0 && !simulator_.quasiStatic() ? std::min(1.0, since_s / live.load.ramp) : 1.0;
    addLoadForces(live.load, live.part, s, body.state().displacements, forces);
  }
  conditions.addForces(id, forces);
}

void ExternalForces::continueToEquilibrium(const SurfaceConditions &conditions) {
  if (!simulator_.quasiStatic() || !simulator_.finished()) return;
  double difference = 0.0, sum = 0.0;
  for (const auto &[id, record] : table_.bodies()) {
    const std::span<const Vec3> before = simulator_.body(id)->externalForces();
    // Forces of a plugin are dead until it sets them again.
    if (before.empty() || sharedPoints_.contains(id)) continue;
    std::vector<Vec3> now;
    addLoads(id, conditions, now);
    for (std::size_t i = 0; i < std::min(now.size(), before.size()); ++i) {
      difference += (now[i] - before[i]).norm();
      sum += now[i].norm();
    }
  }
  const bool differs = difference > kFollowerTolerance * sum;
  if (!differs || repetitions_ >= kMostRepetitions) {
    if (differs)
      world_.context.services.log.warn(
          "the pressures that follow the surface changed by " + shortNumber(100.0 * difference / sum) +
          " % in the last solution: it is no equilibrium with them; a smaller pressure helps");
    repetitions_ = 0;
    return;
  }
  ++repetitions_;
  simulator_.stepper().repeatLastIncrement();
}

std::vector<SavedLoad> ExternalForces::saved() const {
  std::vector<SavedLoad> all;
  for (const auto &[id, live] : loads_)
    if (const BodyRecord *body = table_.body(live.body))
      all.push_back({live.number, body->identity(), live.load, live.startTime_s});
  return all;
}

std::vector<ExternalForces::RuntimeLoad> ExternalForces::prepare(const std::vector<SavedLoad> &saved) const {
  std::vector<RuntimeLoad> all;
  for (const SavedLoad &one : saved) {
    all.push_back({table_.bodyNamed(one.body), one.load, {}, nullptr, one.startTime_s, one.number});
    bind(all.back());
  }
  return all;
}

void ExternalForces::setMatched(ChangeAccess, std::uint64_t body, std::vector<Vec3> forces) {
  if (std::exchange(matchedResets_, world_.resets) != world_.resets) matched_.clear();
  matched_[body] = std::move(forces);
}

std::vector<SavedMatch> ExternalForces::savedMatches() const {
  std::vector<SavedMatch> all;
  if (matchedResets_ != world_.resets) return all;
  for (const auto &[id, forces] : matched_)
    if (const BodyRecord *body = table_.body(id)) all.push_back({body->identity(), forces});
  return all;
}

void ExternalForces::restore(std::vector<RuntimeLoad> loads, const std::vector<SavedMatch> &matches) {
  matched_.clear();
  matchedResets_ = world_.resets;
  for (const SavedMatch &one : matches) matched_[table_.bodyNamed(one.body)] = one.forces;
  std::map<std::uint64_t, std::uint64_t> ids;  // by number: a plugin keeps the handle of its load
  for (const auto &[id, load] : loads_) ids.emplace(load.number, id);
  loads_.clear();
  for (RuntimeLoad &live : loads) {
    lastNumber_ = std::max(lastNumber_, live.number);
    const auto known = ids.find(live.number);
    const std::uint64_t id = known != ids.end() ? known->second : world_.allocateIds(1);
    loads_.emplace(id, std::move(live));
  }
}

void ExternalForces::invalidateMasses(std::uint64_t body) {
  if (const auto lent = sharedPoints_.find(body); lent != sharedPoints_.end()) lent->second.masses.clear();
}

void ExternalForces::removeLoadsOf(ChangeAccess, std::uint64_t body) {
  std::erase_if(loads_, [&](const auto &entry) { return entry.second.body == body; });
  matched_.erase(body);
}

}  // namespace pointbased
