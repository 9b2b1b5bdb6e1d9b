// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "c3de/abi/iface/simulator.h"
#include "pointbased/body.h"

namespace pointbased {

/// The fields of iface.simulator: positions, velocities, masses and volumes of phyxels, deformation gradient F, Green
/// strain, second Piola-Kirchhoff stress and von Mises stress (of the Cauchy stress F S Fᵀ / det F; 0 where the point is
/// inverted), and the positions and normals of surfels.
[[nodiscard]] std::span<const c3de_sim_field> bodyFields();

/// Copies a field into room for all its rows. Errors as sdk::Error: no such field (names what there is), no room.
void readBodyField(const Body &body, std::uint32_t on, std::string_view name, const c3de_mview &out);

}  // namespace pointbased
