// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/default_floor.h"

#include <algorithm>
#include <array>
#include <limits>

#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/session/scene_to_abi.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

constexpr double kGap = 0.05, kMargin = 1.0, kSpaceAbove = 2.0, kFramed = 0.3;  // of the largest extent

double largestExtent(const Bounds_m &bounds) {
  const Vec3 extent = bounds.max - bounds.min;
  return std::max({extent[0], extent[1], extent[2]});
}

}  // namespace

Bounds_m wallsAround(const Bounds_m &bodies) {
  const double extent = largestExtent(bodies);
  return {bodies.min - Vec3{kMargin * extent, kGap * extent, kMargin * extent},
          bodies.max + Vec3{kMargin * extent, kSpaceAbove * extent, kMargin * extent}};
}

Bounds_m framedWith(const Bounds_m &bodies, const Bounds_m &walls) {
  const double beside = kFramed * largestExtent(bodies);
  return {{bodies.min[0] - beside, walls.min[1], bodies.min[2] - beside},
          {bodies.max[0] + beside, bodies.max[1], bodies.max[2] + beside}};
}

std::optional<Bounds_m> boundsOfBodies(c3de_object *simulator) {
  const auto table = simulatorTable(simulator);
  if (!table) return std::nullopt;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Bounds_m bounds{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  c3de_handle body{};
  for (std::uint64_t i = 0; (*table)->body_at(simulator, i, &body) >= 0; ++i)
    for (const Vec3 &x : surfacePositions(simulator, body))
      for (std::size_t a = 0; a < 3; ++a) {
        bounds.min[a] = std::min(bounds.min[a], x[a]);
        bounds.max[a] = std::max(bounds.max[a], x[a]);
      }
  if (!(bounds.min[0] <= bounds.max[0])) return std::nullopt;
  return bounds;
}

std::vector<ParameterValue> wallParameters(const Bounds_m &walls) {
  std::vector<ParameterValue> values(3);
  values[0].id = C3DE_PARAM_ID_BOX_MIN;
  values[1].id = C3DE_PARAM_ID_BOX_MAX;
  values[2].id = C3DE_PARAM_ID_BOX_ENABLED;
  values[0].type = values[1].type = C3DE_PARAM_VEC3;
  values[2].type = C3DE_PARAM_BOOL;
  values[0].vec = walls.min;
  values[1].vec = walls.max;
  values[2].num = 1.0;
  return values;
}

Expected<std::optional<Bounds_m>> addSurroundingWalls(c3de_object *simulator, const Bounds_m &bodies) {
  const auto table = simulatorTable(simulator);
  if (!table) return tl::unexpected(table.error());
  const auto decls = simulatorDeclarations(simulator, C3DE_SIM_SCOPE_WORLD);
  if (!decls) return tl::unexpected(decls.error());
  const Bounds_m walls = wallsAround(bodies);
  const std::vector<ParameterValue> values = wallParameters(walls);
  for (const ParameterValue &value : values) {
    const auto decl = findParameter(*decls, value.id);
    // Without walls in the simulator, or with a body too large for them, bodies fall as before.
    if (!decl || !checkParameter(**decl, value)) return std::nullopt;
  }
  const std::vector<c3de_param_value> abi = toAbi(values);
  if (const c3de_status code = (*table)->set_world(simulator, abi.data(), abi.size(), sizeof(c3de_param_value));
      code < 0)
    return fail(ErrorCode::plugin, "the simulator refused the walls (status " + std::to_string(code) + ")");
  return walls;
}

}  // namespace c3de::session
