// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/parameter.h"
#include "c3de/core/vec.h"

namespace c3de::session {

struct Bounds_m {
  Vec3 min{}, max{};
};

/// Walls for bodies whose scene defines no world, so that a body falling along -y stays in view: a floor slightly below
/// them, three times their extent wide, and free space above. m
[[nodiscard]] Bounds_m wallsAround(const Bounds_m &bodies);
/// The region that a camera should frame: the bodies, and the floor around the position where they come to rest. m
[[nodiscard]] Bounds_m framedWith(const Bounds_m &bodies, const Bounds_m &room);

/// Of the present skins of all bodies; none without a body. [sim]
[[nodiscard]] std::optional<Bounds_m> boundsOfBodies(c3de_object *simulator);

/// The parameters of the world that describe the walls.
[[nodiscard]] std::vector<ParameterValue> wallParameters(const Bounds_m &walls);

/// Adds the walls where the simulator declares world.box. Returns the walls added, or none. Call before attach(). [sim]
[[nodiscard]] Expected<std::optional<Bounds_m>> addSurroundingWalls(c3de_object *simulator, const Bounds_m &bodies);

}  // namespace c3de::session
