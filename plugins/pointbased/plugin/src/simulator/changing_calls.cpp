// SPDX-License-Identifier: Apache-2.0
#include "simulator/changing_calls.h"

#include <algorithm>

#include "c3de/sdk/structs.hpp"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

void ChangingCalls::setWorld(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride) {
  SetWorldParameters change;
  for (std::uint64_t i = 0; i < n; ++i) change.values.emplace_back(sdk::readElement(values, i, stride, "value"));
  (void)parts_.changes.make(std::move(change));
}

void ChangingCalls::setBodyParameter(c3de_handle body, const c3de_param_value *value) {
  const c3de_param_value in = sdk::readStruct(value, "value");
  (void)parts_.changes.make(SetBodyParameter{parts_.queries.nameOfBody(body.v), ParameterEntry(in)});
}

RemoveObject ChangingCalls::removalOf(std::uint64_t id) const {
  using What = RemoveObject::What;
  const std::lock_guard lock(parts_.world.mutex);
  const BodyTable &table = parts_.world.table;
  if (const BodyRecord *body = table.body(id)) return {What::body, body->identity()};
  if (const std::uint64_t number = parts_.holds.numberOf(id)) return {What::hold, {}, number};
  if (const std::uint64_t number = parts_.forces.numberOf(id)) return {What::load, {}, number};
  for (const Probe &probe : parts_.world.simulator.world().probes())
    if (probe.id == id) return {What::probe, {probe.name}};
  if (const ObstacleRecord *obstacle = table.obstacle(id)) return {What::obstacle, obstacle->identity()};
  if (const auto found = table.attachments().find(id); found != table.attachments().end())
    return {What::attachment, {found->second.name}};
  if (const auto found = parts_.world.grasps.find(id); found != parts_.world.grasps.end() && id != kInteractiveGrasp)
    return {What::grasp, {found->second.name}};
  throw Error(noSuch("body, obstacle, attachment, load, probe, grasp or hold"));
}

void ChangingCalls::remove(c3de_handle what) { (void)parts_.changes.make(removalOf(what.v)); }

void ChangingCalls::clear() { (void)parts_.changes.make(ClearWorld()); }

c3de_status ChangingCalls::saveState(c3de_sink bytes) {
  return sdk::put(bytes, parts_.changes.make(StoreState()).bytes);
}

void ChangingCalls::addLoad(c3de_handle body, const c3de_sim_load *load, c3de_handle *out) {
  const AddLoad made = parts_.changes.make(AddLoad{parts_.queries.nameOfBody(body.v), readLoad(load)});
  if (out) *out = {made.id};
}

void ChangingCalls::hold(c3de_handle body, const c3de_sim_hold *hold, c3de_handle *out) {
  const c3de_sim_hold in = sdk::readStruct(hold, "hold");
  const BeginHold made = parts_.changes.make(BeginHold{parts_.queries.nameOfBody(body.v), Vec3(in.at_m), in.radius_m,
                                                       in.frequency_hz, in.damping_ratio, in.max_force_N, in.flags});
  if (out) *out = {made.id};
}

void ChangingCalls::pull(c3de_handle hold, const double *target_m3, const double *quaternion4) {
  PullHold change;
  {
    const std::lock_guard lock(parts_.world.mutex);
    change.number = parts_.holds.numberOf(hold.v);
  }
  change.target = Vec3::Map(&sdk::notNull(target_m3, "target_m3"));
  if (quaternion4) std::copy_n(quaternion4, 4, change.quaternion.emplace().begin());
  if (change.number == 0) throw Error(noSuch("hold"));
  (void)parts_.changes.make(change);
}

}  // namespace pointbased
