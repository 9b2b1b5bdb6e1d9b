// SPDX-License-Identifier: Apache-2.0
#include "simulator/condition_calls.h"

#include <algorithm>

#include "c3de/sdk/conditions.hpp"
#include "simulator/world_simulator.h"

namespace pointbased {

using sdk::Error;

namespace {

static_assert(C3DE_SIM_CONDITION_FIX == static_cast<int>(ConditionKind::fix) + 1 &&
              C3DE_SIM_CONDITION_PRESSURE == static_cast<int>(ConditionKind::pressure) + 1);

SurfacePatch patchOf(const c3de_sim_condition &in) {
  SurfacePatch patch;
  if (in.positions_n > 0) (void)sdk::notNull(in.positions_m, "positions_m");
  if (in.triangles_n > 0) (void)sdk::notNull(in.triangles, "triangles");
  for (std::uint64_t i = 0; i < in.positions_n; ++i)
    patch.positions.emplace_back(in.positions_m[3 * i], in.positions_m[3 * i + 1], in.positions_m[3 * i + 2]);
  for (std::uint64_t i = 0; i < in.triangles_n; ++i)
    patch.triangles.push_back({in.triangles[3 * i], in.triangles[3 * i + 1], in.triangles[3 * i + 2]});
  return patch;
}

}  // namespace

ConditionSnapshot ConditionCalls::existing(std::uint64_t number) {
  const std::lock_guard lock(parts_.world.mutex);
  parts_.conditions.update();
  for (ConditionSnapshot &one : parts_.conditions.snapshots())
    if (one.number == number) return std::move(one);
  throw Error(C3DE_E_STALE,
              "there is no support or load " + std::to_string(number) + "; it was removed, or its body was");
}

void ConditionCalls::set(const c3de_sim_condition *condition, std::uint64_t *number) {
  const c3de_sim_condition in = sdk::readStruct(condition, "condition");
  if (in.kind < C3DE_SIM_CONDITION_FIX || in.kind > C3DE_SIM_CONDITION_PRESSURE)
    throw Error(C3DE_E_ARG, "kind is " + std::to_string(in.kind) + "; accepted: 1 … 4");
  SurfaceCondition made;
  made.name = std::string(sdk::text(in.name));
  made.body = parts_.queries.nameOfBody(in.body.v);
  made.patch = patchOf(in);
  made.kind = static_cast<ConditionKind>(in.kind - C3DE_SIM_CONDITION_FIX);
  made.vector = Vec3(in.vector);
  made.pressure = in.pressure_Pa;
  made.ramp = in.ramp_s;
  made.atRest = (in.flags & C3DE_SIM_CONDITION_AT_REST) != 0;
  std::uint64_t &out = sdk::notNull(number, "number");
  if (out != 0) (void)existing(out);
  out = parts_.changes.make(SetSurfaceCondition{out, std::move(made)}).number;
}

void ConditionCalls::remove(std::uint64_t number) {
  (void)existing(number);
  (void)parts_.changes.make(SetSurfaceCondition{number, std::nullopt});
}

void ConditionCalls::state(std::uint64_t number, c3de_sim_condition_state *out, c3de_sink warning) {
  const ConditionSnapshot now = existing(number);
  c3de_sim_condition_state state{};
  state.area_m2 = now.area;
  std::copy_n(now.force.data(), 3, state.force_N);
  sdk::writeStruct(out, state, "out");
  if (!now.warning.empty())
    if (const c3de_status status = sdk::put(warning, now.warning); status < 0)
      throw Error(status, "the warning was not accepted");
}

}  // namespace pointbased
