// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::session {

struct Bounds_m {
  Vec3 min{}, max{};
};

/// Walls for bodies without a world of their own, so that what falls along -y stays in sight: a floor a little below
/// them, as wide as three of them, and room above. m
[[nodiscard]] Bounds_m roomAround(const Bounds_m &bodies);
/// What a camera should show of them: the bodies, and the floor around where they come to lie. m
[[nodiscard]] Bounds_m framedWith(const Bounds_m &bodies, const Bounds_m &room);

/// Of the skins of all bodies as they are now; none without one. [sim]
[[nodiscard]] std::optional<Bounds_m> boundsOfBodies(c3de_object *simulator);

/// Puts the walls up where the simulator declares world.box; what was put up, or none. Before it is attached. [sim]
[[nodiscard]] Expected<std::optional<Bounds_m>> putUpRoom(c3de_object *simulator, const Bounds_m &bodies);

}  // namespace c3de::session
