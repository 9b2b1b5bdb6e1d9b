// SPDX-License-Identifier: Apache-2.0
// Actions on bodies while they are simulated: forces and loads of other plugins, and grabs that hold them.
#include <algorithm>
#include <cmath>

#include "c3de/sdk/structs.hpp"
#include "instruments/grab_patch.h"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

void WorldSimulator::points(c3de_handle handle, c3de_sim_points *out) {
  const std::lock_guard lock(mutex_);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  const Body &body = *simulator_.body(handle.v);
  c3de_sim_points points{};
  const RestState &rest = body.rest();
  const std::size_t n = rest.phyxelCount();
  if (n > 0 && !body.isStatic() && !body.stopped) {
    SharedPoints &lent = lent_[handle.v];
    lent.name = record.name;
    lent.positions.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      lent.positions[i] = rest.origin + rest.positions[i] + body.state().displacements[i];
    // Copied as well: the caller may keep the pointer, or write to it.
    lent.velocities = body.state().velocities;
    lent.forces.assign(n, Vec3::Zero());
    lent.asked = true;
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

void WorldSimulator::bind(RuntimeLoad &live) const {
  const Body &body = *simulator_.body(live.body);
  const BodyRecord &record = *table_.body(live.body);
  const PlacedMesh &mesh = *record.surface;
  auto part = loadOn(live.load, body.rest(), {mesh.positions, mesh.triangles});
  if (!part) throw Error(C3DE_E_ARG, "a load on body '" + record.name + "': " + part.error());
  live.part = std::move(*part);
  live.rest = body.sharedRest();
}

void WorldSimulator::addLoad(c3de_handle handle, const c3de_sim_load *load, c3de_handle *out) {
  const std::lock_guard lock(mutex_);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  if (simulator_.body(handle.v)->isStatic())
    throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid and stands; a load does not move it");
  RuntimeLoad live{handle.v, readLoad(load), {}, nullptr, simulator_.time()};
  bind(live);
  const std::uint64_t id = nextRuntimeId_++;
  liveLoads_.emplace(id, std::move(live));
  if (out) *out = {id};
}

// Forces requested since the last step, and live loads; other bodies have none.
void WorldSimulator::applyExternalForces() {
  for (const auto &[id, record] : table_.bodies()) {
    const auto found = lent_.find(id);
    const Body &body = *simulator_.body(id);
    const std::size_t n = body.rest().phyxelCount();
    const bool asked = found != lent_.end() && std::exchange(found->second.asked, false);
    std::vector<Vec3> forces;
    if (asked && found->second.forces.size() == n) forces.swap(found->second.forces);
    for (auto &[number, live] : liveLoads_) {
      if (live.body != id || body.isStatic()) continue;
      if (live.rest != body.sharedRest()) bind(live);
      forces.resize(n, Vec3::Zero());
      const double since_s = simulator_.time() - live.began_s;
      const double s =
          live.load.ramp > 0.0 && !simulator_.quasiStatic() ? std::min(1.0, since_s / live.load.ramp) : 1.0;
      addLoadForces(live.load, live.part, s, body.state().displacements, forces);
    }
    if (!forces.empty())
      simulator_.stepper().swapExternalForces(id, forces);
    else if (!body.externalForces().empty())
      simulator_.stepper().setExternalForces(id, {});
    if (asked) found->second.forces.swap(forces);
  }
  std::erase_if(lent_, [this](const auto &entry) { return !table_.hasBody(entry.first); });
}

void WorldSimulator::hold(c3de_handle handle, const c3de_sim_hold *hold, c3de_handle *out) {
  const auto in = sdk::readStruct(hold, "hold");
  const std::lock_guard lock(mutex_);
  const BodyRecord &record = table_.bodyOrThrow(handle.v);
  const Body &body = *simulator_.body(handle.v);
  const Vec3 at(in.at_m[0], in.at_m[1], in.at_m[2]);
  const auto amount = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!at.allFinite() || !(in.radius_m > 0.0) || !std::isfinite(in.radius_m))
    throw Error(C3DE_E_ARG, "hold: accepted: a finite point and a radius above 0 m");
  if (!amount(in.frequency_hz) || !amount(in.damping_ratio) || !amount(in.max_force_N))
    throw Error(C3DE_E_ARG,
                "hold: accepted: a frequency, a damping ratio and a force that are finite and not negative");
  if (in.flags & ~C3DE_SIM_HOLD_SHAPE) throw Error(C3DE_E_UNSUPPORTED, "hold: unknown flags");
  if (body.isStatic()) throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid and stands; nobody pulls it");
  std::vector<Vec3> positions, normals;
  simulator_.world().surfels(handle.v, positions, normals);
  if (positions.empty()) throw Error(C3DE_E_STATE, "body '" + record.name + "' has no surface to hold");
  const auto nearest = std::min_element(positions.begin(), positions.end(), [&](const Vec3 &a, const Vec3 &b) {
    return (a - at).squaredNorm() < (b - at).squaredNorm();
  });
  PinchSettings settings{.radius_mm = 1e3 * in.radius_m};
  if (in.frequency_hz > 0.0) settings.frequency_hz = in.frequency_hz;
  if (in.damping_ratio > 0.0) settings.dampingRatio = in.damping_ratio;
  Grab grab = grabAround(body.rest(), static_cast<std::size_t>(nearest - positions.begin()), settings,
                         body.material().youngsModulus);
  limitToTissue(grab, body, 0.0);
  if (in.max_force_N > 0.0) grab.maxForce = in.max_force_N;
  const Vec3 middle = grab.target = middleOf(grab, body);
  if (in.flags & C3DE_SIM_HOLD_SHAPE) keepShape(grab, body);
  const std::uint64_t id = nextRuntimeId_++;
  holds_.emplace(id, RuntimeHold{handle.v, middle - at, at, Mat3::Identity(), !grab.arms.empty()});
  recordGrab(handle.v, grab);
  simulator_.stepper().setGrab(handle.v, std::move(grab), id);
  if (out) *out = {id};
}

// A body that is rebuilt or restored to an earlier state releases its grabs.
WorldSimulator::RuntimeHold &WorldSimulator::holdOrThrow(c3de_handle handle) {
  const auto found = holds_.find(handle.v);
  if (found != holds_.end() && simulator_.stepper().grabStatus(found->second.body, found->first)) return found->second;
  throw Error(C3DE_E_STALE, "no such hold: it was removed, or what it held has been renewed");
}

void WorldSimulator::pull(c3de_handle handle, const double *target_m3, const double *quaternion4) {
  const std::lock_guard lock(mutex_);
  RuntimeHold &hold = holdOrThrow(handle);
  const Vec3 target = Vec3::Map(&sdk::notNull(target_m3, "target_m3"));
  if (!target.allFinite()) throw Error(C3DE_E_ARG, "pull: the target is not finite");
  Mat3 rotation = Mat3::Identity();
  if (quaternion4 && hold.keepsShape) rotation = readRotation(quaternion4, "pull");
  hold.target = target;
  hold.rotation = rotation;
  recordPull(hold.body, handle.v);
  simulator_.stepper().moveGrab(hold.body, target + rotation * hold.fromNamed, handle.v);
  simulator_.stepper().turnGrab(hold.body, rotation, handle.v);
}

void WorldSimulator::holdState(c3de_handle handle, c3de_sim_hold_state *out) {
  const std::lock_guard lock(mutex_);
  const RuntimeHold &hold = holdOrThrow(handle);
  const GrabStatus status = *simulator_.stepper().grabStatus(hold.body, handle.v);
  c3de_sim_hold_state state{};
  state.body = {hold.body};
  Vec3::Map(state.point_m) = status.point - hold.rotation * hold.fromNamed;
  Vec3::Map(state.target_m) = hold.target;
  Vec3::Map(state.force_N) = status.force;
  Vec3::Map(state.torque_Nm) = status.torque;
  state.mass_kg = status.mass;
  sdk::writeStruct(out, state, "out");
}

}  // namespace pointbased
