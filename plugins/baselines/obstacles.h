// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator.h"

namespace baselines {

using namespace mass_spring;

/// A rigid surface, which stands still or is moved.
/// @throws sdk::Error  what of its mesh or motion cannot be; the host finds no nearest points
[[nodiscard]] Obstacle makeObstacle(sdk::Host host, const c3de_sim_obstacle &in);

}  // namespace baselines
