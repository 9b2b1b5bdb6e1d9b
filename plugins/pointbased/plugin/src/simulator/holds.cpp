// SPDX-License-Identifier: Apache-2.0
#include "simulator/holds.h"

#include <algorithm>
#include <cmath>

#include "c3de/sdk/structs.hpp"
#include "instruments/grab_patch.h"

namespace pointbased {

using sdk::Error;

namespace {

/// Id of the grab of a hold: above all handles, and the same wherever its number is.
std::uint64_t grabOf(std::uint64_t number) { return (std::uint64_t{1} << 48) + number; }

}  // namespace

std::uint64_t Holds::add(ChangeAccess, std::uint64_t held, BeginHold &in) {
  const BodyRecord &record = table_.bodyOrThrow(held);
  const Body &body = *simulator_.body(held);
  const Vec3 &at = in.at;
  const auto amount = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!at.allFinite() || !(in.radius > 0.0) || !std::isfinite(in.radius))
    throw Error(C3DE_E_ARG, "hold: accepted: a finite point and a radius above 0 m");
  if (!amount(in.frequency_hz) || !amount(in.dampingRatio) || !amount(in.maxForce))
    throw Error(C3DE_E_ARG,
                "hold: accepted: a frequency, a damping ratio and a force that are finite and not negative");
  if (in.holdFlags & ~C3DE_SIM_HOLD_SHAPE) throw Error(C3DE_E_UNSUPPORTED, "hold: unknown flags");
  if (body.isStatic())
    throw Error(C3DE_E_STATE, "body '" + record.name + "' is rigid and fixed, so it cannot be pulled");
  std::vector<Vec3> positions, normals;
  simulator_.world().surfels(held, positions, normals);
  if (positions.empty()) throw Error(C3DE_E_STATE, "body '" + record.name + "' has no surface to hold");
  const auto nearest = std::min_element(positions.begin(), positions.end(), [&](const Vec3 &a, const Vec3 &b) {
    return (a - at).squaredNorm() < (b - at).squaredNorm();
  });
  PinchSettings settings{.radius_mm = 1e3 * in.radius};
  if (in.frequency_hz > 0.0) settings.frequency_hz = in.frequency_hz;
  if (in.dampingRatio > 0.0) settings.dampingRatio = in.dampingRatio;
  Grab grab = grabAround(body.rest(), static_cast<std::size_t>(nearest - positions.begin()), settings,
                         body.material().youngsModulus);
  limitToTissue(grab, body, 0.0);
  if (in.maxForce > 0.0) grab.maxForce = in.maxForce;
  const Vec3 middle = grab.target = meanPosition(grab, body);
  if (in.holdFlags & C3DE_SIM_HOLD_SHAPE) addShapeSprings(grab, body);
  const std::uint64_t id = world_.allocateIds(1);
  if (in.number == 0) in.number = lastNumber_ + 1;
  lastNumber_ = std::max(lastNumber_, in.number);
  holds_.emplace(id, Hold{held, middle - at, at, Mat3::Identity(), !grab.arms.empty(), in.number});
  world_.recordGrab(held, grab);
  simulator_.stepper().setGrab(held, std::move(grab), grabOf(in.number));
  return id;
}

void Holds::remove(ChangeAccess, std::uint64_t id) {
  const auto hold = holds_.find(id);
  if (hold == holds_.end()) return;
  simulator_.stepper().releaseGrab(hold->second.body, grabOf(hold->second.number));
  holds_.erase(hold);
}

std::uint64_t Holds::numberOf(std::uint64_t id) const {
  const auto found = holds_.find(id);
  return found == holds_.end() ? 0 : found->second.number;
}

std::uint64_t Holds::holdNumbered(std::uint64_t number) const {
  for (const auto &[id, hold] : holds_)
    if (hold.number == number) return id;
  return 0;
}

void Holds::removeOf(ChangeAccess, std::uint64_t body) {
  std::erase_if(holds_, [&](const auto &entry) { return entry.second.body == body; });
}

// A body that is rebuilt or restored to an earlier state releases its grabs.
Holds::Hold &Holds::holdOrThrow(c3de_handle handle) {
  const auto found = holds_.find(handle.v);
  if (found != holds_.end() && simulator_.stepper().grabStatus(found->second.body, grabOf(found->second.number)))
    return found->second;
  throw Error(C3DE_E_STALE, "no such hold: it was removed, or what it held has been renewed");
}

void Holds::pull(ChangeAccess, std::uint64_t id, const Vec3 &target, const std::optional<Mat3> &turned) {
  Hold &hold = holdOrThrow({id});
  const Mat3 rotation = turned && hold.keepsShape ? *turned : Mat3::Identity();
  hold.target = target;
  hold.rotation = rotation;
  world_.recordPull(hold.body, grabOf(hold.number));
  simulator_.stepper().moveGrab(hold.body, target + rotation * hold.fromNamed, grabOf(hold.number));
  simulator_.stepper().turnGrab(hold.body, rotation, grabOf(hold.number));
}

void Holds::state(c3de_handle handle, c3de_sim_hold_state *out) {
  const std::lock_guard lock(world_.mutex);
  const Hold &hold = holdOrThrow(handle);
  const GrabStatus status = *simulator_.stepper().grabStatus(hold.body, grabOf(hold.number));
  c3de_sim_hold_state state{};
  state.body = {hold.body};
  Vec3::Map(state.point_m) = status.point - hold.rotation * hold.fromNamed;
  Vec3::Map(state.target_m) = hold.target;
  Vec3::Map(state.force_N) = status.force;
  Vec3::Map(state.torque_Nm) = status.torque;
  state.mass_kg = status.mass;
  sdk::writeStruct(out, state, "out");
}

std::vector<SavedHold> Holds::saved() const {
  std::vector<SavedHold> all;
  for (const auto &[id, hold] : holds_)
    if (const BodyRecord *body = table_.body(hold.body))
      all.push_back({hold.number, body->identity(), hold.fromNamed, hold.target, hold.rotation, hold.keepsShape});
  return all;
}

void Holds::restore(const std::vector<SavedHold> &saved) {
  std::map<std::uint64_t, std::uint64_t> ids;  // by number: a plugin keeps the handle of its hold
  for (const auto &[id, hold] : holds_) ids.emplace(hold.number, id);
  holds_.clear();
  for (const SavedHold &one : saved) {
    const auto known = ids.find(one.number);
    holds_.emplace(
        known != ids.end() ? known->second : world_.allocateIds(1),
        Hold{table_.bodyNamed(one.body), one.fromNamed, one.target, one.rotation, one.keepsShape, one.number});
    lastNumber_ = std::max(lastNumber_, one.number);
  }
}

void Holds::grab(ChangeAccess, std::uint64_t body, Grab grab, double ownLimit) {
  if (const Body *held = simulator_.body(body)) limitToTissue(grab, *held, ownLimit);
  world_.recordGrab(body, grab);
  simulator_.stepper().setGrab(body, std::move(grab));
}

void Holds::moveGrab(ChangeAccess, std::uint64_t body, const Vec3 &target) {
  world_.recordPull(body, 0);
  simulator_.stepper().moveGrab(body, target);
}

void Holds::releaseGrab(ChangeAccess, std::uint64_t body) { simulator_.stepper().releaseGrab(body); }

}  // namespace pointbased
