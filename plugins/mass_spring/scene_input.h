// SPDX-License-Identifier: Apache-2.0
// What a scene says of a body, as the host hands it over. Everything throws sdk::Error for what cannot be.
#pragma once

#include <cstdint>
#include <string>

#include "c3de/sdk/simulator.hpp"
#include "point_body.h"

namespace mass_spring {

/// A number in a message: four digits.
[[nodiscard]] std::string shown(double value);

/// From the frame of a mesh to the world, m.
struct Placement {
  Mat3 linear{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  Mat3 inverse = linear;
  Vec3 position{};
};

/// @param in  null: as it is
[[nodiscard]] Placement readPlacement(const c3de_sim_placement *in);
/// @param middle  of the held part, where the motion names no centre; @param index  of the support, for messages
[[nodiscard]] Motion readMotion(const c3de_sim_motion *in, const Vec3 &middle, std::uint32_t index);
[[nodiscard]] SurfaceLoad readLoad(const c3de_sim_load &in, const PointBody &body);

}  // namespace mass_spring
