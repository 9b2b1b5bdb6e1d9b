// SPDX-License-Identifier: Apache-2.0
#include "simulator/holds.h"

#include <algorithm>
#include <cmath>

#include "c3de/sdk/structs.hpp"
#include "instruments/grab_patch.h"

namespace pointbased {

using sdk::Error;

void Holds::add(c3de_handle handle, const c3de_sim_hold *hold, c3de_handle *out) {
  const auto in = sdk::readStruct(hold, "hold");
  const std::lock_guard lock(world_.mutex);
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
  if (body.isStatic())
    throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid and fixed, so it cannot be pulled");
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
  const Vec3 middle = grab.target = meanPosition(grab, body);
  if (in.flags & C3DE_SIM_HOLD_SHAPE) addShapeSprings(grab, body);
  const std::uint64_t id = world_.allocateIds(1);
  holds_.emplace(id, Hold{handle.v, middle - at, at, Mat3::Identity(), !grab.arms.empty()});
  world_.recordGrab(handle.v, grab);
  simulator_.stepper().setGrab(handle.v, std::move(grab), id);
  if (out) *out = {id};
}

bool Holds::remove(std::uint64_t id) {
  const auto hold = holds_.find(id);
  if (hold == holds_.end()) return false;
  simulator_.stepper().releaseGrab(hold->second.body, hold->first);
  holds_.erase(hold);
  return true;
}

void Holds::removeOf(std::uint64_t body) {
  std::erase_if(holds_, [&](const auto &entry) { return entry.second.body == body; });
}

// A body that is rebuilt or restored to an earlier state releases its grabs.
Holds::Hold &Holds::holdOrThrow(c3de_handle handle) {
  const auto found = holds_.find(handle.v);
  if (found != holds_.end() && simulator_.stepper().grabStatus(found->second.body, found->first)) return found->second;
  throw Error(C3DE_E_STALE, "no such hold: it was removed, or what it held has been renewed");
}

void Holds::pull(c3de_handle handle, const double *target_m3, const double *quaternion4) {
  const std::lock_guard lock(world_.mutex);
  Hold &hold = holdOrThrow(handle);
  const Vec3 target = Vec3::Map(&sdk::notNull(target_m3, "target_m3"));
  if (!target.allFinite()) throw Error(C3DE_E_ARG, "pull: the target is not finite");
  Mat3 rotation = Mat3::Identity();
  if (quaternion4 && hold.keepsShape) rotation = readRotation(quaternion4, "pull");
  hold.target = target;
  hold.rotation = rotation;
  world_.recordPull(hold.body, handle.v);
  simulator_.stepper().moveGrab(hold.body, target + rotation * hold.fromNamed, handle.v);
  simulator_.stepper().turnGrab(hold.body, rotation, handle.v);
}

void Holds::state(c3de_handle handle, c3de_sim_hold_state *out) {
  const std::lock_guard lock(world_.mutex);
  const Hold &hold = holdOrThrow(handle);
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

void Holds::grab(std::uint64_t body, Grab grab, double ownLimit) {
  const std::lock_guard lock(world_.mutex);
  if (const Body *held = simulator_.body(body)) limitToTissue(grab, *held, ownLimit);
  world_.recordGrab(body, grab);
  simulator_.stepper().setGrab(body, std::move(grab));
}

void Holds::moveGrab(std::uint64_t body, const Vec3 &target) {
  const std::lock_guard lock(world_.mutex);
  world_.recordPull(body, 0);
  simulator_.stepper().moveGrab(body, target);
}

void Holds::releaseGrab(std::uint64_t body) {
  const std::lock_guard lock(world_.mutex);
  simulator_.stepper().releaseGrab(body);
}

}  // namespace pointbased
